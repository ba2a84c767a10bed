#!/bin/bash
# Run the unit tests and the command-line tests; the last line is "N passed, N failed", the status 1 if any failed.
set -u -o pipefail
cd "$(dirname "$0")/.." || exit 3
: "${BUILD:=$PWD/build}"
export BUILD PATH="$BUILD/bin:$PATH" CMOCKA_MESSAGE_OUTPUT=TAP
export ASAN_OPTIONS=${ASAN_OPTIONS:-detect_leaks=1} OMP_NUM_THREADS=${OMP_NUM_THREADS:-2} OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
log=$BUILD/check.log
mkdir -p "$BUILD"
rm -f "$BUILD/check.result"
: > "$log"

# A program that dies before its last result counts as one failure of its own.
run() {
    local name=$1
    shift
    echo "# $name" | tee -a "$log"
    "$@" 2>&1 | tee -a "$log" | grep -E '^(not ok|#  )'
    local status=${PIPESTATUS[0]}
    if [ "$status" -ne 0 ]; then
        echo "not ok - $name exits with status $status" | tee -a "$log"
    fi
}

for test in tests/unit/*.c; do
    name=$(basename "$test" .c)
    run "unit $name" "$BUILD/tests/$name"
done
for suite in tests/*.bats; do
    run "suite $(basename "$suite")" bats --tap "$suite"
done

passed=$(grep -c '^ok ' "$log")
failed=$(grep -c '^not ok ' "$log")
echo "$passed passed, $failed failed" | tee "$BUILD/check.result"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
