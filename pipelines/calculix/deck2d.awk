# Conditions of a deck in 2D, see deck.awk.

function deck_dim() { return 2 }

# The rigid curve as a strip of quadrilaterals 6 mm wide, all its nodes fixed, behind the face that the body touches.
function print_contact(k,    n, i, f, dx, dy, length_, sign, first_node, first_element, next_node, name, thickness) {
    n = read_table(k, "rigid", 2)
    thickness = 6e-3
    sign = scene_value[k, "side"] == "left" ? 1 : -1 # the strip lies on the other side of the curve
    name = toupper(label[k])
    first_node = node_count
    print "*NODE,NSET=RIGID_" name
    for (i = 1; i <= n; i++) {
        dx = table[i < n ? i + 1 : i, 1] - table[i > 1 ? i - 1 : i, 1]
        dy = table[i < n ? i + 1 : i, 2] - table[i > 1 ? i - 1 : i, 2]
        length_ = sqrt(dx^2 + dy^2)
        printf "%d,%.9g,%.9g\n", ++node_count, table[i, 1], table[i, 2]
        printf "%d,%.9g,%.9g\n", ++node_count, table[i, 1] + sign * thickness * dy / length_,
            table[i, 2] - sign * thickness * dx / length_
    }
    first_element = element_count + 1
    print "*ELEMENT,TYPE=CPE4,ELSET=STRIP_" name
    for (i = 1; i < n; i++) {
        f = first_node + 2 * i - 1
        next_node = f + 2
        if (sign > 0) printf "%d,%d,%d,%d,%d\n", ++element_count, f, f + 1, next_node + 1, next_node
        else printf "%d,%d,%d,%d,%d\n", ++element_count, next_node, next_node + 1, f + 1, f
    }
    print_stiff(name)
    print "*SURFACE,NAME=MASTER_" name ",TYPE=ELEMENT"
    for (i = first_element; i <= element_count; i++) print i ",S4"
    print_pair(k)
}
