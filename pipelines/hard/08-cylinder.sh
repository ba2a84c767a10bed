#!/bin/bash
# Rows 8 and 9: thick cylinders in plane strain, a quarter of the section.
. "$(dirname "$0")/common.sh"
geometry=$(dirname "$0")/../../examples/hard/cylinder.geo

# The tables of two meshes; the finer one's nodes are half as far apart.
for n in 8 16; do
    gmsh -2 -v 1 -setnumber n $n "$geometry" -o "$work/body$n.msh" > /dev/null
    nodes -u m "$work/body$n.msh" | shapefn -o "$work/table$n.mts" 2> /dev/null
done
symmetry='
[displacement symmetry]
facets = xmin, ymin
normal = 0
[solver]
tolerance = 1e-7'

# Mean radial displacement of the inner surface: lies on a chord's end, so at radius 1.
radial() {
    mean_at "$1" 'sqrt($1 ^ 2 + $2 ^ 2) < 1 + 1e-6' '($3 * $1 + $4 * $2) / sqrt($1 ^ 2 + $2 ^ 2)'
}

# pressed NU N OUT: by a pressure of .1 Pa, the linear limit.
pressed() {
    dim=2 nu=$1 scene "$work/a.scene" <<END
[pressure inside]
facets = inner
value = 0.1
$symmetry
END
    relax "$work/a.scene" "$work/table$2.mts" "$3"
}

# Row 8, scaled to 100 Pa.
for case in '0.3 0.0635556' '0.49 0.0665533'; do
    read -r nu reference <<< "$case"
    for n in 8 16; do
        pressed "$nu" $n "$work/a$n.dat"
    done
    row 8 "thick cylinder, nu $nu: u(a), m" "$(calc "$(radial "$work/a16.dat") * 1000")" "$reference" cylinder
    at_least 8 "thick cylinder, nu $nu: order of convergence" \
        "$(order_of "$(radial "$work/a8.dat")" "$(radial "$work/a16.dat")" "$(calc "$reference / 1000")" 2)" order
done

# Nearly incompressible, on the coarse mesh: no worse than twice the error at .49 (u(a) = p a (1 + nu) (b^2 + (1 - 2 nu) a^2) / (E (b^2 - a^2))).
errors=()
for nu in 0.49 0.4999; do
    pressed $nu 8 "$work/a.dat"
    errors+=("$(calc "$(radial "$work/a.dat") / (0.1 * (1 + $nu) * (4 + 1 - 2 * $nu) / 9000) - 1")")
done
at_most 8 'thick cylinder, 8 cells around: error of u(a), nu 0.4999 / nu 0.49' "$(calc "sqrt((${errors[1]} / ${errors[0]}) ^ 2)")" locking

# Row 9: p/mu that inflates it to a, near the incompressible limit; by displacement, and by that pressure.
mu=$(calc '3000 / 2 / 1.499')
for case in '1.1 0.131562' '1.5 0.428228'; do
    read -r a reference <<< "$case"
    dim=2 nu=0.499 scene "$work/b.scene" <<END
[displacement inside]
facets = inner
normal = $(calc "1 - $a")
[output]
reactions = yes
$symmetry
END
    relax "$work/b.scene" "$work/table16.mts" "$work/b.dat"
    row 9 "inflation to a = $a: p/mu from the force" "$(calc "$(reaction "$work/b.dat" inside 1) / $a / $mu")" "$reference" cylinder
    dim=2 nu=0.499 scene "$work/c.scene" <<END
[pressure inside]
facets = inner
value = $(calc "$reference * $mu")
$symmetry
END
    relax "$work/c.scene" "$work/table16.mts" "$work/c.dat"
    row 9 "inflation by p/mu = $reference: a" "$(calc "1 + $(radial "$work/c.dat")")" "$a" cylinder
done
