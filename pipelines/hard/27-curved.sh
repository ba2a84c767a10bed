#!/bin/bash
# Row 27: the eighth of a hollow ball, its inner face widened by a table, beside symmetry planes: the reactions are what the
# derivative of the energy tells. Pressed by p on pi a^2 / 2, it moves by d:
# dU/dd = p pi a^2 / 2, and along each axis a quarter disc bears p pi a^2 / 4.
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/octant.geo

# widened D: relaxed with the inner face moved outward by D, m; rows of the table lie on the true sphere.
widened() {
    awk -v d="$1" 'BEGIN {
        a = 0.05; n = 400; pi = atan2(0, -1)
        for (i = 0; i < n; i++) {
            z = (i + 0.5) / n; x = sqrt(1 - z * z) * cos(i * pi * (3 - sqrt(5))); y = sqrt(1 - z * z) * sin(i * pi * (3 - sqrt(5)))
            if (x > -0.2 && y > -0.2) print a * x, a * y, a * z, d * x, d * y, d * z
        }
    }' > "$work/widened.tsv"
    scene "$work/widened.scene" <<END
[displacement inner]
facets = inner
table = widened.tsv
unit = m
[displacement planes]
facets = planes
normal = 0
[output]
reactions = yes
energy = yes
[solver]
tolerance = 1e-7
END
    relax "$work/widened.scene" "$work/table.mts" "$work/u.dat"
}

energy() { mts print energy "$work/u.dat" | awk '{ print $1 }'; }

for case in '0.025 reaction-coarse' '0.0125 reaction-fine'; do
    read -r h limit <<< "$case"
    gmsh -3 -v 1 -setnumber h "$h" "$geometry" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" 2> /dev/null | shapefn -o "$work/table.mts" 2> /dev/null
    widened 0.00505
    more=$(energy)
    widened 0.00495
    less=$(energy)
    widened 0.005
    for i in 1 2 3; do
        row 27 "hollow ball widened by a table, spacing $h m: force along axis $i, N" \
            "$(mts print reactions "$work/u.dat" | awk -v i=$i 'NR == 1 { print $i }')" \
            "$(calc "($more - $less) / 1e-4 / 2")" "$limit"
    done
done
