# convergence.tsv of make brain2d-convergence: awk -f brain2d-convergence.awk SIZE-SHARE[-ends].errors ..., what fieldcmp prints, by
# size, those of meshes that are finer at the ends after the others; beside each .even, the same against the other reference, and .dat with the
# nodes. Lengths in mm. Of the meshes of a size: least and largest number of nodes, least and largest mean error, the median of these, the
# largest difference, and the median against the other reference.

function median(values, n,    i, k, swap) {
    for (i = 1; i <= n; i++) for (k = i + 1; k <= n; k++) if (values[k] < values[i]) {
        swap = values[i]; values[i] = values[k]; values[k] = swap
    }
    return n % 2 ? values[(n + 1) / 2] : (values[n / 2] + values[n / 2 + 1]) / 2
}

function put() {
    if (!n) return
    middle = median(mean, n)
    print mesh, size, least_nodes "-" most_nodes, sprintf("%.4f-%.4f", mean[1], mean[n]), sprintf("%.4f", middle), sprintf("%.4f", most),
        sprintf("%.4f", median(even, n)), last ? sprintf("%.2f", log(last / middle) / log(last_size / size)) : "-"
    last = middle
    last_size = size
    n = most = 0
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
    print "ends", "lc", "nodes", "means_mm", "median_mm", "max_mm", "even_mm", "order"
    for (i = 1; i < ARGC; i++) {
        base = ARGV[i]
        sub(/errors$/, "", base)
        name = base
        sub(/.*\//, "", name)
        split(name, part, "-")
        fine = name ~ /-ends\./ ? "fine" : "even"
        if (part[1] != size || fine != mesh) put()
        if (fine != mesh) last = 0
        mesh = fine
        size = part[1]
        mean[++n] = 1e3 * value(base "errors", "avg")
        even[n] = 1e3 * value(base "even", "avg")
        largest = 1e3 * value(base "errors", "max")
        if (largest > most) most = largest
        nodes = count_nodes(base "dat")
        if (n == 1 || nodes < least_nodes) least_nodes = nodes
        if (n == 1 || nodes > most_nodes) most_nodes = nodes
    }
    put()
}
END { exit failed }
