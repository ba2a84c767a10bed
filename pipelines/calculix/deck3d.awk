# Conditions of a deck in 3D, see deck.awk.

function deck_dim() { return 3 }

# The rigid triangles as wedges 6 mm thick, all their nodes fixed, behind the face that the body touches.
function print_contact(k,    n, t, i, d, sign, name, first_node, count, text, number, thickness, length_, first_element) {
    n = read_table(k, "rigid", 9)
    thickness = 6e-3
    sign = scene_value[k, "side"] == "back" ? 1 : -1 # the normals, or their opposites, point away from the body
    name = toupper(label[k])
    for (t = 1; t <= n; t++)
        for (i = 1; i <= 3; i++) {
            text = table[t, 3 * i - 2] " " table[t, 3 * i - 1] " " table[t, 3 * i]
            if (!(text in number)) {
                number[text] = ++count
                for (d = 1; d <= 3; d++) vertex[count, d] = table[t, 3 * (i - 1) + d]
            }
            corner_of[t, i] = number[text]
        }
    for (t = 1; t <= n; t++) add_normal(t)
    first_node = node_count
    print "*NODE,NSET=RIGID_" name
    for (i = 1; i <= count; i++) {
        length_ = sign * sqrt(away[i, 1]^2 + away[i, 2]^2 + away[i, 3]^2) / thickness
        printf "%d,%.9g,%.9g,%.9g\n", ++node_count, vertex[i, 1], vertex[i, 2], vertex[i, 3]
        printf "%d,%.9g,%.9g,%.9g\n", ++node_count, vertex[i, 1] + away[i, 1] / length_,
            vertex[i, 2] + away[i, 2] / length_, vertex[i, 3] + away[i, 3] / length_
    }
    first_element = element_count + 1
    print "*ELEMENT,TYPE=C3D6,ELSET=STRIP_" name
    for (t = 1; t <= n; t++) {
        text = ++element_count
        for (d = -1; d <= 0; d++)
            for (i = 1; i <= 3; i++) text = text "," first_node + 2 * corner_of[t, sign > 0 ? i : 4 - i] + d
        print text
    }
    print_stiff(name)
    print "*SURFACE,NAME=MASTER_" name ",TYPE=ELEMENT"
    for (i = first_element; i <= element_count; i++) print i ",S1"
    print_pair(k)
}

# Add the normal of triangle t, as long as twice its area, to those of its corners.
function add_normal(t,    i, d, e, f, p, q) {
    for (d = 1; d <= 3; d++) {
        p[d] = vertex[corner_of[t, 2], d] - vertex[corner_of[t, 1], d]
        q[d] = vertex[corner_of[t, 3], d] - vertex[corner_of[t, 1], d]
    }
    for (d = 1; d <= 3; d++) {
        e = d % 3 + 1
        f = e % 3 + 1
        for (i = 1; i <= 3; i++) away[corner_of[t, i], d] += p[e] * q[f] - p[f] * q[e]
    }
}
