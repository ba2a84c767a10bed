#!/bin/bash
# Solve a scene with mixed elements, quadratic triangles or tetrahedra with linear pressure, by FreeFEM: solve.sh SCENE MESH_STREAM [PLACES] > u.dat
#
# MESH_STREAM is what `nodes -t` writes. Writes a text stream of nodes.x and u, of all nodes of the elements, those of the mesh first
# and in its order, and of reactions; with PLACES, a stream of nodes.x, u is the elements' field there instead, beyond the mesh that at the
# nearest place of it. Prints on standard error, in the form of `mtled -v`: nodes and integration points, load
# steps and Newton iterations, and processor seconds of one thread: of assembly, of the direct solver, and of the whole process without the values at PLACES.
# Exit status: 0; 4 where Newton's method finds no equilibrium; 1 other failures, 2 wrong usage.
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
if [ $# -ne 2 ] && [ $# -ne 3 ]; then
    echo "usage: solve.sh SCENE MESH_STREAM [PLACES] > u.dat" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
scene=$1 mesh=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

command -v FreeFem++-nw > /dev/null || { echo "solve.sh: no FreeFem++-nw: run make deps" >&2; exit 1; }
# Debian's FreeFEM does not look where Debian puts its modules.
export FF_LOADPATH=${FF_LOADPATH-/usr/lib/freefem++} FF_INCLUDEPATH=$here
dim=$(awk '$2 == "nodes.x" { print $5; exit }' "$mesh")
[ -n "$dim" ] || { echo "solve.sh: $mesh: no section nodes.x in text: run nodes -t" >&2; exit 2; }
awk -f "$here/../stream.awk" -f "$here/../scene.awk" -f "$here/../table.awk" \
    -f "$here/problem.awk" -v scene="$scene" -v mesh="$mesh" -v out="$work"
{ [ -z "${3-}" ] || mts print nodes.x "$3"; } | awk '{ row[NR] = $0 } END { print NR; for (i = 1; i <= NR; i++) print row[i] }' > "$work/places"
TIMEFORMAT='%U %S'
if ! { time (cd "$work" && FreeFem++-nw -nw -v 0 "$here/solve${dim}d.edp" > log 2>&1); } 2> "$work/time"; then
    [ ! -s "$work/failure" ] || { echo "solve.sh: $scene: $(cat "$work/failure")" >&2; exit 4; }
    tail -n 20 "$work/log" >&2
    echo "solve.sh: FreeFEM failed on $scene" >&2
    exit 1
fi
awk -v dim="$dim" '
    FILENAME ~ /forces$/ { name = name (name == "" ? "" : ",") $1; sub(/^[^ ]* /, ""); force[++count] = $0; next }
    { n++; x[n] = $1 " " $2 (dim == 3 ? " " $3 : ""); u[n] = $(dim + 1) " " $(dim + 2) (dim == 3 ? " " $6 : "") }
    END {
        axes = dim == 2 ? "x,y" : "x,y,z"
        print "# mts 1"
        printf "# nodes.x f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
        for (i = 1; i <= n; i++) print x[i]
        printf "\n\n# reactions f8 %d %d enc=text unit=%s rows=%s\n", count, dim, dim == 2 ? "N/m" : "N", name
        for (i = 1; i <= count; i++) print force[i]
        printf "\n\n# u f8 %d %d enc=text unit=m cols=%s\n", n, dim, axes
        for (i = 1; i <= n; i++) print u[i]
        print "\n\n# end 3"
    }' "$work/forces" "$work/$([ -n "${3-}" ] && echo at_places || echo field)"
grep -v ^places "$work/report" >&2
awk -F '[ \t]+' '$1 == "places" { places = $3; next } NF == 2 { seconds = $1 + $2 } END { printf "processor seconds\t%.3f\n", seconds - places }' \
    "$work/report" <(tail -n 1 "$work/time") >&2
