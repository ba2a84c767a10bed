#!/bin/bash
# Rounds of pipelines/refine beside a reference: rounds.sh CASE KIND SCENE GEO TOL REFERENCE AT FOLDER, with what refine.sh takes from the
# environment. Prints a row for each round: case, kind, nodes, processor seconds of the round's finer solution and of all rounds so far,
# the estimated mean error, the true one by REFERENCE at its places and, where AT is nodes, both at the nodes instead (mm), effectivity.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
name=$1 kind=$2 reference=$6 at=$7 folder=$8
rm -rf "$folder"
# The budget of nodes or of rounds ends these runs, or a body that folds where cells become small. Solutions begin without load, as those of
# mixed elements do: their times are comparable.
KEEP_ROUNDS=1 AFRESH=yes bash "$here/../refine/refine.sh" "$3" "$4" "$5" "$folder" > "$folder.log" 2>&1 || [ $? -eq 1 ]
cat "$folder.log" >&2
[ "$(wc -l < "$folder/rounds.tsv")" -gt 1 ] # one round at least
tail -n +2 "$folder/rounds.tsv" | while IFS=$'\t' read -r round nodes mean _ seconds all; do
    u=$folder/u-$round.dat
    total=$(awk "BEGIN { print ${total:-0} + $all }")
    if [ "$at" = nodes ]; then
        mean=$(awk -F '\t' '$1 == "avg" { print 1e3 * $2 }' "$folder/errors.tsv")
        fieldcmp --skip-outside "$u" "$reference"
    else
        fieldcmp --skip-outside "$reference" "$u"
    fi > "$folder/compared.tsv"
    awk -F '\t' -v OFS='\t' -v head="$name	$kind	$nodes	$seconds	$total	$mean" -v mean="$mean" '
        $1 == "avg" { error = 1e3 * $2 }
        END { if (!(error > 0)) exit 1; printf "%s\t%.5g\t%.2f\n", head, error, mean / error }' "$folder/compared.tsv"
done
