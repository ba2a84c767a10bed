# incise: bodies cut along surfaces in 2D and 3D, pieces and regions taken out, and what is refused.

load common.bash

setup() { enter_alone; }

# stl CORNER... > FILE: triangles, the nine numbers of each in turn
stl() {
    printf '%s ' "$@" | awk '{ print "solid blade"; for (i = 0; i < NF; i += 9) {
        print "facet normal 0 0 0 outer loop"
        for (k = 1; k <= 9; k += 3) print "vertex", $(i + k), $(i + k + 1), $(i + k + 2)
        print "endloop endfacet" } print "endsolid blade" }'
}

# panel X Y Z UX UY UZ VX VY VZ: the parallelogram at a point, along two directions; its front is where u x v points to
panel() {
    awk -v n="$*" 'BEGIN { split(n, p, " "); for (i = 1; i <= 3; i++) { a[i] = p[i]; b[i] = a[i] + p[3 + i]; d[i] = a[i] + p[6 + i]; c[i] = b[i] + p[6 + i] }
        print a[1], a[2], a[3], b[1], b[2], b[3], c[1], c[2], c[3], a[1], a[2], a[3], c[1], c[2], c[3], d[1], d[2], d[3] }'
}

# A body of .1 x .06 x .05 m in two regions, and its nodes in a set.
body() {
    cloud -d 3 -k jittered -n 13,9,8 --box 0,0.1,0,0.06,0,0.05 --jitter 0.14 | tag -r 'lump=box:0.04,0.02,0.02,0.07,0.04,0.05' -n 'near=box:0,0,0,0.05,0.06,0.05'
}

# size_of NAME FILE: the area of a group of facets, or volume of a region, as tag tells it
size_of() {
    tag -v "$2" 2>&1 > /dev/null | sed -nE "s/^tag: (facets|region) ${1//|/[|]}: [^,]*, [a-z]+ ([^ ]+) m.*/\2/p"
}

@test "a cut ends inside: two faces of its area on it, an edge around it; nothing lost of the body, its regions and groups" {
    body > body.mts
    stl "$(panel .03 .01 .012 .04 0 .004 0 .035 .02)" > blade.stl
    incise -v -s blade.stl -n knife -o cut.mts body.mts 2> said
    [[ "$(cat said)" == "incise: knife: faces of "*"pieces: 1, "* ]]
    mts check cut.mts
    # .04 x .035 along: |u x v| = .0016148 m2; its corners are cut off within a cell
    for lip in front back; do
        awk -v a="$(size_of "knife|$lip" cut.mts)" 'BEGIN { exit !(a > .95 * .0016148 && a < 1.01 * .0016148) }'
    done
    for group in body lump xmin xmax ymin ymax zmin zmax; do
        awk -v a="$(size_of $group body.mts)" -v b="$(size_of $group cut.mts)" 'BEGIN { exit !(a > 0 && a / b - 1 < 1e-3 && 1 - a / b < 1e-3) }'
    done
    # no node of a face is off the plane by a tenth of a spacing; (-.14, -.8, 1.4) is its normal
    mts text cut.mts > cut.txt
    rows facets cut.txt > facets
    paste <(rows facets.set cut.txt) facets | awk -v front=6 '$1 >= front { print $2; print $3; print $4 }' | sort -nu > lips
    rows nodes.x cut.txt | awk 'NR == FNR { lip[$1]; next } (FNR - 1) in lip { d = (-.14 * ($1 - .03) - .8 * ($2 - .01) + 1.4 * ($3 - .012)) / 1.6185; if (d * d > 1e-6) { print; bad = 1 } n++ } END { exit bad || n <= 60 }' lips -
    # parts of a cell have its fibre
    fibres --from zmin,60 --to zmax,-60 --axis 1,0,0 -o turned.mts body.mts 2> note
    incise -s blade.stl -n knife turned.mts > turned_cut.mts
    [ -z "$(comm -13 <(mts print points.fibre turned.mts | sort -u) <(mts print points.fibre turned_cut.mts | sort -u))" ]
    paste <(mts print points.x turned_cut.mts) <(mts print points.fibre turned_cut.mts) | awk -v cells="$(mts print cells turned_cut.mts | wc -l)" '
        { d = (atan2($5, $4) - (60 - 2400 * $3 - 90) / 57.29578) / 3.14159265; d -= int(d + (d < 0 ? -.5 : .5)); sum += d < 0 ? -d : d }
        END { print sum / NR * 180; exit !(NR == cells && sum / NR * 180 < 2) }'
    # points of an evaluation lattice have no cell, and leave the cells without fibres
    ipoints --lattice 4 body.mts | fibres --from zmin,60 --to zmax,-60 --axis 1,0,0 | incise -s blade.stl -n knife > turned_cut.mts
    [ "$(mts print points.fibre turned_cut.mts | sort -u)" = '0 0 0' ]
    # most lie on it exactly
    [ "$(rows nodes.x cut.txt | awk 'NR == FNR { lip[$1]; next } (FNR - 1) in lip { d = -.14 * ($1 - .03) - .8 * ($2 - .01) + 1.4 * ($3 - .012); n++; on += d * d < 1e-20 } END { print (on > .8 * n) }' lips -)" = 1 ]
    # the same input, the same bytes, with any number of threads
    OMP_NUM_THREADS=3 incise -s blade.stl -n knife -v -o again.mts body.mts 2> again
    cmp said again
    diff <(bare cut.txt) <(mts text again.mts | bare)
    refused 2 "opens nothing" incise -s blade.stl -n knife cut.mts
    # set members: copies are members, new nodes where both ends are
    tag -v cut.mts 2> said > copy
    grep -q 'nodes near: .* 0 0 0 to 0.05 ' said
}

