#!/bin/bash
# One mesh, as a new user would try it: held within 12 % of one end of its longest side, the same at the other end pushed by
# 12 % of the length, nu .49, everything by default: bash push.sh NAME MESH [SECONDS] prints a row of foreign.tsv. A NAME
# that ends in -pulled is pulled. Seconds are those of the processor in mtled, which is stopped after so many.
set -uo pipefail
export LC_ALL=C OMP_NUM_THREADS=1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
name=$1 mesh=$2 seconds=${3:-200}
way=-.12
[[ $name != *-pulled ]] || way=.12
status=0

# told NAME FILE: what stands behind the tab of a line of a report.
told() { [ -s "$2" ] || { echo -; return; }; awk -F '\t' -v name="$1" '$1 == name { value = $2 } END { print (value == "" ? "-" : value) }' "$2"; }

fail() {
    printf '%s\t%s\t%s\t%s\t%s\t%s\t%.1f\t%s\t%s\n' "$name" "${nodes:--}" "${cells:--}" "${quality:--}" "$status" \
        "$(told steps "$work/log")" "$(tail -n 1 "$work/time" 2> /dev/null || echo 0)" "$(told 'least J' "$work/log")" "$1"
    exit 0
}

# What a program said at last, without the folder of this run.
last() { tail -n 1 "$1" | tr '\t' ' ' | sed "s|$work/||g" | cut -c 1-200; }

nodes -v -u mm "$mesh" > "$work/body.mts" 2> "$work/said" || { status=$?; fail "$(last "$work/said")"; }
read -r nodes cells < <(sed -nE 's/^nodes: ([0-9]+) nodes, ([0-9]+) cells.*/\1 \2/p' "$work/said")
quality=$(sed -nE 's/^nodes: quality of the cells: least ([^,]*),.*/\1/p' "$work/said")
tag -f held=low:long,12% -f pushed=high:long,12% "$work/body.mts" > "$work/named.mts" 2> "$work/said" ||
    { status=$?; fail "$(last "$work/said")"; }
push=$(mts print nodes.x "$work/body.mts" | awk -v way=$way '
    { for (k = 1; k <= 3; k++) { if (NR == 1 || $k < low[k]) low[k] = $k; if (NR == 1 || $k > high[k]) high[k] = $k } }
    END {
        axis = 1
        for (k = 2; k <= 3; k++) if (high[k] - low[k] > (high[axis] - low[axis]) * (1 + 1e-6)) axis = k
        for (k = 1; k <= 3; k++) printf "%s%.9g", (k > 1 ? ", " : ""), (k == axis ? way * (high[k] - low[k]) : 0)
    }')
regions=$(mts list "$work/body.mts" | sed -nE 's/^cells.region.*names=(.*)$/\1/p')
cat > "$work/push.scene" << END
[scene]
dim = 3
analysis = quasi-static
[material tissue]
region = $regions
E = 3000
nu = 0.49
rho = 1000
[displacement held]
facets = held
components = 0, 0, 0
[displacement pushed]
facets = pushed
components = $push
[output]
reactions = yes
END
shapefn "$work/named.mts" > "$work/table.mts" 2> "$work/said" || { status=$?; fail "$(last "$work/said")"; }
TIMEFORMAT=%U
solve() {
    status=0
    { time (ulimit -S -t "$seconds" && mtled -v "$work/push.scene" "$work/table.mts" > "$work/u.dat" 2> "$work/log"); } 2> "$work/time" ||
        status=$?
}
solve
# What passes through itself is computed again, with contact of the boundary with itself.
if grep -aq 'let it touch itself' "$work/log"; then
    printf '[contact itself]\nfacets = *\nagainst = *\n' >> "$work/push.scene"
    solve
fi
[ "$status" -ne 152 ] || fail "not done after $seconds s of the processor"
[ "$status" -eq 0 ] || fail "$(last <(grep -a '^mtled: ' "$work/log"))"
fail "force $(mts print reactions "$work/u.dat" | awk 'NR == 1 { printf "%.3g N", sqrt($1 ^ 2 + $2 ^ 2 + $3 ^ 2) }')"
