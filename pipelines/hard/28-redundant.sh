#!/bin/bash
# Row 28: all sides of a regular cube prescribed to a simple shear, side by side: many more conditions than the nodes need. The
# forces are those of P = mu (F - I1 / 3 F^-T) on each side, J = 1.
. "$(dirname "$0")/common.sh"

cloud -d 3 -k regular -n 5 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
awk 'BEGIN { for (x = 0; x < 2; x++) for (y = 0; y < 2; y++) for (z = 0; z < 2; z++) print x, y, z, 0.05 * y, 0, 0 }' > "$work/shear.tsv"
{
    for side in xmin xmax ymin ymax zmin zmax; do
        printf '[displacement %s]\nfacets = %s\ntable = shear.tsv\nunit = m\n' $side $side
    done
    printf '[output]\nreactions = yes\n[solver]\ntolerance = 1e-9\n'
} | scene "$work/shear.scene"
relax "$work/shear.scene" "$work/table.mts" "$work/u.dat"
force() { mts print reactions "$work/u.dat" | awk -v row="$1" -v col="$2" 'NR == row { print $col }'; }
mu='3000 / 2 / 1.49'
for side in 1 2; do
    sign=$((2 * side - 3))
    row 28 "cube sheared by all sides: force on x side $side along y, N" "$(force $side 2)" "$(calc "$sign * $mu * 0.05 * (1 + 0.05 ^ 2 / 3) * 0.01")" redundant
    row 28 "cube sheared by all sides: force on y side $side along x, N" "$(force $((side + 2)) 1)" "$(calc "$sign * $mu * 0.05 * 0.01")" redundant
    row 28 "cube sheared by all sides: force on z side $side along z, N" "$(force $((side + 4)) 3)" "$(calc "$sign * $mu * -0.05 ^ 2 / 3 * 0.01")" redundant-small
done
