# A line of compare.tsv: awk -f row.awk -v scheme=NAME -v field=STREAM [-v digits=N] LOG [ERRORS]
#
# LOG is what the tools report with -v, ERRORS what fieldcmp prints of the distance from the reference; without it the distances are "-".
# Seconds have N digits (1) behind the point. Where supports were widened, the name says so.

BEGIN {
    FS = OFS = "\t"
    if (digits == "") digits = 1
    while ((getline line < field) > 0) if (line ~ /^# nodes.x /) {
        split(line, word, " ")
        nodes = word[4]
        break
    }
}

FNR == 1 { file++ }
NF == 2 { value[file, $1] = $2 }

# "support: widened at N points, at most F times"
/^support: widened at [1-9]/ {
    split($0, word, " ")
    scheme = scheme ", " word[4] " points widened"
}

END {
    if (nodes == "" || !((1, "steps") in value) || (file > 1 && !((file, "avg") in value && (2, "avg") in value))) {
        print "row.awk: no errors or no report of " scheme > "/dev/stderr"
        exit 1
    }
    print scheme, nodes, value[1, "points"], millimetres(2, "avg"), millimetres(2, "max"), value[1, "steps"],
        sprintf("%.*f", digits, (1, "solve seconds") in value ? value[1, "solve seconds"] : value[1, "assembly seconds"] + value[1, "solver seconds"])
}

function millimetres(from, name) {
    return (from, name) in value ? sprintf("%.4f", 1e3 * value[from, name]) : "-"
}
