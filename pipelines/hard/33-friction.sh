#!/bin/bash
# Row 33: a block on a slope, which sticks up to tan a = mu; a block that is dragged on a flat with mu = .4; and a rigid ball pressed into a block and dragged along it (Cattaneo and
# Mindlin): the stiffness of the block far from the ball, which is linear, is that of a run in which all points stick.
. "$(dirname "$0")/common.sh"

cloud -d 2 -k regular -n 11 --box 0,0.1,0,0.1 | shapefn -o "$work/block.mts" 2> /dev/null
printf -- '-1 0\n1 0\n' > "$work/flat.tsv"
printf '0 0\n0.5 1\n1 1\n' > "$work/press.tsv"
printf '0 0\n0.5 0\n1 1\n' > "$work/drag.tsv"
# The flat that the block is dragged on, and rests on.
flat='[contact flat]
facets = ymin
rigid = flat.tsv
unit = m
side = left
friction = 0.4'
dim=2 youngs=30000 nu=0.3 scene "$work/drag.scene" <<END
[displacement top]
facets = ymax
components = free, -0.002
curve = press.tsv
[displacement side]
facets = ymax
components = 0.02, free
curve = drag.tsv
$flat
[output]
reactions = yes
END
relax "$work/drag.scene" "$work/block.mts" "$work/drag.dat"
row 33 'friction: a block dragged on a flat, tangential force / normal force' \
    "$(calc "-($(reaction "$work/drag.dat" flat 1)) / ($(reaction "$work/drag.dat" flat 2))")" 0.4 slides

# holds SLOPE: 1 if the block, of mu = .4 and weight 1, is at rest on a slope of this tangent, by its weight's components.
holds() {
    head="gravity = $1, -1" dim=2 youngs=30000 nu=0.3 scene "$work/slope.scene" <<END
$flat
END
    mtled -q "$work/slope.scene" "$work/block.mts" > /dev/null 2> "$work/said" && echo 1 || { grep -q slides "$work/said" && echo 0 || echo nan; }
}
row 33 'friction: a block on a slope of .999 mu is at rest' "$(holds 0.3996)" 1 none
row 33 'friction: a block on a slope of 1.001 mu is at rest' "$(holds 0.4004)" 0 none

gmsh -3 -nt 1 -v 0 "$(dirname "$0")/../../examples/hard/mindlin.geo" -o "$work/body.msh" > /dev/null
nodes -u mm "$work/body.msh" | shapefn -o "$work/body.mts" 2> /dev/null
# The ball, of 300 mm in radius, in facets of .8 mm around its lowest point.
awk 'BEGIN { n = 24; m = 32; pi = atan2(0, -1); for (i = 0; i < n; i++) for (j = 0; j < m; j++) {
        a = 2 * pi * j / m; b = 2 * pi * (j + 1) / m; r = 20 * i / n; s = 20 * (i + 1) / n
        p(r, a); p(s, a); p(s, b); print ""; if (i) { p(r, a); p(s, b); p(r, b); print "" } } }
    function p(r, a) { printf "%.12g %.12g %.12g ", r * cos(a), r * sin(a), 300 - sqrt(90000 - r * r) }' > "$work/ball.tsv"
for mu in 0.3 10; do
    youngs=30000 scene "$work/ball.scene" <<END
[displacement middle]
facets = middle
components = free, 0, free
[displacement bottom]
facets = bottom
components = -0.00008, 0, 0
curve = drag.tsv
[contact ball]
facets = top
rigid = ball.tsv
unit = mm
side = back
friction = $mu
translation = 0, 0, -0.0002
curve = press.tsv
[output]
frames = 6
reactions = yes
[solver]
time_steps = 6
tolerance = 1e-4
END
    relax "$work/ball.scene" "$work/body.mts" "$work/ball-$mu.dat"
done
# Columns 8 to 10 are the force of the ball on a half; of the block's bottom the way is that of the curve, by then.
for frame in 5 6; do
    row 33 "friction: a ball pressed and dragged, frame $frame, displacement / Mindlin's" "$([ ! -s "$work/ball-0.3.dat" ] && echo nan || paste \
        <(mts print reactions.frames "$work/ball-0.3.dat") <(mts print reactions.frames "$work/ball-10.dat") \
        <(for f in 0 1 2 3 4 5 6; do paste <(mts print nodes.x "$work/body.mts") <(mts print "u.frame.$f" "$work/ball-0.3.dat") | awk '$3 < -0.0599 { print -$4; exit }'; done) |
        awk -v row="$frame" 'NR == row + 1 { nu = 0.49; G = 30000 / 2 / (1 + nu); P = -2 * $10; Q = 2 * $8; way = $21; mu = 0.3
            a = (3 * P * 0.3 * (1 - nu ^ 2) / 4 / 30000) ^ (1 / 3); stuck = (2 - nu) / (8 * a * G)
            mindlin = 3 * mu * P * (2 - nu) / (16 * a * G) * (1 - (1 - Q / (mu * P)) ^ (2 / 3))
            printf "%.12g\n", (way - (way / (2 * $18) - stuck) * Q) / mindlin }')" 1 mindlin
done
