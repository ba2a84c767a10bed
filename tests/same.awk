# Do two texts say the same? awk -v tolerance=0.1 -f same.awk A B: words must be equal, numbers agree to that share of
# their size, or with digits=1 to one unit of the last digit shown; blanks are as good as each other. Prints the first line that differs;
# status 1.

# The line with its numbers taken out (into number[which, 1..]); what is left of it is returned.
function skeleton(line, which,    rest, count) {
    gsub(/[ \t]+/, " ", line)
    sub(/^ /, "", line)
    sub(/ $/, "", line)
    rest = ""
    count = 0
    while (match(line, /-?[0-9]+(\.[0-9]+)?([eE][-+]?[0-9]+)?/)) {
        number[which, ++count] = substr(line, RSTART, RLENGTH) + 0
        unit[which, count] = last_digit(substr(line, RSTART, RLENGTH))
        rest = rest substr(line, 1, RSTART - 1) "#"
        line = substr(line, RSTART + RLENGTH)
    }
    numbers[which] = count
    return rest line
}

# What one unit of the last digit of a number is worth.
function last_digit(text,    part, point) {
    split(text, part, /[eE]/)
    point = index(part[1], ".")
    return 10 ^ (part[2] + 0) * (point ? 10 ^ (point - length(part[1])) : 1)
}

function size(a) { return a < 0 ? -a : a }

function differs(first, second,    i, a, b) {
    if (skeleton(first, 1) != skeleton(second, 2)) return 1
    for (i = 1; i <= numbers[1]; i++) {
        a = number[1, i]
        b = number[2, i]
        if (digits && (unit[1, i] != unit[2, i] || !(size(a - b) <= 1.001 * unit[1, i]))) return 1
        if (!digits && !(size(a - b) <= tolerance * (size(a) > size(b) ? size(a) : size(b)))) return 1
    }
    return 0
}

# The lines of a file into text[which, 1..]; their number is returned.
function lines(which,    count) {
    while ((getline text[which, count + 1] < ARGV[which]) > 0) count++
    close(ARGV[which])
    return count + 0
}

BEGIN {
    if (ARGC != 3) exit 2
    count = lines(1)
    if (lines(2) != count || count == 0) {
        print ARGV[1] ": " count " lines, " ARGV[2] ": " lines(2)
        exit 1
    }
    for (i = 1; i <= count; i++)
        if (differs(text[1, i], text[2, i])) {
            print "line " i ": " text[1, i]
            print "is now: " text[2, i]
            exit 1
        }
}
