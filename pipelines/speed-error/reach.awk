# reach.tsv: awk -f reach.awk speed-error.tsv: the time to an error of 1 %, .3 % and .1 %, and to CalculiX's least error, all of it
# (total_s) and, at the end, that of the solution (solve_s), on straight lines between the sizes in log-log. "<" where the coarsest is
# better already, ">" where the finest is not good enough.

BEGIN { FS = OFS = "\t" }
NR == 1 { next }
{
    add($1 OFS $2, $7, $6, $8)
    if ($2 == "calculix" && (!($1 in best) || $8 < best[$1])) best[$1] = $8
}
END {
    print "case", "scheme", "s_to_1_percent", "s_to_0.3_percent", "s_to_0.1_percent", "s_to_least_of_calculix",
        "solve_to_1_percent", "solve_to_0.3_percent", "solve_to_0.1_percent"
    for (i = 1; i <= series; i++) {
        s = order[i]
        split(s, part, OFS)
        print s, reach(total, s, 1), reach(total, s, 0.3), reach(total, s, 0.1), (part[1] in best ? reach(total, s, best[part[1]]) : "-"),
            reach(solve, s, 1), reach(solve, s, 0.3), reach(solve, s, 0.1)
    }
}

function add(s, all, solution, mean,    n) {
    if (!(s in count)) order[++series] = s
    n = ++count[s]
    total[s, n] = all
    solve[s, n] = solution
    error[s, n] = mean
}

function reach(time, s, goal,    k, t) {
    if (error[s, 1] <= goal) return "<" sprintf("%.3g", time[s, 1])
    for (k = 2; k <= count[s]; k++) if (error[s, k] <= goal) {
        t = log(error[s, k - 1] / goal) / log(error[s, k - 1] / error[s, k])
        return sprintf("%.3g", time[s, k - 1] * (time[s, k] / time[s, k - 1]) ^ t)
    }
    return ">" sprintf("%.3g", time[s, count[s]])
}
