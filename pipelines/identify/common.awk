# What the scripts of identify.sh share.

function is_number(word) { return word ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }

function die(message) {
    if (!failed) print "identify: " message > "/dev/stderr"
    failed = 1
    exit 2
}

# Take the present line of PARAMETERS, a table with a head: name[], mean[], deviation[] of `count` parameters.
function take_parameter() {
    sub(/\r$/, "")
    if (/^#/ || /^[ \t]*$/) return
    if (!head) {
        head = 1
        if ($0 != "name\tmean\tdeviation") die(FILENAME ": the first line is not: name, mean, deviation, separated by tabs")
        return
    }
    if (NF != 3 || !is_number($2) || !is_number($3) || $3 <= 0)
        die(FILENAME ": line " FNR ": a name, a mean and a positive deviation, separated by tabs")
    name[++count] = $1
    mean[count] = $2
    deviation[count] = $3
}
