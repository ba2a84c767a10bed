# Percentiles, for the programs of this folder.

# Ascending, from 1.
function sort(list, n,    gap, i, j, item) {
    for (gap = int(n / 2); gap > 0; gap = int(gap / 2))
        for (i = gap + 1; i <= n; i++) {
            item = list[i]
            for (j = i; j > gap && list[j - gap] > item; j -= gap) list[j] = list[j - gap]
            list[j] = item
        }
}

# Of a sorted list, linear between its values: the least at share 0, the greatest at 1.
function percentile(list, n, share,    at, below) {
    at = 1 + share * (n - 1)
    below = int(at)
    return below >= n ? list[n] : list[below] + (at - below) * (list[below + 1] - list[below])
}
