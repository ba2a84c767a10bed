# Contact with rigid surfaces: its stiffness, what holds a body, surfaces out of reach, penetration.

load common.bash

setup() { enter_alone; }

@test "the default stiffness keeps a disc out on a graded body as it does on an even one" {
    awk 'BEGIN { for (i = -24; i <= 24; i++) { a = i * 0.05; printf "%.12g %.12g\n", 0.1 * sin(a), 0.1 * cos(a) - 0.1 } }' > disc.tsv
    for kind in 'regular -n 41' 'graded -n 21 --ratio 6'; do
        # shellcheck disable=SC2086
        cloud -d 2 -k $kind --box 0,0.2,0,0.2 | shapefn > block.mts 2> note
        { block quasi-static && printf '[displacement far]\nfacets = ymax\ncomponents = 0, 0\n[displacement x]\nfacets = xmin\nnormal = 0\n'
            printf '[contact disc]\nfacets = ymin\nrigid = disc.tsv\nunit = m\nside = left\ntranslation = 0, 0.01\ncurve = linear\n'
            printf '[output]\nreactions = yes\ngaps = yes\n[solver]\ntolerance = 1e-4\n'; } > disc.scene
        mtled disc.scene block.mts 2> said > u.dat
        [ ! -s said ]
        # At the end of the patch a node presses with a part of its facets.
        rows gaps u.dat | awk '$3 < -5e-5 { bad = 1 } $4 > 0 && $3 > 5e-5 { ends++ } END { exit bad || ends > 1 }'
        rows reactions u.dat | awk 'NR == 3 { print $2 }' >> forces
    done
    cat forces
    awk '{ f[NR] = $1 } END { d = f[1] / f[2] - 1; exit !(f[1] > 1 && d < 0.02 && d > -0.02) }' forces
}

# notes TEXT: the run is good, and all that is said is TEXT, which may be nothing.
notes() {
    run -0 --separate-stderr mtled lid.scene block.mts
    [ "$stderr" = "$1" ]
}

# lid LINES: a square of 0.1 m on its bottom; a rigid surface, as the lines of its section say, above it.
lid() {
    cloud -d 2 -k regular -n 8 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    { block quasi-static && held_below && printf '[contact lid]\nfacets = ymax\nside = right\n' && printf '%s\n' "$@"; } > lid.scene
}

@test "a disc that sinks into a cup not much larger comes to rest, and weighs what it weighs" {
    # Nodes lie in the creases of the wall's polygon.
    for case in '51 7' '52 4'; do
        read -r cup size <<< "$case"
        printf 'SetFactory("OpenCASCADE");Disk(1)={0,0,0,.05};Rectangle(4)={0,-1,0,1,2};\n' > disc.geo
        printf 'BooleanIntersection(5)={Surface{1};Delete;}{Surface{4};Delete;};Physical Surface("body")={5};\n' >> disc.geo
        gmsh -v 1 -2 -clmin "${size}e-3" -clmax "${size}e-3" disc.geo -o disc.msh
        nodes -u m disc.msh 2> note | tag -f sx=plane:0,0,1,0 -f 'out=all without sx' | shapefn > disc.mts 2> note
        awk -v R="$cup" 'BEGIN { for (i = 0; i < 400; i++) { t = -3.24159265358979 + 3.34159265358979 * i / 399; printf "%.12g %.12g\n", R * cos(t), R - 50 + R * sin(t) } }' > cup.tsv
        { block quasi-static 'gravity = 0, -9.81' | sed 's|^nu = .*|nu = 0.49|'; printf '[displacement sx]\nfacets = sx\nnormal = 0\n'
            printf '[contact cup]\nfacets = out\nrigid = cup.tsv\nunit = mm\nside = left\n[output]\nreactions = yes\n[solver]\nmax_steps = 1000\n'; } > cup.scene
        mtled cup.scene disc.mts > u.dat
        # A polygon is a little less than a disc.
        rows reactions u.dat | awk 'NR == 2 { print $2; exit !($2 < 38.52 && $2 > 38.25) }'
    done
}

