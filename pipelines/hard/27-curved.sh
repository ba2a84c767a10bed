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

# The same ball pressed from within, nearly incompressible: no worse than twice the error at .49 (Lame's solution).
for h in 0.025 0.0125; do
    gmsh -3 -v 1 -setnumber h $h "$geometry" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" 2> /dev/null | shapefn -o "$work/table.mts" 2> /dev/null
    errors=()
    for nu in 0.49 0.4999; do
        nu=$nu scene "$work/pressed.scene" <<END
[pressure inside]
facets = inner
value = 1
[displacement planes]
facets = planes
normal = 0
[solver]
tolerance = 1e-7
END
        relax "$work/pressed.scene" "$work/table.mts" "$work/u.dat"
        mean=$(mean_at "$work/u.dat" 'sqrt($1 ^ 2 + $2 ^ 2 + $3 ^ 2) < 0.05 * (1 + 1e-5)' '($4 * $1 + $5 * $2 + $6 * $3) / sqrt($1 ^ 2 + $2 ^ 2 + $3 ^ 2)')
        errors+=("$(calc "$mean / ((0.05 * (1 - 2 * $nu) + 0.1 ^ 3 * (1 + $nu) / 2 / 0.05 ^ 2) * 0.05 ^ 3 / 3000 / (0.1 ^ 3 - 0.05 ^ 3)) - 1")")
    done
    at_most 27 "hollow ball, spacing $h m, pressed from within: error of u(a), nu 0.4999 / nu 0.49" \
        "$(calc "sqrt((${errors[1]} / ${errors[0]}) ^ 2)")" locking
done
