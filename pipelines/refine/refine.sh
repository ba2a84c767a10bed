#!/bin/bash
# A scene on meshes that are refined where it must be: refine.sh SCENE GEO TOL OUT
#
# Each round meshes the geometry by gmsh, or a label image (GEO ends in .nii, .nii.gz, .nrrd or .mha) by voxels, at sizes s and 2 s, solves the scene on both, and estimates the error of the finer solution
# (fielderr, of order 1: that of singular solutions, so that where a solution is smooth the estimate is too large). While its mean is above TOL (0.2mm; m without a unit), the next round's sizes come from sizefield. In the folder OUT stay
# those of the round of least estimate: body.msh, sizes.pos (of an image body.mts, sizes.mts), u.dat, coarse.dat, errors.tsv; and rounds.tsv, a row for each round:
#   round, nodes, mean_mm over the body and max_mm of the nodes (estimated), seconds (processor time: nodes to mtled on the finer mesh), all_seconds (all of the
#   round, gmsh and the coarser mesh as well)
#
# Environment: UNIT of the geometry, which is no image, about NODES at most (default 20000), ROUNDS at most (default 8), GMSH more arguments for gmsh,
# of an image SPACING of the first round's lattice, such as 6mm, and VOXELS more arguments for voxels (-l labels.tsv; not -h),
# REFINE_GROUPS arguments for tag (GROUPS of make; bash has an array of that name), quoted as in a shell: -u mm -f 'held=low:z,5',
# ORDER of the error for fielderr (default 1; empty: as it observes), SUPPORT arguments for support (-k 2), START a factor for the sizes of the first round (default 1), LEAST a length with unit below which no size goes (sizefield), GRADED=no: all sizes
# made smaller alike, AFRESH=yes: no solution begins from that of the last round (mtled --start), REPEAT how often the finer solution is timed: the least counts.
#
# Exit status: 0 below TOL; 1 the budget of nodes or rounds is spent, or a round failed: the one of least estimate is kept; 2 wrong usage.
set -euo pipefail
export LC_ALL=C OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
TIMEFORMAT='%U %S'
scene=${1-} geometry=${2-} tolerance=${3-} out=${4-}
unit=${UNIT-} budget=${NODES:-20000} rounds=${ROUNDS:-8} start=${START:-1}

# fail STATUS MESSAGE
fail() {
    echo "refine: $2" >&2
    exit "$1"
}

# calc EXPRESSION
calc() {
    awk "BEGIN { printf \"%.9g\", $1 }"
}

# holds EXPRESSION
holds() {
    awk "BEGIN { exit !($1) }"
}

# metres LENGTH: a number, or a number and a unit.
metres() {
    [[ $1 =~ ^([0-9]+\.?[0-9]*|\.[0-9]+)(e-?[0-9]+)?(m|cm|mm|um)?$ ]] || return 1
    case ${BASH_REMATCH[3]} in
        cm) calc "${BASH_REMATCH[1]}${BASH_REMATCH[2]} * 1e-2" ;;
        mm) calc "${BASH_REMATCH[1]}${BASH_REMATCH[2]} * 1e-3" ;;
        um) calc "${BASH_REMATCH[1]}${BASH_REMATCH[2]} * 1e-6" ;;
        *) calc "${BASH_REMATCH[1]}${BASH_REMATCH[2]} * 1" ;;
    esac
}

if [ -z "$scene" ] || [ -z "$geometry" ] || [ -z "$out" ]; then
    fail 2 "usage: make refine SCENE=FILE GEO=FILE UNIT=UNIT TOL=LENGTH, or GEO=IMAGE SPACING=LENGTH"
fi
[ -f "$scene" ] || fail 2 "SCENE: no file $scene"
[ -f "$geometry" ] || fail 2 "GEO: no file $geometry"
case $geometry in
    *.nii | *.nii.gz | *.nrrd | *.mha)
        image=yes unit=m body=body.mts sizes=sizes.mts
        if ! spacing=$(metres "${SPACING-}") || ! holds "$spacing > 0"; then
            fail 2 "SPACING: '${SPACING-}' is not a positive length, such as 6mm"
        fi
        ;;
    *)
        image='' body=body.msh sizes=sizes.pos
        [ -n "$unit" ] || fail 2 "UNIT: say in which unit $geometry is, as UNIT=mm"
        ;;
