# convergence.tsv: awk -f table.awk CASE-SCHEME-SIZE.errors ..., what fieldcmp prints, from coarse to fine; .time beside each gives
# the nodes. Order: between successive sizes, by the mean error and the mean spacing, the number of nodes to the power -1/2; slope:
# by least squares over all sizes.

BEGIN {
    FS = OFS = "\t"
    print "case", "scheme", "h", "nodes", "mean_mm", "max_mm", "order", "slope"
}

FNR == 1 {
    file = FILENAME
    sub(/.*\//, "", file)
    sub(/\.errors$/, "", file)
    split(file, part, "-")
    names[++count] = file
    series[count] = part[1] OFS part[2]
    size[count] = part[3]
    timing = FILENAME
    sub(/errors$/, "time", timing)
    while ((getline line < timing) > 0) {
        split(line, word)
        if (word[1] == "nodes") nodes[count] = word[2]
    }
}
$1 == "avg" { mean[count] = 1e3 * $2 }
$1 == "max" { most[count] = 1e3 * $2 }

END {
    for (i = 1; i <= count; i++) {
        if (!(mean[i] > 0 && nodes[i] > 0)) { print "table.awk: nothing of " names[i] > "/dev/stderr"; exit 1 }
        X[i] = -log(nodes[i]) / 2
        Y[i] = log(mean[i])
        s = series[i]
        n[s]++; sx[s] += X[i]; sy[s] += Y[i]; sxx[s] += X[i] ^ 2; sxy[s] += X[i] * Y[i]
    }
    for (i = 1; i <= count; i++) {
        s = series[i]
        order = i > 1 && series[i - 1] == s ? sprintf("%.2f", (Y[i] - Y[i - 1]) / (X[i] - X[i - 1])) : "-"
        print s, size[i], nodes[i], sprintf("%.5f", mean[i]), sprintf("%.4f", most[i]), order,
            sprintf("%.2f", (n[s] * sxy[s] - sx[s] * sy[s]) / (n[s] * sxx[s] - sx[s] ^ 2))
    }
}
