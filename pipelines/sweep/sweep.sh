#!/bin/bash
# sweep.sh [-j JOBS] CASES TEMPLATE STREAM FOLDER: many cases of one scene, one for each row of a table of parameters; by make, JOBS at once.
# sweep.sh -l CASES TEMPLATE: the names of the cases.
#
# CASES, TEMPLATE and the names in them: scene.awk. STREAM: what shapefn has written, for all cases, or with @NAME@ for each. Results in
# FOLDER: case.sh. A case that fails does not stop the others. The same command goes on where it was killed, and computes again what has
# changed or failed. At the end FOLDER/sweep.tsv has a row for each case: its parameters, its status (done, or that of mtled), and what
# mtled said. Status 0: all done; 1: some failed; 2: the table, template or stream is wrong.
set -eu -o pipefail
scripts=$(dirname "$0")
usage() {
    echo "usage: sweep.sh [-j JOBS] CASES TEMPLATE STREAM FOLDER | sweep.sh -l CASES TEMPLATE" >&2
    exit 2
}

jobs=()
if [ "${1:-}" = -l ]; then
    [ $# -eq 3 ] || usage
    exec awk -f "$scripts/scene.awk" -v list=1 "$2" "$3"
elif [ "${1:-}" = -j ]; then
    [[ ${2:-} =~ ^[1-9][0-9]*$ ]] || usage
    jobs=(-j "$2")
    shift 2
fi
[ $# -eq 4 ] || usage
for file in "$1" "$2"; do
    [ -f "$file" ] && [ -r "$file" ] || { echo "sweep: $file: cannot be read" >&2; exit 2; }
done
[[ $3 = *@* ]] || [ -f "$3" ] || { echo "sweep: $3: no such stream: write one by shapefn -o" >&2; exit 2; }
awk -f "$scripts/scene.awk" -v list=1 -v stream="$3" "$1" "$2" > /dev/null
command -v mtled > /dev/null || { echo "sweep: mtled is not on PATH" >&2; exit 2; }

mkdir -p "$4"
rm -f "$4/sweep.tsv"
export SWEEP_CASES=$1 SWEEP_TEMPLATE=$2 SWEEP_STREAM=$3 SWEEP_FOLDER=$4 SWEEP_SCRIPTS=$scripts
status=0
make -k -s "${jobs[@]}" -f "$scripts/cases.mk" all 2> "$4/sweep.log" || status=$?
grep '^sweep: ' "$4/sweep.log" >&2 || true

# What has become of each.
awk -v folder="$4" '
    BEGIN { FS = OFS = "\t" }
    { sub(/\r$/, "") }
    /^#/ || /^[ \t]*$/ { next }
    !head { head = 1; print $0, "status", "message"; next }
    {
        line = ""
        if ((getline line < (folder "/" $1 ".failed")) > 0) { split(line, part); print $0, part[1], part[2]; failed++ }
        else if ((getline line < (folder "/" $1 ".dat")) > 0) { print $0, "done", ""; done++ }
        else { print $0, "missing", ""; failed++; missing++ }
        close(folder "/" $1 ".failed")
        close(folder "/" $1 ".dat")
    }
    END {
        printf "sweep: %d done, %d not: %s/sweep.tsv\n", done, failed, folder > "/dev/stderr"
        if (missing) while ((getline line < (folder "/sweep.log")) > 0) print line > "/dev/stderr"
        exit failed > 0
    }' "$1" > "$4/sweep.tsv.new" || status=1
mv "$4/sweep.tsv.new" "$4/sweep.tsv"
[ $status -eq 0 ] || exit 1
