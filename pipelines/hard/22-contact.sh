#!/bin/bash
# Rows 22 and 23: a block pressed on a rigid flat and dragged along it; a block pushed into a rigid disc and drawn back.
. "$(dirname "$0")/common.sh"

# ---- 22: in 3D, the top and two sides sliding; the block is dragged by one of these, by three tenths of its size ----
cloud -d 3 -k jittered -n 5 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/cube.mts" 2> /dev/null
echo '-1 -1 0  1 -1 0  1 1 0
-1 -1 0  1 1 0  -1 1 0' > "$work/flat.tsv"
printf '0 0\n0.5 1\n1 1\n' > "$work/press.tsv"
printf '0 0\n0.5 0\n1 1\n' > "$work/drag.tsv"
scene "$work/press.scene" <<END
[displacement top]
facets = zmax
normal = -0.02
curve = press.tsv
[displacement side]
facets = xmin
normal = -0.03
curve = drag.tsv
[displacement plane]
facets = ymin
normal = 0
[contact flat]
facets = zmin
rigid = flat.tsv
unit = m
side = front
[output]
reactions = yes
gaps = yes
[solver]
tolerance = 1e-7
END
relax "$work/press.scene" "$work/cube.mts" "$work/press.dat"
row 22 'pressed on a flat and dragged: P, Pa' "$(calc "$(reaction "$work/press.dat" flat 3) / 0.01")" 763.26922 pressed
row 22 'tangential force of the flat / normal force' \
    "$(calc "$(reaction "$work/press.dat" flat 1) / $(reaction "$work/press.dat" flat 3)")" 0 frictionless
row 22 'force that drags / normal force' \
    "$(calc "$(reaction "$work/press.dat" side 1) / $(reaction "$work/press.dat" flat 3)")" 0 dragged
row 22 'deepest penetration / size' "$([ ! -s "$work/press.dat" ] && echo nan || mts print gaps "$work/press.dat" |
    awk '$4 < -most { most = -$4 } END { print most / 0.1 }')" 0 penetration

# ---- 23: 2D, pushed up by three tenths of its size against a disc of radius .05 ----
cloud -d 2 -k regular -n 21 --box 0,0.1,0,0.1 | shapefn -o "$work/block.mts" 2> /dev/null
awk 'BEGIN { pi = atan2(0, -1); for (i = 0; i <= 96; i++) printf "%.12g %.12g\n", 0.05 + 0.05 * sin(2 * pi * i / 96), 0.15 - 0.05 * cos(2 * pi * i / 96) }' > "$work/disc.tsv"
printf '0 0\n0.4 1\n0.6 1\n1 0\n' > "$work/release.tsv"
for curve in smooth release.tsv; do
    dim=2 scene "$work/disc.scene" <<END
[displacement bottom]
facets = ymin
components = 0, 0.03
curve = $curve
[contact disc]
facets = ymax
rigid = disc.tsv
unit = m
side = right
[output]
reactions = yes
gaps = yes
[solver]
tolerance = 1e-6
max_steps = 60000
END
    relax "$work/disc.scene" "$work/block.mts" "$work/${curve%.tsv}.dat"
done
row 23 'pushed 30 % into a disc: deepest penetration / size' "$([ ! -s "$work/smooth.dat" ] && echo nan ||
    mts print gaps "$work/smooth.dat" | awk '$3 < -most { most = -$3 } END { print most / 0.1 }')" 0 penetration
row 23 'balance of bottom and disc' "$(calc "1 + $(reaction "$work/smooth.dat" bottom 2) / $(reaction "$work/smooth.dat" disc 2)")" 0 balance-contact
row 23 'drawn back: largest displacement / size' "$([ ! -s "$work/release.dat" ] && echo nan ||
    mts print u "$work/release.dat" | awk '{ d = sqrt($1 ^ 2 + $2 ^ 2); if (d > most) most = d } END { print most / 0.1 }')" 0 returned
