# [support NAME]: facets on springs and dashpots, against closed forms (more: pipelines/hard/35-around.sh); what it lacks is one line.

load common.bash

setup() { enter_alone; }

# A block with nu = 0 in $dim dimensions: on the ANALYSIS; the sections that are given follow.
scene() {
    block "$1" | sed "s/^dim = 2/dim = $dim/; s/^nu = .*/nu = 0/"
    printf '%b\n' "${@:2}"
}

# table N: a jittered block of 0.1 m as table.mts, turned by $turn radians about x (in 3D), then about z; $n: its last axis.
table() {
    cloud -t -d $dim -k jittered --jitter 0.1 -n "$1" --box 0,0.1,0,0.1$([ $dim = 2 ] || echo ,0,0.1) |
        awk -v turn=$turn -v dim=$dim 'function put(i, j, a, b) { a = $i; b = $j; $i = c * a - s * b; $j = s * a + c * b }
            BEGIN { OFMT = CONVFMT = "%.17g"; c = cos(turn); s = sin(turn) }
            /^#/ { on = $2 == "nodes.x" } on && NF == dim && !/#/ { if (dim == 3) put(2, 3); put(1, 2) } { print }' |
        shapefn > table.mts 2> note
    n=$(awk -v t=$turn -v dim=$dim 'BEGIN { s = sin(t); c = cos(t); CONVFMT = "%.17g"
        if (dim == 2) print -s ", " c; else print s * s ", " (-s * c) ", " c }')
}

# drift: the largest error of the energy balance in u.dat is below 1e-3, and what has been dissipated in the end is $1 to 1 %.
drift() {
    mts print energy u.dat | awk -v wanted="$1" '{ if ($7 ^ 2 > 1e-6) bad = 1 }
        END { print "dissipated " $6; exit bad || NR < 100 || !(($6 - wanted) ^ 2 <= (0.01 * wanted) ^ 2) }'
}

@test "a block that is pressed sinks by p / k more, however it is turned: 2D and 3D; supports on one facet add" {
    for dim in 2 3; do
        low=$([ $dim = 2 ] && echo ymin || echo zmin)
        for turn in 0 0.4; do
            table 6
            scene quasi-static "[support ground]\nfacets = $low\nnormal = 30000" "[support more]\nfacets = $low\nnormal = 20000" \
                "[support aside]\nfacets = $low\ntangential = 1" "[traction top]\nfacets = ${low/min/max}\ncomponents = $n\ncurve = load.tsv" \
                "[output]\nreactions = yes\n[solver]\ntolerance = 1e-9" > run.scene
            printf '0 0\n1 -30\n' > load.tsv
            mtled run.scene table.mts > u.dat
            paste -d ' ' <(mts print nodes.x u.dat) <(mts print u u.dat) | awk -v n="$n" -v dim=$dim -v turn=$turn 'BEGIN { split(n, a, ", ") }
                { x = u = 0; for (i = 1; i <= dim; i++) { x += $i * a[i]; u += $(dim + i) * a[i] } }
                x < 1e-9 { count++; d = u * 50000 / 30 + 1; if (d ^ 2 > 1e-12) { bad = 1; print "off " d " at " turn } }
                END { exit bad || count != 6 ^ (dim - 1) }'
            mts print reactions u.dat | awk -v n="$n" -v dim=$dim -v turn=$turn 'BEGIN { split(n, a, ", ") }
                { f = 0; for (i = 1; i <= dim; i++) f += $i * a[i]; d = f / (0.1 ^ (dim - 1) * (NR == 1 ? 18 : 12)) - 1
                  if (NR < 3 && d ^ 2 > 1e-10) bad = 1 }
                END { exit bad || NR != 3 }'
        done
    done
}

@test "supports alone hold a body; one that lets it slide or lift does not; neither are they springs of points" {
    turn=0
    for dim in 2 3; do
        table 5
        load='[traction top]\nfacets = xmax\ncomponents = 10, 0'$([ $dim = 2 ] || echo ', 0')
        scene quasi-static '[support all]\nfacets = *\nnormal = 1e4' "$load" > run.scene
        mtled -v run.scene table.mts 2> said > u.dat
        run -1 grep springs said
        for keys in 'normal = 1e4' 'tangential = 1e4'; do
            scene quasi-static "[support one]\nfacets = xmin\n$keys" "$load" > run.scene
            refused 1 'nothing holds the body: it may move along (' mtled run.scene table.mts
        done
    done
}

