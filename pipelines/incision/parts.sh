#!/bin/bash
# Rows of incision.tsv: a block cut through beside its two parts computed alone, and blocks with cuts that contact closes beside whole ones:
# parts.sh FOLDER
set -euo pipefail
cd "$1"
block() { # DIM TOP REGION...
    printf '[scene]\ndim = %s\nanalysis = quasi-static\n' "$1"
    for region in "${@:3}"; do printf '[material %s]\nregion = %s\nE = 3000\nnu = 0.45\nrho = 1000\n' "$region" "$region"; done
    local last=ymin first=ymax zeros='0, 0'
    [ "$1" -eq 2 ] || { last=zmin first=zmax zeros='0, 0, 0'; }
    printf '[displacement bottom]\nfacets = %s\ncomponents = %s\n[displacement top]\nfacets = %s\ncomponents = %s\n[output]\nreactions = yes\n' $last "$zeros" $first "$2"
}
closed() { printf '[contact lips]\nfacets = cut|front\nagainst = cut|back\n'; }
count() { mts list "$1" | awk '$1 == "nodes.x" { print $3 }'; }
row() { # CASE NODES QUANTITY VALUE REFERENCE
    awk -v name="$1" -v nodes="$2" -v what="$3" -v a="$4" -v b="$5" 'BEGIN { printf "%s\t-\t%d\t%s\t%.6g\t%.6g\t%.1e\n", name, nodes, what, a, b, b ? a / b - 1 : a }'
}

# cut through
cloud -d 3 -k jittered -n 15,10,9 --box 0,0.1,0,0.06,0,0.05 --jitter 0.14 > body.mts
printf '%s\n' '.03 -.01 -.01 .05 -.01 .07 .05 .08 .07' '.03 -.01 -.01 .05 .08 .07 .03 .08 -.01' > through.tsv
incise -s through.tsv body.mts | tag -r other=body:2 > cut.mts
block 3 '0.003, 0, 0.004' body other > whole.scene
block 3 '0.003, 0, 0.004' body > body.scene
block 3 '0.003, 0, 0.004' other > other.scene
incise -r other cut.mts > body.part.mts
incise -r body cut.mts > other.part.mts
mtled -q -o whole.dat whole.scene cut.mts 2> note
for part in body other; do
    mtled -q -o $part.dat $part.scene $part.part.mts 2> note
done
paste <(mts print cells.region cut.mts) <(mts print cells cut.mts) | awk '{ for (i = 2; i <= 5; i++) of[$i] = $1 } END { for (n = 0; n in of; n++) print of[n] }' > of
for part in 0:body 1:other; do
    difference=$(paste of <(mts print u whole.dat) | awk -v part="${part%:*}" '$1 == part { print $2, $3, $4 }' | paste - <(mts print u "${part#*:}.dat") |
        awk '{ for (i = 1; i <= 3; i++) { d = $i - $(i + 3); if (d < 0) d = -d; if (d > most) most = d } } END { print most / .005 }')
    row "cut through" "$(count "${part#*:}.part.mts")" "difference from part alone, of 5 mm" "$difference" 0
done

# closed
cloud -d 2 -k jittered -n 31 --jitter .3 --box 0,.1,0,.1 > flat.mts
block 2 '0, -0.005' body > flat.scene
{ cat flat.scene; closed; } > flat.closed.scene
whole=$(mtled -q flat.scene flat.mts 2> note | mts print reactions | awk 'NR == 1 { print $2 }')
for ends in '.02 .0513 .08 .0513' '-.02 .0513 .18 .0513'; do
    xargs -n 2 <<< "$ends" > flat.txt
    incise -s flat.txt flat.mts > flat.cut.mts
    row "closed by contact" "$(count flat.cut.mts)" "force, N/m" "$(mtled -q flat.closed.scene flat.cut.mts 2> note | mts print reactions | awk 'NR == 1 { print $2 }')" "$whole"
done
cloud -d 3 -k jittered -n 8 --jitter .14 --box 0,.1,0,.1,0,.1 > cube.mts
block 3 '0, 0, -0.005' body > cube.scene
{ cat cube.scene; closed; } > cube.closed.scene
printf '%s\n' '.02 .02 .0513 .08 .02 .0513 .08 .08 .0513' '.02 .02 .0513 .08 .08 .0513 .02 .08 .0513' > cube.tsv
incise -s cube.tsv cube.mts > cube.cut.mts
whole=$(mtled -q cube.scene cube.mts 2> note | mts print reactions | awk 'NR == 1 { print $3 }')
row "closed by contact" "$(count cube.cut.mts)" "force, N" "$(mtled -q cube.closed.scene cube.cut.mts 2> note | mts print reactions | awk 'NR == 1 { print $3 }')" "$whole"
