#!/bin/bash
# A converged solution: reference.sh SCENE MESH UNIT [PLACES] > TABLE (x y ux uy, m). Run by hand (make convergence-references); its tables
# are kept in examples/convergence, so that the study needs minutes only.
#
# Mixed elements (quadratic displacement, linear pressure) on MESH (gmsh), its halves and its quarters; the fields at the common nodes give the order
# at which they converge, and with it the limit at the nodes of the halves (Richardson). With PLACES (a stream with nodes.x) the table has the
# finest mesh's field there, not extrapolated: for corners whose singularity grows with the load, where the order is not settled. The head of the
# table tells all that, and the force of the last condition on the three meshes.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
scene=$1 unit=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp "$2" "$work/0.msh"
for level in 0 1 2; do
    [ $level -eq 0 ] || gmsh -v 1 "$work/$((level - 1)).msh" -refine -o "$work/$level.msh" > /dev/null
    nodes -u "$unit" -t "$work/$level.msh" > "$work/$level.dat"
    bash "$here/../mixed/solve.sh" "$scene" "$work/$level.dat" ${4+"$4"} > "$work/$level.u" 2> "$work/$level.log" ||
        { cat "$work/$level.log" >&2; exit 1; }
    mts print reactions "$work/$level.u" | awk 'END { for (d = 1; d <= NF; d++) printf "%.6g%s", $d, d < NF ? "," : " " }' >> "$work/forces"
    paste <(mts print nodes.x "$work/$level.u") <(mts print u "$work/$level.u") > "$work/$level.tsv"
done
awk -v scene="$(basename "$scene")" -v nodes="$(sed -n 's/^nodes\t//p' "$work"/[012].log | tr '\n' ' ')" -v forces="$(cat "$work/forces")" -v extrapolate=$(($# == 3)) '
    function key() { return sprintf("%.5e %.5e", $1 + 1e-9, $2 + 1e-9) }
    FNR == 1 { level = file++ }
    { ux[level, key()] = $3; uy[level, key()] = $4 }
    level == 0 { common[++count] = key() }
    level == 1 { place[++places] = key(); x[places] = $1; y[places] = $2 }
    function change(a, b, k) { return sqrt((ux[a, k] - ux[b, k]) ^ 2 + (uy[a, k] - uy[b, k]) ^ 2) }
    END {
        for (i = 1; i <= count; i++) { first += change(0, 1, common[i]); second += change(1, 2, common[i]) }
        order = log(first / second) / log(2)
        share = 1 / (2 ^ order - 1)
        printf "# %s by mixed elements (P2-P1, FreeFEM) on nested meshes of %snodes, %s.\n", scene, nodes,
            extrapolate ? "extrapolated" : "the finest"
        printf "# Mean changes %.5f and %.5f mm: order %.2f; from the finest to the extrapolated %.5f mm. Forces %sN/m.\n# x_m y_m ux_m uy_m\n",
            1e3 * first / count, 1e3 * second / count, order, 1e3 * share * second / count, forces
        share *= extrapolate
        for (i = 1; i <= places; i++) {
            k = place[i]
            printf "%.7g %.7g %.5e %.5e\n", x[i], y[i], ux[2, k] + share * (ux[2, k] - ux[1, k]), uy[2, k] + share * (uy[2, k] - uy[1, k])
        }
    }' "$work/0.tsv" "$work/1.tsv" "$work/2.tsv"