esac
if ! wanted=$(metres "$tolerance") || ! holds "$wanted > 0"; then
    fail 2 "TOL: '$tolerance' is not a positive length, such as 0.2mm"
fi
[[ $budget =~ ^[1-9][0-9]{1,7}$ ]] || fail 2 "NODES: '$budget' is not a number of nodes from 10 to 99999999"
[[ $rounds =~ ^[1-9][0-9]?$ ]] || fail 2 "ROUNDS: '$rounds' is not a number from 1 to 99"
if [[ ! $start =~ ^[0-9]*\.?[0-9]+$ ]] || ! holds "$start > 0"; then
    fail 2 "START: '$start' is not a positive number"
fi
# Words as of a shell, without evaluating them.
if ! naming=$(xargs -r printf '%s\n' <<< "${REFINE_GROUPS-}" 2> /dev/null); then
    fail 2 "GROUPS: ${REFINE_GROUPS-}: a quote is not closed"
fi
mapfile -t naming < <([ -z "$naming" ] || printf '%s\n' "$naming")
dim=$(sed -n 's/^dim *= *\([23]\).*/\1/p' "$scene")
[ -n "$dim" ] || fail 2 "SCENE: $scene has no dim = 2 or 3"
mkdir -p "$out"
work=$(mktemp -d "$out/.round.XXXXXX")
trap 'rm -rf "$work"' EXIT

# mesh FACTOR FILE: the geometry with the sizes of the last round, or its own, times FACTOR.
mesh() {
    local from=$geometry
    if [ "$image" ]; then
        # shellcheck disable=SC2086 # several arguments
        voxels -h "$(calc "$1 * $spacing")" ${graded:+--sizes <(scaled "$1")} ${VOXELS-} "$geometry" -o "$2" 2> "$work/log"
        return
    fi
    [ -z "$graded" ] || from=$work/graded.geo
    # shellcheck disable=SC2086 # several arguments
    gmsh -v 1 "-$dim" ${GMSH-} -setnumber Mesh.RandomSeed 1 -clscale "$1" "$from" -o "$2" > "$work/log" 2>&1
}

# scaled FACTOR: the sizes of an image's cells times FACTOR.
scaled() {
    awk -v factor="$1" '/^# / { on = $2 == "size" } on && NF == 1 { $1 = sprintf("%.17g", factor * $1) } { print }' "$work/$sizes"
}

# named: the stage tag, where it is asked for.
named() {
    if [ "${#naming[@]}" -gt 0 ]; then tag "${naming[@]}"; else cat; fi
}

# solve MESH FILE [START]: the stages start together, and all of them append to an empty log. The solution begins from that of START, or without load.
solve() {
    : > "$work/log"
    # shellcheck disable=SC2086 # several arguments
    if [ "$image" ]; then cat "$1"; else nodes -u "$unit" "$1" 2>> "$work/log"; fi | named 2>> "$work/log" | ipoints 2>> "$work/log" | support ${SUPPORT-} 2>> "$work/log" | shapefn 2>> "$work/log" | mtled -q ${3:+-s "$3"} "$scene" -o "$2" 2>> "$work/log"
}

# What the last command said, in a line: of a pipe not what stages say of one before them that failed.
said() {
    grep -v 'did an earlier stage fail?' "$work/log" | tail -n 1
}

# The processor seconds in a file of `time`.
seconds() {
    awk '{ sum += $1 + $2 } END { printf "%.3f", sum }' "$@"
}

quantity() {
    awk -F '\t' -v name="$1" '$1 == name { print $2 }' "$work/errors.tsv"
}

