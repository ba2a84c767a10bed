#!/bin/bash
# Static checks: clang-tidy (.clang-tidy), cppcheck and shellcheck; see lint.mk. A program that is not installed is reported and left
# out. Status 1 when something is found.
# shellcheck disable=SC2317 # functions are called by name
set -u -o pipefail
cd "$(dirname "$0")/.." || exit 3
found=0
mapfile -t sources < <(find lib tools -name '*.c' -not -path 'tools/mpi/*' | LC_ALL=C sort)
mapfile -t scripts < <(find . -name '*.sh' -not -path './build*'; echo .ci/run)

tidy() {
    printf '%s\n' "${sources[@]}" | xargs -P "$(nproc)" -n 8 bash -c \
        'clang-tidy --quiet "$@" -- -std=c11 -D_GNU_SOURCE -Ilib -Itools -Itools/common -fopenmp 2> /dev/null' tidy
}

# What is not asked for, and why: missingInclude: system headers need not be read. uninitvar, ctuuninitvar, ctunullpointer: wrong
# where an array is filled in a loop or an error text by who is called; gcc and clang warn of these as well.
# arrayIndexOutOfBoundsCond: one wrong finding (tools/mts.c), of calls that do not return.
# Arguments of formats are the compiler's to check: cppcheck takes int64_t and intmax_t for two types.
cpp() {
    cppcheck --quiet --std=c11 --enable=warning,performance,portability -D_GNU_SOURCE -Ilib -Itools -Itools/common --error-exitcode=1 \
        --library=pipelines/cppcheck.cfg --template='{file}:{line}: {id}: {message}' --suppress=missingInclude --suppress=invalidPrintfArgType_sint \
        --suppress=uninitvar --suppress=ctuuninitvar --suppress=ctunullpointer --suppress=arrayIndexOutOfBoundsCond \
        "${sources[@]}"
}

check() { # PROGRAM FUNCTION
    if ! command -v "$1" > /dev/null; then
        echo "lint: no $1: left out (make deps-lint)"
    elif ! "$2"; then
        echo "lint: $1 found something"
        found=1
    fi
}

shells() { shellcheck -x -P SCRIPTDIR -S warning -s bash "${scripts[@]}"; }

check clang-tidy tidy
check cppcheck cpp
check shellcheck shells
exit "$found"
