# Data for body3d.gp: awk -f pipelines/stream.awk -f body3d.awk -v field=STREAM -v view=X,Y,Z -v most=MM [-v cut=X,Y,Z,MM] > FILE
#
# field: u.dat of a body in 3D; view: where it is seen from, z is up. cut: what lies beyond that plane (normal and offset) at rest
# is taken away. The body is drawn where it comes to lie. Blocks: segments x y dx dy, mm on the screen, of the outline at rest; then
# polygons, from far to near: rows x y colour, a blank line between. Colours: |u| up to `most` mm, shaded; green beyond.

BEGIN {
    read_stream(field, "")
    need_section("facets", "run nodes")
    need_section("u", "run mtled")
    split(view, n, ",")
    scale(n)
    turned = sqrt(n[1]^2 + n[2]^2)
    r[1] = -n[2] / turned; r[2] = n[1] / turned; r[3] = 0
    for (k = 1; k <= 3; k++) up[k] = n[k % 3 + 1] * r[(k + 1) % 3 + 1] - n[(k + 1) % 3 + 1] * r[k % 3 + 1]
    if (cut != "") { split(cut, plane, ","); offset = plane[4]; plane[4] = 0; scale(plane) }
    stops = split("fc fd bf fe c4 88 fb 87 61 e5 50 64 b5 36 7a 81 25 81 4f 12 7b 1c 10 44", byte) / 3
    for (i in byte) byte[i] = hex(byte[i])
    for (i = 0; i < rows["u"]; i++) {
        for (d = 0; d < 3; d++) { rest[d + 1] = 1e3 * value["nodes.x", i, d]; u[d + 1] = 1e3 * value["u", i, d] }
        place(i, rest, u)
    }
    boundary()
    outline()
    if (cut != "") for (c = 0; c < rows["cells"]; c++) cut_cell(c)
    print "\n"
    for (d = least; d <= greatest; d++) printf "%s", polygons[d]
}

function scale(v,    size) { size = sqrt(v[1]^2 + v[2]^2 + v[3]^2); v[1] /= size; v[2] /= size; v[3] /= size }
function along(a, v) { return a[1] * v[1] + a[2] * v[2] + a[3] * v[3] }
function hex(pair) { return 16 * (index("0123456789abcdef", substr(pair, 1, 1)) - 1) + index("0123456789abcdef", substr(pair, 2, 1)) - 1 }

# Vertex i: at rest on the screen, moved there with its depth, its |u|, its height over the plane of the cut.
function place(i, at, u,    k, moved) {
    for (k = 1; k <= 3; k++) moved[k] = at[k] + u[k]
    was_x[i] = along(at, r); was_y[i] = along(at, up); was_z[i] = along(at, n)
    x[i] = along(moved, r); y[i] = along(moved, up); z[i] = along(moved, n)
    size[i] = sqrt(u[1]^2 + u[2]^2 + u[3]^2)
    above[i] = cut == "" ? -1 : along(at, plane) - offset
}

# The vertex where edge a-b meets the plane.
function meet(a, b,    i, t) {
    i = (a + 0) < (b + 0) ? a ":" b : b ":" a
    if (!(i in x)) {
        t = above[a] / (above[a] - above[b])
        x[i] = x[a] + t * (x[b] - x[a]); y[i] = y[a] + t * (y[b] - y[a]); z[i] = z[a] + t * (z[b] - z[a])
        size[i] = size[a] + t * (size[b] - size[a])
    }
    return i
}

# The whole boundary: facets of one cell each. Named ones may stand twice.
function boundary(    c, k, l, m, v, w, key, count) {
    split("1 2 3 0 3 2 0 1 3 0 2 1", corner, " ")
    for (c = 0; c < rows["cells"]; c++)
        for (k = 0; k < 4; k++) {
            for (l = 1; l <= 3; l++) v[l] = value["cells", c, corner[3 * k + l]] + 0
            key = sorted(v)
            if (key in face) delete face[key]
            else face[key] = v[1] " " v[2] " " v[3]
        }
    for (key in face) { split(face[key], v, " "); facet(v) }
}