@test "a blade that branches, through the body: three pieces, four where two cross; no node is on an edge of the cut" {
    body > body.mts
    # panels from the line through (.052, *, .026): two in one sheet, one or two others
    a='.052 -.02 .026' b='.052 .09 .026'
    half() { printf '%s %s %s\n%s %s %s\n' "$a" "$b" "$2" "$a" "$2" "$1"; }       # to the right of a and b
    back() { printf '%s %s %s\n%s %s %s\n' "$a" "$2" "$b" "$a" "$1" "$2"; }
    { half '-.018 -.02 .006' '-.018 .09 .006'; back '.132 -.02 .051' '.132 .09 .051'; } > across.tsv
    { half '.062 -.02 -.034' '.062 .09 -.034'; back '.032 -.02 .096' '.032 .09 .096'; } > down.tsv
    { cat across.tsv; head -2 down.tsv; } > branch.tsv
    cat across.tsv down.tsv > cross.tsv
    for blade in branch:3 cross:4; do
        incise -v -s "${blade%:*}.tsv" -o cut.mts body.mts 2> said
        grep -q ' 0 nodes on the edge.*pieces: '"${blade#*:}, " said
        mts check cut.mts | has "${blade#*:} connected bodies"
    done
    incise -s across.tsv body.mts | incise -v -s down.tsv 2> said | mts check | has '4 connected bodies'
    grep -q ' 0 nodes on the edge.*pieces: 4, ' said
    # three half-planes from a line, of which two face one way round it, one the other
    awk 'BEGIN { split("90 210 330", at); for (i = 1; i <= 3; i++) { a = at[i] / 57.29578; p = ".0481 .0527"; q = .0481 + cos(a) " " .0527 + sin(a)
        print i < 2 ? p " -1 " q " -1 " q " 1\n" p " -1 " q " 1 " p " 1" : p " -1 " q " 1 " q " -1\n" p " -1 " p " 1 " q " 1" } }' > three.tsv
    cloud -d 3 -k jittered --jitter 0.14 -n 11 --box 0,0.1,0,0.1,0,0.1 | incise -v -s three.tsv -o cut.mts 2> said
    grep -q ' 0 nodes on the edge.*pieces: 3, ' said
    # in 2D half-lines from a point, each drawn away from it or towards it
    cloud -d 2 -k jittered --jitter 0.15 -n 31 --box 0,0.1,0,0.1 > plate.mts
    for ways in '1 1 1 1' '0 1 1 1' '1 0 1 0' '0 1 0 1'; do
        awk -v ways="$ways" 'BEGIN { split(ways, out); split("1 1 1 -1 -1 -1 -1 1", to); p = ".0481 .0527"
            for (i = 1; i <= 4; i++) { q = to[2 * i - 1] " " to[2 * i]; print out[i] ? p "\n" q "\n" : q "\n" p "\n" } }' > rays.tsv
        incise -v -s rays.tsv -o cut.mts plate.mts 2> said
        grep -q ' 0 nodes on the edge.*pieces: 4, ' said
    done
}

