# Tables of displacements of a scene and their values at points, for the programs of pipelines/, after pipelines/scene.awk, which
# reads the scene: awk -f pipelines/stream.awk -f pipelines/scene.awk -f pipelines/table.awk -f PROGRAM ...
#
# The program keeps dim and the coordinates of its points, x[point, 1..dim], m.

# Rows of a table of the scene: table[row, column], in metres, rows from 1; returns their number. Blank lines and
# comments are skipped.
function read_table(k, key, width,    file, line, field, count, n, i) {
    file = folder scene_value[k, key]
    while ((getline line < file) > 0) {
        sub(/#.*/, "", line)
        count = split(line, field)
        if (count == 0) continue
        n++
        if (count != width) die(file ": not rows of " width " numbers")
        for (i = 1; i <= count; i++) table[n, i] = field[i] * metres(scene_value[k, "unit"])
    }
    close(file)
    if (n < 2) die(file ": no table")
    return n
}

# u[1..dim] at point i by the table of n rows, m.
function table_at(i, n, u) {
    if (dim == 2) table_at_curve(i, n, u)
    else table_at_surface(i, n, u)
}

# u at point i by the table of n points along a curve: linear between the ends of the nearest segment.
function table_at_curve(i, n, u,    s, best, distance2, t, dx, dy) {
    best = -1
    for (s = 1; s < n; s++) {
        dx = table[s + 1, 1] - table[s, 1]
        dy = table[s + 1, 2] - table[s, 2]
        t = ((x[i, 1] - table[s, 1]) * dx + (x[i, 2] - table[s, 2]) * dy) / (dx^2 + dy^2)
        t = t < 0 ? 0 : t > 1 ? 1 : t
        distance2 = (x[i, 1] - table[s, 1] - t * dx)^2 + (x[i, 2] - table[s, 2] - t * dy)^2
        if (best >= 0 && distance2 >= best) continue
        best = distance2
        u[1] = table[s, 3] + t * (table[s + 1, 3] - table[s, 3])
        u[2] = table[s, 4] + t * (table[s + 1, 4] - table[s, 4])
    }
}

# u at point i by the table of n points on a surface: the quadratic polynomial in the coordinates from the point that fits the
# nearest points, weighted by distance, best; combinations that points on a surface do not tell are kept small.
function table_at_surface(i, n, u,    count, r, s, d, distance, radius, w, p, A, a, b) {
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

# The `most` rows of the table nearest to point i, nearest first: near_row, near_distance; returns how many there are.
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
