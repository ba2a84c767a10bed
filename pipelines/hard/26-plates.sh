#!/bin/bash
# Row 26: a block and a cube of .1 m bonded to plates that are wider than they are, pressed to 50 and 70 %. The plates are
# rigid surfaces that move with the bonded faces, and the sides that bulge lie down on them; without them they would go
# through the planes of the plates, which is reported.
#
# A quarter of the block, an eighth of the cube; the middle stays and the plate comes down. The force is that of the bonded
# face and of the plate together. A plate that is turned as it presses ends the row.
. "$(dirname "$0")/common.sh"
examples=$(dirname "$0")/../../examples/hard

# press DIM MESH OUT PUSH: the plate by PUSH (m; half of the whole); `plates=no` leaves the rigid plate out.
press() {
    local down symmetry=xmin sides=xmax side=right plate=
    down="0, $(calc "-($4)")"
    if [ "$1" -eq 3 ]; then
        down="0, $down" symmetry='xmin, ymin' sides='xmax, ymax' side=front
    fi
    [ "${plates:-}" = no ] || plate="[contact rigid]
facets = $sides
rigid = plate$1.tsv
unit = m
side = $side
translation = $down
curve = smooth"
    dim=$1 scene "$work/a.scene" <<END
[displacement symmetry]
facets = $symmetry
normal = 0
[displacement middle]
facets = middle
normal = 0
[displacement plate]
facets = plate
components = $down
$plate
[output]
reactions = yes
energy = yes
[solver]
tolerance = $([ "$1" -eq 2 ] && echo 1e-6 || echo 1e-5)
END
    relax "$work/a.scene" "$work/$2.mts" "$work/$3.dat"
}

# force DIM OUT: of bonded face and plate, upwards on them, N (2D: N/m), of the part that is computed.
force() {
    calc "-($(reaction "$work/$2.dat" plate "$1")) - ($(reaction "$work/$2.dat" rigid "$1"))"
}

printf -- '-1 0.05\n1 0.05\n' > "$work/plate2.tsv"
echo '-1 -1 0.05  1 1 0.05  1 -1 0.05
-1 -1 0.05  -1 1 0.05  1 1 0.05' > "$work/plate3.tsv"
for mesh in 'coarse 0.004 1' 'fine 0.002 1' 'graded 0.004 0.2'; do
    read -r name h rim <<< "$mesh"
    gmsh -2 -v 1 -setnumber h "$h" -setnumber rim "$rim" "$examples/block.geo" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" | shapefn -o "$work/$name.mts" 2> /dev/null
done
for mesh in 'cube 0.015' 'finer 0.01'; do
    read -r name h <<< "$mesh"
    gmsh -3 -v 1 -setnumber h "$h" -setnumber rim 1 -setnumber Mesh.RandomSeed 1 "$examples/cube.geo" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" | shapefn -o "$work/$name.mts" 2> /dev/null
done

pushing2() {
    press 2 coarse push "$1"
    force 2 push
}
pushing3() {
    press 3 cube push "$1"
    force 3 push
}

for part in '50 0.025' '70 0.035'; do
    read -r percent push <<< "$part"
    for mesh in coarse fine; do
        press 2 $mesh $mesh "$push"
    done
    row 26 "block, $percent %, plates: work / stored energy ($(count coarse) nodes)" \
        "$(calc "$(work pushing2 "$push") / $(stored "$work/coarse.dat")")" 1 work
    row 26 "block, $percent %, plates: force, N/m, $(count fine) nodes against $(count coarse)" \
        "$(force 2 fine)" "$(force 2 coarse)" plates-refined
    row 26 "block, $percent %, plates: balance of the forces" \
        "$(calc "$(reaction "$work/fine.dat" middle 2) / ($(force 2 fine)) - 1")" 0 balance-plates
done
# On a mesh that is graded to the rim. A crease beside the plate was reported here at 69 % while contacts acted on the nodes; they act
# on quadrature points now, the side lies on the plate up to the end, and the force is judged as on even meshes. At 20 % it is
# the plate that makes the problem one with a solution: without it mixed elements on this graded mesh find no equilibrium beyond .78 of the
# load, and here a cell turns over at .87.
for part in '20 0.01' '50 0.025' '60 0.03' '70 0.035'; do
    read -r percent push <<< "$part"
    press 2 fine fine "$push"
    press 2 graded graded "$push"
    row 26 "block, $percent %, plates: force, N/m, $(count graded) graded against $(count fine)" \
        "$(force 2 graded)" "$(force 2 fine)" plates-refined
done
for part in '50 0.025' '70 0.035'; do
    read -r percent push <<< "$part"
    press 3 cube cube "$push"
    row 26 "cube, $percent %, plates: work / stored energy ($(count cube) nodes)" \
        "$(calc "$(work pushing3 "$push") / $(stored "$work/cube.dat")")" 1 work
    press 3 finer finer "$push"
    row 26 "cube, $percent %, plates: balance of the forces ($(count finer) nodes)" \
        "$(calc "$(reaction "$work/finer.dat" middle 3) / ($(force 3 finer)) - 1")" 0 balance-plates
done

# Without plates the run says where and from which load on.
plates=no press 2 fine alone 0.035 2> "$work/said"
row 26 'block, 70 %, without plates: told that it folds' "$(grep -c 'the body folds from 0\.[0-9]* of the load on' "$work/said")" 1 none

