#!/bin/bash
# Rows 17, 18 and 20 in 2D: a block of .1 x .1 m between clamps, compressed and extended.
#
# References beside those of the cases: the limits of CalculiX's CPE6 (pipelines/hard/references.tsv).
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/block.geo

# push TABLE OUT NU DISPLACEMENT: clamped at the bottom, the top moved.
push() {
    dim=2 nu=$3 scene "$work/a.scene" <<END
[displacement bottom]
facets = ymin
components = 0, 0
[displacement top]
facets = ymax
components = 0, $4
[output]
reactions = yes
[solver]
tolerance = 1e-6
END
    relax "$work/a.scene" "$1" "$2"
}

force() {
    calc "sqrt(($(reaction "$1" top 2)) ^ 2)"
}

# How far the forces on top and bottom are from balance, relative.
balance() {
    calc "sqrt(($(reaction "$1" top 2) + ($(reaction "$1" bottom 2))) ^ 2) / $(force "$1")"
}

gmsh -2 -v 1 -setnumber h 0.0032 "$geometry" -o "$work/body.msh" > /dev/null
nodes -u m "$work/body.msh" | shapefn -o "$work/mesh.mts" 2> /dev/null
for n in 9 13 17 25 33 49; do
    cloud -d 2 -k regular -n $n --box 0,0.1,0,0.1 | shapefn -o "$work/lattice$n.mts" 2> /dev/null
done

# ---- 17: 20 %, and 10 % ----
push "$work/mesh.mts" "$work/a.dat" 0.49 -0.02
row 17 "clamped block, 20 %, $(mts print nodes.x "$work/mesh.mts" | wc -l) nodes of a mesh: force, N/m" "$(force "$work/a.dat")" 133 0.0075
push "$work/lattice33.mts" "$work/a.dat" 0.49 -0.02
row 17 'clamped block, 20 %, 33 x 33 nodes: force, N/m' "$(force "$work/a.dat")" 133 0.0075
row 17 'clamped block, 20 %, limit of CPE6: force, N/m' "$(force "$work/a.dat")" 132.15 0.01
push "$work/lattice33.mts" "$work/a.dat" 0.49 -0.01
row 17 'clamped block, 10 %, limit of CPE6: force, N/m' "$(force "$work/a.dat")" 58.26 0.01

# ---- 20: the error does not grow toward incompressibility, by force and by field ----
for nu in 0.49 0.499; do
    push "$work/lattice13.mts" "$work/coarse$nu.dat" $nu -0.002
    push "$work/lattice49.mts" "$work/fine$nu.dat" $nu -0.002
done
row 20 'clamped block, 2 %, nu 0.49, 13 x 13 nodes: force, N/m' "$(force "$work/coarse0.49.dat")" 10.435 0.01
row 20 'clamped block, 2 %, nu 0.499, 13 x 13 nodes: force, N/m' "$(force "$work/coarse0.499.dat")" 10.775 0.02
average() {
    fieldcmp "$1" "$2" | awk '$1 == "avg" { print $2 }'
}
at_most 20 'error of the field at nu 0.499 / at 0.49 (49 x 49 nodes the truth)' \
    "$(calc "$(average "$work/coarse0.499.dat" "$work/fine0.499.dat") / $(average "$work/coarse0.49.dat" "$work/fine0.49.dat")")" 2

# ---- 18: far compression and extension ----
for percent in 50 70; do
    for n in 9 13 17 25; do
        push "$work/lattice$n.mts" "$work/far$n.dat" 0.49 "$(calc "-$percent / 1000")"
    done
    at_least 18 "block, $percent %: least J" "$(reported "$work/far25.dat" 'least J')" 0.01
    row 18 "block, $percent %: balance of the forces" "$(balance "$work/far25.dat")" 0 0.01
    row 18 "block, $percent %: force, N/m, 25 x 25 nodes against 17 x 17" "$(force "$work/far25.dat")" "$(force "$work/far17.dat")" 0.05
done
push "$work/lattice25.mts" "$work/a.dat" 0.49 0.1
row 18 'block, extension 100 %: force, N/m' "$(force "$work/a.dat")" 215.04 0.005
