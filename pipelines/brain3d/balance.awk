# A line of balance.tsv: awk -f pipelines/stream.awk -f balance.awk -v scheme=NAME -v field=STREAM -v report=LOG
#
# field: u.dat as mtled or mixed/solve.sh write it, with the reactions; LOG: what they report. Forces on the body, N: that
# of the prescribed displacement, that of the contact, and what is missing to their balance; then the deepest of the contact
# gaps, and how many contact nodes (or nodes) touch. "-" where it is not reported. J is that of the integration points, from the strains.

BEGIN {
    read_stream(field, "")
    need_section("reactions", "ask for it in the scene's [output]")
    while ((getline line < report) > 0) if (split(line, word, "\t") == 2) told[word[1]] = word[2]
    OFS = "\t"
    print scheme, "pairs" in told ? told["pairs"] : "-", jacobians(), forces(), gaps()
}

# J^2 = det(2 E + I); the columns of E are xx, yy, zz, xy, xz, yz.
function jacobians(    q, k, c, J2, least, most) {
    if (!("strain" in rows)) return "-\t-"
    for (q = 0; q < rows["strain"]; q++) {
        for (k = 0; k < 6; k++) c[k] = 2 * value["strain", q, k] + (k < 3)
        J2 = c[0] * (c[1] * c[2] - c[5]^2) - c[3] * (c[3] * c[2] - c[5] * c[4]) + c[4] * (c[3] * c[5] - c[1] * c[4])
        if (q == 0 || J2 < least) least = J2
        if (q == 0 || J2 > most) most = J2
    }
    return sprintf("%.3f\t%.3f", sqrt(least), sqrt(most))
}

function forces(    d, pressed, skull, missing) {
    for (d = 0; d < 3; d++) {
        pressed += value["reactions", 0, d]^2
        if (rows["reactions"] < 2) continue
        skull += value["reactions", 1, d]^2
        missing += (value["reactions", 0, d] + value["reactions", 1, d])^2
    }
    return rows["reactions"] < 2 ? sprintf("%.5f\t-\t-", sqrt(pressed)) \
                                 : sprintf("%.5f\t%.5f\t%.1e", sqrt(pressed), sqrt(skull), sqrt(missing))
}

function gaps(    a, deepest, touching) {
    if (!("gaps" in rows)) return "-\t-\t-"
    for (a = 0; a < rows["gaps"]; a++) {
        if (value["gaps", a, 3] != "inf" && -value["gaps", a, 3] > deepest) deepest = -value["gaps", a, 3]
        touching += value["gaps", a, 4] > 0
    }
    return sprintf("%.4f\t%d\t%d", 1e3 * deepest, touching, rows["gaps"])
}
