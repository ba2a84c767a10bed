# reach.tsv: awk -v levels="CASE:ERROR ..." -f reach.awk refinement.tsv: what each kind of mesh needs to a mean error, mm, by straight lines
# in log-log between the rounds: nodes, and processor seconds of the solution. "<" where the first mesh is better already, ">" where none
# is good enough.
#   graded/even     nodes of these programs on graded meshes by those on even ones
#   graded/mixed    seconds of these programs on graded meshes by those of mixed elements on even or graded ones, the quicker of the two
# Where one of two is a bound, the quotient is one, too; where both are, "-".

BEGIN { FS = OFS = "\t" }
NR == 1 { next }
{
    s = $1 OFS $2
    n = ++count[s]
    nodes[s, n] = $3
    seconds[s, n] = $4
    error[s, n] = $7
}
END {
    print "case", "error_mm", "even_nodes", "graded_nodes", "graded/even", "even_s", "graded_s", "mixed_even_s", "mixed_graded_s", "graded/mixed"
    m = split(levels, level, " ")
    for (i = 1; i <= m; i++) {
        split(level[i], part, ":")
        name = part[1]
        goal = part[2]
        even = reach(nodes, name OFS "even")
        graded = reach(nodes, name OFS "graded")
        ours = reach(seconds, name OFS "graded")
        peer_even = reach(seconds, name OFS "mixed even")
        peer = reach(seconds, name OFS "mixed graded")
        print name, goal, even, graded, quotient(graded, even), reach(seconds, name OFS "even"), ours, peer_even, peer, quotient(ours, best(peer_even, peer))
    }
}

function reach(what, s,    k, t) {
    if (!count[s]) return "-"
    if (error[s, 1] <= goal) return "<" sprintf("%.3g", what[s, 1])
    for (k = 2; k <= count[s]; k++) if (error[s, k] <= goal) {
        t = log(error[s, k - 1] / goal) / log(error[s, k - 1] / error[s, k])
        return sprintf("%.3g", what[s, k - 1] * (what[s, k] / what[s, k - 1]) ^ t)
    }
    return ">" sprintf("%.3g", largest(what, s))
}

function largest(what, s,    k, most) {
    for (k = 1; k <= count[s]; k++) if (what[s, k] > most) most = what[s, k]
    return most
}

# The smaller of two, one that is reached before one that is not.
function best(a, b) {
    if (a == "-" || a ~ /^>/) return b == "-" ? a : b ~ /^>/ && a != "-" && value(a) > value(b) ? a : b
    if (b == "-" || b ~ /^>/) return a
    return value(a) <= value(b) ? a : b
}

function value(a) {
    sub(/^[<>]/, "", a)
    return a + 0
}

function quotient(a, b,    sign, other) {
    if (a == "-" || b == "-") return "-"
    sign = substr(a, 1, 1)
    other = substr(b, 1, 1)
    sign = sign ~ /[<>]/ ? sign : ""
    other = other == "<" ? ">" : other == ">" ? "<" : ""
    if (sign != "" && other != "" && sign != other) return "-"
    return sign (sign == "" ? other : "") sprintf("%.2f", value(a) / value(b))
}
