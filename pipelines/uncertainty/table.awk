# uncertainty.tsv from what place.awk writes: awk -f percentile.awk -f table.awk -v region=NAME FILE

BEGIN { OFS = "\t" }
/^# / { block = $2; next }
NF == 0 { next }
block == "centres" { n++; right[n] = $4; up[n] = $5; far[n] = sqrt($4 * $4 + $5 * $5) }
block == "band" { width[++nodes] = sqrt(($5 - $3)^2 + ($6 - $4)^2) }
END {
    print "quantity", "unit", "samples", "mean", "deviation", "percentile_2.5", "percentile_97.5"
    row(region ": centre moves right", right)
    row(region ": centre moves up", up)
    row(region ": centre moves", far)
    nodes-- # the first node again
    sort(width, nodes)
    printf "%s\t%s\t%d\t%.4f\t%s\t%.4f\t%.4f\n", region ": width of the 95 % band of its outline (percentiles: of its nodes)", "mm", n, \
        average(width, nodes), "-", percentile(width, nodes, 0.025), percentile(width, nodes, 0.975)
}

function average(list, n,    i, sum) {
    for (i = 1; i <= n; i++) sum += list[i]
    return sum / n
}

function row(name, list,    i, mean, square) {
    mean = average(list, n)
    for (i = 1; i <= n; i++) square += (list[i] - mean)^2
    sort(list, n)
    printf "%s\t%s\t%d\t%.4f\t%.4f\t%.4f\t%.4f\n", name, "mm", n, mean, sqrt(square / (n - 1)), percentile(list, n, 0.025), percentile(list, n, 0.975)
}
