#!/bin/bash
# Row 11: Cook's membrane. Its plane stress, E = 1, nu = 1/3, is the plane strain of E = .9375, nu = .25; the load of 1 N/m is
# scaled to a ten-thousandth, the linear limit.
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/cook.geo

for h in 4 2; do
    gmsh -2 -v 1 -setnumber h $h "$geometry" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" | shapefn -o "$work/table.mts" 2> /dev/null
    dim=2 youngs=0.9375 nu=0.25 scene "$work/a.scene" <<END
[displacement clamped]
facets = clamped
components = 0, 0
[traction loaded]
facets = loaded
components = 0, $(calc '1e-4 / 16')
END
    relax "$work/a.scene" "$work/table.mts" "$work/$h.dat"
done
middle() {
    calc "1e4 * ($(mean_at "$1" '$1 > 48 - 1e-6 && ($2 - 52) ^ 2 < 1e-6' '$4'))"
}
for h in 4 2; do
    row 11 "Cook's membrane, $(mts print nodes.x "$work/$h.dat" | wc -l) nodes: u_y at (48, 52), m" "$(middle "$work/$h.dat")" 23.968 cook
done