@test "dynamics: a block that bounces on a support with dashpots: closed form, dissipated work, the balance, the bytes of a restart" {
    dim=2 turn=0
    table 8
    motion='[traction top]\nfacets = ymax\ncomponents = 0, -1\ncurve = step\n[output]\nenergy = yes\n[solver]\nend_time = 1'
    for damping in 0 100; do
        # 100 kg/m2 on 1000 Pa/m and 100 Pa s/m, under 1 Pa; stiff enough to be rigid.
        scene dynamic "[support ground]\nfacets = ymin\nnormal = 1000\ntangential = 1000\ndamping = $damping" "$motion" | sed 's/^E = .*/E = 3e5/' > run.scene
        mtled run.scene table.mts > u.dat
        read -r u lost < <(awk -v c=$damping 'BEGIN { g = c / 200; w = sqrt(10 - g * g)
            for (i = 0; i <= 10000; i++) { t = i / 10000; e = exp(-g * t); u = -0.001 * (1 - e * (cos(w * t) + g / w * sin(w * t)))
                v = -0.01 / w * e * sin(w * t); lost += 0.1 * c * v * v / 10000 } print u, lost }')
        mts print u u.dat | awk -v u="$u" '{ d = $2 / u - 1; if (d ^ 2 > 1e-4) bad = 1 } END { exit bad || NR != 64 }'
        drift "$lost"
    done
    goes_on u.dat run.scene
    # Dashpots alone: p / c (t - m / c (1 - exp(-c t / m)))
    sed -i '/^normal = 1000/d; /^tangential/d' run.scene
    mtled run.scene table.mts | mts print u | awk '{ d = $2 / (-0.01 * exp(-1)) - 1; if (d ^ 2 > 1e-4) bad = 1 } END { exit bad || NR != 64 }'
    # Dashpots as stiff as they like need no shorter steps, also beside a displacement.
    scene dynamic '[support ground]\nfacets = ymin\nnormal = 1000\ndamping = 1e9' '[displacement side]\nfacets = xmin\ncomponents = 1e-4, 1e-4' "$motion" > stiff.scene
    mtled stiff.scene table.mts > u.dat
    mts print energy u.dat | awk '{ if ($7 ^ 2 > 1e-6) bad = 1 } END { print "dissipated " $6; exit bad || !($6 > 0) }'
}

@test "what is wrong with a support is one line with its key" {
    dim=2 turn=0
    table 3
    try() { # MESSAGE LINES
        scene quasi-static "[support ground]" "$2" > run.scene
        refused 2 "run.scene:$1" mtled run.scene table.mts
    }
    try '11: [support ground]: facets: missing' 'normal = 1'
    try "11: [support ground]: no facet group 'roof'; there are: " 'facets = roof\nnormal = 1'
    try '11: [support ground]: normal and tangential: both are 0: give a stiffness in Pa/m' 'facets = ymin\nnormal = 0'
    try '13: [support ground]: normal: -1 is not at least 0' 'facets = ymin\nnormal = -1\ntangential = 1'
    try "13: [support ground]: tangential: 'nan' is not a finite number" 'facets = ymin\ntangential = nan'
    try '14: [support ground]: damping: not allowed: a quasi-static scene has no velocities' 'facets = ymin\nnormal = 1\ndamping = 1'
    try '13: [support ground]: stiffness: unknown key: allowed are facets, normal, tangential, damping' 'facets = ymin\nstiffness = 1'
}

