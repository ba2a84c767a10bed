# Triangles of the deformed body for gnuplot, x y (mm) and vertical stress (kPa) at each corner:
# awk -f pipelines/stream.awk -f examples/block/stress.awk -v field=u.dat > FILE

BEGIN {
    read_stream(field, "")
    need_section("stress", "say `stress = yes` in the scene's [output]")
    for (c = 0; c < rows["cells"]; c++) {
        for (k = 0; k <= 3; k++) {
            n = value["cells", c, k % 3]
            print 1e3 * (value["nodes.x", n, 0] + value["u", n, 0]), \
                1e3 * (value["nodes.x", n, 1] + value["u", n, 1]), 1e-3 * value["stress", c, 1]
        }
        print ""
    }
}
