# Data for difference.gp: awk -f pipelines/stream.awk -f difference.awk -v mesh=STREAM -v field=STREAM > FILE
#
# mesh: what `nodes -t` writes; field: a text stream with the section `difference` (m, one column) at its nodes, or at these and, behind
# them, those in the middle of edges. Lengths in mm.
# The first block is the outline (x y dx dy; the facets, and the edges between two regions); each further one a triangle
# (x y difference; a grid of 2 x 2 points, the last one doubled, as pm3d takes it).

BEGIN {
    read_stream(mesh, "")
    read_stream(field, "field ")
    need_section("cells", "run nodes")
    need_section("field difference", "run fieldcmp")
    if (rows["nodes.x"] > rows["field difference"]) die(field ": not a field on the nodes of " mesh)
    for (i = 0; i < rows["nodes.x"]; i++) for (d = 0; d < 2; d++)
        if ((value["field nodes.x", i, d] - value["nodes.x", i, d]) ^ 2 > 1e-18) die(field ": not a field on the nodes of " mesh)

    print "# outline"
    for (f = 0; f < rows["facets"]; f++) edge(value["facets", f, 0], value["facets", f, 1])
    for (c = 0; c < rows["cells"]; c++)
        for (k = 0; k < 3; k++) {
            a = value["cells", c, k]
            b = value["cells", c, (k + 1) % 3]
            region = value["cells.region", c, 0]
            if ((b, a) in region_of && region_of[b, a] != region) edge(a, b)
            region_of[a, b] = region
        }
    for (c = 0; c < rows["cells"]; c++) {
        print "\n"
        corner(value["cells", c, 0])
        corner(value["cells", c, 1])
        print ""
        corner(value["cells", c, 2])
        corner(value["cells", c, 2])
    }
}

function millimetres(i, d) {
    return 1e3 * value["nodes.x", i, d]
}

function edge(a, b) {
    printf "%.6g %.6g %.6g %.6g\n", millimetres(a, 0), millimetres(a, 1),
        millimetres(b, 0) - millimetres(a, 0), millimetres(b, 1) - millimetres(a, 1)
}

function corner(i) {
    printf "%.6g %.6g %.6g\n", millimetres(i, 0), millimetres(i, 1), 1e3 * value["field difference", i, 0]
}
