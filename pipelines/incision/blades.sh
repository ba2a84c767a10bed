#!/bin/bash
# Rows of incision.tsv: twenty blades (blade.awk) through three bodies, and pairs of blades that cross, faces pressed apart on springs: how many are
# solved, and the largest number of force evaluations beside that of the body that is whole: blades.sh FOLDER SCRIPTS LIVER. FOLDER gets blades.tsv,
# a row for each cut.
set -euo pipefail
scripts=$(realpath "$2") liver=$(realpath "$3")
cd "$1"
evaluations() { awk -F '\t' '$1 == "force evaluations" { print $2 }' "$1"; }
blade() { awk -f "$scripts/blade.awk" -v n="$1" -v seed="$2" -v mid="$3" -v size="$4" > "$5"; }
scene() { # BODY: its regions, on springs; a load follows
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n'
    for region in $(mts list "$1" | sed -n 's/^cells.region.*names=//p' | tr , ' '); do
        printf '[material %s]\nregion = %s\nE = 3000\nnu = 0.45\nrho = 1000\n' "$region" "$region"
    done
    printf '[support outer]\nfacets = outer\nnormal = 1e5\ntangential = 1e5\n[pressure load]\n'
}
# A row: body, kind, blade, status of incise or mtled, evaluations, verdict
try() { # BODY KIND N SIZE MIDDLE
    local status=0
    blade "$3" "$3" "$5" "$4" one.tsv
    blade $((($3 + 4) % 20)) $(($3 + 20)) "$5" "$4" two.tsv
    { if [ "$2" = pair ]; then incise -n k -s one.tsv "$1.mts" | incise -l 0.1% -n k -s two.tsv; else incise -l 0.1% -n k -s one.tsv "$1.mts"; fi; } > cut.mts 2> said || status=$?
    [ "$status" -ne 0 ] || { { scene cut.mts; printf 'facets = %s\nvalue = 30\n' "$(mts list cut.mts | sed -n 's/^facets.set.*names=//p' | tr , '\n' | grep '^k|' | paste -sd,)"; } > cut.scene
        mtled -v -o u.dat cut.scene cut.mts 2> said || status=$?; }
    printf '%s\t%s\t%d\t%d\t%s\t%s\n' "$1" "$2" "$3" "$status" "$(evaluations said)" "$(grep -o 'the body .*' said | cut -c1-60 || true)"
}
body() { # BODY SIZE MIDDLE
    { scene "$1.mts"; printf 'facets = outer\nvalue = -30\n'; } > whole.scene
    mtled -v -o u.dat whole.scene "$1.mts" 2> said
    local whole nodes; whole=$(evaluations said) nodes=$(mts list "$1.mts" | awk '$1 == "nodes.x" { print $3 }')
    for kind in one pair; do
        for n in $([ $kind = one ] && seq 1 20 || seq 4 4 20); do try "$1" $kind "$n" "$2" "$3"; done > "$1.$kind"
        awk -F '\t' -v OFS='\t' -v body="$1 cut by $([ $kind = one ] && echo one blade || echo two)" -v nodes="$nodes" -v whole="$whole" '
            { solved += $4 == 0; if ($5 > most) most = $5 } END { print body, "-", nodes, "solved", solved, NR, sprintf("%.1e", 1 - solved / NR)
            print body, "-", nodes, "evaluations: most, and uncut", most, whole, sprintf("%.2f", most / whole) }' "$1.$kind"
    done
}
cloud -d 3 -k jittered -n 11,9,8 --box 0,0.1,0,0.06,0,0.05 --jitter 0.15 | tag -r 'lump=box:0.04,0.02,0.02,0.07,0.04,0.05' -f outer=all > block.mts 2> note
cloud -d 3 -k jittered -n 7 --jitter .15 --box -.04,.04,-.04,.04,-.04,.04 | tag -f outer=all > cube.mts 2> note
voxels -h 18mm -l "$liver/labels.tsv" "$liver/labels.nii.gz" 2> note | tag -f outer=all > liver.mts 2> note
body block .05 '.05 .03 .0214286'
body cube .08 '0 0 0'
body liver .1 '.04 0 .1'
(printf 'body\tkind\tblade\tstatus\tevaluations\tverdict\n'; cat block.one block.pair cube.one cube.pair liver.one liver.pair) > blades.tsv
