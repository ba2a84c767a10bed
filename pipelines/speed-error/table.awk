# speed-error.tsv: awk -f table.awk CASE-SCHEME-SIZE.errors ..., what fieldcmp prints; .time lies beside each, and .force, the
# components of a force, the last of which is told.

BEGIN {
    FS = "[ \t]+"
    OFS = "\t"
    print "case", "scheme", "h", "nodes", "prepare_s", "solve_s", "total_s", "error_percent", "force_N"
}

FNR == 1 { tell(); file = FILENAME; error = "-" }
$1 == "avg_relative" { error = 100 * $2 }
END { tell() }

function tell(    name, part, word, line, told, beside, force) {
    if (file == "") return
    name = beside = file
    sub(/.*\//, "", name)
    sub(/\.[a-z]*$/, "", name)
    sub(/[a-z]*$/, "", beside)
    split(name, part, "-")
    while ((getline line < (beside "time")) > 0) { split(line, word, "\t"); told[word[1]] = word[2] }
    if (error == "-" || !("solve" in told)) { print "table.awk: nothing of " name > "/dev/stderr"; exit 1 }
    force = "-"
    if ((getline line < (beside "force")) > 0) {
        force = word[split(line, word, " ")]
        force = sprintf("%.6g", force < 0 ? -force : force)
    }
    print part[1], part[2], part[3], told["nodes"], sprintf("%.3f", told["prepare"]), sprintf("%.3f", told["solve"]),
        sprintf("%.3f", told["prepare"] + told["solve"]), sprintf("%.4f", error), force
}
