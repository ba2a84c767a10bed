#!/bin/bash
# A text afresh: bash pipelines/readme.sh < README.md > new. Needs the tools on PATH; see readme.mk and tests/readme.bats.
#
# Figures come from the files of pipelines/results (RESULTS, if set), which make readme takes from the studies.
#
# - Blocks ```console: each "$ command" (continued in lines "> ...") is run, in one shell and in a folder of its own that
#   sees examples/ and pipelines/; what it prints takes the place of what stands below it. A command that fails
#   is an error.
# - Between "<!-- tools -->" and "<!-- end -->": the tools and their one-line summaries, from their usage texts.
# - Between "<!-- studies -->" and "<!-- end -->": the studies, from the first lines of pipelines/*.mk.
# - Between "<!-- study FILE [COLUMN...] -->" and "<!-- end -->": the table FILE, or what study_table picks of it.
# - "<!-- figure: FILE COLUMN ROW -->...<!-- end -->" within a line: one figure, see figures.awk.
# - A picture that the commands make, build/NAME.png, replaces examples/*/pictures/NAME.png where KEEP=1 is set.
set -uo pipefail

source_root=$(cd "$(dirname "$0")/.." && pwd)
results=${RESULTS:-pipelines/results}
[[ $results = /* ]] || results=$source_root/$results
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ln -s "$source_root/examples" "$source_root/pipelines" "$work"
mkdir "$work/build"
cd "$work" || exit 3
failures=0

# Run one command; its output, in order, without blanks at the ends of lines.
run() {
    eval "$1" > "$work/.output" 2>&1 < /dev/null
    local status=$?
    if [ "$status" -ne 0 ]; then
        printf 'readme: status %d: %s\n' "$status" "$1" >&2
        failures=$((failures + 1))
    fi
    sed 's/[[:blank:]]*$//' "$work/.output"
}

tools_table() {
    local file
    printf '| tool | does |\n|---|---|\n'
    for file in "$source_root"/tools/*.c; do
        "$(basename "$file" .c)" -h | sed -n '1s/^\([^ ]*\) - \(.*\)/| `\1` | \2 |/p'
    done
}

studies_table() {
    printf '| command | what it computes |\n|---|---|\n'
    local file
    for file in "$source_root"/pipelines/*.mk; do
        awk '
            NR == 1 && !/^# make [^:]*: / { exit }
            NR == 1 { command = $0; sub(/^# /, "", command); sub(/: .*/, "", command); sub(/^[^:]*: /, "") }
            !/^#/ && NR > 1 || /^#$/ { exit }
            { sub(/^# /, ""); text = text (text == "" ? "" : " ") $0 }
            END {
                sub(/\. .*|\.$/, "", text)
                if (command != "") print "| `" command "` | " text " |"
            }' "$file"
    done
}

# study_table FILE [COLUMN | COLUMN=VALUE,VALUE... | last]...: as a table of Markdown: these columns, of the rows with one of these values,
# and with "last" of the last row for each combination of the first two columns.
study_table() {
    local file=$results/$1
    shift
    awk -F '\t' -v wanted="$*" '
        function fail(what) { print "readme: " FILENAME ": no " what > "/dev/stderr"; exit failed = 1 }
        function show() { if (shown != "") print shown; shown = "" }
        NR == 1 {
            count = split(wanted, word, " ")
            for (i = 1; i <= NF; i++) at[$i] = i
            for (i = 1; i <= count; i++) {
                values = ""
                if (word[i] == "last") { last = 1; continue }
                if (match(word[i], "=")) { values = substr(word[i], RSTART + 1); word[i] = substr(word[i], 1, RSTART - 1) }
                if (!(word[i] in at)) fail("column " word[i])
                if (values != "") only[at[word[i]]] = "," values ","; else pick[++n] = at[word[i]]
            }
            if (n == 0) while (n < NF) pick[++n] = n
        }
        NR > 1 { for (i in only) if (!index(only[i], "," $i ",")) next }
        { row = "|"; for (i = 1; i <= n; i++) row = row " " $pick[i] " |" }
        !last || $1 FS $2 != kind { show() }
        { kind = $1 FS $2; shown = row; rows++ }
        NR == 1 { show(); rule = "|"; for (i = 1; i <= n; i++) rule = rule (i == 1 ? "---|" : "--:|"); print rule }
        END { if (!failed) { show(); if (rows < 2) fail("rows") } }' "$file"
}

# Drop the lines up to the mark that ends the generated part.
drop_lines() { while IFS= read -r line && [ "$line" != "<!-- end -->" ]; do :; done; }

command=
flush() {
    if [ -n "$command" ]; then
        run "$command"
        command=
    fi
}

awk -f "$source_root/pipelines/figures.awk" -v results="$results" > "$work/.text" || exit 1

console=
while IFS= read -r line; do
    if [ -n "$console" ]; then
        case $line in
        '```') flush; console=; printf '%s\n' "$line" ;;
        '$ '*) flush; command=${line#'$ '}; printf '%s\n' "$line" ;;
        '> '*) command+=$'\n'${line#'> '}; printf '%s\n' "$line" ;;
        esac
        continue
    fi
    printf '%s\n' "$line"
    case $line in
    '```console') console=yes ;;
    '<!-- tools -->') tools_table; drop_lines; printf '<!-- end -->\n' ;;
    '<!-- studies -->') studies_table; drop_lines; printf '<!-- end -->\n' ;;
    '<!-- study '*)
        table=${line#'<!-- study '}
        read -ra table <<< "${table%' -->'}"
        study_table "${table[@]}" || failures=$((failures + 1))
        drop_lines
        printf '<!-- end -->\n'
        ;;
    esac
done < "$work/.text"

if [ "${KEEP:-}" = 1 ] && [ "$failures" -eq 0 ]; then
    for picture in "$source_root"/examples/*/pictures/*.png; do
        made=$work/build/$(basename "$picture")
        [ ! -f "$made" ] || cp "$made" "$picture"
    done
fi
[ "$failures" -eq 0 ]
