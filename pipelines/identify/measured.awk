# Measured displacements in metres: awk -f common.awk -f measured.awk -v dim=DIM -v unit=UNIT -v of_all=DEVIATION MEASURED > TABLE
#
# Rows of TABLE: place, displacement, deviation, separated by tabs. Status 2 and one line for a row that is none.

BEGIN {
    OFS = "\t"
    CONVFMT = OFMT = "%.17g"
    scale = unit == "mm" ? 1e-3 : unit == "cm" ? 1e-2 : unit == "m" ? 1 : is_number(unit) ? unit + 0 : 0
    if (scale <= 0) die("unit '" unit "': m, cm, mm, or metres as a positive number")
    if (of_all != "" && !(is_number(of_all) && of_all > 0)) die("deviation '" of_all "': a positive number")
}

{ sub(/\r$/, "") }
/^[ \t]*(#|$)/ { next }
NF != 2 * dim + 1 && !(NF == 2 * dim && of_all != "") {
    die(FILENAME ": line " FNR ": " NF " values: " 2 * dim " for place and displacement, and one for the deviation, or -d")
}
{
    for (k = 1; k <= NF; k++) {
        if (!is_number($k)) die(FILENAME ": line " FNR ": '" $k "' is no number")
        $k *= scale
    }
    if (NF == 2 * dim) $(NF + 1) = of_all * scale
    if ($NF <= 0) die(FILENAME ": line " FNR ": a deviation of " $NF / scale)
    rows++
    print
}

END { if (!failed && rows == 0) die(FILENAME ": no points in it") }