@test "a slit in plane strain opens by 4 (1 - nu^2) sigma a / E in its middle, within 2 %" {
    # a = 10 mm in 80 x 80 mm, h = 1 mm about the slit; on the rim the displacements of the infinite plate (Westergaard)
    cat > slit.geo << 'END'
SetFactory("OpenCASCADE");
Rectangle(1) = {-40, -40, 0, 80, 80};
Physical Surface("body") = {1};
Physical Curve("rim") = {1, 2, 3, 4};
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Field[1] = MathEval;
Field[1].F = "1 + 0.0625 * (Sqrt(x * x + y * y) - 13 + Fabs(Sqrt(x * x + y * y) - 13))";
Background Field = 1;
END
    gmsh -2 -v 1 slit.geo -o slit.msh
    awk 'function put(x, y,  r, t, zr, zi, m, e) { # w = sqrt(z^2 - a^2) on the side of z; 2 G u = (k - 1) / 2 Re s w - y Im Z, 2 G v = (k + 1) / 2 Im s w - y Re Z
            zr = x * x - y * y - 100; zi = 2 * x * y; m = sqrt(sqrt(zr * zr + zi * zi)); t = atan2(zi, zr) / 2
            r = m * cos(t); e = m * sin(t); if (r * x + e * y < 0) { r = -r; e = -e }
            m = r * r + e * e; zr = (x * r + y * e) / m; zi = (y * r - x * e) / m
            print x, y, s * (.4 * r - y * zi) / (2 * G), s * (1.4 * e - y * zr) / (2 * G) }
        BEGIN { OFMT = "%.17g"; OFS = "\t"; s = .3; G = 3000 / 2.6
            for (i = -200; i <= 200; i++) { put(i / 5, -40); put(i / 5, 40); if (i * i < 40000) { put(-40, i / 5); put(40, i / 5) } } }' > rim.tsv
    { block quasi-static | sed 's/nu = .*/nu = 0.3/'; printf '[displacement rim]\nfacets = rim\ntable = rim.tsv\nunit = mm\n[solver]\ntolerance = 1e-5\n'; } > slit.scene
    printf '%s\n' '-10 0' '10 0' > slit.txt
    nodes -u mm slit.msh | incise -s slit.txt -u mm > slit.mts
    [ "$(mts list slit.mts | awk '$1 == "sets.idx" { print $3 }')" = 2 ]
    mtled -q slit.scene slit.mts 2> note > slit.dat
    rows facets.set <(mts text slit.mts) > set
    paste set <(rows facets <(mts text slit.mts)) | awk '$1 > 0 { print $2, $1; print $3, $1 }' | sort -un > lips
    paste <(rows nodes.x slit.dat) <(rows u slit.dat) | awk 'NR == FNR { lip[$1] = $2; next } (FNR - 1) in lip { l = lip[FNR - 1]; x = $1 * $1; if (!(l in best) || x < best[l]) { best[l] = x; v[l] = $4 } }
        END { w = v[1] - v[2]; if (w < 0) w = -w; error = w / (4 * .91 * 1e-4 * .01) - 1; print error; exit !(error < 0 && error > -.02) }' lips -
}

