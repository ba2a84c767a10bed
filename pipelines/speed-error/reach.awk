# reach.tsv: awk -f reach.awk speed-error.tsv: the time to an error of 1 % and .3 %, and to CalculiX's least error, on straight
# lines between the sizes in log-log. "<" where the coarsest is better already, ">" where the finest is not good enough.

BEGIN { FS = OFS = "\t" }
NR == 1 { next }
{
    s = $1 OFS $2
    if (!(s in count)) order[++series] = s
    n = ++count[s]
    time[s, n] = $7
    error[s, n] = $8
    if ($2 == "calculix" && (!($1 in best) || $8 < best[$1])) best[$1] = $8
}
END {
    print "case", "scheme", "s_to_1_percent", "s_to_0.3_percent", "s_to_least_of_calculix"
    for (i = 1; i <= series; i++) {
        split(order[i], part, OFS)
        print order[i], reach(order[i], 1), reach(order[i], 0.3), (part[1] in best ? reach(order[i], best[part[1]]) : "-")
    }
}

function reach(s, goal,    k, t) {
    if (error[s, 1] <= goal) return "<" sprintf("%.3g", time[s, 1])
    for (k = 2; k <= count[s]; k++) if (error[s, k] <= goal) {
        t = log(error[s, k - 1] / goal) / log(error[s, k - 1] / error[s, k])
        return sprintf("%.3g", time[s, k - 1] * (time[s, k] / time[s, k - 1]) ^ t)
    }
    return ">" sprintf("%.3g", time[s, count[s]])
}
