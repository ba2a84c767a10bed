#!/bin/bash
# identify.sh [-j JOBS] [-u UNIT] [-d DEVIATION] PARAMETERS TEMPLATE STREAM MEASURED FOLDER: parameters of a scene (loads, stiffness) from
# displacements that were measured at points: the most probable parameters, by Gauss and Newton's method (Tarantola 2005, chapter 3).
#
# PARAMETERS: a line "name mean deviation", then a line for each parameter, all separated by tabs: what is known of it beforehand, as a normal
# distribution. TEMPLATE: a scene with @NAME@ where the parameter belongs. What was measured is not prescribed in it. STREAM: what shapefn
# has written. MEASURED: rows x y z ux uy uz deviation (in 2D x y ux uy deviation) in UNIT (m, cm, mm, or metres as a number); without the
# last column each component has the standard deviation DEVIATION.
#
# A round computes the scene, and once more for each parameter with a tenth of its deviation added, JOBS at once, by sweep.sh, in
# FOLDER/round-K. Where the misfit has grown the step is halved. The rounds end where the next step would change the displacements at the
# points by less than a tenth of their deviations.
#
# Prints a line for each round: the misfit at the points (root mean square, in deviations: about 1 where the scene can be right) and the
# parameters. FOLDER then has identified.tsv (name, value, deviation, and mean and deviation beforehand), identified.scene, and
# identified.dat, its result. Status 1: a run failed, or no end within 20 rounds; 2: a file is wrong.
set -eu -o pipefail
scripts=$(dirname "$0")
usage() {
    echo "usage: identify.sh [-j JOBS] [-u UNIT] [-d DEVIATION] PARAMETERS TEMPLATE STREAM MEASURED FOLDER" >&2
    exit 2
}
fail() {
    echo "identify: $2" >&2
    exit "$1"
}

jobs=1 unit=m deviation=
while getopts j:u:d: option; do
    case $option in
    j) jobs=$OPTARG ;;
    u) unit=$OPTARG ;;
    d) deviation=$OPTARG ;;
    *) usage ;;
    esac
done
shift $((OPTIND - 1))
if [ $# -ne 5 ] || [[ ! $jobs =~ ^[1-9][0-9]*$ ]]; then usage; fi
parameters=$1 template=$2 stream=$3 measured=$4 folder=$5
for file in "$parameters" "$template" "$stream" "$measured"; do
    [ -f "$file" ] && [ -r "$file" ] || fail 2 "$file: cannot be read"
done
for program in mts interp mtled; do
    command -v $program > /dev/null || fail 2 "$program is not on PATH"
done
dim=$(mts list "$stream" | awk -F '\t' '$1 == "nodes.x" { print $4 }')
[ -n "$dim" ] || fail 2 "$stream: no coordinates of nodes in it"

mkdir -p "$folder"
rm -rf "$folder"/round-* "$folder"/identified.* "$folder/state.tsv"
awk -f "$scripts/common.awk" -f "$scripts/measured.awk" -v dim="$dim" -v unit="$unit" -v of_all="$deviation" "$measured" > "$folder/measured.tsv"
cut -f "1-$dim" "$folder/measured.tsv" > "$folder/places.tsv"

for round in {1..20}; do
    at=$folder/round-$round
    mkdir "$at"
    awk -f "$scripts/common.awk" -f "$scripts/cases.awk" -v state="$folder/state.tsv" "$parameters" > "$at/cases.tsv"
    bash "$scripts/../sweep/sweep.sh" -j "$jobs" "$at/cases.tsv" "$template" "$stream" "$at" 2> "$at/log" ||
        fail 1 "$(sed -n '/^sweep: .* done, /d; s/^sweep: //p' "$at/log" | head -n 1)"
    for name in $(sed 1d "$at/cases.tsv" | cut -f 1); do
        interp -f u -p "$folder/places.tsv" -u m -o "$at/$name.points" "$at/$name.dat" || fail 2 "$measured: not all of its points are in the body"
        mts print u "$at/$name.points" > "$at/$name.u"
    done
    awk -f "$scripts/common.awk" -f "$scripts/step.awk" -v round="$round" -v at="$at" -v folder="$folder" -v dim="$dim" "$parameters"
    [ ! -f "$folder/identified.tsv" ] || break
done
[ -f "$folder/identified.tsv" ] || fail 1 "no end after $round rounds: the displacements do not determine the parameters, or the scene cannot have them"
sed 1d "$at/trial.scene" > "$folder/identified.scene"
cp "$at/trial.dat" "$folder/identified.dat"
