#!/bin/bash
# Rows of incision.tsv: twenty blades (blade.awk) through four bodies, and pairs of blades that cross, faces pressed apart on springs: how many are
# solved, and the largest numbers of force evaluations and of steps beside those of the body that is whole: blades.sh FOLDER SCRIPTS EXAMPLES. FOLDER gets blades.tsv,
# a row for each cut.
set -euo pipefail
scripts=$(realpath "$2") examples=$(realpath "$3")
cd "$1"
counted() { awk -F '\t' '{ n[$1] = $2 } END { print n["force evaluations"] "\t" n["steps"] }' said; }
blade() { awk -f "$scripts/blade.awk" -v n="$1" -v seed="$2" -v mid="$3" -v size="$4" > "$5"; }
scene() { # BODY: its regions, on springs; a load follows
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n'
    for region in $(mts list "$1" | sed -n 's/^cells.region.*names=//p' | tr , ' '); do
        printf '[material %s]\nregion = %s\nE = 3000\nnu = 0.45\nrho = 1000\n' "$region" "$region"
    done
    printf '[support outer]\nfacets = outer\nnormal = 1e5\ntangential = 1e5\n[pressure load]\n'
}
# A row: body, kind, blade, status of incise or mtled, evaluations, steps, verdict
try() { # BODY KIND N SIZE MIDDLE
    local status=0
    blade "$3" "$3" "$5" "$4" one.tsv
    blade $((($3 + 4) % 20)) $(($3 + 20)) "$5" "$4" two.tsv
    { if [ "$2" = pair ]; then incise -n k -s one.tsv "$1.mts" | incise -l 0.1% -n k -s two.tsv; else incise -l 0.1% -n k -s one.tsv "$1.mts"; fi; } > cut.mts 2> said || status=$?
    [ "$status" -ne 0 ] || { { scene cut.mts; printf 'facets = %s\nvalue = 30\n' "$(mts list cut.mts | sed -n 's/^facets.set.*names=//p' | tr , '\n' | grep '^k|' | paste -sd,)"; } > cut.scene
        mtled -v -o u.dat cut.scene cut.mts 2> said || status=$?; }
    printf '%s\t%s\t%d\t%d\t%s\t%s\n' "$1" "$2" "$3" "$status" "$(counted)" "$(grep -o 'the body .*' said | cut -c1-60 || true)"
}
body() { # BODY SIZE MIDDLE
    { scene "$1.mts"; printf 'facets = outer\nvalue = -30\n'; } > whole.scene
    mtled -v -o u.dat whole.scene "$1.mts" 2> said
    local whole nodes; whole=$(counted) nodes=$(mts list "$1.mts" | awk '$1 == "nodes.x" { print $3 }')
    for kind in one pair; do
        for n in $([ $kind = one ] && seq 1 20 || seq 4 4 20); do try "$1" $kind "$n" "$2" "$3"; done
    done > "$1.cuts"
    awk -F '\t' -v OFS='\t' -v body="$1, cut" -v nodes="$nodes" -v whole="$whole" '
        { solved += $4 == 0; for (i = 5; i < 7; i++) if ($i > most[i]) most[i] = $i }
        END { print body, "-", nodes, "solved", solved, NR, sprintf("%.1e", 1 - solved / NR); split(whole, uncut)
            for (i = 5; i < 7; i++) print body, "-", nodes, (i == 5 ? "evaluations" : "steps") ": most, and uncut", most[i], uncut[i - 4], sprintf("%.2f", most[i] / uncut[i - 4]) }' "$1.cuts"
}
cloud -d 3 -k jittered -n 11,9,8 --box 0,0.1,0,0.06,0,0.05 --jitter 0.15 | tag -r 'lump=box:0.04,0.02,0.02,0.07,0.04,0.05' -f outer=all > block.mts 2> note
printf '%s\n' 'SetFactory("OpenCASCADE"); Sphere(1) = {0, 0, 0, 40}; Physical Volume("body") = {1}; Physical Surface("outer") = {1};' > ball.geo
gmsh -3 -nt 1 -v 1 -clmax 11 -clmin 11 ball.geo -o ball.msh
nodes -u mm ball.msh > ball.mts 2> note
voxels -h 18mm -l "$examples/liver/labels.tsv" "$examples/liver/labels.nii.gz" 2> note | tag -f outer=all > liver.mts 2> note
gzip -dc "$examples/brain3d/brain3d_surfaces.msh.gz" > brain3d_surfaces.msh
cp "$examples/brain3d/brain3d.geo" .
gmsh -3 -nt 1 -v 1 -setnumber lc 16 brain3d.geo -o brain.msh
nodes -u mm brain.msh 2> note | tag -f outer=all > brain.mts 2> note
body block .05 '.05 .03 .0214286'
body ball .08 '0 0 0'
body liver .1 '.04 0 .1'
body brain .1 '0 -.02 .01'
(printf 'body\tkind\tblade\tstatus\tevaluations\tsteps\tverdict\n'; cat {block,ball,liver,brain}.cuts) > blades.tsv
