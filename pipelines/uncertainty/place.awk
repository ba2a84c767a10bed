# Where a region comes to lie in each of many cases: awk -f pipelines/stream.awk -f place.awk -v mesh=STREAM -v region=NAME < ROWS
#
# mesh: what `nodes -t` writes (2D). ROWS: for each case a line "case NAME", then a line of u for each node. Writes blocks for gnuplot, mm:
# "centres": a line "NAME x y ux uy" for each case, the centre of the deformed region and how far it has moved; "rest": the region's
# outline; "mean": its mean; "outlines": each case's; "band": the mean, and the 2.5 and 97.5 percentiles of the place along the normal of the
# mean, as a line "x y x_low y_low x_high y_high normal_x normal_y" for each node of the outline.

BEGIN {
    read_stream(mesh, "")
    need_section("cells", "run nodes")
    wanted = name_index_of(region)
    nodes = rows["nodes.x"]
    cells = count = 0
    for (c = 0; c < rows["cells"]; c++) {
        if (value["cells.region", c, 0] != wanted) continue
        for (k = 0; k < 3; k++) corner[cells, k] = value["cells", c, k] + 0
        cells++
        for (k = 0; k < 3; k++) edge[value["cells", c, k] + 0, value["cells", c, (k + 1) % 3] + 0] = 1
    }
    if (cells == 0) die(mesh ": region " region " has no cells")
    # Edges of one cell only, one behind the other.
    for (pair in edge) {
        split(pair, end, SUBSEP)
        if (!((end[2], end[1]) in edge)) { after[end[1]] = end[2]; if (first == "" || end[1] + 0 < first) first = end[1] + 0 }
    }
    node = first
    do { outline[count++] = node; node = after[node] } while (node != first && count <= nodes)
    for (node in after) edges++
    if (count != edges) die(mesh ": the outline of region " region " is not one closed line")
}

$1 == "case" { check_case(); name[cases++] = $2; row = 0; next }
{
    if (row >= nodes) die("case " name[cases - 1] ": more rows than the mesh has nodes")
    x[row] = 1e3 * (value["nodes.x", row, 0] + $1)
    y[row] = 1e3 * (value["nodes.x", row, 1] + $2)
    row++
    if (row == nodes) end_case()
}

END {
    if (dead) exit 2
    check_case()
    if (cases < 2) die("fewer than two cases")
    print "# centres"
    centre_of_rest()
    for (s = 0; s < cases; s++) printf "%s %.6f %.6f %.6f %.6f\n", name[s], cx[s], cy[s], cx[s] - rest_x, cy[s] - rest_y
    print "\n\n# rest"
    for (i = 0; i <= count; i++) printf "%.6f %.6f\n", 1e3 * value["nodes.x", outline[i % count], 0], 1e3 * value["nodes.x", outline[i % count], 1]
    for (i = 0; i < count; i++) {
        mx[i] = my[i] = 0
        for (s = 0; s < cases; s++) { mx[i] += px[s, i] / cases; my[i] += py[s, i] / cases }
    }
    print "\n\n# mean"
    for (i = 0; i <= count; i++) printf "%.6f %.6f\n", mx[i % count], my[i % count]
    print "\n\n# outlines"
    for (s = 0; s < cases; s++) {
        for (i = 0; i <= count; i++) printf "%.6f %.6f\n", px[s, i % count], py[s, i % count]
        print ""
    }
    print "\n# band"
    for (i = 0; i <= count; i++) band(i % count, (i + 1) % count, (i + count - 1) % count)
}

function band(i, next_one, last_one,    nx, ny, length_, s) {
    nx = my[next_one] - my[last_one]
    ny = mx[last_one] - mx[next_one]
    length_ = sqrt(nx * nx + ny * ny)
    nx /= length_
    ny /= length_
    for (s = 0; s < cases; s++) sorted[s + 1] = (px[s, i] - mx[i]) * nx + (py[s, i] - my[i]) * ny
    sort(sorted, cases)
    low = percentile(sorted, cases, 0.025)
    high = percentile(sorted, cases, 0.975)
    printf "%.6f %.6f %.6f %.6f %.6f %.6f %.6f %.6f\n", mx[i], my[i], mx[i] + low * nx, my[i] + low * ny, mx[i] + high * nx, my[i] + high * ny, nx, ny
}

function end_case(    i, s) {
    s = cases - 1
    for (i = 0; i < count; i++) { px[s, i] = x[outline[i]]; py[s, i] = y[outline[i]] }
    centre()
    cx[s] = sum_x / area
    cy[s] = sum_y / area
}

# Of the region with its nodes at x, y.
function centre(    c, a, b, d, part) {
    area = sum_x = sum_y = 0
    for (c = 0; c < cells; c++) {
        a = corner[c, 0]; b = corner[c, 1]; d = corner[c, 2]
        part = ((x[b] - x[a]) * (y[d] - y[a]) - (x[d] - x[a]) * (y[b] - y[a])) / 2
        area += part
        sum_x += part * (x[a] + x[b] + x[d]) / 3
        sum_y += part * (y[a] + y[b] + y[d]) / 3
    }
}

function centre_of_rest(    i) {
    for (i = 0; i < nodes; i++) { x[i] = 1e3 * value["nodes.x", i, 0]; y[i] = 1e3 * value["nodes.x", i, 1] }
    centre()
    rest_x = sum_x / area
    rest_y = sum_y / area
}

function check_case() {
    if (cases > 0 && row != nodes) { dead = 1; die("case " name[cases - 1] ": " row " rows, but the mesh has " nodes " nodes") }
}

function name_index_of(wanted,    names, n, i) {
    n = split(attribute["cells.region", "names"], names, ",")
    for (i = 1; i <= n; i++) if (names[i] == wanted) return i - 1
    die(mesh ": no region " wanted)
}
