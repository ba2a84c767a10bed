#!/bin/bash
# One label image through voxels, then held at one end of its longest side and pushed by a tenth of it at the other, nu .49, all by
# default: bash row.sh NAME IMAGE [OPTIONS OF voxels] prints a row of voxels.tsv. Seconds are those of the processor.
set -uo pipefail
export LC_ALL=C
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
name=$1
shift
status=0
TIMEFORMAT=%U

told() { awk -F '\t' -v name="$1" '$1 == name { value = $2 } END { print (value == "" ? "-" : value) }' "$work/log"; }
seen() { sed -nE "s/$1/\1/p" "$work/said" | tail -n 1; }

{ time voxels -v "$@" > "$work/body.mts" 2> "$work/said"; } 2> "$work/seconds" || { cat "$work/said" >&2; exit 1; }
mts check "$work/body.mts" > "$work/check" || true
valid=$(grep -vc 'connected bodies$' "$work/check")
[ "$valid" -eq 0 ] && valid=yes || valid=no
worst=$(sed -nE 's/^voxels: .* of cells \(([+-][0-9.]+) %\).*/\1/p' "$work/said" |
    awk '{ a = $1 < 0 ? -$1 : $1; if (a >= most) { most = a; value = $1 } } END { printf "%.2f", value }')
lost=$(sed -nE 's/^voxels: .*: ([0-9.e+-]+) ml are lost.*/\1/p' "$work/said" | awk '{ sum += $1 } END { printf "%.3g", sum }')

# Only one body can be held at its ends.
voxels --largest "$@" 2> "$work/largest" | tag -f held=low:long,12% -f pushed=high:long,12% > "$work/named.mts" 2> "$work/groups" ||
    { cat "$work/groups" >&2; exit 1; }
push=$(mts print nodes.x "$work/named.mts" | awk '
    { for (k = 1; k <= 3; k++) { if (NR == 1 || $k < low[k]) low[k] = $k; if (NR == 1 || $k > high[k]) high[k] = $k } }
    END {
        axis = 1
        for (k = 2; k <= 3; k++) if (high[k] - low[k] > (high[axis] - low[axis]) * (1 + 1e-6)) axis = k
        for (k = 1; k <= 3; k++) printf "%s%.9g", (k > 1 ? ", " : ""), (k == axis ? -.1 * (high[k] - low[k]) : 0)
    }')
{
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n'
    mts list "$work/named.mts" | sed -nE 's/^cells.region.*names=(.*)$/\1/p' | tr , '\n' | while read -r region; do
        printf '[material %s]\nregion = %s\nE = 3000\nnu = 0.49\nrho = 1000\n' "$region" "$region"
    done
    printf '[displacement held]\nfacets = held\ncomponents = 0, 0, 0\n'
    printf '[displacement pushed]\nfacets = pushed\ncomponents = %s\n' "$push"
} > "$work/push.scene"
shapefn "$work/named.mts" > "$work/table.mts" 2> "$work/shapefn"
solve() { status=0; mtled -v "$work/push.scene" "$work/table.mts" > "$work/u.dat" 2> "$work/log" || status=$?; }
solve
first=$(grep -ao 'folds from [0-9.]* of the load on: .*' "$work/log" | sed 's/: let it touch itself.*//') || true
# A body whose crevices the push closes is computed again, with contact of the boundary with itself.
if grep -aq 'let it touch itself' "$work/log"; then
    printf '[contact itself]\nfacets = *\nagainst = *\n' >> "$work/push.scene"
    solve
fi
message=$(grep -a '^mtled: ' "$work/log" | sed 's/^mtled: [^ ]*push.scene: //' | tail -n 1 | tr '\t' ' ' | cut -c 1-160)
steps=$(told steps)
printf '%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\t%s\n' "$name" \
    "$(seen '^voxels: spacing .*: ([0-9]+) nodes, .*')" "$(seen '^voxels: spacing .* nodes, ([0-9]+) cells.*')" "$valid" \
    "$(seen '^voxels: spacing .* from ([0-9.]+) to .*')" "$(seen '^voxels: spacing .* to ([0-9.]+) degrees')" "$worst" "$lost" \
    "$(seen '^voxels: nodes of interfaces: farthest ([0-9.e+-]+) voxels.*')" "$(seen '^voxels: nodes of .* off, ([0-9]+) of .*')" \
    "$(cat "$work/seconds")" "$status" "$steps" "$(told 'least J')" "${first:+the body $first}${first:+${message:+; }}$message"
