# Interfaces between materials of unequal stiffness: supports stop there, and the stress is right on both sides.
# The figures, in 2D and 3D and on a ball of three layers: pipelines/hard/31-interfaces.sh.

load common.bash

# The layers of examples/hard, as body.mts.
layers() {
    gmsh -2 -v 1 -setnumber h 9 "$top/examples/hard/layers.geo" -o layers.msh
    nodes -u mm layers.msh > body.mts
}

# scene SLIDING PUSHED PUSH
scene() {
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n'
    printf '[material %s]\nregion = %s\nE = %s\nnu = %s\nrho = 1000\n' left left 3000 0.49 middle middle 30000 0.3 right right 9000 0.45
    printf '[displacement sliding]\nfacets = %s\nnormal = 0\n[displacement pushed]\nfacets = %s\nnormal = %s\n' "$1" "$2" "$3"
    printf '[output]\nstress = yes\nstrain = yes\nreactions = yes\n[solver]\ntolerance = 1e-10\n'
}

# through OPTIONS OF support: body.mts to u.dat
through() {
    ipoints body.mts | support "$@" | shapefn | mtled -q body.scene > u.dat 2> note
}

# even SECTION LIMIT: its largest deviation from the mean over a region, relative to the largest value of the region, is at most LIMIT.
even() {
    paste <(mts print cells.region u.dat) <(mts print "$1" u.dat) | awk -v limit="$2" '
        {
            n[$1]++
            for (k = 2; k <= NF; k++) {
                sum[$1, k] += $k
                if (n[$1] == 1 || $k < least[$1, k]) least[$1, k] = $k
                if (n[$1] == 1 || $k > most[$1, k]) most[$1, k] = $k
            }
        }
        END {
            for (r in n) {
                size = 0
                for (k = 2; k <= NF; k++) if ((sum[r, k] / n[r]) ^ 2 > size) size = (sum[r, k] / n[r]) ^ 2
                for (k = 2; k <= NF; k++) {
                    spread = (most[r, k] - least[r, k]) / sqrt(size)
                    if (!(spread <= worst)) worst = spread
                }
            }
            print worst
            exit !(NR > 100 && worst <= limit)
        }'
}

@test "in series and side by side: exact in every cell, and not so across the interfaces" {
    layers
    for case in xmin,ymin,ymax:xmax:-0.01 xmin,ymin:ymax:-0.006; do
        IFS=: read -r sliding pushed push <<< "$case"
        scene "$sliding" "$pushed" "$push" > body.scene
        through -i middle,right
        mts check u.dat
        even stress 1e-8
        even strain 1e-8
        mts print u u.dat > named
        # Which regions are named does not matter: the stiffer side owns an interface.
        for names in left,middle right,left,middle; do
            through -i "$names"
            mts print u u.dat | cmp - named
        done
        nodes -u mm layers.msh | mtled -q body.scene 2> note | mts print u - | cmp - named
        through -i none
        run ! even stress 1e-2
    done
}

@test "results say at which interfaces supports stop: evaluated at the nodes they are what they say" {
    layers
    scene xmin,ymin ymax -0.006 > body.scene
    through -i middle
    [ "$(mts print parameters.side u.dat | sort -u | tr '\n' ' ')" = "0 1 " ]
    interp -f u -p u.dat u.dat | mts print u - > at
    mts print u u.dat > given
    paste at given | awk '{ for (k = 1; k <= 2; k++) { d = $k - $(k + 2); if (d * d > 1e-26) bad = 1 } } END { exit bad || NR < 50 }'
    # Without that it is another field.
    mts drop parameters.side u.dat | interp -f u -p u.dat | mts print u - > other
    run cmp -s at other
    [ "$status" -eq 1 ]
}

@test "Gauss points see one side as well" {
    layers
    scene xmin,ymin,ymax xmax -0.01 | sed 's/^nu = .*/nu = 0.3/' > body.scene
    ipoints -g 3 body.mts | support -i middle,right | shapefn | mtled -q body.scene > u.dat
    mts check u.dat
    mts print strain u.dat > with
    ipoints -g 3 body.mts | support -i none | shapefn | mtled -q body.scene 2> note | mts print strain - > without
    grep -q '^mtled: the stiffness jumps 10 : 1 between cells of ' note
    # The strain along x is -.1 in the mean; unevenness of it within a region, in the mean.
    unevenness() {
        paste <(mts print points.cell points.mts) "$1" | awk -v regions="$(mts print cells.region body.mts | tr '\n' ' ')" '
            BEGIN { split(regions, region, " ") }
            { r = region[$1 + 1]; n[r]++; s[r] += $2; q[r] += $2 ^ 2 }
            END { for (r in n) sum += sqrt(q[r] / n[r] - (s[r] / n[r]) ^ 2); print sum }'
    }
    ipoints -g 3 body.mts > points.mts
    awk -v a="$(unevenness with)" -v b="$(unevenness without)" 'BEGIN { print a, b; exit !(a > 0 && a < 0.8 * b) }'
}

