# The cases of a round: awk -f cases.awk -v state=STATE PARAMETERS > CASES
#
# The case `trial` has the parameters that STATE leads to: rows name, value, step; without that file the means. A case for each parameter has a
# tenth of its deviation added to it. Status 2 and one line where PARAMETERS is wrong.

BEGIN {
    FS = OFS = "\t"
    CONVFMT = OFMT = "%.17g"
    while ((getline < state) > 0) trial[$1] = $2 + $3
}

{ sub(/\r$/, "") }
/^#/ || /^[ \t]*$/ { next }
!head {
    head = 1
    if ($0 != "name\tmean\tdeviation") die("the first line is not: name, mean, deviation, separated by tabs")
    next
}
NF != 3 || !is_number($2) || !is_number($3) || $3 <= 0 { die("line " FNR ": a name, a mean and a positive deviation, separated by tabs") }
{
    name[++count] = $1
    mean[count] = $2
    deviation[count] = $3
}

END {
    if (failed) exit 2
    if (count == 0) die("no parameters in it")
    line = "case"
    for (i = 1; i <= count; i++) line = line OFS name[i]
    print line
    for (i = 0; i <= count; i++) {
        line = i == 0 ? "trial" : "more_" name[i]
        for (j = 1; j <= count; j++) line = line OFS (name[j] in trial ? trial[name[j]] : mean[j]) + (j == i ? deviation[j] / 10 : 0)
        print line
    }
}

function is_number(word) { return word ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }

function die(message) {
    if (!failed) print "identify: " FILENAME ": " message > "/dev/stderr"
    failed = 1
    exit 2
}
