# The cases of a round: awk -f common.awk -f cases.awk -v state=STATE PARAMETERS > CASES
#
# The case `trial` has the parameters that STATE leads to: rows name, value, step; without that file the means. A case for each parameter has a
# tenth of its deviation added to it. Status 2 and one line where PARAMETERS is wrong.

BEGIN {
    FS = OFS = "\t"
    CONVFMT = OFMT = "%.17g"
    while ((getline < state) > 0) trial[$1] = $2 + $3
}

{ take_parameter() }

END {
    if (failed) exit 2
    if (count == 0) die(FILENAME ": no parameters in it")
    line = "case"
    for (i = 1; i <= count; i++) line = line OFS name[i]
    print line
    for (i = 0; i <= count; i++) {
        line = i == 0 ? "trial" : "more_" name[i]
        for (j = 1; j <= count; j++) line = line OFS (name[j] in trial ? trial[name[j]] : mean[j]) + (j == i ? deviation[j] / 10 : 0)
        print line
    }
}