@test "a jump across which supports reach is reported: of regions, and of a table of E" {
    layers
    scene xmin,ymin ymax -0.006 > body.scene
    through -i none
    grep -q '^mtled: the stiffness jumps .* : 1 between cells of .* and .* at (0.0[35].*, and supports reach across: .*: .*support without -i' note
    through
    [ ! -s note ]
}

# halves E NU E NU: a square whose halves along x have these moduli, by a table and by two regions; the same field.
halves() {
    mts print points.x table.mts | awk -v m="$*" 'BEGIN { split(m, of, " ") } { k = $1 < 0.05 ? 1 : 3; print $1, $2, of[k], of[k + 1] }' > E.tsv
    { cat rest; printf '[material body]\nregion = body\ntable = E.tsv\nunit = m\n'; } > table.scene
    { cat rest; printf '[material %s]\nregion = %s\nE = %s\nnu = %s\n' body body "$1" "$2" right right "$3" "$4"; } > regions.scene
    for kind in table regions; do
        mtled -q $kind.scene $kind.mts > $kind.dat 2> note
        [ ! -s note ]
    done
    fieldcmp --tol-max 1e-9 table.dat regions.dat
}

@test "a table of E and nu that jumps: the same field as with regions; layers in series" {
    cloud -d 2 -k regular -n 9 --box 0,0.1,0,0.1 | tag -r 'right=half:0.05,0,1,0' 2> note | shapefn > regions.mts 2> note
    cloud -d 2 -k regular -n 9 --box 0,0.1,0,0.1 | shapefn > table.mts 2> note
    printf '[displacement held]\nfacets = xmin, ymin\nnormal = 0\n[displacement pulled]\nfacets = xmax\nnormal = 0.0005\n' > rest
    printf '[output]\nreactions = yes\n[scene]\ndim = 2\nanalysis = quasi-static\n' >> rest
    halves 3000 0.45 90000 0.45
    halves 2980 0.3 2980 0.49
    halves 3000 0 300000 0
    mts print reactions table.dat | awk 'NR == 2 { f = $1 / (0.0005 / (0.05 / 3000 + 0.05 / 300000) * 0.1); print f; exit !(f > 0.99 && f < 1.01) }'
}

@test "bad input: regions, options, damaged sides" {
    layers
    refused 2 "--interface: no region 'centre'; there are: left,middle,right" support -i left,centre body.mts
    refused 2 "--interface: region 'left' stands twice" support -i left,left body.mts
    refused 2 "--interface: no region ''" support -i '' body.mts
    refused 2 "--reach distance acts across the interfaces of -i" support --reach distance -i left body.mts
    cloud -d 2 -k halton -n 50 --box 0,1,0,1 > bare.mts
    refused 2 "no section cells" support -i left bare.mts
    ipoints body.mts | support -t -i middle > lists.txt
    shortened support.side lists.txt > short.txt
    refused 2 "support.side: " shapefn short.txt
    awk '/^# /{ on = $2 == "support.side" } on && /^[0-9]/ && !done { $0 = "-3"; done = 1 } { print }' lists.txt > damaged.txt
    refused 2 "support.side: row 0: no row -3 of cells" shapefn damaged.txt
    run -1 mts check damaged.txt
    [[ $output == *"support.side: row 0: no row -3 of cells"* ]]
}

# In 3D faces between cells share points at the middles of edges; those at an interface do not.
@test "in 3D: layers in series, exact in every cell; again and anew: the same bytes" {
    cloud -d 3 -k jittered -n 8,5,5 --jitter 0.15 --seed 2 --box 0,0.14,0,0.08,0,0.08 > cloud.mts
    mts text cloud.mts | awk '
        # cells on either side of the lattice plane x = 0.06
        /^# nodes.x / { print; on = 1; next }
        /^# / { on = 0 }
        on && NF { if ($1 > 0.05 && $1 < 0.07) $1 = 0.06; x[n++] = $1 }
        /^# cells / { cells = 1; print; next }
        /^# / { cells = 0 }
        cells && NF { side[c++] = x[$1] + x[$2] + x[$3] + x[$4] > 0.24 }
        /^# cells.region / { sub(/names=[^ ]*/, "names=soft,stiff"); print; while ((getline line) > 0 && line != "") ; for (i = 0; i < c; i++) print side[i]; print ""; next }
        { print }' > body.mts
    mts check body.mts
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n' > body.scene
    printf '[material %s]\nregion = %s\nE = %s\nnu = %s\nrho = 1000\n' soft soft 3000 0.3 stiff stiff 30000 0.3 >> body.scene
    printf '[displacement sliding]\nfacets = xmin,ymin,ymax,zmin,zmax\nnormal = 0\n[displacement pushed]\nfacets = xmax\nnormal = -0.01\n' >> body.scene
    printf '[output]\nstress = yes\nstrain = yes\n[solver]\ntolerance = 1e-10\n' >> body.scene
    through
    even stress 1e-8
    through -i none
    run ! even stress 1e-2
    ipoints body.mts > points.mts
    support -i stiff points.mts | mts text | bare > one.txt
    support -i none points.mts | mts text | bare > plain.txt
    support -i stiff points.mts | support -i none | mts text | bare | cmp - plain.txt
    support points.mts | support -i stiff | mts text | bare | cmp - one.txt
}

