#!/bin/bash
# Rows 2 to 6: homogeneous deformations of a cube of .1 m, on a jittered cloud, with the default scheme.
. "$(dirname "$0")/common.sh"

cloud -d 3 -k jittered -n 5 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
solver='
[output]
reactions = yes
stress = yes
[solver]
tolerance = 1e-8'

# Lateral stretch of the face x = .1, and its largest deviation from the mean.
lateral() {
    [ -s "$1" ] || { echo nan nan; return; }
    paste <(mts print nodes.x "$1") <(mts print u "$1") | awk '$1 > 0.1 - 1e-9 {
        n++
        sum += $4
        if (n == 1 || $4 < least) least = $4
        if (n == 1 || $4 > most) most = $4
    } END { printf "%.10g %.3g\n", 1 + sum / n / 0.1, (most - least) / 0.1 }'
}

# unconfined CASE STRETCH P LATERAL: sliding ends.
unconfined() {
    local push mean spread
    push=$(calc "($2 - 1) * 0.1")
    scene "$work/a.scene" <<END
[displacement planes]
facets = xmin, ymin, zmin
normal = 0
[displacement top]
facets = zmax
normal = $push
$solver
END
    relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
    row "$1" "unconfined, stretch $2: P, Pa" "$(calc "$(reaction "$work/a.dat" top 3) / 0.01")" "$3" homogeneous
    read -r mean spread < <(lateral "$work/a.dat")
    [ -z "$4" ] || row "$1" "unconfined, stretch $2: lateral stretch" "$mean" "$4" homogeneous
    row "$1" "unconfined, stretch $2: unevenness of the sides" "$spread" 0 homogeneous
}

unconfined 2 0.8 -763.26922 1.11574668
# The state of row 3 is stable on 4 and 5 nodes a side. On finer clouds its free edges buckle, smoothly on 6 nodes a side at .51,
# and then the free sides crease (Lestringant, Maurini, Lazarus and Audoly 2017; Hong, Zhao and Suo 2009): reported as a fold.
mv "$work/table.mts" "$work/five.mts"
cloud -d 3 -k jittered -n 4 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
unconfined 3 0.5 -3503.55836 ''
sed 's/^normal = -.*/normal = -0.049/' "$work/a.scene" > "$work/six.scene"
cloud -d 3 -k jittered -n 6 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
relax "$work/six.scene" "$work/table.mts" "$work/a.dat"
told 3 'unconfined, stretch 0.51, 6 nodes a side' "$work/a.dat"
mv "$work/five.mts" "$work/table.mts"
unconfined 3 0.5 -3503.55836 ''
cp "$work/table.mts" "$work/five.mts"
cloud -d 3 -k regular -n 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/table.mts" 2> /dev/null
relax "$work/a.scene" "$work/table.mts" "$work/a.dat"
told 3 'unconfined, stretch 0.5, 7 nodes a side' "$work/a.dat"
mv "$work/five.mts" "$work/table.mts"
unconfined 4 1.2 504.78406 ''
unconfined 4 1.5 1050.71532 ''

scene "$work/b.scene" <<END
[displacement walls]
facets = xmin, xmax, ymin, ymax, zmin
normal = 0
[displacement top]
facets = zmax
normal = -0.02
$solver
END
relax "$work/b.scene" "$work/table.mts" "$work/b.dat"
row 5 'confined, stretch 0.8: P, Pa' "$(calc "$(reaction "$work/b.dat" top 3) / 0.01")" -10350.4555 homogeneous

# u = .5 z along x on the whole boundary; finer, because a node is held by one condition for each side it lies on, and coarse
# bodies have fewer nodes than that.
cloud -d 3 -k jittered -n 9 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/fine.mts" 2> /dev/null
mts print nodes.x "$work/fine.mts" | awk -v OFMT=%.17g '
    function outer(x) { return x < 1e-9 || x > 0.1 - 1e-9 }
    outer($1) || outer($2) || outer($3) { print $1, $2, $3, 0.5 * $3, 0, 0 }' > "$work/shear.tsv"
scene "$work/c.scene" <<END
[displacement sides]
facets = xmin, xmax, ymin, ymax, zmin, zmax
table = shear.tsv
unit = m
$solver
END
relax "$work/c.scene" "$work/fine.mts" "$work/c.dat"
# Each component of Cauchy stress where it is farthest from the reference: xx, yy, zz, xz.
for component in '11 1 167.78523' '22 2 -83.89262' '33 3 -83.89262' '13 5 503.35570'; do
    read -r name column reference <<< "$component"
    worst=$({ [ ! -s "$work/c.dat" ] || mts print stress "$work/c.dat"; } | awk -v column="$column" -v reference="$reference" '
        { d = $column - reference; if (d < 0) d = -d; if (NR == 1 || d > most) { most = d; worst = $column } }
        END { print (NR > 0 ? worst : "nan") }')
    row 6 "simple shear 0.5: worst sigma$name, Pa" "$worst" "$reference" homogeneous
done
