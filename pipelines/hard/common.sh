# shellcheck shell=bash
# What the hard cases share; sourced by pipelines/hard/*.sh, each of which prints rows of hard.tsv on standard output.
#
# A row is: case, quantity, value, reference, error, tolerance, verdict (pass or FAIL), between tabs. The error is
# relative to the reference, absolute where the reference is 0.
set -euo pipefail
export LC_ALL=C
# The bodies are small: threads cost more than they give.
export OMP_NUM_THREADS=1

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# tolerance NAME: the limit of that name in tolerances.tsv, which says why it is that. Ends the script where there is none.
tolerance() {
    awk -F '\t' -v name="$1" '$1 == name { print $2; found = 1 } END { exit !found }' "$(dirname "${BASH_SOURCE[0]}")/tolerances.tsv" ||
        { echo "tolerances.tsv has no limit '$1'" >&2; return 1; }
}

# row CASE QUANTITY VALUE REFERENCE LIMIT: LIMIT as in tolerances.tsv.
row() {
    local tolerance
    tolerance=$(tolerance "$5")
    awk -v OFS='\t' -v name="$1" -v quantity="$2" -v value="$3" -v reference="$4" -v tolerance="$tolerance" '
        function is_number(text) { return text ~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/ }
        BEGIN {
            if (!is_number(value)) { # also nan and inf
                print name, quantity, "none", reference, "-", tolerance, "FAIL"
                exit
            }
            error = value - reference
            if (reference != 0) error /= reference
            if (error < 0) error = -error
            printf "%s\t%s\t%.8g\t%.8g\t%.3g\t%g\t%s\n", name, quantity, value, reference, error, tolerance,
                error <= tolerance ? "pass" : "FAIL"
        }'
}

# at_least CASE QUANTITY VALUE LIMIT, at_most CASE QUANTITY VALUE LIMIT: the error is how far it is beyond that.
at_least() {
    one_sided "$1" "$2" "$3" "$4" '>='
}
at_most() {
    one_sided "$1" "$2" "$3" "$4" '<='
}
one_sided() {
    local bound
    bound=$(tolerance "$4")
    awk -v name="$1" -v quantity="$2" -v value="$3" -v bound="$bound" -v relation="$5" '
        BEGIN {
            head = name "\t" quantity
            if (value !~ /^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$/) {
                printf "%s\tnone\t%s %s\t-\t0\tFAIL\n", head, relation, bound
                exit
            }
            beyond = relation == "<=" ? value - bound : bound - value
            if (beyond < 0) beyond = 0
            printf "%s\t%.4g\t%s %s\t%.3g\t0\t%s\n", head, value, relation, bound, beyond, (beyond > 0 ? "FAIL" : "pass")
        }'
}

# calc EXPRESSION: its value. `nan` in it makes it nan, which no row passes.
calc() {
    awk "BEGIN { pi = atan2(0, -1); nan = log(0) - log(0); printf \"%.12g\\n\", $1 }" || echo nan
}

# scene FILE: write standard input as a scene, after the head and the base material that most scenes share. Variables: dim
# (default 3), youngs (3000), nu (.49), rho (1000), analysis (quasi-static), head (more lines of [scene]).
scene() {
    cat > "$1" - <(printf '\n[material body]\nregion = body\nE = %s\nnu = %s\nrho = %s\n' \
        "${youngs:-3000}" "${nu:-0.49}" "${rho:-1000}")
    sed -i "1i [scene]\ndim = ${dim:-3}\nanalysis = ${analysis:-quasi-static}\n${head:-}" "$1"
}

# cube LINES [ANALYSIS]: a scene of a unit cube with faces xmin, ymin, zmin that slide, to standard output: LINES of its material and, after
# them, what else there is; ANALYSIS: more lines of [scene]. The cube of 8 nodes itself: unit_cube.
cube() {
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n%b\n[material body]\nregion = body\n%b\n' "${2:-}" "$1"
    printf '[displacement %s]\nfacets = %s\nnormal = 0\n' x xmin y ymin z zmin
    printf '[output]\nreactions = yes\n'
}
unit_cube() { cloud -d 3 -k regular -n 2 --box 0,1,0,1,0,1 2> /dev/null | shapefn > "$work/cube.mts" 2> /dev/null; }

# relax SCENE TABLE OUT: run mtled; what it says on standard error goes to OUT.log. When it fails its message is shown and
# OUT is empty: the rows made of it then read `none` and FAIL.
relax() {
    if ! mtled -v "$1" "$2" > "$3" 2> "$3.log"; then
        tail -n 1 "$3.log" >&2
        : > "$3"
        [ -z "${ESTIMATE:-}" ] || grep -q "the body folds" "$3.log" || no_estimate - >> "$ESTIMATE"
    elif [ -n "${ESTIMATE:-}" ] && grep -q quasi-static "$1"; then
        estimate "$1" "$2" >> "$ESTIMATE"
    fi
}

