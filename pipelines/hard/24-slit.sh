#!/bin/bash
# Row 24: a block with a V slit, .5 mm wide at its mouth; one arm is lifted, the other feels it only around the tip.
#
# References: CalculiX's CPE6, forces (N/m) and motion of the end of the lower arm (mm) on triangles of 2, 1 and .5 mm; then of 1
# and .5 mm, a twentieth and a fiftieth of that at the tip, where the stress is singular:
#   .32145  .31756  .31582  .31564  .31489
#   .4737   .4801   .4830   .48381  .48439
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/slit.geo

dim=2 scene "$work/lift.scene" <<END
[displacement held]
facets = held
components = 0, 0
[displacement lifted]
facets = lifted
components = 0, 3e-3
[output]
reactions = yes
END
for h in 2 1; do
    gmsh -2 -v 0 -setnumber h $h "$geometry" -o "$work/body.msh" > /dev/null
    nodes -u mm "$work/body.msh" | shapefn -o "$work/table.mts" 2> /dev/null
    relax "$work/lift.scene" "$work/table.mts" "$work/a.dat"
    row 24 "slit, $h mm: force on the lifted arm, N/m" "$(reaction "$work/a.dat" lifted 2)" 0.31489 slit
    row 24 "slit, $h mm: motion of the other arm, m" "$(mean_at "$work/a.dat" '$1 > 0.0399 && $2 < 0.00976' '$4')" 0.48439e-3 slit
done

