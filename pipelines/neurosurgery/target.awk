# Errors of landmarks, mm, without and with prediction: awk -f target.awk TRUE PREDICTED..., all of rows ux uy uz, m.

FNR == 1 { file++ }
file == 1 { for (i = 1; i <= 3; i++) true[FNR, i] = $i; error[1, FNR] = size($1, $2, $3) }
file > 1 { error[file, FNR] = size($1 - true[FNR, 1], $2 - true[FNR, 2], $3 - true[FNR, 3]) }
{ n[file] = FNR }

END {
    for (f = 1; f <= file; f++) if (n[f] != n[1]) wrong = 1
    if (file < 2 || wrong) {
        print "target.awk: files are missing, or their lengths differ" > "/dev/stderr"
        exit 1
    }
    row("landmarks, mean, mm", 0)
    row("landmarks, 95th percentile, mm", 95)
}

# The mean, or a percentile.
function row(title, percent,    f, i, value) {
    printf "%s", title
    for (f = 1; f <= file; f++) {
        for (i = 1; i <= n[1]; i++) value[i] = error[f, i]
        printf "\t%.2f", percent ? percentile(value, n[1], percent) : mean(value, n[1])
    }
    print ""
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
