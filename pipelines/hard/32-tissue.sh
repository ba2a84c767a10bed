#!/bin/bash
# Row 32: laws with fibres. FEBio's fi08 and fi10 on its nodes, a block of 10 x 10 x 10 bricks of trans-iso, whose fibres in fi10 turn
# from x to z along x: the norm of the free components of displacement. The cardiac mechanics benchmark (Land et al. 2015, eleven
# groups), guccione: 1, a beam bent by a following pressure, the height of its end, where the groups have 4.15 to 4.17 mm; 2, an
# isotropic ventricle under pressure, the apex in the middle of the wall, -27.33 mm of fine solutions; each on three meshes, of
# which the finest is judged.
. "$(dirname "$0")/common.sh"
geometries=$(dirname "$0")/../../examples/hard

# law LINE...: the head of a scene.
law() { printf '%s\n' '[scene]' 'dim = 3' 'analysis = quasi-static' '[material body]' 'region = body' "$@"; }

# febio NAME FIGURE FIBRES
febio() {
    {
        law 'model = trans-iso' 'c1 = 1' 'c3 = 1' 'c4 = 1' 'c5 = 1' 'lambda_max = 10' 'kappa = 100' "${@:3}"
        printf '[displacement %s]\nfacets = %s\nnormal = %s\n' a zmin 0 b zmax 0.2 c ymin 0 d xmin 0
    } > "$work/febio.scene"
    relax "$work/febio.scene" "$work/cube.mts" "$work/u.dat"
    row 32 "FEBio $1: norm of the displacement, on its nodes" "$(paste <(mts print nodes.x "$work/u.dat") <(mts print u "$work/u.dat") |
        awk '{ sum += ($1 > -0.499) * $4^2 + ($2 > -0.499) * $5^2 + ($3 > 0.001 && $3 < 0.999) * $6^2 } END { print (NR > 1 ? sqrt(sum) : "nan") }')" \
        "$2" fibres
}

# place FILE POINT: where the point, in mm, has gone to along z.
place() {
    echo "$2" > "$work/point.tsv"
    interp -p "$work/point.tsv" -u mm "$1" 2> /dev/null | mts print u | awk -v z="${2##* }" '{ print z + 1000 * $3 }' || echo nan
}

cloud -d 3 -k regular -n 11 --box -0.5,0.5,-0.5,0.5,0,1 | shapefn > "$work/cube.mts" 2> /dev/null
febio fi08 4.532630 'fibre = 1, 1, 1'
awk 'BEGIN { for (i = 0; i < 1000; i++) { k = i % 10
    print k - 4.5, int(i / 10) % 10 - 4.5, int(i / 100) + 0.5, k < 5 ? 1 : 2 - 0.2 * k, 0, k < 5 ? 0.2 * k : 1 } }' > "$work/turn.tsv"
febio fi10 4.519432 'fibres = turn.tsv' 'unit = 0.1'

{
    law 'model = guccione' 'C = 2000' 'bf = 8' 'bt = 2' 'bfs = 4' 'kappa = 1e7' 'fibre = 1, 0, 0'
    printf '[displacement end]\nfacets = xmin\ncomponents = 0, 0, 0\n[pressure below]\nfacets = zmin\nvalue = 4\n'
} > "$work/beam.scene"
for cells in 4:land-coarse 6:land-coarse 8:land-beam; do
    n=${cells%:*}
    cloud -d 3 -k regular -n $((10 * n + 1)),$((n + 1)),$((n + 1)) --box 0,0.01,0,0.001,0,0.001 2> /dev/null | shapefn > "$work/beam.mts" 2> /dev/null
    relax "$work/beam.scene" "$work/beam.mts" "$work/u.dat"
    row 32 "Land 1: height of the beam's end, $n cells across, mm" "$(place "$work/u.dat" '10 0.5 1')" 4.16 "${cells#*:}"
done

{
    law 'model = guccione' 'C = 10000' 'bf = 1' 'bt = 1' 'bfs = 1' 'kappa = 1e7' 'fibre = 1, 0, 0'
    printf '[displacement base]\nfacets = base\ncomponents = 0, 0, 0\n[pressure blood]\nfacets = inside\nvalue = 10000\n'
} > "$work/ventricle.scene"
for size in 2:land-coarse 1.5:land-coarse 1:land-coarse 0.75:land-ventricle; do
    gmsh -3 -v 1 -setnumber h "${size%:*}" "$geometries/ventricle.geo" -o "$work/ventricle.msh" > /dev/null
    nodes -u mm "$work/ventricle.msh" 2> /dev/null | shapefn > "$work/ventricle.mts" 2> /dev/null
    relax "$work/ventricle.scene" "$work/ventricle.mts" "$work/u.dat"
    row 32 "Land 2: apex in the middle of the wall, cells of ${size%:*} mm, mm" "$(place "$work/u.dat" '0 0 -18.5')" -27.33 "${size#*:}"
done
