# Data for picture.gp: awk -f pipelines/stream.awk -f slice.awk -v field=STREAM -v skull=TABLE > FILE
#
# field: u.dat as mtled writes it; skull: the triangles of the scene, mm. The material that lies at z = 20 mm at rest, where it
# comes to lie, seen from above. Blocks: segments (x y dx dy, mm) of the skull, of the outline at rest and of the deformed
# one; then each cut cell (x y |u|, mm; a grid of 2 x 2 points).

BEGIN {
    read_stream(field, "")
    need_section("cells", "run nodes")
    need_section("u", "run mtled")
    level = 20
    for (i = 0; i < rows["u"]; i++)
        for (d = 0; d < 3; d++) {
            at[i, d] = 1e3 * value["nodes.x", i, d]
            u[i, d] = 1e3 * value["u", i, d]
        }

    print "# skull"
    while ((getline line < skull) > 0) {
        if (line ~ /^#/) continue
        split(line, word)
        for (i = 0; i < 3; i++)
            for (d = 0; d < 3; d++) { at["s" i, d] = word[3 * i + d + 1]; u["s" i, d] = 0 }
        segment("s0", "s1", "s2", 0)
    }
    print "\n\n# outline at rest"
    for (f = 0; f < rows["facets"]; f++) segment(value["facets", f, 0], value["facets", f, 1], value["facets", f, 2], 0)
    print "\n\n# deformed outline"
    for (f = 0; f < rows["facets"]; f++) segment(value["facets", f, 0], value["facets", f, 1], value["facets", f, 2], 1)
    for (c = 0; c < rows["cells"]; c++) cut()
}

function is_above(i) { return at[i, 2] > level }

# Where edge a-b meets the level: cut_x[d], cut_u[d].
function meet(a, b,    t, d) {
    t = (level - at[a, 2]) / (at[b, 2] - at[a, 2])
    for (d = 0; d < 3; d++) {
        cut_x[d] = at[a, d] + t * (at[b, d] - at[a, d])
        cut_u[d] = u[a, d] + t * (u[b, d] - u[a, d])
    }
}

# The segment in which triangle a b c meets the level, moved by `part` of the displacement.
function segment(a, b, c, part,    n, x, y) {
    if (is_above(a) != is_above(b)) { meet(a, b); x[++n] = cut_x[0] + part * cut_u[0]; y[n] = cut_x[1] + part * cut_u[1] }
    if (is_above(b) != is_above(c)) { meet(b, c); x[++n] = cut_x[0] + part * cut_u[0]; y[n] = cut_x[1] + part * cut_u[1] }
    if (is_above(c) != is_above(a)) { meet(c, a); x[++n] = cut_x[0] + part * cut_u[0]; y[n] = cut_x[1] + part * cut_u[1] }
    if (n == 2) printf "%.5g %.5g %.5g %.5g\n", x[1], y[1], x[2] - x[1], y[2] - y[1]
}

# Cell c where it meets the level: a triangle (a corner doubled) or a quadrilateral.
function cut(    i, low, lows, high, highs) {
    for (i = 0; i < 4; i++)
        if (is_above(value["cells", c, i])) high[++highs] = value["cells", c, i]
        else low[++lows] = value["cells", c, i]
    if (lows == 0 || highs == 0) return
    print "\n"
    point(low[1], high[1])
    point(low[1], high[highs == 1 ? 1 : 2])
    print ""
    point(low[lows == 1 ? 1 : 2], high[highs == 1 ? 1 : highs == 3 ? 3 : 1])
    point(low[lows == 1 ? 1 : lows == 3 ? 3 : 2], high[highs == 3 ? 3 : highs == 1 ? 1 : 2])
}

function point(a, b) {
    meet(a, b)
    printf "%.5g %.5g %.4g\n", cut_x[0] + cut_u[0], cut_x[1] + cut_u[1], sqrt(cut_u[0]^2 + cut_u[1]^2 + cut_u[2]^2)
}
