#!/bin/bash
# Row 35: what surrounds an organ. A block on an elastic support sinks by p / k more; a bar that is dragged along a tangential support follows
# u'' = k p / (E A) u. A coated bar has the axial stiffness E A + E_m t p; a coated ring (plane strain) and a
# coated ball under inner pressure are Lame's with the membrane's hoop stress outside.
. "$(dirname "$0")/common.sh"

cloud -d 3 -k jittered --jitter 0.1 -n 6 --box 0,0.1,0,0.1,0,0.1 | shapefn > "$work/block.mts" 2> /dev/null
youngs=3000 nu=0 scene "$work/sink.scene" << 'END'
[support ground]
facets = zmin
normal = 50000
[traction top]
facets = zmax
components = 0, 0, -30
[displacement a]
facets = xmin
normal = 0
[displacement b]
facets = ymin
normal = 0
[solver]
tolerance = 1e-8
END
relax "$work/sink.scene" "$work/block.mts" "$work/u.dat"
row 35 'support: a block pressed by p sinks by p / k, m' "$(mean_at "$work/u.dat" '$3 < 1e-9' '-$6')" 0.0006 around-exact

cloud -d 2 -k jittered --jitter 0.1 -n 161,9 --box 0,1,0,0.04 | shapefn > "$work/bar.mts" 2> /dev/null
dim=2 youngs=3000 nu=0 scene "$work/drag.scene" << 'END'
[support sides]
facets = ymin, ymax
tangential = 240
[displacement end]
facets = xmax
components = 0.001, 0
[output]
reactions = yes
END
relax "$work/drag.scene" "$work/bar.mts" "$work/u.dat"
row 35 'support: a bar dragged along one, force at its end, N/m' "$(reaction "$work/u.dat" end 1)" \
    "$(calc '3000 * 0.04 * 0.002 * (exp(4) - 1) / (exp(4) + 1)')" around
row 35 'support: a bar dragged along one, its other end, m' "$(mean_at "$work/u.dat" '$1 < 1e-9' '$3')" "$(calc '0.002 / (exp(2) + exp(-2))')" around

cloud -d 3 -k jittered --jitter 0.1 -n 21,6,6 --box 0,0.1,0,0.02,0,0.02 | shapefn > "$work/coated.mts" 2> /dev/null
youngs=3000 nu=0 scene "$work/coated.scene" << 'END'
[membrane skin]
facets = ymin, ymax, zmin, zmax
thickness = 1e-4
E = 1e5
nu = 0
[displacement a]
facets = xmin
normal = 0
[displacement b]
facets = xmax
normal = 1e-5
[displacement c]
facets = ymin
normal = 0
[displacement d]
facets = zmin
normal = 0
[output]
reactions = yes
END
relax "$work/coated.scene" "$work/coated.mts" "$work/u.dat"
row 35 'membrane: a coated bar, E A + E_m t p, N' "$(calc "$(reaction "$work/u.dat" b 1) / 1e-4")" 2 coated

cat > "$work/ring.geo" << 'END'
Point(1)={0,0,0}; Point(2)={50,0,0}; Point(3)={-50,0,0}; Point(4)={100,0,0}; Point(5)={-100,0,0};
Circle(1)={2,1,3}; Circle(2)={3,1,2}; Circle(3)={4,1,5}; Circle(4)={5,1,4}; Curve Loop(1)={3,4}; Curve Loop(2)={1,2}; Plane Surface(1)={1,2};
Physical Surface("body")={1}; Physical Curve("out")={3,4}; Physical Curve("in")={1,2};
END
gmsh -v 0 -2 "$work/ring.geo" -clmax 6 -clmin 6 -o "$work/ring.msh" > /dev/null
nodes -u mm "$work/ring.msh" 2> /dev/null | shapefn > "$work/ring.mts" 2> /dev/null
dim=2 youngs=3000 nu=0.3 scene "$work/ring.scene" << 'END'
[membrane skin]
facets = out
thickness = 1e-4
E = 1e6
nu = 0.4
[support weak]
facets = in
normal = 0.01
tangential = 0.01
[pressure in]
facets = in
value = 0.03
END
ring() { # INNER PRESSURE, PRESSURE OF THE SKIN'S PRESTRESS: mean displacement outside by Lame's
    relax "$work/ring.scene" "$work/ring.mts" "$work/u.dat"
    [ -s "$work/u.dat" ] || { echo nan; return; }
    paste <(mts print nodes.x "$work/u.dat") <(mts print u "$work/u.dat") | awk -v p="$1" -v q="$2" '
        BEGIN { a = 0.05; b = 0.1; k = 1e2 / 0.84 / b^2 * 1.3 / 3000; c = 1 + k * 0.4 * b; B = (c * p - q) / (c / a^2 - 1 / b^2 + k / b); A = B / a^2 - p }
        { r = sqrt($1^2 + $2^2) } r > 0.0999 { sum += ($3 * $1 + $4 * $2) / r / (1.3 / 3000 * (0.4 * A * r + B / r)); n++ } END { printf "%.12g\n", sum / n }'
}
row 35 "membrane: a coated ring under inner pressure, radius outside, displacement / Lame's" "$(ring 0.03 0)" 1 around
sed -i 's/^value = .*/value = 0/; /^nu = 0.4/a prestress = 300' "$work/ring.scene"
row 35 "membrane: the same under its prestress alone, displacement / Lame's" "$(ring 0 0.3)" 1 around

gmsh -3 -nt 1 -v 0 -setnumber h 0.008 "$(dirname "$0")/../../examples/hard/octant.geo" -o "$work/ball.msh" > /dev/null
nodes -u m "$work/ball.msh" 2> /dev/null | tag -f 'outer=all without planes without inner' 2> /dev/null | shapefn > "$work/ball.mts" 2> /dev/null
youngs=3000 nu=0.3 scene "$work/ball.scene" << 'END'
[membrane skin]
facets = outer
thickness = 1e-4
E = 1e6
nu = 0.4
[displacement planes]
facets = planes
normal = 0
[pressure in]
facets = inner
value = 0.3
END
relax "$work/ball.scene" "$work/ball.mts" "$work/u.dat"
row 35 "membrane: a coated ball under inner pressure, radius outside, displacement / Lame's" "$([ ! -s "$work/u.dat" ] && echo nan || paste <(mts print nodes.x "$work/u.dat") <(mts print u "$work/u.dat") |
    awk 'BEGIN { a = 0.05; b = 0.1; K3 = 3000 / 0.4; G4 = 4 * 3000 / 2.6; k = 2 * 1e2 / 0.6 / b^2 # A and B of u = A r + B / r^2
            c = G4 / b^3 - k / b^2; d = K3 + k * b; B = -0.3 / (K3 * c / d - G4 / a^3); A = c * B / d }
        { r = sqrt($1^2 + $2^2 + $3^2) } r > 0.0999 { sum += ($4 * $1 + $5 * $2 + $6 * $3) / r / (A * r + B / r^2); n++ } END { printf "%.12g\n", sum / n }')" 1 coated-ball
