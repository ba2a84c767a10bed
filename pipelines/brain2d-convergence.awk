# convergence.tsv of make brain2d-convergence: awk -f brain2d-convergence.awk SIZE-SHARE.errors ..., what fieldcmp prints, by size;
# beside each .even, the same against the other reference, and .dat with the nodes. Lengths in mm; of the meshes of a size all means, their
# median, the largest difference, and the median against the other reference.

function median(values, n,    i, k, swap) {
    for (i = 1; i <= n; i++) for (k = i + 1; k <= n; k++) if (values[k] < values[i]) {
        swap = values[i]; values[i] = values[k]; values[k] = swap
    }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
}

function put() {
    if (!n) return
    print size, substr(nodes, 2), substr(means, 2), sprintf("%.4f", median(mean, n)), sprintf("%.4f", most),
        sprintf("%.4f", median(even, n)), sprintf("%.2f", last ? log(last / median(mean, n)) / log(last_size / size) : 0)
    last = median(mean, n)
    last_size = size
    n = most = 0
    nodes = means = ""
}

# The value of a row of what fieldcmp prints, m.
function value(file, name,    line, word, found) {
    while ((getline line < file) > 0) {
        split(line, word)
        if (word[1] == name) found = word[2]
    }
    close(file)
    if (found == "") { print "brain2d-convergence.awk: no " name " in " file > "/dev/stderr"; failed = 1; exit 1 }
    return found
}

function count_nodes(file,    line, word) {
    while ((getline line < file) > 0) {
        split(line, word)
        if (word[2] == "nodes.x") { close(file); return word[4] }
    }
    print "brain2d-convergence.awk: no nodes in " file > "/dev/stderr"
    failed = 1
    exit 1
}

BEGIN {
    OFS = "\t"
    print "lc", "nodes", "means_mm", "median_mm", "max_mm", "even_mm", "order"
    for (i = 1; i < ARGC; i++) {
        base = ARGV[i]
        sub(/errors$/, "", base)
        name = base
        sub(/.*\//, "", name)
        split(name, part, "-")
        if (part[1] != size) put()
        size = part[1]
        mean[++n] = 1e3 * value(base "errors", "avg")
        even[n] = 1e3 * value(base "even", "avg")
        largest = 1e3 * value(base "errors", "max")
        if (largest > most) most = largest
        nodes = nodes "/" count_nodes(base "dat")
        means = means "/" sprintf("%.4f", mean[n])
    }
    put()
}
END { exit failed }