# keep: what a later round that fails, or is worse, leaves alone.
keep() {
    local file
    cp "$work/u.dat" "$work/last.dat"
    # The state of a scene in time or with friction depends on the way there.
    [ -n "${AFRESH-}" ] || grep -qE '^(friction|duration|frames) *=' "$scene" || last=$work/last.dat
    holds "$estimate < ${least_estimate:-1e300}" || return 0
    least_estimate=$estimate kept="round $round, $nodes nodes, $(calc "1000 * $estimate") mm"
    for file in "$body" u.dat coarse.dat errors.tsv "$sizes"; do
        [ ! -e "$work/$file" ] || cp "$work/$file" "$out/.$file.new"
    done
    rm -f "$out/$sizes"
    for file in "$body" u.dat coarse.dat errors.tsv "$sizes"; do
        [ ! -e "$out/.$file.new" ] || mv "$out/.$file.new" "$out/$file"
    done
}

kept=none what='' graded='' last=''
# lost WHAT: a round that failed.
lost() {
    fail 1 "round $round: $1: $(said); kept: $kept"
}

# turning: how far places move by an error of the body's shape, as a share of that: where it slides as far; elsewhere by the gradient of u,
# about the largest displacement over the longest side of the body.
turning() {
    ! grep -q '^\[contact' "$scene" || { echo 1; return; }
    mts print nodes.x "$work/last.dat" | awk -v u="$(quantity reference)" '
        { for (k = 1; k <= NF; k++) { if (NR == 1 || $k < low[k]) low[k] = $k; if (NR == 1 || $k > high[k]) high[k] = $k } }
        END { for (k = 1; k <= NF; k++) if (high[k] - low[k] > side) side = high[k] - low[k]; print (u < side ? u / side : 1) }'
}

# grade: the sizes, and graded.geo or the spacing, for the share of the error of the last good round.
grade() {
    local form=(-n "$(calc "int($budget * $asked_by_made)")" --sag "$(calc "$share * $estimate / $(turning)")" -u "$unit")
    [ -z "$image" ] || form=("${form[@]:0:2}" -t) # the volumes that voxels keeps make up for chords
    sizefield -v -s "$share" ${least:+--least "$least"} "${form[@]}" -o "$work/$sizes" "$work/last.dat" 2> "$work/log" || lost sizefield
    smallest=$(awk -F '\t' '$1 == "least size" { print $2 }' "$work/log")
    asked=$(awk -F '\t' '$1 == "nodes" { print $2 }' "$work/log")
    graded=yes
    if [ "$image" ]; then
        # The mean edge of a lattice's cells is .911 of its spacing.
        spacing=$(awk -F '\t' '$1 == "largest size" { printf "%.9g", $2 / 0.911 }' "$work/log")
        return
    fi
    # Whatever else the geometry says of sizes does not count.
    {
        printf 'Include "%s";\nMerge "%s";\nBackground Mesh View[0];\n' "$(realpath "$geometry")" "$(realpath "$work/sizes.pos")"
        printf 'Mesh.MeshSize%s;\n' 'ExtendFromBoundary = 0' 'FromPoints = 0' 'FromCurvature = 0' 'Min = 0' 'Max = 1e22'
    } > "$work/graded.geo"
}

# timed_solve MESH FILE [START]: the least time of REPEAT runs.
timed_solve() {
    local run
    rm -f "$work/solve.runs"
    for ((run = 1; run <= ${REPEAT:-1}; run++)); do
        { time solve "$@"; } 2>> "$work/solve.runs" || return 1
    done
    awk '{ print $1 + $2, 0 }' "$work/solve.runs" | sort -g | head -n 1 > "$work/solve.time"
    rm "$work/solve.runs"
}