@test "a region is taken out, what lies behind a closed blade, and small pieces; the walls have names" {
    body > body.mts
    incise -v -r lump body.mts 2> said > left.mts
    grep -qE '^incise: lump: [0-9]+ cells taken out$' said
    mts check left.mts
    mts list left.mts | has '^cells.region.*names=body$'
    # five of the six sides of the lump of .03 x .02 x .03 m are within; cells are jittered
    awk -v a="$(size_of 'lump|wall' left.mts)" -v body="$(size_of body body.mts)" -v b="$(size_of body left.mts)" 'BEGIN { exit !(a > 2e-3 && a < 6e-3 && body / b - 1 < 1e-12) }'
    # an octahedron about (.05, .03, .025) of radius .024 m, closed: its inside is taken out, its front face stays
    awk 'BEGIN { r = .024; c[0] = .05; c[1] = .03; c[2] = .025
        for (k = 0; k < 8; k++) { s[0] = k % 2 ? -1 : 1; s[1] = int(k / 2) % 2 ? -1 : 1; s[2] = k > 3 ? -1 : 1; flip = s[0] * s[1] * s[2] < 0
            for (v = 0; v < 3; v++) { i = flip ? 2 - v : v; for (a = 0; a < 3; a++) printf "%g ", c[a] + (a == i ? s[i] * r : 0) } print "" } }' > closed.tsv
    incise -x -s closed.tsv -n bite -v body.mts > bitten.mts 2> said
    grep -q 'incise: pieces taken out: 1, ' said
    mts check bitten.mts
    [ -z "$(size_of 'bite|back' bitten.mts)" ]
    awk -v a="$(size_of 'bite|front' bitten.mts)" -v taken="$(sed -n 's/.*taken out: 1, \([^ ]*\).*/\1/p' said)" 'BEGIN { exit !(a > .88 * .00399 && a < .00399 && taken > .88 * 1.843e-5 && taken < 1.843e-5) }'
    # without -x both faces stay
    [ "$(incise -s closed.tsv body.mts 2> note | mts check | grep -c '2 connected bodies')" = 1 ]
    # a corner of 1 % of the body is cut off: kept, noted where it is less than .1 %, taken out by -l
    printf '%s\n' '.02 -.02 0 -.01 .02 0 -.01 -.01 .03' > corner.tsv
    incise -s corner.tsv body.mts 2> said | mts list > list
    incise -l 2% -s corner.tsv body.mts 2> said > left.mts
    grep -qE 'incise: pieces taken out: 1, ' said
    run -0 mts check left.mts
    refused 2 "nothing is left of the body" incise -l 100% -s corner.tsv body.mts
}

@test "bad blades, and what does not fit: one line each" {
    cloud -d 3 -k regular -n 5 --box 0,0.1,0,0.1,0,0.1 > body.mts
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 > flat.mts
    try() { # TEXT BLADE ARGUMENT...
        printf '%s\n' "$2" > blade.tsv
        refused 2 "$1" incise -s blade.tsv "${@:3}"
    }
    good='.03 .01 .015 .08 .01 .015 .05 .09 .03'
    try "is outside of the body: its box is 1 " "1 0 0 1 1 0 1 0 1" body.mts
    try "opens nothing" "$good" -u mm body.mts
    try "opens nothing" "0 -1 -1 0 3 -1 0 -1 3" body.mts
    try "'furlong'" "$good" -u furlong body.mts
    try "'0'" "$good" -u 0 body.mts
    try "is open" "$good" -x body.mts
    try "tsv:1: column 7: 'nan' is not a finite number" '.03 .01 .01 .05 .01 .01 nan .05 .03' body.mts
    try "tsv:1: triangle without area" '.03 .01 .01 .05 .01 .01 .03 .01 .01' body.mts
    try "facets 1 and 2 cross" '0 0 .02 .1 0 .02 .05 .06 .02
.04 .01 0 .06 .01 .01 .05 .03 .05' body.mts
    try "disagree on the side" '0 0 .02 .1 0 .02 .05 .06 .02
0 0 .02 .1 0 .02 .05 -.06 .02' body.mts
    try "has 9 columns, not 2" "$good" flat.mts
    try "cross" $'0 0\n1 1\n0 1\n1 0' flat.mts
    try "repeats the point" $'0 0\n1 1\n1 1' flat.mts
    try "no section u" "$good" -d body.mts body.mts
    try "percentage" "$good" -l 3 body.mts
    try "no blanks" "$good" -n 'a b' body.mts
    refused 2 "no region 'lump'; there are: body" incise -r lump body.mts
    refused 2 "nothing is left of the body" incise -r body body.mts
    refused 2 "nothing to do" incise body.mts
    refused 2 "-x goes with -s" incise -x -r body body.mts
    # a part that nothing holds is mtled's to refuse
    printf '%s\n' '.05 -1' '.05 1' > blade.txt
    incise -s blade.txt -o cut.mts flat.mts
    { block quasi-static 'gravity = 0, -1'; printf '[displacement left]\nfacets = xmin\ncomponents = 0, 0\n'; } > scene
    refused 1 "nothing holds body 2" mtled scene cut.mts
    mts drop cells body.mts > nodes.mts
    try "no section cells" "$good" nodes.mts
}

