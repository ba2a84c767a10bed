#!/bin/bash
# A cut that goes on, in five advances of 13 mm: cut.sh FOLDER, at the top of the repository, programs on PATH. FOLDER gets the states
# u0.dat to u5.dat. Each advance is a blade in the plane x = -45 mm of the body as it is deformed then; the equilibrium after it begins
# from the state before.
set -euo pipefail
folder=$1 liver=examples/liver
voxels -h 15mm -l $liver/labels.tsv $liver/labels.nii.gz |
    tag -u mm -d 'liver|outside' -f 'tip=low:x,6%' -f 'held=ball:30,-50,140,60 and normal:0,-1,0,50 without liver|kidney' > "$folder/body.mts"
mtled -q -o "$folder/u0.dat" $liver/cut.scene "$folder/body.mts"
for i in 1 2 3 4 5; do
    z=$((166 - 13 * i))
    printf '%s\n' "-45 -200 $z -45 200 $z -45 200 300" "-45 -200 $z -45 200 300 -45 -200 300" > "$folder/blade.tsv"
    incise -v -s "$folder/blade.tsv" -u mm -n knife -d "$folder/u$((i - 1)).dat" -o "$folder/next.mts" "$folder/body.mts"
    mv "$folder/next.mts" "$folder/body.mts"
    mtled -q -s "$folder/u$((i - 1)).dat" -o "$folder/u$i.dat" $liver/cut.scene "$folder/body.mts"
done
