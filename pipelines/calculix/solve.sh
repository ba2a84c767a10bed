#!/bin/bash
# Solve a scene with CalculiX's quadratic triangles or tetrahedra: solve.sh SCENE MESH_STREAM [INCREMENT] > u.dat
#
# MESH_STREAM is what `nodes -t` writes; INCREMENT the largest part of the load applied at once (0.1). Prints on standard error, in the form of `mtled -v`: nodes and integration points of
# the elements, increments, seconds of the solution by the clock and of the processors. OMP_NUM_THREADS is honoured; SOLVER names a
# solver of CalculiX other than its default, as ITERATIVE CHOLESKY.
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
awk -f "$here/../stream.awk" -f "$here/../scene.awk" -f "$here/../table.awk" -f "$here/deck.awk" -f "$here/deck${dim}d.awk" -v scene="$scene" -v mesh="$mesh" \
    -v increment="$increment" -v solver="${SOLVER:-}" > "$work/deck.inp"
TIMEFORMAT='%R %U %S'
if ! { time (cd "$work" && ccx deck > log 2>&1); } 2> "$work/time"; then
    tail -n 20 "$work/log" >&2
    echo "solve.sh: ccx failed on $scene" >&2
    exit 1
fi
awk -f "$here/../stream.awk" -f "$here/field.awk" -v mesh="$mesh" -v results="$work/deck.dat"
awk -v time="$(tail -n 1 "$work/time")" '
    /^\*/ { part = $0; next }
    part == "*NODE,NSET=BODY" { nodes++ }
    part ~ /CPE6/ { points += 3 }
    part ~ /C3D10/ { points += 4 }
    FILENAME ~ /sta$/ && $1 ~ /^[0-9]+$/ { steps++ }
    END {
        split(time, seconds, " ")
        printf "nodes\t%d\npoints\t%d\nsteps\t%d\nsolve seconds\t%.3f\nprocessor seconds\t%.3f\n",
            nodes, points, steps, seconds[1], seconds[2] + seconds[3]
    }
' "$work/deck.inp" "$work/deck.sta" >&2