# flat_blade N SEED: curves through and in a plate of .1 x .06 m: through, inside, arcs, along a row of nodes, nearly, tangent to the top, branching, bent
flat_blade() {
    awk -v n="$1" -v seed="$2" 'function line(x, y, a, l) { print x - l / 2 * cos(a), y - l / 2 * sin(a); print x + l / 2 * cos(a), y + l / 2 * sin(a) }
        function in_(a, b) { return a + (b - a) * rand() }
        BEGIN { srand(seed); OFMT = CONVFMT = "%.12g"; x = in_(.025, .075); y = in_(.015, .045); a = in_(0, 3.1416)
            if (n < 5) line(x, y, a, .3); else if (n < 9) line(x, y, a, .04)
            else if (n < 13) { r = in_(.01, .045); e = in_(1, 3); for (i = 0; i <= 30; i++) print x + r * cos(a + i * e / 30), y + r * sin(a + i * e / 30) }
            else if (n == 13) { print .02, .03; print .08, .03 } else if (n == 14) { print -.01, .0303; print .11, .0308 }
            else if (n == 15) { print -.01, .0585; print .11, .058 } else if (n == 16) { print .02, .02; print .05, .03; print .08, .031; print ""; print .05, .03; print .045, .05 }
            else if (n == 17) { print .02, .018; print .04, .042; print .06, .018; print .08, .042 } else if (n == 18) line(.05, .03, a, .011)
            else { line(.05, .06, 0, .2) } }'
}

# pressed_open DIM REGION... > SCENE: the faces of the cut k are pushed apart, the rest of the boundary is on springs
pressed_open() {
    printf '[scene]\ndim = %s\nanalysis = quasi-static\n' "$1"
    for region in "${@:2}"; do printf '[material %s]\nregion = %s\nE = 3000\nnu = 0.45\nrho = 1000\n' "$region" "$region"; done
    printf '[support outer]\nfacets = outer\nnormal = 1e5\ntangential = 1e5\n[pressure lips]\nfacets = k|front, k|back\nvalue = 30\n'
}

# solved STREAM SCENE: valid; the computation ends well, so neither face of the cut passes through the other
solved() {
    mts check "$1" > said || { cat said; return 1; }
    mtled -q "$2" "$1" > u.dat 2> note || { cat note; return 1; }
}

@test "twenty blades through a plate of two regions, and pairs that cross: valid streams, all solved" {
    cloud -d 2 -k jittered -n 25,17 --jitter .35 --box 0,.1,0,.06 | tag -r 'lump=box:.04,.02,.07,.04' -f outer=all > body.mts
    pressed_open 2 body lump > open.scene
    for n in {0..18}; do
        flat_blade "$n" "$n" > blade.txt
        incise -l 0.1% -n k -s blade.txt -o cut.mts body.mts 2> said || { echo "blade $n"; cat said; false; }
        solved cut.mts open.scene || { echo "blade $n"; false; }
    done
    flat_blade 19 1 > blade.txt
    refused 2 "opens nothing" incise -s blade.txt body.mts
    for n in {0..8}; do
        flat_blade "$n" "$n" > one.txt
        flat_blade $(((n + 4) % 9)) $((n + 20)) > two.txt
        incise -n k -s one.txt body.mts 2> note | incise -l 0.2% -n k -s two.txt -o cut.mts 2> note
        solved cut.mts open.scene || { echo "blades $n"; false; }
    done
}

