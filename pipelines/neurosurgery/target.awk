# Errors of landmarks before and after, mm: awk -f target.awk TRUE PREDICTED, both rows ux uy uz, m.

NR == FNR { for (i = 1; i <= 3; i++) true[FNR, i] = $i; before[FNR] = size($1, $2, $3); n = FNR; next }
{ after[FNR] = size($1 - true[FNR, 1], $2 - true[FNR, 2], $3 - true[FNR, 3]); m = FNR }

END {
    if (n == 0 || n != m) {
        print "target.awk: " n " rows and " m + 0 > "/dev/stderr"
        exit 1
    }
    printf "landmarks, mean, mm\t%.2f\t%.2f\n", mean(before, n), mean(after, n)
    printf "landmarks, 95th percentile, mm\t%.2f\t%.2f\n", percentile(before, n, 95), percentile(after, n, 95)
}

function size(x, y, z) { return 1e3 * sqrt(x * x + y * y + z * z) }

function mean(value, n,    i, sum) {
    for (i = 1; i <= n; i++) sum += value[i]
    return sum / n
}

# The smallest value that is not below so many percent of all.
function percentile(value, n, percent,    i, j, v, sorted) {
    for (i = 1; i <= n; i++) {
        v = value[i]
        for (j = i - 1; j >= 1 && sorted[j] > v; j--) sorted[j + 1] = sorted[j]
        sorted[j + 1] = v
    }
    i = n * percent / 100
    return sorted[i > int(i) ? int(i) + 1 : int(i)]
}
