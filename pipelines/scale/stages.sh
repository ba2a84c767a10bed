#!/bin/bash
# stages.sh N FOLDER: rows of stages.tsv, what each stage of the pipe costs on a cube of N x N x N nodes, each from file to file, one thread;
# mtled's memory by a quasi-static scene that ends after a step, and the time of one evaluation from two dynamic runs, one longer.
set -eu -o pipefail
n=$1 folder=$2
here=$(dirname "$0")
at=$folder/$n
nodes=$((n * n * n))
export OMP_NUM_THREADS=1
mkdir -p "$folder"

# row STAGE STATUS OUTPUT INPUT COMMAND...: what is written is what the stage adds to its input and what it passes on.
row() {
    local stage=$1 wanted=$2 seconds _ peak anonymous bytes status
    shift 2
    IFS=$'\t' read -r seconds _ peak anonymous bytes status < <(python3 "$here/measured.py" "$@")
    [ "$status" -eq "$wanted" ] || { cat "$1.log" >&2; echo "stages.sh: $stage: status $status" >&2; exit 1; }
    awk -v OFS='\t' -v stage="$stage" -v nodes=$nodes -v seconds="$seconds" -v peak="$peak" -v anonymous="$anonymous" -v bytes="$bytes" 'BEGIN {
        printf "%s\t%d\t%.2f\t%.0f\t%.0f\t%.0f\t%.2f\n", stage, nodes, 1e6 * seconds / nodes, bytes / nodes, peak / nodes, anonymous / nodes, \
            anonymous / 1e9 }'
}

scene() { # ANALYSIS, more lines
    printf '[scene]\ndim = 3\nanalysis = %s\n%s[material body]\nregion = body\nE = 3000\nnu = 0.49\nrho = 1000\n' "$1" "$2"
    printf '[displacement bottom]\nfacets = zmin\ncomponents = 0, 0, 0\n'
}

# dynamic STEPS: processor seconds and evaluations of a dynamic run of about so many steps.
dynamic() {
    (scene dynamic $'gravity = 0, 0, -9.81\n'
        awk -v n="$n" -v steps="$1" 'BEGIN { printf "[solver]\nend_time = %.9g\n", steps * 0.1 / n / 15 }') > "$at.dynamic.scene"
    python3 "$here/measured.py" "$at.dynamic.dat" "$at.shapefn.mts" mtled -v "$at.dynamic.scene" | cut -f 1
    awk '/^force evaluations/ { print $3 }' "$at.dynamic.dat.log"
}

row cloud 0 "$at.cloud.mts" - cloud -d 3 -k jittered --jitter 0.15 -n "$n" --box 0,0.1,0,0.1,0,0.1
row ipoints 0 "$at.ipoints.mts" "$at.cloud.mts" ipoints
row support 0 "$at.support.mts" "$at.ipoints.mts" support
row shapefn 0 "$at.shapefn.mts" "$at.support.mts" shapefn
rm "$at.support.mts"
(scene quasi-static ''; printf '[displacement top]\nfacets = zmax\ncomponents = 0, 0, -0.001\n[solver]\nmax_steps = 1\n') > "$at.scene"
row 'mtled, one step' 1 "$at.dat" "$at.shapefn.mts" mtled -q "$at.scene"
mapfile -t short < <(dynamic 5)
mapfile -t long < <(dynamic 40)
awk -v nodes=$nodes -v a="${short[0]}" -v b="${long[0]}" -v c="${short[1]}" -v d="${long[1]}" 'BEGIN {
    if (!(d > c)) { print "stages.sh: no evaluations counted" > "/dev/stderr"; exit 1 }
    printf "mtled, an evaluation\t%d\t%.2f\t-\t-\t-\t-\n", nodes, 1e6 * (b - a) / (d - c) / nodes }'
rm "$at.shapefn.mts" "$at.ipoints.mts"