# blade N SEED X Y Z SIZE: as pipelines/incision/blade.awk says
blade() { awk -f "$top/pipelines/incision/blade.awk" -v n="$1" -v seed="$2" -v mid="$3 $4 $5" -v size="$6"; }

# blades SIZE FIRST LAST STEP: such blades through body.mts, valid and without a fold; in two the computation is done
blades() {
    read -r -a mid <<< "$2"
    for ((n = $3; n <= $4; n++)); do
        blade "$n" "$n" "${mid[@]}" "$1" > blade.tsv
        incise -l 0.1% -n k -s blade.tsv -o cut.mts body.mts 2> said || { echo "blade $n"; cat said; return 1; }
        mts check cut.mts > said || { echo "blade $n"; cat said; return 1; }
        [[ " $5 " != *" $n "* ]] || solved cut.mts open.scene || { echo "blade $n"; return 1; }
    done
}

@test "twenty blades through a block of two regions, a ball of two shells and a liver: valid streams, solved" {
    cloud -d 3 -k jittered -n 11,9,8 --box 0,0.1,0,0.06,0,0.05 --jitter 0.15 | tag -r 'lump=box:0.04,0.02,0.02,0.07,0.04,0.05' -f outer=all > body.mts
    pressed_open 3 body lump > open.scene
    blades .05 '.05 .03 .0214286' 0 19 '5 10 18'
    for n in 1 10 19; do # two that cross: parts of the lump there are too small for supports of their own; an edge is uncertain
        blade $n $n .05 .03 .0214286 .05 > one.tsv
        blade $(((n + 4) % 20)) $((n + 20)) .05 .03 .0214286 .05 > two.tsv
        incise -n k -s one.tsv body.mts 2> note | incise -l 0.1% -n k -s two.tsv -o cut.mts 2> note
        solved cut.mts open.scene || { echo "blades $n"; false; }
    done
    printf '%s\n' 'SetFactory("OpenCASCADE");' 'Sphere(1) = {0, 0, 0, 40};' 'Sphere(2) = {5, 0, 0, 20};' 'BooleanFragments{ Volume{1}; Delete; }{ Volume{2}; Delete; }' \
        'Physical Volume("core") = {2};' 'Physical Volume("shell") = {3};' 'Mesh.MeshSizeMax = 10;' 'Mesh.MeshSizeMin = 10;' > ball.geo
    gmsh -3 -v 1 ball.geo -o ball.msh
    nodes -u mm ball.msh 2> note | tag -f outer=all > body.mts
    pressed_open 3 core shell > open.scene
    blades .08 '0 0 0' 0 19 '2 8 17'
    voxels -h 18mm -l "$top/examples/liver/labels.tsv" "$top/examples/liver/labels.nii.gz" 2> note | tag -f outer=all > body.mts
    blades .1 '.04 0 .1' 0 14 ''
}

