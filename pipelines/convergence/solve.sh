#!/bin/bash
# One solution of a study of errors: solve.sh SCHEME SCENE MESH UNIT OUT
#
# Makes OUT.dat (the displacements, a text stream) and OUT.time: the processor seconds, of one thread, of the preparation (nodes to
# shapefn; for CalculiX nothing) and of the solution, the least of some repeats where it is quick. Schemes:
#   mls1, mmls         the founding paper's: 4 points per cell, pointwise volume, conditions at the nodes, regularised weight, constant
#                      radius (2D), or quartic weight and local radius (3D); mmls with mu = 1e-7 for lengths in mm
#   default            these programs by default
#   mixed              FreeFEM: quadratic displacement and linear pressure on the same mesh, Newton's method, a sparse direct solver; its
#                      seconds of solution are assembly and direct solver, those of preparation the rest of the process
#   dolfinx            the same elements and method by dolfinx, which compiles the forms; that is not counted, nor is starting Python
#   calculix           quadratic triangles or tetrahedra on the same mesh, the load in halves, with contact in tenths, or less where
#                      that fails; in 3D by the quicker one of its solvers, direct or iterative, if that ends within two minutes
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=1
here=$(cd "$(dirname "$0")" && pwd)
scheme=$1 scene=$2 mesh=$3 unit=$4 out=$5
TIMEFORMAT='%U %S'
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# OUT.time comes last: where it is, OUT.dat is whole.
finish() {
    rm -f "$out.time"
    mv "$work/u.dat" "$out.dat"
    mv "$work/time" "$out.time"
    exit
}

dim=$(sed -n 's/^dim = //p' "$scene")
if [ "$scheme" = calculix ]; then
    nodes -u "$unit" -t "$mesh" > "$work/cloud.dat"
    most=1 # part of the load in an increment
    ! grep -q '^\[contact' "$scene" || most=0.1
    bash "$here/../calculix/solve.sh" "$scene" "$work/cloud.dat" "$most" > "$work/u.dat" 2> "$work/logs" || { cat "$work/logs" >&2; exit 1; }
    if [ "$dim" -eq 3 ] && SOLVER='ITERATIVE CHOLESKY' timeout 120 bash "$here/../calculix/solve.sh" "$scene" "$work/cloud.dat" "$most" \
        > "$work/other.dat" 2> "$work/log"; then
        cat "$work/log" >> "$work/logs"
    fi
    awk -F '\t' '
        $1 == "nodes" { nodes = $2 }
        $1 == "processor seconds" && (least == "" || $2 < least) { least = $2 }
        END { printf "prepare\t0\nsolve\t%s\nnodes\t%d\n", least, nodes }' "$work/logs" > "$work/time"
    finish
fi

# The peers report alike.
case $scheme in
mixed) peer=(bash "$here/../mixed/solve.sh") ;;
dolfinx) peer=(/usr/bin/python3 "$here/../dolfinx/solve.py") ;;
*) peer=() ;;
esac
if [ ${#peer[@]} -gt 0 ]; then
    nodes -u "$unit" -t "$mesh" > "$work/cloud.dat"
    for _ in 1 2 3; do
        "${peer[@]}" "$scene" "$work/cloud.dat" > "$work/u.dat" 2> "$work/log" || { cat "$work/log" >&2; exit 1; }
        cat "$work/log" >> "$work/logs"
        awk -F '\t' '$1 == "processor seconds" { exit $2 < 5 }' "$work/log" && break
    done
    awk -F '\t' '
        { told[$1] = $2 }
        $1 == "processor seconds" && (least == "" || $2 < least) {
            least = $2
            solve = told["solver seconds"] + told["assembly seconds"]
        }
        END { printf "prepare\t%s\nsolve\t%s\nnodes\t%d\n", least - solve, solve, told["nodes"] }' "$work/logs" > "$work/time"
    finish
fi

# The paper's radius is 8 mm at a spacing of 5 mm; spacing is here that of the mesh's mean cell.
spacing() {
    mts print points.weight "$1" | awk '{ sum += $1; n++ } END { printf "%.6g\n", sqrt(4 / sqrt(3) * sum / n) }'
}
case $scheme in
default) rule=-c support='' ;;
mls1) rule='-g 4' support='-b mls1' ;;
mmls) rule='-g 4' support='-b mmls2 --mu 1e-7 --mu-unit mm' ;;
*) echo "solve.sh: unknown scheme $scheme" >&2; exit 2 ;;
esac
if [ "$scheme" != default ]; then
    if [ "$dim" -eq 2 ]; then
        nodes -u "$unit" "$mesh" | ipoints -g 1 > "$work/one.mts"
        h=$(spacing "$work/one.mts")
        support+=" -w regularised -R $(awk -v h="$h" 'BEGIN { print 1.6 * h }')"
    else
        support+=" -k $([ "$scheme" = mls1 ] && echo 1.4 || echo 1.8)"
    fi
    # The same scene, beside the original for the files it names.
    own=$(dirname "$scene")/.$(basename "$out").scene
    trap 'rm -rf "$work" "$own"' EXIT
    { cat "$scene"; printf 'constraint_points = node\nvolume = pointwise\n'; } > "$own"
    scene=$own
fi
cpu() {
    awk '{ print $1 + $2 }' <(tail -n 1 "$1")
}
for _ in 1 2 3; do
    # shellcheck disable=SC2086 # several arguments
    { time { nodes -u "$unit" "$mesh" | ipoints $rule | support $support | shapefn > "$work/table.mts"; } 2> "$work/log"; } 2> "$work/prepare.time"
    { time mtled -v "$scene" "$work/table.mts" > "$work/u.dat" 2> "$work/log"; } 2> "$work/solve.time" ||
        { cat "$work/log" >&2; exit 1; }
    printf '%s\t%s\n' "$(cpu "$work/prepare.time")" "$(cpu "$work/solve.time")" >> "$work/times"
    awk 'END { exit $2 < 5 }' "$work/times" && break
done
nodes=$(mts print nodes.x "$work/u.dat" | wc -l)
awk -v nodes="$nodes" '
    NR == 1 || $1 < prepare { prepare = $1 }
    NR == 1 || $2 < solve { solve = $2 }
    END { printf "prepare\t%s\nsolve\t%s\nnodes\t%d\n", prepare, solve, nodes }' "$work/times" > "$work/time"
finish