@test "a ball that plates hold does not roll onto its facets: the force of an eighth of it; an ellipse turns" {
    printf 'SetFactory("OpenCASCADE");\nSphere(1) = {0, 0, 0, 10};\nPhysical Volume("body") = {1};\n' > ball.geo
    gmsh -v 1 -3 -clmin 2.5 -clmax 2.5 ball.geo -o ball.msh
    nodes -u mm ball.msh 2> note | shapefn > ball.mts 2> note
    printf -- '-30 -30 -10 30 -30 -10 30 30 -10\n-30 -30 -10 30 30 -10 -30 30 -10\n' > lower.tsv
    printf -- '-30 -30 10 30 30 10 30 -30 10\n-30 -30 10 -30 30 10 30 30 10\n' > upper.tsv
    plates() { # SIDE MOTION
        printf '[contact %s]\nfacets = *\nrigid = %s.tsv\nunit = mm\nside = '"$1"'\n' lower lower upper upper
        printf 'translation = %s\ncurve = linear\n[output]\nreactions = yes\n' "$2"
    }
    { block quasi-static | sed 's/^dim = 2/dim = 3/'; plates front '0, 0, -0.004'; } > z.scene
    { block quasi-static | sed 's/^dim = 2/dim = 3/'; plates front '-0.004, 0, 0'; } > x.scene
    for axis in z x; do # two orientations of the mesh
        mtled "$axis.scene" ball.mts > u.dat
        rows reactions u.dat | awk -v a="$axis" 'NR == 1 { f = a == "z" ? $3 : $1; print f; exit !(f > 0.0569 && f < 0.0592) }'
        awk '{ print $3, $1, $2, $6, $4, $5, $9, $7, $8 }' lower.tsv > turned && mv turned lower.tsv
        awk '{ print $3, $1, $2, $6, $4, $5, $9, $7, $8 }' upper.tsv > turned && mv turned upper.tsv
    done
    printf -- '-30 -10\n30 -10\n' > lower.tsv
    printf -- '30 10\n-30 10\n' > upper.tsv
    { block quasi-static; plates left '0, -0.004'; } > disc.scene
    for turn in 0.3 0.6; do
        printf 'SetFactory("OpenCASCADE");\nDisk(1) = {0, 0, 0, 12, 10};\nRotate {{0, 0, 1}, {0, 0, 0}, %s} {Surface{1};}\nPhysical Surface("body") = {1};\n' "$turn" > ellipse.geo
        gmsh -v 1 -2 -clmin 2 -clmax 2 ellipse.geo -o ellipse.msh
        nodes -u mm ellipse.msh 2> note | shapefn 2> note | mtled disc.scene > u.dat
        rows reactions u.dat | awk 'NR == 1 { print $2; exit !($2 > 9.65 && $2 < 9.85) }' # long axis along the plates
    done
}

@test "a rigid surface that is never touched is told" {
    # Beside the body, level with its top.
    lid 'rigid = plate.tsv' 'unit = mm' 'translation = 0, -0.01' 'curve = linear'
    printf '%s\n' '200 100' '1000 100' > plate.tsv
    notes 'mtled: lid.scene: [contact lid]: the body never touches the rigid surface: has that the right unit and place, and does it begin outside the body?'
    # A plate that presses, and leaves again, has touched.
    lid 'rigid = plate.tsv' 'unit = mm' 'translation = 0, -0.01' 'curve = there.tsv'
    printf '%s\n' '-10 100' '110 100' > plate.tsv
    printf '%s\n' '0 0' '0.4 1' '0.8 -1' '1 -1' > there.tsv
    notes ''
    # A box that lies in the body from the beginning.
    lid 'rigid = box.tsv' 'unit = mm'
    printf '%s\n' '40 40' '60 40' '60 60' '40 60' '40 40' > box.tsv
    notes 'mtled: lid.scene: [contact lid]: the body never touches the rigid surface: has that the right unit and place, and does it begin outside the body?'
}

