# Conditions of a deck in 3D, see deck.awk.

function deck_dim() { return 3 }

# ---- displacements by table ------------------------------------------------------------------------------------------

# u at node i by the table of n points on a surface: the quadratic polynomial in the coordinates from the node that fits the
# nearest points, weighted by distance, best; combinations that points on a surface do not tell are kept small.
function table_at(i, n, u,    count, r, s, d, distance, radius, w, p, A, a, b) {
    count = nearest_rows(i, n, 24)
    radius = 1.1 * near_distance[count]
    for (r = 1; r <= count; r++) {
        s = near_row[r]
        distance = near_distance[r] / radius
        w = (1 - distance)^3 * (1 + 3 * distance)
        p[1] = 1
        for (d = 1; d <= 3; d++) p[1 + d] = (table[s, d] - x[i, d]) / radius
        p[5] = p[2]^2; p[6] = p[3]^2; p[7] = p[4]^2
        p[8] = p[2] * p[3]; p[9] = p[3] * p[4]; p[10] = p[4] * p[2]
        for (a = 1; a <= 10; a++) {
            for (b = 1; b <= 10; b++) A[a, b] += w * p[a] * p[b]
            for (d = 1; d <= 3; d++) A[a, 10 + d] += w * p[a] * table[s, 3 + d]
        }
    }
    for (a = 2; a <= 10; a++) A[a, a] += 1e-9 * A[1, 1]
    solve(A, 10, 3)
    for (d = 1; d <= 3; d++) u[d] = A[1, 10 + d]
}

# The `most` rows of the table nearest to node i, nearest first: near_row, near_distance; returns how many there are.
function nearest_rows(i, n, most,    s, at, count, distance) {
    for (s = 1; s <= n; s++) {
        distance = sqrt((table[s, 1] - x[i, 1])^2 + (table[s, 2] - x[i, 2])^2 + (table[s, 3] - x[i, 3])^2)
        if (count == most && distance >= near_distance[count]) continue
        at = count < most ? ++count : count
        for (; at > 1 && near_distance[at - 1] > distance; at--) {
            near_distance[at] = near_distance[at - 1]
            near_row[at] = near_row[at - 1]
        }
        near_distance[at] = distance
        near_row[at] = s
    }
    return count
}

# Solve the symmetric positive definite system A[1..n, 1..n] for `right` columns behind it, in place.
function solve(A, n, right,    a, b, c, factor) {
    for (a = 1; a <= n; a++)
        for (b = 1; b <= n; b++) {
            if (b == a) continue
            factor = A[b, a] / A[a, a]
            for (c = a; c <= n + right; c++) A[b, c] -= factor * A[a, c]
        }
    for (a = 1; a <= n; a++)
        for (c = n + 1; c <= n + right; c++) A[a, c] /= A[a, a]
}

# ---- contact ---------------------------------------------------------------------------------------------------------

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