# attempt: a round's meshes, solutions and estimate; where it fails $what says at what.
attempt() {
    rm -f "$work"/*.time
    what=$([ "$image" ] && echo voxels || echo gmsh)
    { time mesh "$factor" "$work/$body"; } 2> "$work/mesh.time" || return 1
    { time mesh "$(calc "2 * $factor")" "$work/coarse_$body"; } 2> "$work/coarse_mesh.time" || return 1
    what="the scene"
    # The body may come to rest elsewhere, or fold, from where the last round ended: then without load.
    { [ -n "$last" ] && timed_solve "$work/$body" "$work/u.dat" "$last"; } || timed_solve "$work/$body" "$work/u.dat" || return 1
    what="the scene at twice the size"
    { time { { [ -n "$last" ] && solve "$work/coarse_$body" "$work/coarse.dat" "$last"; } || solve "$work/coarse_$body" "$work/coarse.dat"; }; } \
        2> "$work/coarse.time" || return 1
    what=fielderr
    { time fielderr ${order:+-p "$order"} --skip-outside "$work/u.dat" "$work/coarse.dat" > "$work/errors.tsv" 2> "$work/log"; } 2> "$work/estimate.time" || return 1
}

printf 'round\tnodes\tmean_mm\tmax_mm\tseconds\tall_seconds\n' | tee "$out/rounds.tsv"
order=${ORDER-1} factor=$start least=${LEAST-} again=0 stuck=0
# How many nodes sizes asked for, by how many were made of them: learnt in each round. The octree of voxels makes up to twice as many.
asked='' asked_by_made=$([ "$image" ] && echo 0.5 || echo 1)
for ((round = 1; round <= rounds; round++)); do
    if ! attempt; then
        if [ -z "$graded" ] || [[ $what != "the scene"* && $what != voxels ]] || ((again++ == 3)); then
            lost "$what"
        fi
        # Small cells at a corner may fold where larger ones do not, and voxels may refuse so fine a lattice.
        least=$(calc "2 * $smallest")$([[ $unit =~ ^(m|cm|mm|um)$ ]] && echo "$unit")
        echo "refine: round $round: $what: $(said): once more with no size below $least" >&2
        grade
        ((round--))
        continue
    fi
    nodes=$(quantity n) estimate=$(quantity mean)
    [ -z "$asked" ] || asked_by_made=$(calc "$asked / $nodes")
    printf '%d\t%d\t%.6g\t%.6g\t%s\t%s\n' "$round" "$nodes" "$(calc "1000 * $estimate")" "$(calc "1000 * $(quantity max)")" \
        "$(seconds "$work/solve.time")" "$(seconds "$work"/*.time)" | tee -a "$out/rounds.tsv"
    keep
    [ -z "${KEEP_ROUNDS-}" ] || cp "$work/u.dat" "$out/u-$round.dat"
    ! holds "$estimate <= $wanted" || exit 0
    left=$(sed -n 's/^tolerance *= *//p' "$scene")
    holds "$wanted > ${left:-1e-5} * $(quantity reference)" ||
        fail 1 "TOL: $tolerance is less than the error that the scene's [solver] tolerance of ${left:-1e-5} leaves; kept: $kept"
    holds "$nodes < 0.85 * $budget" || fail 1 "the budget of $budget nodes (NODES) is spent; kept: $kept"
    # Grading may move nodes about without many more of them: then ask for more.
    if holds "$nodes > 1.05 * ${before:-0}"; then
        stuck=0
    elif ((++stuck == (${#least} > 0 ? 2 : 4))); then
        fail 1 "the sizes become no smaller${least:+ than $least (LEAST)}; kept: $kept"
    fi
    before=$nodes
    # A round at a time: the errors tell little of sizes far from those they were found with; and estimates wander, so that
    # asking for a little less again and again leads nowhere.
    share=$(awk -v s="$(calc "0.8 * $wanted / $estimate / 2 ^ $stuck")" 'BEGIN { print (s < 0.25 ? 0.25 : s > 0.5 ? 0.5 : s) }')
    if [ "${GRADED-}" = no ]; then
        # Errors of an order of 1.5 or a little more; no more nodes than there may be.
        factor=$(awk -v f="$factor" -v s="$share" -v room="$(calc "$nodes / $budget")" -v dim="$dim" \
            'BEGIN { a = s ^ 0.6; b = room ^ (1 / dim); print f * (a > b ? a : b) }')
    else
        grade
        factor=1
    fi
done
fail 1 "$rounds rounds (ROUNDS) are over; kept: $kept"
