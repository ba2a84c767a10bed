#!/bin/bash
# Row 36: a ventricle, problems 2 and 3 of the cardiac mechanics benchmark (Land et al. 2015). 3: it contracts, the apex inside and outside,
# where a public solution (github.com/finsberg/pulse, pull request 98) has -11.996 and -15.223 mm, on two meshes. 2: an isotropic guccione law under pressure,
# the apex in the middle of the wall, -27.33 mm of fine solutions: of the whole on two coarse meshes, and of a quarter on three, with 2 to 6 cells
# across the wall. A run that has not ended within 600 s is a row without value.
. "$(dirname "$0")/common.sh"
geometries=$(dirname "$0")/../../examples/hard
mtled() { timeout 600 mtled "$@"; }

# mesh SIZE [QUARTER]: of cells of so many mm; 1: of a quarter.
mesh() { gmsh -3 -v 1 -setnumber h "$1" -setnumber quarter "${2:-0}" "$geometries/ventricle.geo" -o "$work/ventricle.msh" > /dev/null; }

# Pressure and active stress grow together, as in that solution.
sed 's/^curve = .*/curve = linear/; /^frames/d; /^\[output/d' "$geometries/../ventricle/ventricle.scene" > "$work/contracted.scene"
for size in 1.5:land-coarse 1:land-contracted; do
    mesh "${size%:*}"
    nodes -u mm "$work/ventricle.msh" 2> /dev/null | fibres --from inside,90 --to 'all without inside without base,-90' --axis 0,0,1 2> /dev/null |
        shapefn > "$work/ventricle.mts" 2> /dev/null
    relax "$work/contracted.scene" "$work/ventricle.mts" "$work/u.dat"
    row 36 "Land 3: apex inside, cells of ${size%:*} mm, mm" "$(place "$work/u.dat" '0 0 -17')" -11.996 "${size#*:}"
    row 36 "Land 3: apex outside, cells of ${size%:*} mm, mm" "$(place "$work/u.dat" '0 0 -20')" -15.223 "${size#*:}"
done

cat > "$work/ventricle.scene" << 'END'
[scene]
dim = 3
analysis = quasi-static
[material body]
region = body
model = guccione
C = 10000
bf = 1
bt = 1
bfs = 1
kappa = 1e7
fibre = 1, 0, 0
[displacement base]
facets = base
components = 0, 0, 0
[pressure blood]
facets = inside
value = 10000
END

# inflated SIZE:TOLERANCE SCENE WHAT: the row of a mesh of that.
inflated() {
    nodes -u mm "$work/ventricle.msh" 2> /dev/null | shapefn > "$work/ventricle.mts" 2> /dev/null
    relax "$2" "$work/ventricle.mts" "$work/u.dat"
    row 36 "Land 2: apex in the middle of the wall, $3, cells of ${1%:*} mm, mm" "$(place "$work/u.dat" '0 0 -18.5')" -27.33 "${1#*:}"
}
for size in 2:land-coarse 1.5:land-coarse; do
    mesh "${size%:*}"
    inflated "$size" "$work/ventricle.scene" whole
done
printf '[displacement symmetry]\nfacets = symmetry\nnormal = 0\n' | cat "$work/ventricle.scene" - > "$work/quarter.scene"
for size in 1.5:land-coarse 1:land-ventricle .5:land-fine; do
    mesh "${size%:*}" 1
    inflated "$size" "$work/quarter.scene" quarter
done
