# speed-error.tsv: awk -f table.awk -v limit=N CASE-SCHEME-SIZE.errors ... CASE-SCHEME-SIZE.force ...; .time lies beside each.
# .errors is what fieldcmp prints, .force the components of a force whose last one is compared with the limit.

BEGIN {
    FS = "[ \t]+"
    OFS = "\t"
    print "case", "scheme", "h", "nodes", "prepare_s", "solve_s", "total_s", "error_percent", "force_N"
}

FNR == 1 { tell(); file = FILENAME; error = force = "-" }
$1 == "avg_relative" { error = 100 * $2 }
FILENAME ~ /force$/ { force = $NF < 0 ? -$NF : $NF; error = 100 * (force / limit - 1); if (error < 0) error = -error }
END { tell() }

function tell(    name, part, word, line, told, timing) {
    if (file == "") return
    name = timing = file
    sub(/.*\//, "", name)
    sub(/\.[a-z]*$/, "", name)
    sub(/[a-z]*$/, "time", timing)
    split(name, part, "-")
    while ((getline line < timing) > 0) { split(line, word, "\t"); told[word[1]] = word[2] }
    if (error == "-" || !("solve" in told)) { print "table.awk: nothing of " name > "/dev/stderr"; exit 1 }
    print part[1], part[2], part[3], told["nodes"], sprintf("%.3f", told["prepare"]), sprintf("%.3f", told["solve"]),
        sprintf("%.3f", told["prepare"] + told["solve"]), sprintf("%.4f", error), force
}