@test "contacts that penetrate: a verdict with its cause; in time a note" {
    printf '%s\n' '-1 0.1' '1 0.1' > plate.tsv
    lid 'rigid = plate.tsv' 'unit = m' 'translation = 0, -0.01' 'curve = linear' 'stiffness = 1'
    refused 1 'lid.scene: contacts penetrate by 0.0' mtled lid.scene block.mts
    [[ "$stderr" == *' m, most [contact lid], so that forces are too small by about 1e+02 %: leave its stiffness out,'* ]]
    lid 'rigid = plate.tsv' 'unit = m' '[displacement top]' 'facets = ymax' 'components = 0, 0.001'
    run -1 --separate-stderr mtled lid.scene block.mts
    [[ "$stderr" == *'leave facets that a [displacement] moves out of it'* ]]
    lid 'rigid = plate.tsv' 'unit = m' 'translation = 0, -0.01' 'curve = smooth'
    notes ''
    sed -i 's/quasi-static/dynamic/' lid.scene
    printf '[solver]\nend_time = 0.5\ndamping = 60\n' >> lid.scene
    mtled lid.scene block.mts 2> said > u.dat
    [[ "$(cat said)" == 'mtled: lid.scene: contacts penetrate by '*' m, not '*' m, most [contact lid]: a larger stiffness, with shorter steps, or a finer cloud there helps' ]]
}

@test "a body that no contact presses at the end, and that nothing else holds, is told" {
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    printf '%s\n' '0.1 -1' '0.1 1' > plate.tsv
    { block quasi-static && printf '[output]\nframes = 1\n' # at rest, where the side is on the plate to round-off, none is told
        printf '[displacement y]\nfacets = ymin\nnormal = 0\n[contact x]\nfacets = xmax\nrigid = plate.tsv\nunit = m\nside = left\ntranslation = -0.01, 0\ncurve = smooth\n'; } > lid.scene
    notes 'mtled: lid.scene: at the end no contact presses the body, which nothing else holds: it may move along (1, 0), and lies anywhere; it may have slipped out of its contacts or turned over: frames show when'
    printf '%s\n' '0.0999999 -1' '0.0999999 1' > plate.tsv # the side begins behind it: no penetration of frame 0
    printf '[displacement held]\nfacets = xmin\nnormal = 0\n' >> lid.scene
    notes ''
}

@test "a block that walls enclose, at a pressure of 20 shear moduli: the closed form" {
    cloud -d 2 -k jittered -n 9 --jitter 0.15 --seed 3 --box 0,0.1,0,0.1 | shapefn > square.mts 2> note
    printf '%s\n' '0.1 -1' '0.1 1' > x.tsv
    printf '%s\n' '1 0.1' '-1 0.1' > y.tsv
    { block quasi-static | sed "s/^nu = .*/nu = 0.4999/"
        printf '[displacement x]\nfacets = xmin\nnormal = 0\n[displacement y]\nfacets = ymin\nnormal = 0\n[output]\nreactions = yes\n'
        printf '[contact x]\nfacets = xmax\nrigid = x.tsv\nunit = m\nside = left\ntranslation = -0.0002, 0\ncurve = smooth\n'
        printf '[contact y]\nfacets = ymax\nrigid = y.tsv\nunit = m\nside = left\ntranslation = 0, -0.0002\ncurve = smooth\n'; } > square.scene
    mtled square.scene square.mts 2> note > u.dat
    # the law's stress at stretches of .998, .998, 1
    rows reactions u.dat | awk 'NR == 1 { d = $1 / 1994.1378 - 1; print; exit !(d * d < 2e-3 ^ 2) }'
}

@test "a block that only four walls hold, two of which close by 40 %: the closed form" {
    cloud -d 2 -k regular -n 7 --box 0,0.1,0,0.1 | shapefn > square.mts 2> note
    printf '0 1\n0 -1\n' > xmin.tsv
    printf -- '-1 0\n1 0\n' > ymin.tsv
    printf '0.1 -1\n0.1 1\n' > xmax.tsv
    printf '1 0.1\n-1 0.1\n' > ymax.tsv
    { block quasi-static && printf '[output]\nreactions = yes\n'
        for wall in 'xmin 0, 0' 'ymin 0, 0' 'xmax -0.04, 0' 'ymax 0, -0.04'; do
            printf '[contact %s]\nfacets = %s\nrigid = %s.tsv\nunit = m\nside = left\ntranslation = %s\ncurve = smooth\n' "${wall%% *}" "${wall%% *}" "${wall%% *}" "${wall#* }"
        done; } > walls.scene
    mtled walls.scene square.mts 2> note > u.dat
    # the law's stress at stretches of .6, .6, 1
    rows reactions u.dat | awk '{ d = ($1 + $2) ^ 2 / 456.6797 ^ 2 - 1; bad += d * d > 1e-4 ^ 2 } END { exit bad || NR != 4 }'
}

