# Time of one evaluation on many processes, on paper: awk -f model.awk STAGES PARTS
#
# STAGES has the measured time of an evaluation for each node, PARTS the halos that part -v reports. An evaluation is computing, on the part
# with the most work, and waiting for others, nothing of it hidden behind computing:
#   - two exchanges of halo values, displacements in and forces back: 2 messages to each of the neighbouring parts, and the bytes;
#   - `passes` + 1 exchanges of one number for each node on the border: nodal volumes and the passes of their Chebyshev iteration (7 at
#     nu = 0.49). These nodes are taken for half of those that an evaluation needs, which is more than there are;
#   - one sum over all parts: 2 log2(parts) messages.
# A message takes `latency` s and its bytes over `bandwidth` bytes/s. Strong: the body of PARTS. Weak: 50 000 nodes a part, with the depth of the
# halo as measured, the largest of all rows: of a cube of m^3 own nodes, with neighbours on all sides, (m + 2 depth)^3 - m^3 are needed.

BEGIN {
    FS = OFS = "\t"
    latency = 10e-6
    bandwidth = 10e9
    passes = 7
    each = 50000
}
FNR == NR { if ($1 == "mtled, an evaluation" && $2 > largest) { largest = $2; kernel = 1e-6 * $3 } next }
/^parts/ { next }
{
    parts[++n] = $1; own[n] = $2; needed[n] = $7; others[n] = $9; bytes[n] = $11; imbalance[n] = $12
    nodes = $1 * $2
    deep = (($2 + $6)^(1 / 3) - $2^(1 / 3)) / 2
    if (deep > depth) depth = deep
}
END {
    if (kernel == "" || n == 0) { print "model.awk: no time of an evaluation, or no parts" > "/dev/stderr"; exit 1 }
    print "scaling", "parts", "nodes_a_part", "needed_most", "computing_us", "waiting_us", "waiting_percent", "speedup", "efficiency_percent"
    for (i = 1; i <= n; i++)
        row("strong", parts[i], own[i], needed[i], others[i], bytes[i], imbalance[i], nodes * kernel)
    m = each^(1 / 3)
    halo = (m + 2 * depth)^3 - m^3
    for (p = 2; p <= 1024; p *= 2) row("weak", p, each, halo, 26, 48 * halo, 0.03, p * each * kernel)
}

function row(kind, p, own_nodes, halo_nodes, beside, amount, uneven, alone,    computing, waiting) {
    computing = own_nodes * kernel * (1 + uneven)
    waiting = (2 + passes + 1) * beside * latency + (amount + (passes + 1) * 8 * halo_nodes / 2) / bandwidth \
        + 2 * log(p) / log(2) * latency
    printf "%s\t%d\t%.0f\t%.0f\t%.1f\t%.1f\t%.1f\t%.1f\t%.0f\n", kind, p, own_nodes, halo_nodes, 1e6 * computing, 1e6 * waiting, \
        100 * waiting / (computing + waiting), alone / (computing + waiting), 100 * alone / (computing + waiting) / p
}
