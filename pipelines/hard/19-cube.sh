#!/bin/bash
# Rows 18 and 19 in 3D: a cube of .1 m between clamps, compressed to 20, 50 and 70 % and extended by 100 %.
. "$(dirname "$0")/common.sh"

# push NODES OUT DISPLACEMENT: a lattice of NODES^3, clamped at the bottom, the top moved.
push() {
    [ -s "$work/lattice$1.mts" ] ||
        cloud -d 3 -k regular -n "$1" --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/lattice$1.mts" 2> /dev/null
    scene "$work/a.scene" <<END
[displacement bottom]
facets = zmin
components = 0, 0, 0
[displacement top]
facets = zmax
components = 0, 0, $3
[output]
reactions = yes
[solver]
tolerance = 1e-5
END
    relax "$work/a.scene" "$work/lattice$1.mts" "$2"
}

force() {
    calc "sqrt(($(reaction "$1" top 3)) ^ 2)"
}

balance() {
    calc "sqrt(($(reaction "$1" top 3) + ($(reaction "$1" bottom 3))) ^ 2) / $(force "$1")"
}

for n in 5 7 9; do
    push $n "$work/near$n.dat" -0.02
done
row 19 'clamped cube, 20 %, 729 nodes: force, N' "$(force "$work/near9.dat")" 9.39 0.01
row 19 'clamped cube, 20 %, limit of C3D10: force, N' "$(force "$work/near9.dat")" 9.2 0.02
row 19 'clamped cube, 20 %: force, N, 9^3 nodes against 7^3' "$(force "$work/near9.dat")" "$(force "$work/near7.dat")" 0.02

for percent in 50 70; do
    for n in 7 9; do
        push $n "$work/far$n.dat" "$(calc "-$percent / 1000")"
    done
    at_least 18 "cube, $percent %: least J" "$(reported "$work/far9.dat" 'least J')" 0.01
    row 18 "cube, $percent %: balance of the forces" "$(balance "$work/far9.dat")" 0 0.01
    row 18 "cube, $percent %: force, N, 9^3 nodes against 7^3" "$(force "$work/far9.dat")" "$(force "$work/far7.dat")" 0.1
done
for n in 5 7; do
    push $n "$work/long$n.dat" 0.1
done
row 18 'cube, extension 100 %: force, N, 7^3 nodes against 5^3' "$(force "$work/long7.dat")" "$(force "$work/long5.dat")" 0.02