function sorted(v,    a, b, c, t) {
    a = v[1]; b = v[2]; c = v[3]
    if (a > b) { t = a; a = b; b = t }
    if (b > c) { t = b; b = c; c = t }
    if (a > b) { t = a; a = b; b = t }
    return a "," b "," c
}

function facet(v,    k, a, b, count, ring, front) {
    front = (was_x[v[2]] - was_x[v[1]]) * (was_y[v[3]] - was_y[v[1]]) > (was_x[v[3]] - was_x[v[1]]) * (was_y[v[2]] - was_y[v[1]])
    for (k = 1; k <= 3; k++) side[v[k], v[k % 3 + 1]] = front
    for (k = 1; k <= 3; k++) {
        a = v[k]; b = v[k % 3 + 1]
        if (above[a] <= 0) ring[++count] = a
        if ((above[a] <= 0) != (above[b] <= 0)) ring[++count] = meet(a, b)
    }
    if (count > 2) polygon(ring, count, 0)
}

# Edges at rest between facets that face the viewer and facets that do not.
function outline(    edge, v) {
    for (edge in side) {
        split(edge, v, SUBSEP)
        if (side[edge] && !side[v[2], v[1]])
            printf "%.5g %.5g %.5g %.5g\n", was_x[v[1]], was_y[v[1]], was_x[v[2]] - was_x[v[1]], was_y[v[2]] - was_y[v[1]]
    }
}

function cut_cell(c,    k, i, low, lows, high, highs, ring, count) {
    for (k = 0; k < 4; k++) {
        i = value["cells", c, k] + 0
        if (above[i] <= 0) low[++lows] = i
        else high[++highs] = i
    }
    if (lows == 0 || highs == 0) return
    if (lows == 2) {
        ring[1] = meet(low[1], high[1]); ring[2] = meet(low[1], high[2]); ring[3] = meet(low[2], high[2]); ring[4] = meet(low[2], high[1])
        count = 4
    } else for (k = 1; k <= 3; k++) { ring[k] = lows == 1 ? meet(low[1], high[k]) : meet(low[k], high[1]); count = 3 }
    polygon(ring, count, 1)
}

# A convex polygon goes to its depth, coloured by its mean |u|, shaded by its normal; facets that turn away are left out.
function polygon(ring, count, inside,    k, ax, ay, az, bx, by, bz, nx, ny, nz, normal, light, depth, mean, text, colour) {
    ax = x[ring[2]] - x[ring[1]]; ay = y[ring[2]] - y[ring[1]]; az = z[ring[2]] - z[ring[1]]
    bx = x[ring[3]] - x[ring[1]]; by = y[ring[3]] - y[ring[1]]; bz = z[ring[3]] - z[ring[1]]
    nx = ay * bz - az * by; ny = az * bx - ax * bz; nz = ax * by - ay * bx
    if (nz <= 0 && !inside) return
    normal = sqrt(nx^2 + ny^2 + nz^2)
    if (normal == 0) return
    light = inside ? 1 : 0.55 + 0.45 * (-0.35 * nx + 0.5 * ny + 0.79 * nz) / normal
    if (light < 0.4) light = 0.4
    if (light > 1) light = 1
    for (k = 1; k <= count; k++) { depth += z[ring[k]] / count; mean += size[ring[k]] / count }
    colour = shade(mean, light)
    for (k = 1; k <= count + 1; k++) text = text sprintf("%.5g %.5g %d\n", x[ring[(k - 1) % count + 1]], y[ring[(k - 1) % count + 1]], colour)
    depth = int(10 * depth + 1e5)
    if (least == "" || depth < least) least = depth
    if (depth > greatest) greatest = depth
    polygons[depth] = polygons[depth] text "\n"
}

function shade(mean, light,    t, k, c, sum) {
    if (mean > most) return 65536 * int(30 * light) + 256 * int(160 * light) + int(90 * light)
    t = mean / most * (stops - 1)
    k = int(t)
    if (k > stops - 2) k = stops - 2
    for (c = 1; c <= 3; c++) sum = 256 * sum + int(light * (byte[3 * k + c] + (t - k) * (byte[3 * k + 3 + c] - byte[3 * k + c])))
    return sum
}