@test "regions of single cells, slivers among them: their supports reach across" {
    cloud -d 3 -k jittered -n 7 --jitter 0.3 --seed 3 --box 0,1,0,1,0,1 > cloud.mts
    mts text cloud.mts | awk '
        /^# cells.region/ { sub(/names=[^ ]*/, "names=a,b"); on = 1; print; next }
        /^# / { on = 0 }
        on && NF { $0 = int(k++ * 0.6180339887 * 97) % 2 }
        { print }' | ipoints | support | shapefn | mts check
}

# on_levels STEP 'HEIGHTS': the rows of nodes of a plane lattice on standard input, at multiples of STEP, at these heights, in m.
on_levels() {
    mts text | awk -v step="$1" -v heights="$2" '
        BEGIN { split(heights, level, " ") }
        /^# / { on = $2 == "nodes.x" }
        on && /^[0-9]/ { $2 = level[int($2 / step + 1.5)] }
        { print }'
}

# ends_moved Y: a plane scene without materials, one end held and the other moved across.
ends_moved() {
    printf '%s\n' '[scene]' 'dim = 2' 'analysis = quasi-static' '[displacement held]' 'facets = xmin' 'components = 0, 0' \
        '[displacement moved]' 'facets = xmax' "components = 0, $1" '[output]' 'reactions = yes'
}

# A core of two cells across between skins of two flat cells, 1000 times as stiff; one end is held, the other moved across.
@test "a sandwich of few cells: each side of an interface has supports of its own" {
    cloud -d 2 -k regular -n 21,7 --box 0,0.1,0,0.024 | on_levels 0.004 '0 0.001 0.002 0.012 0.022 0.023 0.024' |
        tag -r 'core=box:0,0.002,0.1,0.022' > body.mts 2> note
    { ends_moved 0.0001; printf '[material %s]\nregion = %s\nE = %s\nnu = 0.3\n' core core 1000 skin body 1e6; } > body.scene
    # Quadratic triangles, small strains: 12.206, 12.170, 12.156, 12.151, 12.150 mN/m with 2, 4, .. 32 across.
    mtled -q body.scene body.mts > u.mts 2> note
    mts print reactions u.mts | awk 'NR == 2 { exit !(($2 / 0.01215 - 1) ^ 2 < 0.02 ^ 2) }'
    # A constant radius has none.
    ipoints body.mts | support > lists.mts
    mts list lists.mts | grep -q '^support.sides'
    ipoints body.mts | support -R 6mm > balls.mts
    run -1 grep -q 'sides' <(mts list balls.mts | grep -v '^support.side\b')
    mts text lists.mts | awk '/^# /{ on = $2 == "support.sides" } on && /^[0-9]/ && !done { $3 = "-1"; done = 1 } { print }' > damaged.txt
    refused 2 "support.sides: row 0: " shapefn damaged.txt
    # The result has what its field needs: at the nodes, those on interfaces, too, it is u.
    mts print nodes.x u.mts > points.tsv
    interp -p points.tsv -u m -f u u.mts | mts print u - > again.tsv
    mts print u u.mts | paste - again.tsv | awk '{ if (($2 - $4) ^ 2 > 1e-24) bad = 1 } END { exit bad || NR < 100 }'
}

# A layer that is 1000 times as stiff, with two cells across, each a quarter as thick as long, within a body; its ends are moved along each other.
@test "a thin stiff layer within a soft body: as alone, its supports are as flat as its cells" {
    cloud -d 2 -k regular -n 17,11 --box 0,2,0,1 | on_levels 0.1 '0 0.125 0.25 0.375 0.5 0.53 0.56 0.67 0.78 0.89 1' |
        tag -r 'layer=box:0,0.5,2,0.56' > body.mts 2> note
    { ends_moved 0.01; printf '[material %s]\nregion = %s\nmu = %s\nkappa = %s\n' body body 1000 10000 layer layer 1000000 10000000; } > body.scene
    # Quadratic triangles with linear pressures (Taylor and Hood): 3.6824, 3.5976, 3.5608, 3.5474 N/m with 1, 2, 4, 8 across the layer.
    mtled -q body.scene body.mts 2> note | mts print reactions - | awk 'NR == 2 { exit !(($2 / 3.547 - 1) ^ 2 < 0.05 ^ 2) }'
}
