# Triangles of the tissue in a frame for gnuplot, both halves: x, y (mm) and how far it is dragged along (mm) at each corner:
# awk -f pipelines/stream.awk -f pipelines/gallery/needle.awk -v field=needle.dat -v frame=24 > FILE

BEGIN {
    read_stream(field, "")
    u = "u.frame." frame
    need_section(u, "ask for that many frames")
    for (half = 1; half >= -1; half -= 2) {
        for (c = 0; c < rows["cells"]; c++) {
            for (k = 0; k <= 3; k++) {
                n = value["cells", c, k % 3]
                print 1e3 * (value["nodes.x", n, 0] + value[u, n, 0]), half * 1e3 * (value["nodes.x", n, 1] + value[u, n, 1]), 1e3 * value[u, n, 0]
            }
            print ""
        }
    }
}
