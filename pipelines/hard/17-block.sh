#!/bin/bash
# Rows 17, 18 and 20 in 2D: a block of .1 x .1 m bonded to plates, pressed together and drawn apart.
#
# A quarter of it, finer at the corner of the plate, where the stress is singular. References beside those of the cases are
# limits of mixed elements (quadratic displacement, linear pressure). Their forces (N/m) on even lattices of the quarter
# and, as far as equilibria are found, on meshes graded to the corner:
#   10 %             58.18 on 66 049 nodes; graded 58.157              -> 58.1  +- .05
#   20 %             131.72, 131.14, 130.75                            -> 130.3 +- .5
#   20 %, nu .4999   135.59 on 6 561 nodes, falling to 135.0           -> 135.3 +- .3
#   2 %              graded 10.4370, 10.4354                           -> 10.435
#   2 %, nu .499     graded 10.7744, 10.7725                           -> 10.772
# The forces here at nu .4999 do not fall toward that: 136.38, 136.41, 136.42 N/m on graded meshes of 135, 461, 1 076 nodes.
# Displacement elements lock: CalculiX's CPE6 has 136.23, 134.21, 133.18 N/m at 20 % on triangles of 10, 5 and 2.5 mm.
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/block.geo

# mesh NAME H RIM
mesh() {
    gmsh -2 -v 1 -setnumber h "$2" -setnumber rim "$3" "$geometry" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" | shapefn -o "$work/$1.mts" 2> /dev/null
}

# press TABLE OUT NU PUSH: the plate held and the middle pushed toward it by PUSH (m; half of the whole).
press() {
    dim=2 nu=$3 scene "$work/a.scene" <<END
[displacement symmetry]
facets = xmin
normal = 0
[displacement middle]
facets = middle
normal = $(calc "-($4)")
[displacement plate]
facets = plate
components = 0, 0
${contact:-}
[output]
reactions = yes
energy = yes
folds = allowed
[solver]
tolerance = 1e-6
END
    relax "$work/a.scene" "$work/$1.mts" "$work/$2.dat"
}

# force OUT: of the whole block, N/m.
force() {
    calc "2 * sqrt(($(reaction "$work/$1.dat" middle 2)) ^ 2)"
}

# pushing PUSH: the force on the middle of the coarse quarter, along the push.
pushing() {
    press coarse push 0.49 "$1"
    reaction "$work/push.dat" middle 2
}

# balance OUT: the sum of all forces along the push, relative to that of the middle.
balance() {
    calc "($(reaction "$work/$1.dat" plate 2) + $(reaction "$work/$1.dat" middle 2) + ${2:-0}) / $(reaction "$work/$1.dat" middle 2)"
}

mesh coarse 0.008 0.2
mesh fine 0.004 0.2
mesh even 0.004 1
mesh half 0.002 1

# ---- 17: 20 % and 10 %, and 20 % nearly incompressible ----
press fine a 0.49 0.01
row 17 "clamped block, 20 %: force, N/m ($(count fine) nodes)" "$(force a)" 130.3 block-20
press fine a 0.49 0.005
row 17 'clamped block, 10 %: force, N/m' "$(force a)" 58.1 block-10
press fine a 0.4999 0.01
row 17 'clamped block, 20 %, nu 0.4999: force, N/m' "$(force a)" 135.3 block-20-4999

# ---- 20: the error does not grow toward incompressibility, by force and by field ----
for ratio in 0.49 0.499; do
    press even even$ratio $ratio 0.001
    press half half$ratio $ratio 0.001
done
row 20 "clamped block, 2 %, nu 0.49: force, N/m ($(count even) even nodes)" "$(force even0.49)" 10.435 block-2
row 20 "clamped block, 2 %, nu 0.499: force, N/m ($(count even) even nodes)" "$(force even0.499)" 10.772 block-2
average() {
    fieldcmp "$work/even$1.dat" "$work/half$1.dat" | awk '$1 == "avg" { print $2 }'
}
at_most 20 'clamped block: error of the field, nu 0.499 / nu 0.49' "$(calc "$(average 0.499) / $(average 0.49)")" locking

# ---- 18: far compression and extension ----
press coarse a 0.49 0.025
press fine b 0.49 0.025
at_least 18 'block, 50 %: least J' "$(reported "$work/b.dat" 'least J')" least-J
row 18 'block, 50 %: balance of the forces' "$(balance b)" 0 balance
row 18 'block, 50 %: work of the force / stored energy' "$(calc "($(work pushing 0.025)) / ($(stored "$work/a.dat"))")" 1 work
row 18 "block, 50 %: force, N/m, $(count fine) nodes against $(count coarse)" "$(force b)" "$(force a)" block-50

# The bulge would soon go through the plane of the plate. With a rigid flat there it lies against it. Beside the rim the side is
# compressed along itself beyond what a free surface bears; pressed on by multipliers alone it creases.
printf -- '-1 0.05\n1 0.05\n' > "$work/plate.tsv"
contact='[contact side]
facets = xmax
rigid = plate.tsv
unit = m
side = right'
press coarse a 0.49 0.025
press fine b 0.49 0.025
contact=
at_least 18 'block, 50 %, with contact: least J' "$(reported "$work/b.dat" 'least J')" least-J
row 18 'block, 50 %, with contact: balance of the forces' "$(balance b "$(reaction "$work/b.dat" side 2)")" 0 balance
row 18 "block, 50 %, with contact: force, N/m, $(count fine) nodes against $(count coarse)" "$(force b)" "$(force a)" block-50-contact

# Without plates as wide as the bulge, sides fold over the plates' edges, as nothing in the scene forbids it: that is reported. With
# plates: 26-plates.sh.
press fine b 0.49 0.035
told 18 'block, 70 %' "$work/b.dat"

press coarse a 0.49 -0.05
press fine b 0.49 -0.05
row 18 'block, extension 100 %: work of the force / stored energy' "$(calc "($(work pushing -0.05)) / ($(stored "$work/a.dat"))")" 1 work
row 18 "block, extension 100 %: force, N/m ($(count fine) nodes)" "$(force b)" 215.04 extension
at_most 18 "block, extension 100 %: error, $(count fine) nodes / $(count coarse)" \
    "$(calc "($(force b) - 215.04) / ($(force a) - 215.04)")" refined
