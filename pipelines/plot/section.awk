# Data for section.gp: awk -f pipelines/stream.awk -f section.awk -v mesh=STREAM [-v field=STREAM] > FILE
#
# mesh: what `nodes -t` writes; field: a text stream with u, the body is drawn where it comes to lie. Lengths in mm. Blocks:
# "region NAME" (closed triangles) for each region, then "outline undeformed" and "outline deformed" (facets), then "inner undeformed"
# and "inner deformed", the edges between two regions.

BEGIN {
    read_stream(mesh, "")
    read_stream(field, "field ")
    need_section("cells", "run nodes")
    need_section("field u", "run mtled")
    if (rows["nodes.x"] != rows["field u"]) die(field ": not a field on the nodes of " mesh)
    for (i = 0; i < rows["nodes.x"]; i++)
        for (d = 0; d < 2; d++) {
            rest[i, d] = 1e3 * value["nodes.x", i, d]
            moved[i, d] = rest[i, d] + 1e3 * value["field u", i, d]
        }

    region_count = split(attribute["cells.region", "names"], name, ",")
    for (r = 1; r <= region_count; r++) {
        print "# region " name[r]
        for (c = 0; c < rows["cells"]; c++) {
            if (value["cells.region", c, 0] != r - 1) continue
            for (k = 0; k <= 3; k++) point(moved, value["cells", c, k % 3])
            print ""
        }
        print ""
    }
    print "# outline undeformed"
    outline(rest)
    print "\n# outline deformed"
    outline(moved)
    print "\n# inner undeformed"
    inner(rest)
    print "\n# inner deformed"
    inner(moved)
}

function inner(at,    c, k, a, b, region, region_of) {
    for (c = 0; c < rows["cells"]; c++)
        for (k = 0; k < 3; k++) {
            a = value["cells", c, k] + 0
            b = value["cells", c, (k + 1) % 3] + 0
            region = value["cells.region", c, 0]
            if ((b, a) in region_of && region_of[b, a] != region) { point(at, a); point(at, b); print "" }
            region_of[a, b] = region
        }
}

function point(at, i) {
    printf "%.6g %.6g\n", at[i, 0], at[i, 1]
}

function outline(at,    f) {
    for (f = 0; f < rows["facets"]; f++) {
        point(at, value["facets", f, 0])
        point(at, value["facets", f, 1])
        print ""
    }
}
