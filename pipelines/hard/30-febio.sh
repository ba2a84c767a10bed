#!/bin/bash
# Row 30: two cases of FEBio's verification suite, a block of 8 x 4 x 4 bricks that is bonded at both ends and drawn to 1.5 times its
# length: mi09 (neo-Hookean, C1 = 1) and ma01 (Ogden, c = .658, m = 6.83), bulk modulus 1000. The figure is the norm of all
# free components of displacement at its 225 nodes.
#
# FEBio's own figures, 7.7590 and 7.7315, are those of its bricks: CalculiX's C3D8I has 7.7560 and 7.7355 on the same. They are no
# reference for a converged solution, which is 7.657 and 7.602: CalculiX's quadratic bricks (C3D20R) have 7.6724, 7.6564, 7.6574 and
# 7.6260, 7.6026, 7.6023 on as many, on twice and three times as many along each side; for mi09 mixed elements (FreeFEM, as in
# pipelines/mixed) have 7.6800 and 7.6597. So FEBio's are 1.3 and 1.7 % off. Ours are set beside both: on its nodes, and, beside the
# converged ones, on three times as many along each side.
. "$(dirname "$0")/common.sh"
examples=$(dirname "$0")/../../examples/hard

# draw NAME LINES SHEAR: run it; LINES of the material, its shear modulus.
draw() {
    youngs=$(calc "9000 * $3 / (3000 + $3)") nu=$(calc "(3000 - 2 * $3) / (2 * (3000 + $3))") scene "$work/a.scene" <<END
[displacement left]
facets = left
components = 0, 0, 0
[displacement right]
facets = right
components = 1, 0, 0
END
    sed -i "s/^region = body/&\n$2/" "$work/a.scene"
    relax "$work/a.scene" "$work/bricks.mts" "$work/$1.dat"
}

# norm NAME: of the free components at FEBio's nodes, a quarter apart; those of both ends are prescribed.
norm() {
    [ -s "$work/$1.dat" ] || { echo nan; return; }
    paste <(mts print nodes.x "$work/$1.dat") <(mts print u "$work/$1.dat") |
        awk 'function known(x) { x *= 4; return (x - int(x + 100.5) + 100)^2 < 1e-12 }
            known($1) && known($2) && known($3) && $1 > -0.999 && $1 < 0.999 { sum += $4^2 + $5^2 + $6^2 } END { printf "%.12g\n", sqrt(sum) }'
}

# bricks N: as many times as FEBio's along each side.
bricks() {
    gmsh -3 -v 1 "$examples/bricks.geo" -setnumber n "$1" -o "$work/bricks.msh" > /dev/null
    nodes -u m "$work/bricks.msh" | shapefn -o "$work/bricks.mts" 2> /dev/null
}

# judge NAME FIGURE: FEBio's.
judge() { row 30 "FEBio $1: norm of the displacement ($(count bricks) nodes), against FEBio" "$(norm "$1")" "$2" febio; }

# converged NAME NORM LIMIT
converged() { row 30 "FEBio $1: the same ($(count bricks) nodes), against quadratic bricks, converged" "$(norm "$1")" "$2" "$3"; }

mi09=('model = neo-hookean' 2) ma01=('model = ogden\nalpha = 6.83' 0.329)
bricks 1
draw mi09 "${mi09[@]}"
judge mi09 7.75904447437
converged mi09 7.657 febio-limit
draw ma01 "${ma01[@]}"
judge ma01 7.73149507271
converged ma01 7.602 febio-limit
bricks 3
draw mi09 "${mi09[@]}"
converged mi09 7.657 febio-fine
draw ma01 "${ma01[@]}"
converged ma01 7.602 febio-fine
