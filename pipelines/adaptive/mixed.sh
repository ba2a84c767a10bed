#!/bin/bash
# Mixed elements (pipelines/mixed) on meshes that are refined by their own solution, or alike: mixed.sh CASE KIND SCENE GEO REFERENCE FOLDER
#
# Each round meshes the geometry by gmsh, solves the scene, and takes the sizes of the next mesh from the gradients of the solution between
# the vertices of the elements (sizefield), as pipelines/refine does; KIND even: all sizes are made smaller alike. Prints a row for each round as rounds.sh
# does: case, kind, nodes (of vertices and edges), processor seconds of the solution and of all rounds so far (but those without an equilibrium), no estimate, the true mean
# error by REFERENCE at its places (mm), no effectivity.
#
# Environment: UNIT of the geometry, GMSH more arguments for gmsh, BUDGET: the nodes at which it ends, SHARE of the present error wanted of a
# round, SAG a length that facets may be off a curve, LEAST size, both with unit, REPEAT how often
# a solution is timed: the least counts.
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=1
here=$(cd "$(dirname "$0")" && pwd)
name=$1 kind=$2 scene=$3 geometry=$(realpath "$4") reference=$5 folder=$6
TIMEFORMAT='%U %S'
dim=$(sed -n 's/^dim *= *\([23]\).*/\1/p' "$scene")
rm -rf "$folder"
mkdir -p "$folder"

# The vertices with their displacements, and the cells: of the mesh stream $1 and the field $2.
vertices() {
    local n
    n=$(mts print nodes.x "$1" | wc -l)
    grep -v '^# end' "$1"
    printf '# u f8 %d %d enc=text unit=m\n' "$n" "$dim"
    mts print u "$2" | awk -v n="$n" 'NR <= n'
    printf '\n\n# end %d\n' $(($(grep -c '^# [a-z].* enc=' "$1") + 1))
}

# lost NAME: that failed; its message.
lost() {
    echo "mixed.sh: $name, $kind, round $round: $1: $(tail -n 1 "$folder/log")" >&2
    exit 1
}

# grade: graded.geo, with sizes from the last solution.
grade() {
    sizefield -v -s "$SHARE" -n 1000000 ${sag:+--sag "$sag"} ${least:+--least "$least"} -u "$UNIT" -o "$folder/sizes.pos" "$folder/u.dat" 2> "$folder/log" || lost sizefield
    smallest=$(awk -F '\t' '$1 == "least size" { print $2 }' "$folder/log")
    {
        printf 'Include "%s";\nMerge "%s";\nBackground Mesh View[0];\n' "$geometry" "$(realpath "$folder/sizes.pos")"
        printf 'Mesh.MeshSize%s;\n' 'ExtendFromBoundary = 0' 'FromPoints = 0' 'FromCurvature = 0' 'Min = 0' 'Max = 1e22'
    } > "$folder/graded.geo"
    from=$folder/graded.geo
}

from=$geometry factor=1 total=0 least=${LEAST-} sag=${SAG-} again=0
for ((round = 1; round <= 12; round++)); do
    # shellcheck disable=SC2086 # several arguments
    { time gmsh -v 1 "-$dim" ${GMSH-} -setnumber Mesh.RandomSeed 1 -clscale "$factor" "$from" -o "$folder/body.msh" > "$folder/log" 2>&1; } 2> "$folder/time" || lost gmsh
    nodes -u "$UNIT" -t "$folder/body.msh" > "$folder/mesh.dat" 2> "$folder/log" || lost nodes
    status=0
    : > "$folder/seconds"
    for ((run = 1; run <= ${REPEAT:-1} && status == 0; run++)); do
        bash "$here/../mixed/solve.sh" "$scene" "$folder/mesh.dat" "$reference" > "$folder/places.dat" 2> "$folder/report" || status=$?
        awk -F '\t' '$1 == "processor seconds" { print $2 }' "$folder/report" >> "$folder/seconds"
    done
    if [ "$status" -ne 0 ]; then
        cp "$folder/report" "$folder/log"
        # Status 4: no equilibrium is found. As of these programs, larger cells at the corners may do.
        if [ "$status" -ne 4 ] || [ "$round" -eq 1 ]; then lost solve.sh; fi
        echo "mixed.sh: $name, $kind, round $round: $(tail -n 1 "$folder/report")" >&2
        if [ "$kind" = even ] || ((again++ == 3)); then break; fi
        least=$(awk -v s="$smallest" -v unit="$UNIT" 'BEGIN { print 2 * s unit }')
        grade
        continue
    fi
    nodes=$(awk -F '\t' '$1 == "nodes" { print $2 }' "$folder/report")
    seconds=$(sort -g "$folder/seconds" | head -n 1)
    total=$(awk -v sum="$total" -v s="$seconds" '{ print sum + s + $1 + $2 }' <(tail -n 1 "$folder/time"))
    fieldcmp --skip-outside "$reference" "$folder/places.dat" > "$folder/compared.tsv"
    awk -F '\t' -v head="$name	mixed $kind	$nodes	$seconds	$total	-" '
        $1 == "avg" { error = 1e3 * $2 }
        END { if (!(error > 0)) exit 1; printf "%s\t%.5g\t-\n", head, error }' "$folder/compared.tsv"
    [ "$nodes" -lt "$BUDGET" ] || break
    if [ "$kind" = even ]; then
        factor=$(awk -v f="$factor" 'BEGIN { print f / sqrt(2) }')
        continue
    fi
    bash "$here/../mixed/solve.sh" "$scene" "$folder/mesh.dat" > "$folder/field.dat" 2> "$folder/log" || lost solve.sh
    vertices "$folder/mesh.dat" "$folder/field.dat" > "$folder/u.dat"
    grade
done
