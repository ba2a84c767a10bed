# Measured displacements in metres: awk -f measured.awk -v dim=DIM -v unit=UNIT -v deviation=DEVIATION MEASURED > TABLE
#
# Rows of TABLE: place, displacement, deviation, separated by tabs. Status 2 and one line for a row that is none.

BEGIN {
    OFS = "\t"
    CONVFMT = OFMT = "%.17g"
    scale = unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : unit == "m" ? 1 : is_number(unit) ? unit + 0 : 0
    if (scale <= 0) die("unit '" unit "': m, cm, mm, or metres as a positive number")
    if (deviation != "" && !(is_number(deviation) && deviation > 0)) die("deviation '" deviation "': a positive number")
}

{ sub(/\r$/, "") }
/^[ \t]*(#|$)/ { next }
NF != 2 * dim + 1 && !(NF == 2 * dim && deviation != "") {
    die(FILENAME ": line " FNR ": " NF " values: " 2 * dim " for place and displacement, and one for the deviation, or -d")
}
{
    for (k = 1; k <= NF; k++) {
        if (!is_number($k)) die(FILENAME ": line " FNR ": '" $k "' is no number")
        $k *= scale
    }
    if (NF == 2 * dim) $(NF + 1) = deviation * scale
    if ($NF <= 0) die(FILENAME ": line " FNR ": a deviation of " $NF / scale)
    rows++
    print
}

END { if (!failed && rows == 0) die(FILENAME ": no points in it") }

function is_number(word) { return word ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }

function die(message) {
    if (!failed) print "identify: " message > "/dev/stderr"
    failed = 1
    exit 2
}
