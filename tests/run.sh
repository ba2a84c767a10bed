#!/bin/bash
# run.sh [all]: run the unit programs and the suites of command-line tests, as many at a time as there are cores, the slow ones first.
# With "all", also the tests that are tagged "thorough", which repeat on larger cases what others show. A line is printed for each
# program and suite as it ends, and what those printed that failed, at the end; all that they print is in BUILD/check.log, in a
# fixed order. What runs longer than LIMIT seconds (600) is ended and has failed. The last line is "N passed, N failed"; the status is 1
# if any failed.
set -u -o pipefail
cd "$(dirname "$0")/.." || exit 3
: "${BUILD:=$PWD/build}" "${LIMIT:=600}"
export BUILD LIMIT PATH="$BUILD/bin:$PATH" CMOCKA_MESSAGE_OUTPUT=TAP ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1}
cores=$(env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc) # nproc counts no more than these
# One thread each, but for the tests of threads; idle threads sleep.
export OMP_NUM_THREADS=1 OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
export logs=$BUILD/check tags='!thorough'
[ "${1:-}" != all ] || tags=

# Run one unit program (unit/NAME) or suite (NAME.bats). Its output gets a line "not ok" if it ends before it has reported that itself.
run() {
    local log=$logs/${1//\//-} begin=$EPOCHREALTIME command status=0
    case $1 in
    unit/*) command=("$BUILD/tests/${1#unit/}") ;;
    *) command=(bats --tap ${tags:+--filter-tags "$tags"} "tests/$1") ;;
    esac
    timeout -k 10 "$LIMIT" "${command[@]}" > "$log" 2>&1 < /dev/null || status=$?
    case $status in
    0) ;;
    124 | 137) echo "not ok - $1 is ended after $LIMIT s" >> "$log" ;;
    *) grep -q '^not ok' "$log" || echo "not ok - $1 exits with status $status" >> "$log" ;;
    esac
    awk -v name="$1" -v begin="${begin/,/.}" -v end="${EPOCHREALTIME/,/.}" '
        /^ok .*# skip/ { skipped++; next } /^ok / { passed++ } /^not ok/ { failed++ }
        END { printf "%-28s %3d passed%s%s %7.1f s\n", name, passed, failed ? ", " failed " failed" : "",
            skipped ? ", " skipped " skipped" : "", end - begin }' "$log"
}
export -f run

rm -rf "$logs" "$BUILD/check.result"
mkdir -p "$logs"
slow=(mpi incise deny touching faults warp conditions voxels nodes fielderr plates hard make python pipelines numbers install)
slow=("${slow[@]/%/.bats}" unit/label_cells)
mapfile -t units < <(cd tests && printf '%s\n' unit/*.c | sed 's/\.c$//')
mapfile -t suites < <(cd tests && printf '%s\n' *.bats)
printf '%s\n' "${slow[@]}" "${suites[@]}" "${units[@]}" | awk '!seen[$0]++' | xargs -P "$cores" -I NAME bash -c 'run NAME'

for name in "${units[@]}" "${suites[@]}"; do
    echo "# $name"
    cat "$logs/${name//\//-}"
done > "$BUILD/check.log"
for name in "${units[@]}" "${suites[@]}"; do
    if grep -q '^not ok' "$logs/${name//\//-}"; then
        echo "# $name"
        grep -v '^ok ' "$logs/${name//\//-}"
    fi
done
grep '^ok .*# skip' "$BUILD/check.log"
skipped=$(grep -c '^ok .*# skip' "$BUILD/check.log")
passed=$(($(grep -c '^ok ' "$BUILD/check.log") - skipped))
failed=$(grep -c '^not ok' "$BUILD/check.log")
[ "$skipped" -eq 0 ] || echo "$skipped skipped"
echo "$passed passed, $failed failed" | tee "$BUILD/check.result"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
