#!/bin/bash
# coverage.sh BUILD: lines that were run in a build with COVERAGE=1, by file, the least covered first, and of all.
set -eu -o pipefail
mapfile -t data < <(find "$1/lib" "$1/tools" -name '*.gcno')
printf 'file\tlines\trun\tpercent\n'
gcov -n "${data[@]}" 2> /dev/null | awk -F "[':%]" -v OFS='\t' '
    /^File / { file = $2 }
    /^Lines executed/ && file ~ /^(lib|tools)\/.*\.c$/ {
        split($0, w, / of /)
        lines = w[2]; run = int($2 * lines / 100 + 0.5)
        print file, lines, run, $2
        all += lines; reached += run
    }
    /^Lines executed/ || /^No executable/ { file = "" }
    END { printf "all\t%d\t%d\t%.2f\n", all, reached, 100 * reached / all }
' | sort -t $'\t' -k 4,4n