@test "an asterisk is the whole boundary, of a mesh without names as well: a disc rests in a groove" {
    # On cells of 10 mm round-off decides whether points go from facet to facet: the state is then accepted at 5e-4, which is told.
    printf 'SetFactory("OpenCASCADE");\nDisk(1) = {0, 0, 0, 50};\nMesh.MeshSizeMin = 9;\nMesh.MeshSizeMax = 9;\n' > disc.geo
    gmsh -v 1 -2 disc.geo -o disc.msh
    nodes -u mm disc.msh 2> said > disc.mts
    tag -f skin=all < disc.mts > named.mts
    printf -- '-200 129.289\n0 -70.711\n200 129.289\n' > groove.tsv
    { block quasi-static 'gravity = 0, -9.81'
        printf '[contact groove]\nfacets = *\nrigid = groove.tsv\nunit = mm\nside = left\n[output]\nreactions = yes\n'; } > whole.scene
    sed 's/^facets = \*/facets = skin/' whole.scene > skin.scene
    shapefn < disc.mts 2> said | mtled whole.scene > whole.dat 2> said
    printf -- '-200 129.289\n0 -70.711\n\n0 -70.711\n200 129.289\n' > sides.tsv # in two parts, the same surface
    sed 's/groove.tsv/sides.tsv/' whole.scene > sides.scene
    shapefn < disc.mts 2> said | mtled sides.scene 2> said | cmp <(rows u whole.dat) <(rows u)
    shapefn < named.mts 2> said | mtled skin.scene > skin.dat 2> said
    cmp <(rows u whole.dat) <(rows u skin.dat)
    sides=$(mts text named.mts | rows facets | wc -l)
    rows reactions whole.dat | awk -v n="$sides" 'BEGIN { pi = atan2(0, -1); weight = 9810 * n / 2 * 0.05 ^ 2 * sin(2 * pi / n) }
        { d = $2 / weight - 1; print $2, weight; exit !(d < 1e-3 && -d < 1e-3) }'
}

@test "the result under a large pressure does not depend on steps of the load, nor on the tolerance" {
    gmsh -2 -v 1 -setnumber h 0.008 -setnumber rim 0.2 "$top/examples/hard/block.geo" -o block.msh
    nodes -u m block.msh | shapefn > block.mts 2> note
    printf -- '-1 0.05\n1 0.05\n' > plate.tsv
    { block quasi-static | sed 's/^nu = .*/nu = 0.49/'
        printf '[displacement symmetry]\nfacets = xmin\nnormal = 0\n[displacement middle]\nfacets = middle\nnormal = -0.025\n'
        printf '[displacement plate]\nfacets = plate\ncomponents = 0, 0\n[contact side]\nfacets = xmax\nrigid = plate.tsv\nunit = m\nside = right\n'; } > press.scene
    for case in '1e-7 1' '1e-7 5' '1e-5 1'; do
        read -r tolerance frames <<< "$case"
        { cat press.scene && printf '[output]\nframes = %s\n[solver]\ntolerance = %s\n' "$frames" "$tolerance"; } > "$tolerance-$frames.scene"
        mtled "$tolerance-$frames.scene" block.mts > "$tolerance-$frames.dat"
    done
    for other in 1e-7-5 1e-5-1; do
        fieldcmp $other.dat 1e-7-1.dat | awk '$1 == "max" { print $2; exit !($2 < 2.5e-6) }' # 1e-4 of the push; 3.2e-6 and 5.6e-6 if a penalty stays what it was on the way
    done
}
