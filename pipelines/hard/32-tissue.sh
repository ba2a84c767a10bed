#!/bin/bash
# Row 32: laws with fibres. Closed forms of uniaxial stress, incompressible (ours has kappa = 1e5 times the stiffness): Weiss's law with c1 =
# c3 = c4 = 1, sigma = 2 (l^2 - 1/l) + exp(l - 1) - 1 along the fibres; Guccione's with 2 kPa, 8, 2, 4, along and across the fibres. FEBio's
# fi02, a cube; fi08 and fi10 on its nodes, a block of 10 x 10 x 10 bricks of trans-iso, whose fibres in fi10 turn from x to z along x: the
# norm of the free components of displacement. The cardiac mechanics benchmark (Land et al. 2015, eleven groups), guccione: 1, a beam bent
# by a following pressure, the height of its end, where the groups have 4.15 to 4.17 mm, on three meshes, of which the finest is judged;
# 2: 36-ventricle.sh.
. "$(dirname "$0")/common.sh"

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

# uniaxial NAME STRETCH SIGMA LINES: of a cube that is stretched along x.
uniaxial() {
    { cube "$4"; printf '[displacement w]\nfacets = xmax\nnormal = %s\n[solver]\ntolerance = 1e-8\n' "$(calc "$2 - 1")"; } > "$work/cube.scene"
    relax "$work/cube.scene" "$work/cube.mts" "$work/u.dat"
    row 32 "$1, stretch $2: Cauchy stress, Pa" "$(calc "$2 * $(reaction "$work/u.dat" w 1)")" "$3" incompressible
}

unit_cube
for at in '1.1 .70699' '1.2 1.43474' '1.5 3.81539'; do
    uniaxial 'Weiss, along the fibres' ${at% *} "${at#* }" 'model = trans-iso\nc1 = 1\nc3 = 1\nc4 = 1\nkappa = 1e6\nfibre = 1, 0, 0'
done
guccione='model = guccione\nC = 2000\nbf = 8\nbt = 2\nbfs = 4\nkappa = 2e9\nfibre ='
for at in '1.05 1018.18' '1.1 2420.69' '1.2 8096.52'; do
    uniaxial 'Guccione, along the fibres' ${at% *} "${at#* }" "$guccione 1, 0, 0"
done
for at in '1.1 784.45' '1.2 1904.77'; do
    uniaxial 'Guccione, across the fibres' ${at% *} "${at#* }" "$guccione 0, 1, 0"
done

# Active stress T: free, incompressible, (mu + T) l^3 = mu.
{ cube 'mu = 1000\nkappa = 1e8\nactive = 1500\ncurve = linear\nfibre = 1, 0, 0'; printf '[solver]\ntolerance = 1e-8\n'; } > "$work/active.scene"
relax "$work/active.scene" "$work/cube.mts" "$work/u.dat"
row 32 'active stress: stretch of a free block, T = 1.5 mu' "$(mean_at "$work/u.dat" '$1 > 0.5' '1 + $4')" "$(calc '0.4 ^ (1 / 3)')" incompressible

# fi02: held at xmin, ymax and zmin; free are y at ymin and z at zmax.
{
    law 'model = trans-iso' 'c1 = 1' 'c3 = 5' 'c4 = 1' 'kappa = 1000' 'fibre = 0.866, 0.5, 0'
    printf '[displacement %s]\nfacets = %s\nnormal = %s\n' a xmin 0 b ymax 0 c zmin 0 d xmax 1
} > "$work/fi02.scene"
relax "$work/fi02.scene" "$work/cube.mts" "$work/u.dat"
row 32 'FEBio fi02: norm of the displacement, on its nodes' "$(mts print u "$work/u.dat" | awk '{ sum += $2^2 + $3^2 } END { print (NR > 1 ? sqrt(sum) : "nan") }')" 0.836223 febio

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
