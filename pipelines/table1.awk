# Our table beside the paper's: awk -f table1.awk PAPER_TABLE OUR_TABLE. Status 1 unless the regular columns agree within
# .0001 (one unit of the last digit printed) and the irregular ones are singular in the same places; `*` marks the others.

BEGIN { FS = "\t" }

FNR == 1 { file++; next }

file == 1 {
    paper_regular[$1, $2, $3] = $4
    paper_irregular[$1, $2, $3] = $5
    next
}

file == 2 {
    if (++n == 1) {
        printf "%-14s %-7s %-4s  %9s %9s   %9s %9s\n", "", "", "", "regular", "", "irregular", ""
        printf "%-14s %-7s %-4s  %9s %9s   %9s %9s\n", "method", "mu", "R", "ours", "paper", "ours", "paper"
    }
    regular = paper_regular[$1, $2, $3]
    irregular = paper_irregular[$1, $2, $3]
    agrees = ($4 == "singular") == (regular == "singular") && ($5 == "singular") == (irregular == "singular") &&
        regular != "" && ($4 - regular)^2 < 1.5e-4^2
    if (!agrees) differing++
    printf "%-14s %-7s %-4s  %9s %9s   %9s %9s %s\n", $1, $2, $3, $4, regular, $5, irregular, agrees ? "" : "*"
}

END {
    print "RMSE; irregular: ours is the mean of six jittered clouds, the paper's cloud is not known."
    if (n == 0 || differing) {
        print "table1: " differing + 0 " of " n + 0 " rows differ from the paper" > "/dev/stderr"
        exit 1
    }
}
