# Data for picture.gp: awk -f pipelines/stream.awk -f surface.awk -v field=STREAM > FILE
#
# field: u.dat as mtled writes it. The deformed outer surface seen from the craniotomy along its axis, up being up: the first
# block is the rim of the craniotomy (x y dx dy, mm on the screen), each further one a triangle that faces the viewer, from
# far to near (x y |u|, mm; a grid of 2 x 2 points, the last one doubled, as pm3d takes it).

BEGIN {
    read_stream(field, "")
    need_section("facets", "run nodes")
    need_section("u", "run mtled")
    view(0.9798, 0.1591, 0.1212)
    count = split(attribute["facets.set", "names"], name, ",")
    for (i = 1; i <= count; i++) group[i - 1] = name[i]
    for (i = 0; i < rows["u"]; i++) project(i)

    print "# rim"
    for (f = 0; f < rows["facets"]; f++) {
        set = group[value["facets.set", f, 0]]
        if (set == "ventricles") continue
        for (k = 0; k < 3; k++) {
            a = value["facets", f, k]
            b = value["facets", f, (k + 1) % 3]
            if ((b, a) in side && side[b, a] != set)
                printf "%.5g %.5g %.5g %.5g\n", right[a], up[a], right[b] - right[a], up[b] - up[a]
            side[a, b] = set
        }
        store(f)
    }
    for (d = nearest_depth; d <= farthest_depth; d++) printf "%s", triangles[d]
}

# The viewer's axes: n points to him.
function view(x, y, z,    length_) {
    nx = x; ny = y; nz = z
    length_ = sqrt(x^2 + y^2)
    rx = -y / length_; ry = x / length_
    ux = -nz * ry; uy = nz * rx; uz = nx * ry - ny * rx
}

function project(i,    x, y, z) {
    x = 1e3 * (value["nodes.x", i, 0] + value["u", i, 0])
    y = 1e3 * (value["nodes.x", i, 1] + value["u", i, 1])
    z = 1e3 * (value["nodes.x", i, 2] + value["u", i, 2])
    right[i] = rx * x + ry * y
    up[i] = ux * x + uy * y + uz * z
    depth[i] = nx * x + ny * y + nz * z
    moved[i] = 1e3 * sqrt(value["u", i, 0]^2 + value["u", i, 1]^2 + value["u", i, 2]^2)
}

# Keep facet f under its depth if it faces the viewer.
function store(f,    a, b, c, d) {
    a = value["facets", f, 0]
    b = value["facets", f, 1]
    c = value["facets", f, 2]
    if ((right[b] - right[a]) * (up[c] - up[a]) <= (right[c] - right[a]) * (up[b] - up[a])) return
    d = int(10 * (depth[a] + depth[b] + depth[c]) / 3 + 1e4) # 0.1 mm
    if (nearest_depth == "" || d < nearest_depth) nearest_depth = d
    if (d > farthest_depth) farthest_depth = d
    triangles[d] = triangles[d] "\n\n" point(a) point(b) "\n" point(c) point(c)
}

function point(i) {
    return sprintf("%.5g %.5g %.4g\n", right[i], up[i], moved[i])
}