@test "a cut that contact closes under compression: in few steps, the forces of the body that is whole, within .5 %; along faces of the cells only two corners are divided" {
    cloud -d 2 -k jittered -n 15 --jitter .3 --box 0,.1,0,.1 > body.mts
    { pressed_block; printf '[output]\nreactions = yes\n'; } > whole.scene
    { cat whole.scene; printf '[contact lips]\nfacets = cut|front\nagainst = cut|back\n'; } > cut.scene
    mtled -q whole.scene body.mts 2> note | mts print reactions > whole
    for ends in '.02 .0513 .08 .0513' '-.02 .0513 .18 .0513'; do
        xargs -n 2 <<< "$ends" > blade.txt
        incise -s blade.txt body.mts | mtled -v cut.scene 2> note | mts print reactions > cut
        awk -F '\t' '$1 == "force evaluations" { n = $2 } END { exit !(n > 0 && n < 300) }' note
        paste whole cut | awk 'NR < 3 { d = $4 / $2 - 1; if (d > .005 || d < -.005) exit 1 } NR == 3 { if ($2 * $2 < 100) exit 1; n++ } END { exit !n }'
    done
    cloud -d 3 -k regular -n 6 --box 0,.1,0,.1,0,.1 > body.mts
    { pressed_cube zmin zmax -.005; printf '[output]\nreactions = yes\n'; } > whole.scene
    { cat whole.scene; printf '[contact lips]\nfacets = cut|front\nagainst = cut|back\n'; } > cut.scene
    stl "$(panel .02 .02 .04 .06 0 0 0 .06 0)" > blade.stl
    incise -v -s blade.stl -o cut.mts body.mts 2> said
    grep -q 'faces of 0.0036 m2, 12 nodes on the edge; nodes: 2 put on edges, 0 moved, 6 doubled' said
    mtled -q whole.scene body.mts 2> note | mts print reactions > whole
    mtled -q cut.scene cut.mts 2> note | mts print reactions > cut
    paste whole cut | awk 'NR < 3 { d = $6 / $3 - 1; if (d > .005 || d < -.005) exit 1; n++ } END { exit n != 2 }'
}

# pulled_apart DIM > SCENE
pulled_apart() {
    block quasi-static | sed "s/^dim = 2/dim = $1/"
    printf '[displacement %s]\nfacets = %s\ncomponents = %s0.005, free%s\n' left xmin - "${2:-}" right xmax '' "${2:-}"
    printf '[displacement low]\nfacets = ymin\nnormal = 0\n'
}

@test "a cut goes on in the deformed body, from the state before: one edge, where the blade ends; the state of a run from rest" {
    cloud -d 2 -k jittered -n 27,17 --jitter .3 --box 0,.1,0,.06 > body.mts
    pulled_apart 2 > scene
    mtled -q scene body.mts 2> note > u.dat
    for y in .05 .04 .03 .02; do
        printf '%s\n' '.052 .07' ".052 $y" > blade.txt
        incise -s blade.txt -n knife -d u.dat -o cut.mts body.mts
        mts check cut.mts
        # its edge is where the blade ends, in the state before
        interp -f u -u m -p <(mts print nodes.x cut.mts | sed -n "$(($(mts print sets.idx cut.mts) + 1))p") --deformed u.dat |
            mts print x.deformed | awk -v y=$y '{ dx = $1 - .052; dy = $2 - y; if (dx * dx + dy * dy > 1e-6) { print; exit 1 } n++ } END { exit n != 1 }'
        mtled -q -s u.dat scene cut.mts 2> note > next.dat
        mv next.dat u.dat
        mv cut.mts body.mts
    done
    mtled -q scene body.mts 2> note > cold.dat
    fieldcmp cold.dat u.dat | awk -F '\t' '$1 == "max_relative" { exit !($2 < 1e-5) }'
    cloud -d 3 -k jittered -n 11,7,8 --box 0,0.1,0,0.06,0,0.07 --jitter 0.15 > body.mts
    pulled_apart 3 ', free' | sed 's/^facets = ymin/facets = ymin, zmin/' > scene
    mtled -q scene body.mts 2> note > u.dat
    for z in .06 .048 .036; do
        stl "$(panel .047 -.01 $z .001 .1 0 .004 0 .1)" > blade.stl
        incise -s blade.stl -n knife -d u.dat -o cut.mts body.mts
        mts check cut.mts
        # all nodes of the edge are near the end of this blade, none where the last one ended
        mts print sets.idx cut.mts > edge
        mts print nodes.x cut.mts | awk -v z=$z 'NR == FNR { edge[$1]; next } (FNR - 1) in edge { n++; d = $3 - z; if (d * d > .004 ^ 2) { print; bad = 1 } } END { exit bad || n <= 5 }' edge -
        mtled -q -s u.dat scene cut.mts 2> note > next.dat
        mv next.dat u.dat
        mv cut.mts body.mts
    done
}
