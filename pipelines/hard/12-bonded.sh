#!/bin/bash
# Row 12: a cylinder of radius .05 m and height .1 m between bonded plates, pressed by 1 % and 10 %; a quarter of it.
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/bonded.geo

gmsh -3 -v 1 -setnumber h 0.009 -setnumber Mesh.RandomSeed 1 "$geometry" -o "$work/body.msh" > /dev/null
nodes -u m "$work/body.msh" | shapefn -o "$work/table.mts" 2> /dev/null
for case in '0.001 0.2821' '0.01 3.094'; do
    read -r push reference <<< "$case"
    scene "$work/a.scene" <<END
[displacement symmetry]
facets = xmin, ymin
normal = 0
[displacement bottom]
facets = zmin
components = 0, 0, 0
[displacement top]
facets = zmax
components = 0, 0, -$push
[output]
reactions = yes
[solver]
tolerance = 1e-5
END
    relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
    row 12 "bonded cylinder, $(calc "$push * 1000") %: force, N ($(mts print nodes.x "$work/table.mts" | wc -l) nodes)" \
        "$(calc "-4 * $(reaction "$work/a.dat" top 3)")" "$reference" "$(calc "0.005 / $reference")"
done
