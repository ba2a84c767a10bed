# The opening of a cut in its middle beside the exact one, as a row of incision.tsv; and its profile:
# awk -v case=NAME -v size=N -v exact=MM -v profile=FILE LIPS NODES
#
# LIPS has rows of the number of a face of the cut and a node, NODES those of the nodes: place and u, m. The radius is 10 mm, the cut across the last
# axis. The opening is that of the ellipse, w sqrt(1 - r^2 / a^2), fitted to the nodes of each face within half the radius.
NR == FNR { lip[$2] = $1; next }
{
    dim = NF / 2; nodes++
    if (!(FNR - 1 in lip)) next
    l = lip[FNR - 1]
    r2 = ($1 ^ 2 + (dim == 3 ? $2 ^ 2 : 0)) / 1e-4
    s = r2 < 1 ? sqrt(1 - r2) : 0
    u = $(2 * dim) * 1e3
    if (r2 < 0.25) { us[l] += u * s; ss[l] += s * s; mean += u; inner++ }
    place[++count] = sqrt(r2); value[count] = u; which[count] = l
}
END {
    for (l in ss) w += sign++ ? -us[l] / ss[l] : us[l] / ss[l]
    if (w < 0) w = -w
    for (i = 1; i <= count; i++) { d = (value[i] - mean / inner) * 2 / exact; printf "%g\t%g\n", place[i], d < 0 ? -d : d > profile }
    printf "%s\t%d\t%d\topening, mm\t%.6f\t%.6f\t%.4f\n", case, size, nodes, w, exact, w / exact - 1
}
