#!/bin/bash
# Row 12: a cylinder of radius .05 m and height .1 m between bonded plates, pressed by 1 % and 10 %; an eighth of it, finer at
# the rim of the plate, where the stress is singular. References: mixed elements, .2821 and 3.0936 +- .002 N; CalculiX's
# axisymmetric CAX6 tends to .2820 and 3.092 N. The rim decides: at 10 %, with a spacing there of a fifth of h, the forces are
# 3.1020, 3.1011 N for h = 9, 6.5 mm (1 199, 2 474 nodes); a tenth: 3.0963, 3.0962 N for 11, 9 mm (1 491, 2 387 nodes); a
# twentieth: 3.0917, 3.0921 N for 15, 12.5 mm (1 662, 2 287 nodes).
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/bonded.geo

gmsh -3 -v 1 -setnumber h 0.011 -setnumber rim 0.1 -setnumber Mesh.RandomSeed 1 "$geometry" -o "$work/body.msh" > /dev/null
nodes -u m "$work/body.msh" | shapefn -o "$work/table.mts" 2> /dev/null
for case in '0.001 0.2821 bonded-1' '0.01 3.0936 bonded-10'; do
    read -r push reference limit <<< "$case"
    scene "$work/a.scene" <<END
[displacement symmetry]
facets = xmin, ymin, middle
normal = 0
[displacement plate]
facets = plate
components = 0, 0, $(calc "-$push / 2")
[output]
reactions = yes
[solver]
tolerance = 1e-5
END
    relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
    row 12 "bonded cylinder, $(calc "$push * 1000") %: force, N ($(mts print nodes.x "$work/table.mts" | wc -l) nodes)" \
        "$(calc "-4 * $(reaction "$work/a.dat" plate 3)")" "$reference" "$limit"
done
