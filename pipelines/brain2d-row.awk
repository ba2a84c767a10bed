# A line of compare.tsv: awk -f brain2d-row.awk -v scheme=NAME ERRORS LOG
#
# ERRORS is what fieldcmp prints, LOG what the tools report with -v. Where supports were widened, the name says so.

BEGIN { FS = OFS = "\t" }

NF == 2 { value[$1] = $2 }

/^support: widened at [1-9]/ {
    split($0, word, " ")
    scheme = scheme ", " word[4] " points widened"
}

END {
    if (!("avg" in value) || !("steps" in value)) {
        print "brain2d-row: no errors or no report of " scheme > "/dev/stderr"
        exit 1
    }
    print scheme, "nodes" in value ? value["nodes"] : value["n"], value["points"],
        sprintf("%.4f", 1e3 * value["avg"]), sprintf("%.4f", 1e3 * value["max"]),
        value["steps"], sprintf("%.2f", "solve seconds" in value ? value["solve seconds"] : value["assembly seconds"] + value["solver seconds"])
}
