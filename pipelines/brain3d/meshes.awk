# Three rows of row.awk for each name: awk -f meshes.awk -v names='NAME TAB NAME ...' ROW ...
#
# A line for each name: nodes, and the least, median and largest of the mean errors, and the most seconds.

BEGIN {
    FS = OFS = "\t"
    count = split(names, name, "\t")
    print "scheme", "nodes", "least_mm", "median_mm", "most_mm", "seconds"
}

{
    set = int((NR - 1) / 3) + 1
    nodes[set] = nodes[set] (NR % 3 == 1 ? "" : " ") $2
    error[set, (NR - 1) % 3] = $4 + 0
    if ($7 > seconds[set]) seconds[set] = $7
}

END {
    if (NR != 3 * count) {
        print "meshes.awk: " NR " rows for " count " names" > "/dev/stderr"
        exit 1
    }
    for (i = 1; i <= count; i++) {
        a = error[i, 0]; b = error[i, 1]; c = error[i, 2]
        low = a < b ? (a < c ? a : c) : (b < c ? b : c)
        high = a > b ? (a > c ? a : c) : (b > c ? b : c)
        printf "%s\t%s\t%.4f\t%.4f\t%.4f\t%s\n", name[i], nodes[i], low, a + b + c - low - high, high, seconds[i]
    }
}
