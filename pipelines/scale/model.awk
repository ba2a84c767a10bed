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
#
# These are bodies whose vectors are cut as well. mtled-mpi (rows "mtled-mpi, strong" and "mtled-mpi, weak") keeps them whole. It sends
#   - to each neighbour 3 messages: volume ratios, forces of corners, forces on faces and vertices; for each node that is needed that is
#     `row_bytes`, 13 faces and vertices of 32 bytes, and half as much for the corners. These bytes travel while what no other process needs is
#     computed, and only what takes longer than that is waited for;
#   - to each neighbour `passes` messages more, of the pressures at half of these nodes, and one of what L of the preconditioner makes of the
#     force: 24 bytes a node;
#   - to all others, of each own node, the force, what L^T makes of that, and what L^T makes of the forces of the conditions, twice: 24 bytes
#     each; and `small` shorter ones, of conditions and the coarse space. That is log2(parts) messages each;
# and `replicated` of the computing is done by all, or again at borders: of a quasi-static cube of 15 625 nodes held on two sides, twice the
# processor time of two processes by that of one, less 1, is below a tenth, and a third of four times that of four, less 1, above it.

BEGIN {
    FS = OFS = "\t"
    latency = 10e-6
    bandwidth = 10e9
    passes = 7
    each = 50000
    row_bytes = 1.5 * 13 * 32
    large = 4
    small = 7
    replicated = 0.1
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
    for (i = 1; i <= n && parts[i] <= 64; i++) if (parts[i] > 1) whole_vectors("strong", parts[i], own[i], needed[i], others[i], imbalance[i])
    for (p = 2; p <= 64; p *= 2) whole_vectors("weak", p, each, halo, 26, 0.03)
}

function whole_vectors(kind, p, own_nodes, halo_nodes, beside, uneven,    computing, inner, travelling, waiting, alone) {
    alone = p * own_nodes * kernel
    inner = own_nodes * kernel * (1 - replicated)
    computing = inner * (1 + uneven) + alone * replicated
    travelling = row_bytes * halo_nodes / bandwidth
    waiting = ((4 + passes) * beside + (large + small) * log(p) / log(2)) * latency + (8 * passes / 2 + 24) * halo_nodes / bandwidth \
        + 24 * large * (p - 1) * own_nodes / bandwidth + (travelling > inner ? travelling - inner : 0)
    tell("mtled-mpi, " kind, p, own_nodes, halo_nodes, computing, waiting, alone)
}

function tell(kind, p, own_nodes, halo_nodes, computing, waiting, alone) {
    printf "%s\t%d\t%.0f\t%.0f\t%.1f\t%.1f\t%.1f\t%.1f\t%.0f\n", kind, p, own_nodes, halo_nodes, 1e6 * computing, 1e6 * waiting, \
        100 * waiting / (computing + waiting), alone / (computing + waiting), 100 * alone / (computing + waiting) / p
}

function row(kind, p, own_nodes, halo_nodes, beside, amount, uneven, alone,    computing, waiting) {
    computing = own_nodes * kernel * (1 + uneven)
    waiting = (2 + passes + 1) * beside * latency + (amount + (passes + 1) * 8 * halo_nodes / 2) / bandwidth \
        + 2 * log(p) / log(2) * latency
    tell(kind, p, own_nodes, halo_nodes, computing, waiting, alone)
}
