#!/bin/bash
# Solve a scene with CalculiX's quadratic triangles or tetrahedra: solve.sh SCENE MESH_STREAM [INCREMENT] > u.dat
#
# MESH_STREAM is what `nodes -t` writes; INCREMENT the largest part of the load applied at once (0.1). Prints on standard error, in the form of `mtled -v`: nodes and integration points of
# the elements, increments, seconds of the solution. OMP_NUM_THREADS is honoured.
set -euo pipefail
if [ $# -ne 2 ] && [ $# -ne 3 ]; then
    echo "usage: solve.sh SCENE MESH_STREAM [INCREMENT] > u.dat" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
scene=$1 mesh=$2 increment=${3-0.1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

dim=$(awk '$2 == "nodes.x" { print $5; exit }' "$mesh")
[ -n "$dim" ] || { echo "solve.sh: $mesh: no section nodes.x in text: run nodes -t" >&2; exit 2; }
awk -f "$here/../stream.awk" -f "$here/deck.awk" -f "$here/deck${dim}d.awk" -v scene="$scene" -v mesh="$mesh" \
    -v increment="$increment" > "$work/deck.inp"
begin=$(date +%s.%N)
if ! (cd "$work" && ccx deck > log 2>&1); then
    tail -n 20 "$work/log" >&2
    echo "solve.sh: ccx failed on $scene" >&2
    exit 1
fi
end=$(date +%s.%N)
awk -f "$here/../stream.awk" -f "$here/field.awk" -v mesh="$mesh" -v results="$work/deck.dat"
awk -v seconds="$(awk -v begin="$begin" -v end="$end" 'BEGIN { print end - begin }')" '
    /^\*/ { part = $0; next }
    part == "*NODE,NSET=BODY" { nodes++ }
    part ~ /CPE6/ { points += 3 }
    part ~ /C3D10/ { points += 4 }
    FILENAME ~ /sta$/ && $1 ~ /^[0-9]+$/ { steps++ }
    END { printf "nodes\t%d\npoints\t%d\nsteps\t%d\nsolve seconds\t%.3f\n", nodes, points, steps, seconds }
' "$work/deck.inp" "$work/deck.sta" >&2