# estimate SCENE TABLE: rows of estimate.tsv, see pipelines/estimate.mk, for runs to two tolerances compared with one to 1e-8, or
# 1e-7 where round-off admits no less. A scene that ends at rest has none: its error is relative to the largest displacement
# on the way.
estimate() {
    local tolerance
    estimate_run "$1" "$2" 1e-8 exact || estimate_run "$1" "$2" 1e-7 exact || { no_estimate 1e-7; return; }
    for tolerance in 1e-3 1e-5; do
        estimate_run "$1" "$2" $tolerance run || { no_estimate $tolerance; continue; }
        paste "$work/estimate.run.u" "$work/estimate.exact.u" | awk -v name="$(basename "$0" .sh)" -v tolerance="$tolerance" '
            NR == FNR { split($0, word, "\t"); told[word[1]] = word[2]; next }
            {
                size = difference = 0
                for (i = 1; i <= NF / 2; i++) { size += $(i + NF / 2) ^ 2; difference += ($i - $(i + NF / 2)) ^ 2 }
                if (size > largest) largest = size
                if (difference > worst) worst = difference
                sizes += size; differences += difference
            }
            END {
                if (largest < 1e-18) exit
                estimated = told["iteration error, m"] / sqrt(largest) # with the remaining penetration of contacts
                true = sqrt(worst / largest)
                if (sqrt(differences / sizes) > true) true = sqrt(differences / sizes)
                printf "%s\t%s\t%.3g\t%.3g\t%.3g\t%d\t%s\n", name, tolerance, estimated, true, true / estimated,
                    told["force evaluations"], (true <= estimated ? "pass" : "FAIL")
            }' "$work/estimate.run" -
    done
}

# estimate_run SCENE TABLE TOLERANCE NAME: estimate.NAME, what mtled -v tells, and estimate.NAME.u, the displacements.
estimate_run() {
    local scene=$work/estimate.scene out=$work/estimate.$4
    grep -v '^tolerance' "$1" > "$scene"
    grep -q '^\[solver\]' "$scene" || printf '\n[solver]\n' >> "$scene"
    sed -i "/^\[solver\]/a tolerance = $3" "$scene"
    mtled -v "$scene" "$2" > "$out.dat" 2> "$out" || return
    mts print u "$out.dat" > "$out.u"
}

# no_estimate TOLERANCE: the row of a run that fails.
no_estimate() {
    printf '%s\t%s\tnone\tnone\t-\t-\tFAIL\n' "$(basename "$0" .sh)" "$1"
}

# place FILE POINT: where the point, in mm, has gone to along z, mm.
place() {
    echo "$2" > "$work/point.tsv"
    interp -p "$work/point.tsv" -u mm "$1" 2> /dev/null | mts print u | awk -v z="${2##* }" '{ print z + 1000 * $3 }' || echo nan
}

# count TABLE: the number of nodes of $work/TABLE.mts.
count() {
    mts print nodes.x "$work/$1.mts" | wc -l
}

# told CASE QUANTITY OUT: the run reports that the body folds.
told() {
    at_least "$1" "$2: told that it folds" "$(grep -c 'the body folds' "$3.log")" told
}

# reported FILE NAME: a number of mtled's report.
reported() {
    awk -F '\t' -v name="$2" '$1 == name { print $2 }' "$1.log"
}

# reaction FILE SECTION COMPONENT: total force of a section of the scene, component 1, 2 or 3; nan where the run failed.
reaction() {
    local rows
    if [ ! -s "$1" ]; then
        echo nan
        return
    fi
    rows=$(mts list "$1" | sed -n 's/^reactions\t.*rows=\([^ \t]*\).*/\1/p')
    mts print reactions "$1" | awk -v rows="$rows" -v section="$2" -v component="$3" '
        BEGIN { split(rows, name, ",") }
        name[NR] == section { print $component }'
}

# stored FILE: the energy of a quasi-static run whose scene asks for it, J (2D: J/m); nan where the run failed.
stored() {
    [ -s "$1" ] || { echo nan; return; }
    mts print energy "$1" | awk '{ printf "%.12g\n", $1 + $2 }'
}

# work FORCE PUSH: that of a force along its path from 0 to PUSH, by Gauss' rule of four points; `FORCE AT` prints the force at
# the push AT.
work() {
    local sum=0 point weight
    for pair in '0.0694318442 0.1739274226' '0.3300094782 0.3260725774' '0.6699905218 0.3260725774' '0.9305681558 0.1739274226'; do
        read -r point weight <<< "$pair"
        sum=$(calc "$sum + $weight * ($2) * ($("$1" "$(calc "$point * ($2)")"))")
    done
    echo "$sum"
}

# order COARSE MIDDLE FINE RATIO: observed order of convergence of three values on meshes refined by RATIO.
order() {
    calc "log(($1 - $2) / ($2 - $3)) / log($4)"
}

# limit COARSE MIDDLE FINE RATIO: the value that they tend to (Richardson, at the observed order).
limit() {
    calc "$3 + ($3 - $2) ^ 2 / (($2 - $1) - ($3 - $2))"
}

# mean_at FILE CONDITION VALUE: mean over the nodes where an awk condition holds of an awk expression, both in $1.. the
# coordinates and, after them, the displacements; nan where the run failed or no node is meant.
mean_at() {
    if [ ! -s "$1" ]; then
        echo nan
        return
    fi
    paste <(mts print nodes.x "$1") <(mts print u "$1") | awk "$2"' { n++; sum += '"$3"' }
        END { if (n > 0) printf "%.12g\n", sum / n; else print "nan" }'
}

# order_of COARSE FINE EXACT RATIO: order of convergence to a known value on two meshes.
order_of() {
    calc "log(sqrt((($1 - ($3)) / ($2 - ($3))) ^ 2)) / log($4)"
}
