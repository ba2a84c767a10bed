# Move nodes of a mesh of tetrahedra (MSH 2.2, ASCII) at random, those on the boundary a little, as long as no cell at them
# gets worse than a radius ratio of .002: awk -v seed=N -f jitter.awk in.msh > out.msh

function length3(a, b) { return sqrt((x[a] - x[b]) ^ 2 + (y[a] - y[b]) ^ 2 + (z[a] - z[b]) ^ 2) }

function area(a, b, c,  u1, u2, u3, v1, v2, v3) {
    u1 = x[b] - x[a]; u2 = y[b] - y[a]; u3 = z[b] - z[a]
    v1 = x[c] - x[a]; v2 = y[c] - y[a]; v3 = z[c] - z[a]
    return sqrt((u2 * v3 - u3 * v2) ^ 2 + (u3 * v1 - u1 * v3) ^ 2 + (u1 * v2 - u2 * v1) ^ 2) / 2
}

function volume(a, b, c, d,  u1, u2, u3, v1, v2, v3, w1, w2, w3) {
    u1 = x[b] - x[a]; u2 = y[b] - y[a]; u3 = z[b] - z[a]
    v1 = x[c] - x[a]; v2 = y[c] - y[a]; v3 = z[c] - z[a]
    w1 = x[d] - x[a]; w2 = y[d] - y[a]; w3 = z[d] - z[a]
    return (u1 * (v2 * w3 - v3 * w2) - u2 * (v1 * w3 - v3 * w1) + u3 * (v1 * w2 - v2 * w1)) / 6
}

function quality(cell,  a, b, c, d, v, p, e, f, g, s) {
    a = corner[cell, 1]; b = corner[cell, 2]; c = corner[cell, 3]; d = corner[cell, 4]
    v = volume(a, b, c, d)
    if (v <= 0) return -1
    e = length3(a, b) * length3(c, d); f = length3(a, c) * length3(b, d); g = length3(a, d) * length3(b, c)
    p = (e + f + g) / 2
    s = p * (p - e) * (p - f) * (p - g)
    return s <= 0 ? 0 : 54 * v * v / ((area(a, b, c) + area(a, b, d) + area(a, c, d) + area(b, c, d)) * sqrt(s))
}

function worst(node,  i, q, least) {
    least = 1
    for (i = 1; i <= cells_at[node]; i++) {
        q = quality(cell_at[node, i])
        if (q < least) least = q
    }
    return least
}

{ line[NR] = $0 }
$1 ~ /^\$/ { section = $1 }
section == "$Nodes" && NF == 4 { x[$1] = $2; y[$1] = $3; z[$1] = $4; place[$1] = NR; order[++nodes] = $1 }
section == "$Elements" && $2 == 2 { for (k = NF - 2; k <= NF; k++) on_boundary[$k] = 1 }
section == "$Elements" && $2 == 4 {
    cells++
    for (k = 1; k <= 4; k++) {
        node = corner[cells, k] = $(NF - 4 + k)
        cell_at[node, ++cells_at[node]] = cells
    }
}

END {
    srand(seed)
    for (c = 1; c <= cells; c++) { # positive, whatever the order in the file
        if (volume(corner[c, 1], corner[c, 2], corner[c, 3], corner[c, 4]) < 0) {
            swap = corner[c, 1]; corner[c, 1] = corner[c, 2]; corner[c, 2] = swap
        }
    }
    for (i = 1; i <= 3 * nodes; i++) {
        n = order[(i - 1) % nodes + 1]
        if (!cells_at[n]) continue
        if (i <= nodes) { x0[n] = x[n]; y0[n] = y[n]; z0[n] = z[n] }
        size = length3(corner[cell_at[n, 1], 1], corner[cell_at[n, 1], 2])
        px = x[n]; py = y[n]; pz = z[n]
        for (try = 0; try < 6; try++) {
            reach = (n in on_boundary ? .2 : .9) * size * (1 - try / 8)
            x[n] = x0[n] + reach * (2 * rand() - 1); y[n] = y0[n] + reach * (2 * rand() - 1); z[n] = z0[n] + reach * (2 * rand() - 1)
            if (worst(n) >= .002) break
            x[n] = px; y[n] = py; z[n] = pz
        }
        line[place[n]] = sprintf("%d %.12g %.12g %.12g", n, x[n], y[n], z[n])
    }
    for (i = 1; i <= NR; i++) print line[i]
}
