# The study of a craniotomy, coarsely: from a label image to the shift of landmarks.

load common.bash

setup() {
    enter
    scripts=$top/pipelines/neurosurgery
}

# bats test_tags=thorough
@test "from a label image: the exposed cortex predicts half of the shift of landmarks, with the weight found from it, or with given gravity, four fifths" {
    at=$PWD/out/neurosurgery
    make -C "$top" BUILD="$(realpath --relative-to "$top" "$BUILD")" OUT="$PWD/out" NEURO_SPACING=12mm NEURO_TRUE_SPACING=11mm \
        "$at"/{true,craniotomy,load,position}.landmarks "$at"/craniotomy.scan.nii.gz "$at"/{before,craniotomy}.volumes > log 2>&1 || { cat log; false; }
    awk -f "$scripts/target.awk" "$at"/{true,craniotomy,load,position}.landmarks | tee rows
    awk -F '\t' '{ n++; if (!($2 > 4 && $2 < 10 && $3 < 0.6 * $2 && $4 < 0.2 * $2 && $5 < 0.2 * $2)) bad = 1 }
        NR == 1 && !($3 < 0.5 * $2) { bad = 1 }
        END { exit bad || n != 2 }' rows
    # The noise of what is measured is as asked for, and smoothing takes most of it away.
    awk -f "$scripts/random.awk" -f "$top/pipelines/stream.awk" -f "$scripts/measured.awk" -v field="$at/true.u.dat" -v points=200 \
        -v noise=0 > quiet
    paste <(grep -v '^#' quiet) <(grep -v '^#' "$at/measured.tsv") "$at/exposed.tsv" | tee all | awk '
        { for (i = 4; i <= 6; i++) { noise += ($(i + 6) - $i)^2; left += ($(i + 12) - $i)^2; n++ } }
        END { print n, sqrt(noise / n), sqrt(left / n); exit !(n > 150 && noise / n > 0.45^2 && noise / n < 0.55^2 && left / n < 0.3^2) }'
    # The labels go where the body goes: the tumour keeps its volume, the ventricles are pressed.
    awk 'NR == FNR { was[$1] = $2; next } { share[$1] = $2 / was[$1] }
        END { exit !(share[3] > 0.9 && share[3] < 1.1 && share[2] > 0.5 && share[2] < 1.02 && share[1] > 0.97 && share[1] < 1.01) }' \
        "$at"/{before,craniotomy}.volumes
    sample -p "$at/landmarks.tsv" -u mm "$at/craniotomy.scan.nii.gz" > values
    # What warp says is what the text of the example shows, but for the numbers, which are those of a finer lattice, where no cell is inverted.
    warp -v --field "$top/examples/neurosurgery/colin27_labels.nii.gz" "$at/craniotomy.u.dat" 2> said > field.nii.gz
    awk '/cells are folded/ { n = $2 } END { exit n > 2 }' said
    words() { sed -E '/^warp: /!d; /folded|two parts/d; s/[0-9][0-9.e+-]*/#/g' "$1"; }
    [ "$(words said | wc -l)" -eq 3 ]
    diff <(words "$top/examples/neurosurgery/README.md") <(words said)
}

# scenario NAME SPACING TRUE_SPACING: landmarks of the true state and of two predictions, as rows
scenario() {
    local at=$PWD/out/neurosurgery/$1
    make -C "$top" BUILD="$(realpath --relative-to "$top" "$BUILD")" OUT="$PWD/out" NEURO_SCENARIO="$1" NEURO_SPACING="$2" NEURO_TRUE_SPACING="$3" \
        "$at"/{true,"$1","$1"_position}.landmarks > log 2>&1 || { cat log; false; }
    awk -f "$scripts/target.awk" "$at"/{true,"$1","$1"_position}.landmarks | tee rows
}

# bats test_tags=thorough
@test "a resection: the cavity has a wall, fluid stands below a level; points of cortex and cavity predict most of the shift" {
    scenario resection 14mm 13mm
    awk -F '\t' 'NR == 1 { exit !($2 > 3 && $3 < 0.6 * $2 && $4 < 0.35 * $2) }' rows
    mts list out/neurosurgery/resection/predicted.body.mts | has '^facets.set.*names=.*parenchyma|tumour'
    awk 'NF != 7 || $7 != 0.5 { bad = !/^#/ } END { exit bad }' out/neurosurgery/resection/measured.tsv
}

# bats test_tags=thorough
@test "electrodes: points inside predict most of the shift, without a load" {
    scenario electrodes 14mm 13mm
    awk -F '\t' 'NR == 1 { exit !($2 > 3 && $3 < 0.35 * $2 && $4 < 0.25 * $2) }' rows
    [ "$(wc -l < out/neurosurgery/electrodes/measured.tsv)" -eq 200 ]
    run -2 make -C "$top" NEURO_SCENARIO=nose neurosurgery
    [[ "$output" == *"NEURO_SCENARIO: nose is none of craniotomy, resection, electrodes"* ]]
}

@test "distance of a surface: a square moved along its normal, and one that grows" {
    printf '0 0 0 .01 0 0 .01 .01 0\n0 0 0 .01 .01 0 0 .01 0\n' > triangles
    u() { for _ in 1 2 3 4 5 6; do echo "$1"; done; }
    u "0 0 .003" > true
    u "0 0 .0025" > near
    u "0 .004 .003" > aside # beside it, in its plane: two corners are on it, two beyond, by 4 mm
    awk -f "$scripts/surface.awk" -v triangles=triangles true near aside | tee rows
    awk -F '\t' 'NR == 1 { ok = $2 == "3.00" && $3 == "0.50" && $4 == "4.00" } NR == 2 { exit !(ok && $2 == "0.0" && $3 == "100.0" && $4 == "50.0") }' rows
    run -1 --separate-stderr awk -f "$scripts/surface.awk" -v triangles=triangles true <(head -n 5 near)
    [ "$stderr" = "surface.awk: files are missing, or not of 6 corners" ]
}

@test "errors of landmarks: mean and percentile, and rows that are missing" {
    for i in $(seq 1 20); do echo "$i 0 0"; done | awk '{ print $1 / 1e3, 0, 0 }' > true
    awk '{ print $1, .002, 0 }' true > off
    awk -f "$scripts/target.awk" true off | tee rows
    [ "$(cut -f 2- rows | tr '\t\n' '  ')" = "10.50 2.00 19.00 2.00 " ]
    run -1 awk -f "$scripts/target.awk" true <(head -n 3 off)
}