# A disc and a ball of the same size, not bonded to the plates: a quarter of the disc, an eighth of the ball, between the
# same plates. Pressures reach ten shear moduli.
squeeze() { # DIM MESH OUT PUSH
    local down symmetry='normal = 0' side=right
    down="0, $(calc "-($4)")"
    [ "$1" -eq 2 ] || down="0, $down" side=front
    dim=$1 scene "$work/a.scene" <<END
[displacement symmetry]
facets = xmin
$symmetry
[displacement middle]
facets = middle
$symmetry
$([ "$1" -eq 2 ] || printf '[displacement other]\nfacets = ymin\n%s\n' "$symmetry")
[contact rigid]
facets = round
rigid = plate$1.tsv
unit = m
side = $side
translation = $down
curve = smooth
[output]
reactions = yes
energy = yes
[solver]
tolerance = 1e-5
END
    relax "$work/a.scene" "$work/$2.mts" "$work/$3.dat"
}

# round DIM MESH SIZE
round() {
    { printf 'SetFactory("OpenCASCADE"); Mesh.MeshSizeMin = %s; Mesh.MeshSizeMax = %s;\n' "$3" "$3"
        if [ "$1" -eq 2 ]; then
            printf 'Disk(1) = {0, 0, 0, .05}; Rectangle(2) = {0, 0, 0, 1, 1}; BooleanIntersection(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; };
b[] = Boundary{ Surface{3}; }; x[] = Curve In BoundingBox{-1e-6, -1, -1, 1e-6, 1, 1}; z[] = Curve In BoundingBox{-1, -1e-6, -1, 1, 1e-6, 1};
Physical Surface("body") = {3}; Physical Curve("xmin") = {x[]}; Physical Curve("middle") = {z[]}; b[] -= x[]; b[] -= z[]; Physical Curve("round") = {b[]};\n'
        else
            printf 'Sphere(1) = {0, 0, 0, .05}; Box(2) = {0, 0, 0, 1, 1, 1}; BooleanIntersection(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
b[] = Boundary{ Volume{3}; }; x[] = Surface In BoundingBox{-1e-6, -1, -1, 1e-6, 1, 1}; y[] = Surface In BoundingBox{-1, -1e-6, -1, 1, 1e-6, 1};
z[] = Surface In BoundingBox{-1, -1, -1e-6, 1, 1, 1e-6}; b[] -= x[]; b[] -= y[]; b[] -= z[]; Physical Volume("body") = {3};
Physical Surface("xmin") = {x[]}; Physical Surface("ymin") = {y[]}; Physical Surface("middle") = {z[]}; Physical Surface("round") = {b[]};\n'
        fi; } > "$work/round.geo"
    gmsh -"$1" -v 1 -nt 1 "$work/round.geo" -o "$work/body.msh" > /dev/null
    nodes -u m "$work/body.msh" | shapefn -o "$work/$2.mts" 2> /dev/null
}
squeezing2() {
    squeeze 2 round2 push "$1"
    calc "-($(reaction "$work/push.dat" rigid 2))"
}
squeezing3() {
    squeeze 3 round3 push "$1"
    calc "-($(reaction "$work/push.dat" rigid 3))"
}
for body in 'disc 2 0.007 0.0045' 'ball 3 0.011 0.008'; do
    read -r name dim3 h half <<< "$body"
    round "$dim3" "round$dim3" "$h"
    round "$dim3" "finer$dim3" "$half"
    for part in '50 0.025' '70 0.035'; do
        read -r percent push <<< "$part"
        squeeze "$dim3" "round$dim3" round "$push"
        squeeze "$dim3" "finer$dim3" finer "$push"
        row 26 "$name, $percent %, plates: work / stored energy ($(count "round$dim3") nodes)" \
            "$(calc "$(work "squeezing$dim3" "$push") / $(stored "$work/round.dat")")" 1 work
        row 26 "$name, $percent %, plates: force, N, $(count "finer$dim3") nodes against $(count "round$dim3")" \
            "$(reaction "$work/finer.dat" rigid "$dim3")" "$(reaction "$work/round.dat" rigid "$dim3")" plates-refined
    done
done

# A plate over a block that is held at its bottom, tilted by 5 degrees as it comes down by 15 %: the force is along its normal.
cloud -d 2 -k regular -n 13 --box 0,0.1,0,0.1 | shapefn -o "$work/tilted.mts" 2> /dev/null
printf -- '-1 0.1\n1 0.1\n' > "$work/lid.tsv"
dim=2 scene "$work/a.scene" <<END
[displacement bottom]
facets = ymin
components = 0, 0
[contact lid]
facets = ymax
rigid = lid.tsv
unit = m
side = right
translation = 0, -0.015
angle = 5
axis_point = 0.05, 0.1
curve = linear
[output]
reactions = yes
gaps = yes
[solver]
tolerance = 1e-7
END
relax "$work/a.scene" "$work/tilted.mts" "$work/tilted.dat"
row 26 'tilted plate: deepest penetration / size' "$([ ! -s "$work/tilted.dat" ] && echo nan ||
    mts print gaps "$work/tilted.dat" | awk '$3 < -most { most = -$3 } END { print most / 0.1 }')" 0 penetration
row 26 'tilted plate: direction of its force, degrees' \
    "$(calc "atan2($(reaction "$work/tilted.dat" lid 1), -($(reaction "$work/tilted.dat" lid 2))) * 180 / pi")" 5 normal
