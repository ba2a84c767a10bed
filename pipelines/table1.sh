#!/bin/bash
# The errors of the founding paper's table 1: table1.sh PAPER_TABLE > table1.tsv
#
# Approximates u = (1 - r^2) exp(-r^2 / 2) on [-4, 4]^2 from its values at 18 x 18 nodes and prints the root mean square
# error over 81 x 81 points, for each row (method, mu, R) of PAPER_TABLE. What the paper leaves open is set as reproduces
# its regular column: nodes and points lie on the boundary too, mu is absolute in these coordinates, and at most the
# 20 nearest nodes enter a support. Its irregular cloud is not given: the mean over jittered clouds stands for it.
set -euo pipefail
shopt -s inherit_errexit
seeds=(1 2 3 4 5 6)
box=-4,4,-4,4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# rmse CLOUD METHOD MU R: the error, or `singular`.
rmse() {
    local cloud=$1 method=$2 mu=$3 radius=$4 basis status=0
    case $method in
    "MLS linear") basis=(-b mls1) ;;
    "MLS quadratic") basis=(-b mls2) ;;
    MMLS) basis=(-b mmls2 --mu "$mu" --mu-unit m) ;;
    esac
    support -R "$radius" -n 20 --no-widen -w quartic "${basis[@]}" "$cloud" > "$work/support.mts"
    shapefn -o "$work/table.mts" "$work/support.mts" 2> "$work/message" || status=$?
    if [ "$status" -eq 1 ]; then
        echo singular
    elif [ "$status" -ne 0 ]; then
        cat "$work/message" >&2
        return "$status"
    else
        interp "$work/table.mts" | fieldcmp - "$work/exact.mts" | awk '$1 == "rmse" { print $2 }'
    fi
}

cloud -d 2 -k regular -n 81,81 --box $box --field paper -o "$work/exact.mts"
cloud -d 2 -k regular -n 18,18 --box $box --field paper | ipoints --lattice 81,81 -o "$work/regular.mts"
for seed in "${seeds[@]}"; do
    cloud -d 2 -k jittered -n 18,18 --box $box --seed "$seed" --field paper |
        ipoints --lattice 81,81 -o "$work/jittered$seed.mts"
done

printf 'method\tmu\tR\trmse_regular\trmse_irregular\n'
tail -n +2 "$1" | while IFS=$'\t' read -r method mu radius _; do
    regular=$(rmse "$work/regular.mts" "$method" "$mu" "$radius")
    irregular=$(for seed in "${seeds[@]}"; do
        rmse "$work/jittered$seed.mts" "$method" "$mu" "$radius"
    done | awk '$1 == "singular" { singular = 1 } { sum += $1 } END { print singular ? "singular" : sum / NR }')
    printf '%s\t%s\t%s\t%s\t%s\n' "$method" "$mu" "$radius" "$regular" "$irregular" |
        awk -F '\t' -v OFS='\t' '{ for (i = 4; i <= 5; i++) if ($i != "singular") $i = sprintf("%.4f", $i); print }'
done