# All facets move as x does in (1.1, .2; 0, 1): the skin on the sides xmax and ymax of a block at nu = 0 has E t (1 + .2^2 - 1)^2 / 8 and E t (1.1^2 - 1)^2 / 8.
@test "a membrane on sides whose displacement varies: its energy is exact" {
    dim=2 turn=0
    table 4
    printf '%s\n' '0 0 0 0' '.1 0 .01 0' '0 .1 .02 0' '.1 .1 .03 0' | awk '{ for (i = -1; i < 2; i++) for (j = -1; j < 2; j++) {
        x = $1 + i * .05; y = $2 + j * .05; if (!((x, y) in seen)) print x, y, .1 * x + .2 * y, 0; seen[x, y] = 1 } }' > shear.tsv
    scene quasi-static '[displacement a]\nfacets = *\ntable = shear.tsv\nunit = m' '[output]\nenergy = yes' > bare.scene
    { cat bare.scene; printf '[membrane skin]\nfacets = xmax, ymax\nthickness = 1e-3\nE = 1e6\nnu = 0\n'; } > skin.scene
    for run in bare skin; do mtled $run.scene table.mts | mts print energy; done |
        awk '{ e[NR] = $1 } END { want = 1e3 * .1 / 8 * (.04^2 + .21^2); print e[2] - e[1], want; exit !(((e[2] - e[1]) / want - 1)^2 < 1e-16) }'
}

@test "a membrane: the balance in time; what is wrong with it is one line" {
    cat > ring.geo << 'END'
Point(1)={0,0,0}; Point(2)={50,0,0}; Point(3)={-50,0,0}; Point(4)={100,0,0}; Point(5)={-100,0,0};
Circle(1)={2,1,3}; Circle(2)={3,1,2}; Circle(3)={4,1,5}; Circle(4)={5,1,4}; Curve Loop(1)={3,4}; Curve Loop(2)={1,2}; Plane Surface(1)={1,2};
Physical Surface("body")={1}; Physical Curve("out")={3,4}; Physical Curve("in")={1,2};
END
    dim=2
    scene quasi-static '[membrane skin]\nfacets = out\nthickness = 1e-4\nE = 1e6\nnu = 0.4' '[support weak]\nfacets = in\nnormal = 0.01\ntangential = 0.01' \
        '[pressure in]\nfacets = in\nvalue = 0.03' | sed 's/^nu = 0$/nu = 0.3/' > ring.scene
    gmsh -v 1 -2 ring.geo -clmax 6 -clmin 6 -o ring.msh
    nodes -u mm ring.msh 2> note | shapefn > table.mts 2> note
    sed 's/quasi-static/dynamic/; s/^value.*/value = 200/; $ a [output]\nenergy = yes\n[solver]\nend_time = 0.1' ring.scene > moving.scene
    mtled moving.scene table.mts > u.dat
    mts print energy u.dat | awk '{ if ($7 ^ 2 > 1e-6) bad = 1 } END { exit bad || NR < 100 }'
    # Prestress S t alone, pressing with S t / R as it grows: Lame's ring with the springs inside taken as free; and the work of its growth in time.
    sed 's/^value.*/value = 0/; /^nu = 0.4/a prestress = 300' ring.scene > tense.scene
    mtled tense.scene table.mts > u.dat
    paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '
        BEGIN { b = 0.1; k = 1e2 / 0.84 / b ^ 2 * 1.3 / 3000; B = -0.3 / ((1 + k * 0.4 * b) * 400 - 100 + k / b); lame = 1.3 / 3000 * (0.4 * B * 400 * b + B / b) }
        (r = sqrt($1 ^ 2 + $2 ^ 2)) > 0.0999 { sum += ($3 * $1 + $4 * $2) / r / lame; n++ } END { print sum / n; exit !((sum / n - 1) ^ 2 < 1e-4) }'
    sed 's/quasi-static/dynamic/; s/^prestress.*/prestress = 1e5/; $ a [output]\nenergy = yes\n[solver]\nend_time = 0.1' tense.scene > moving.scene
    mtled moving.scene table.mts > u.dat
    mts print energy u.dat | awk '{ if ($7 ^ 2 > 1e-6) bad = 1 } END { exit bad || NR < 100 || !($5 < 0) }'
    for bad in prestress=-1 curve=linear thickness=0 E=-1 nu=0.6 nu=nan thickness= facets=roof; do
        sed "/^\[membrane/,/^nu/s/^${bad%=*} = .*/#/; s/^\[membrane.*/&\n${bad/=/ = }/" ring.scene > wrong.scene
        refused 2 '[membrane skin]: ' mtled wrong.scene table.mts
    done
}
