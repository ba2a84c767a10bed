# Loads and contacts of a scene: what presses on a body is what holds it, whatever kind of load it is; and each fault in a
# section of them is one line that names it.

load common.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    square_msh
    nodes -u mm body.msh 2> note | shapefn > square.mts 2> note
}

setup() {
    enter_alone
    cp "$BATS_FILE_TMPDIR"/{body.msh,square.mts} .
    { block quasi-static && held_below && walls; } > held.scene
}

# Sides that slide along rigid plates: the top stays as long as it is.
walls() { printf '[displacement sides]\nfacets = xmin, xmax\nnormal = 0\n'; }

# solved LINES...: the scene of the held block with these lines; leaves u.dat, with reactions.
solved() {
    { cat held.scene; printf '%b\n' "$@"; printf '[output]\nreactions = yes\n'; } > run.scene
    grep -q '^\[solver' run.scene || printf '[solver]\ntolerance = 1e-7\n' >> run.scene
    mtled run.scene "${stream:-square.mts}" > u.dat 2> note
}

# holds FORCE...: what the section `bottom` carries, per component, to 1e-6 of the largest one.
holds() {
    rows reactions u.dat | head -n 1 | awk -v wanted="$*" '
        { n = split(wanted, w)
          for (i = 1; i <= n; i++) if ((a = w[i] < 0 ? -w[i] : w[i]) > scale) scale = a
          for (i = 1; i <= n; i++) { d = $i - w[i]; if (!(d <= 1e-6 * scale && -d <= 1e-6 * scale)) bad = 1 }
          print "holds " $0 ", to be " wanted }
        END { exit bad || NF != n || NR != 1 }'
}

# near KIND TOLERANCE: u.dat is other.dat to so many metres, at the worst node (max) or on average (avg).
near() { fieldcmp "--tol-$1" "$2" other.dat u.dat > /dev/null; }

@test "traction, pressure, weight: the bottom holds what the top is loaded with" {
    solved '[traction top]\nfacets = ymax\ncomponents = 0, -300'
    holds 0 30
    cp u.dat other.dat
    solved '[pressure top]\nfacets = ymax\nvalue = 300' # between walls the top stays flat and as long
    holds 0 30
    near max 1e-7 # of 0.6 mm
    { block quasi-static 'gravity = 0, -9.81' && held_below; } > held.scene
    solved
    holds 0 98.1
}

@test "in time a body comes to rest under its weight as it does in a static scene" {
    { block quasi-static 'gravity = 0, -9.81' && held_below; } > held.scene
    solved && cp u.dat other.dat
    { block dynamic 'gravity = 0, -9.81' && held_below; printf '[solver]\nend_time = 2\ndamping = 20\n'; } > held.scene
    solved && near max 1e-7 # of 10 mm
}

@test "groups of one section that overlap: a pressure, a traction, a contact acts once on each facet" {
    stream=capped.mts
    nodes -u mm body.msh 2> note | tag -f cap=ymax 2> note > capped.mts
    printf -- '-1 0.095\n2 0.095\n' > roof.tsv
    for load in '[pressure a]\nvalue = 300' '[traction a]\ncomponents = 0, -300' '[contact a]\nrigid = roof.tsv\nunit = m\nside = right'; do
        solved "$load\nfacets = ymax" && cp u.dat other.dat
        solved "$load\nfacets = ymax, cap" && near max 0
    done
}

# immersed DIM LEVEL [LINES...]: a block of 0.1 m on a wall below, between walls that it slides along, as heavy as the fluid it stands in, which
# is so deep and does not get under it; leaves u.dat
immersed() {
    local walls='xmin, xmax' top=ymax
    local level="0.05, $2" gravity='0, -9.81' box=0,0.1,0,0.1 count=13 # so many that the nodes' mean is the top's
    [ "$1" = 2 ] || { walls="$walls, ymin, ymax" top=zmax level="0.05, 0.05, $2" gravity="0, 0, -9.81" box=$box,0,0.1 count=11; }
    cloud -d "$1" -k jittered -n $count --box $box --jitter 0.1 | shapefn > table.mts 2> note
    {
        block quasi-static "gravity = $gravity" | sed "s/^dim = 2/dim = $1/"
        printf '[displacement walls]\nfacets = %s\nnormal = 0\n[displacement bottom]\nfacets = %s\nnormal = 0\n' "$walls" "${top/max/min}"
        printf '[pressure fluid]\nfacets = %s\ndensity = 1000\nlevel = %s\n' $top "$level"
        printf '%b\n' "${@:3}" '[output]\nreactions = yes\npressure = yes\n[solver]\ntolerance = 1e-8\n'
    } > run.scene
    mtled run.scene table.mts > u.dat
}

# On the top as deformed: the bottom bears the weight, and the fluid above the top.
@test "a fluid that stands above: its weight on the deformed top, in 2D and 3D; nothing where its level is below" {
    for dim in 2 3; do
        immersed $dim 0.3
        rows reactions u.dat > forces
        moved=$(paste -d ' ' <(mts print nodes.x u.dat) <(mts print u u.dat) | awk -v d=$dim '$d > 0.0999 { s += $(2 * d); n++ } END { print s / n }')
        awk -v d=$dim -v moved="$moved" 'NR == 2 {
            area = 0.1 ^ (d - 1); to_be = 9810 * area * (0.1 + 0.2 - moved)
            e = $d / to_be - 1; print $d, to_be; exit !(e < 2e-5 && e > -2e-5 && moved < -0.001) }' forces
        immersed $dim 0.05
        rows reactions u.dat | awk -v d=$dim 'NR == 2 { e = $d / (9810 * 0.1 ^ d) - 1; exit !(e < 1e-6 && e > -1e-6) }'
        # hanging from above, where the level is: the same with the other sign
        immersed $dim 0.05 'side = above'
        rows reactions u.dat | awk -v d=$dim 'NR == 2 { f = $d / (9810 * 0.1 ^ (d - 1)); print f; exit !(f < 0.1 - 0.049 && f > 0.1 - 0.051) }'
    done
}

@test "a fluid on all sides of a body that is as heavy: it floats; half immersed: half of its weight; any direction of gravity" {
    cloud -d 3 -k jittered -n 6 --box 0,0.1,0,0.1,0,0.1 --jitter 0.1 | shapefn > table.mts 2> note
    for level in 0.16 0.05; do
        {
            block quasi-static 'gravity = 0, 0, -9.81' | sed 's/^dim = 2/dim = 3/; s/^E = .*/E = 300000/'
            printf '[displacement point]\npoints = hold.tsv\nunit = m\n[pressure fluid]\nfacets = xmin, xmax, ymin, ymax, zmin, zmax\ndensity = 1000\n'
            printf 'level = 0, 0, %s\n[output]\nreactions = yes\nmoments = yes\nmoments_about = 0.05, 0.05, 0.05\n[solver]\ntolerance = 1e-8\n' $level
        } > run.scene
        printf '0.02 0.03 0.05 0 0 0\n0.08 0.03 0.05 0 0 0\n0.05 0.08 0.05 0 0 0\n' > hold.tsv
        mtled run.scene table.mts > u.dat
        rows reactions u.dat | awk -v immersed="$(awk -v l=$level 'BEGIN { print (l > 0.1 ? 0.1 : l) }')" '{
            e = $3 / 9.81 - (0.1 - immersed) * 10; print; exit !(e < 2e-3 && e > -2e-3 && $1^2 < 1e-6 && $2^2 < 1e-6) }'
    done
    # turned: gravity along x, the level in a section of its own
    sed 's/^gravity = .*/gravity = -9.81, 0, 0/; s/^level = .*/level = 0.16, 0, 0/' run.scene > turned.scene
    mtled turned.scene table.mts > u.dat
    rows reactions u.dat | awk '{ exit !($1^2 + $2^2 + $3^2 < 4e-4) }'
    sed 's/^gravity = .*//; s/^level = .*/&\ngravity = 0, 0, -9.81/' run.scene > light.scene
    mtled light.scene table.mts > u.dat # no weight: half immersed
    rows reactions u.dat | awk '{ e = $3 / 9.81 + 0.5; exit !(e < 2e-3 && e > -2e-3) }'
}

@test "a fluid: force and moment on a wall, up to its level amid a facet; keys that do not go together" {
    cloud -d 2 -k regular -n 21 --box 0,0.1,0,0.1 | shapefn > wall.mts 2> note
    {
        block quasi-static | sed 's/^E = .*/E = 1e7/'
        printf '[displacement back]\nfacets = xmax\ncomponents = 0, 0\n[pressure fluid]\nfacets = xmin\ndensity = 1000\nlevel = 0, 0.083\ngravity = 0, -9.81\n'
        printf '[output]\nreactions = yes\nmoments = yes\n'
    } > wall.scene
    mtled wall.scene wall.mts > u.dat
    # rho g h^2 / 2, at a third of its height
    rows reactions u.dat | awk '{ e = -$1 / (9810 * 0.083^2 / 2) - 1; print e; exit !(e < 2e-3 && e > -2e-3) }'
    rows moments u.dat | awk '{ e = $1 / (9810 * 0.083^3 / 6) - 1; print e; exit !(e < 3e-3 && e > -3e-3) }'
    sed '/^gravity = /d' wall.scene > weightless.scene
    refused 2 "[pressure fluid]: density: a fluid without weight: give gravity here or in [scene]" mtled weightless.scene wall.mts
    sed '/^level = /d' wall.scene > no.scene
    refused 2 "level" mtled no.scene wall.mts
    sed 's/^density = .*/value = 3/' wall.scene > no.scene
    refused 2 "level: not allowed: it goes with density" mtled no.scene wall.mts
    sed 's/^density = .*/&\nvalue = 3/' wall.scene > no.scene
    refused 2 "value" mtled no.scene wall.mts
    sed 's/^level = .*/&\nside = left/' wall.scene > no.scene
    refused 2 "side: 'left' is none of below, above, both" mtled no.scene wall.mts
}

@test "a force on a node; its section's own curve in time" {
    { block quasi-static && held_below; } > held.scene
    solved '[force pull]\nnodes = corner\ncomponents = 3, -2'
    holds -3 2
    printf '0 0\n1 0.5\n' > half.txt
    solved '[force pull]\nnodes = corner\ncomponents = 6, -4\ncurve = half.txt'
    holds -3 2
}

@test "values set at the nodes: the same where the shape functions almost interpolate" {
    solved
    { cat held.scene; printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n'; } > top.scene
    mv top.scene held.scene
    nodes -u mm body.msh 2> note | ipoints -g 4 | support -w regularised | shapefn > almost.mts 2> note
    stream=almost.mts
    solved '[solver]\nconstraint_points = node'
    cp u.dat other.dat
    solved '[solver]\nconstraints = direct\nconstraint_points = node'
    near max 1e-4
    paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) |
        awk '$2 > 0.0999 { d = $4 + 0.005; if (!(d < 1e-4 && d > -1e-4)) bad = 1; n++ } END { exit bad || n != 5 }'
}

@test "a node of a set goes where it is prescribed, and pulls back as the bottom holds" {
    { block quasi-static && held_below; } > held.scene
    solved '[displacement pull]\nnodes = corner\ncomponents = 0.002, free'
    paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) |
        awk '$1 > 0.0999 && $2 > 0.0999 { d = $3 - 0.002; n++ } END { exit !(n == 1 && d < 1e-8 && d > -1e-8) }'
    rows reactions u.dat | awk '{ x[NR] = $1 } END { exit !(NR == 2 && x[2] > 0.1 && (x[1] + x[2])^2 < 1e-6 * x[2]^2) }'
}

@test "contact: a rigid floor in any unit, drawn either way; a stiffness of one's own" {
    { block quasi-static && printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n'; } > held.scene
    contact='[contact floor]\nfacets = ymin\nrigid = floor.tsv'
    printf -- '-1 -0.002\n2 -0.002\n' > floor.tsv
    solved "$contact\nunit = m\nside = left"
    rows reactions u.dat | awk '{ y[NR] = $2 } END { exit !(NR == 2 && y[1] < -1 && y[2] > 1 && (y[1] + y[2])^2 < 1e-4 * y[1]^2) }'
    cp u.dat other.dat
    printf -- '2000 -2\n-1000 -2\n' > floor.tsv
    solved "$contact\nunit = mm\nside = right"
    near max 1e-9
    solved "$contact\nunit = mm\nside = right\nstiffness = 1e6"
    near max 2e-5
}

@test "a uniform pressure of six shear moduli: the closed form" {
    cloud -d 3 -k jittered --jitter 0.2 -n 5 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    block quasi-static | sed 's/dim = 2/dim = 3/; s/^nu = .*/nu = 0.499/' > head
    { cat head; printf '[pressure all]\nfacets = *\nvalue = 6004.002668\n[displacement pins]\npoints = pins.tsv\nunit = m\n'; } > deep.scene
    printf '%s\n' '0.05 0.05 0.05 0 0 0' '0.07 0.05 0.05 nan 0 0' '0.05 0.07 0.05 nan nan 0' > pins.tsv
    mtled -q deep.scene cube.mts > u.dat
    # p = 6 mu, J = 1 - p / kappa.
    paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) | awk 'BEGIN { s = (1 - 6004.002668 / 500000)^(1 / 3) - 1 }
        { for (a = 1; a <= 3; a++) { d = $(a + 3) - s * ($a - 0.05); worst = d * d > worst ? d * d : worst } }
        END { print sqrt(worst) / (0.05 * -s); exit !(NR == 125 && worst < (1e-4 * 0.05 * s)^2) }'
}

@test "a pressure on one side only, whose rim has no potential: the closed form, up to twice the shear modulus" {
    # Displacements are compared to 2e-6 of the side, so runs go below that; one that goes round in circles ends by max_steps.
    for case in '2 .3 1' '2 .45 2' '2 .49 1.5' '3 .45 1'; do
        read -r dim nu share <<< "$case"
        cloud -d "$dim" -k jittered --jitter 0.12 -n 7 --seed 3 --box 0,0.1,0,0.1$([ "$dim" = 2 ] || echo ,0,0.1) 2> note | shapefn > body.mts 2> note
        { block quasi-static | sed "s/dim = 2/dim = $dim/; s/^nu = .*/nu = $nu/"; for axis in x y z; do
            [ $axis$dim = z2 ] || printf '[displacement %s]\nfacets = %smin\nnormal = 0\n' $axis $axis; done
            awk -v nu="$nu" -v share="$share" 'BEGIN { printf "[pressure end]\nfacets = xmax\nvalue = %.12g\n", share * 1500 / (1 + nu) }'
            printf '[solver]\ntolerance = 1e-7\nmax_steps = 500\n'; } > end.scene
        mtled -q end.scene body.mts > u.dat 2> note
        # Stretches a along the pressure and b across it: of (mu J^(-5/3) dev B + kappa (J - 1)) the axial part is -p, the others are 0.
        paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) | awk -v dim="$dim" -v nu="$nu" -v share="$share" '
            function stress(along,    J, c, trace) { c = dim == 3 ? b : 1; J = a * b * c; trace = a * a + b * b + c * c
                return J ^ (-5 / 3) * ((along ? a * a : b * b) - trace / 3) + 2 * (1 + nu) / 3 / (1 - 2 * nu) * (J - 1) }
            BEGIN { a = b = 1
                for (i = 0; i < 60; i++) { f = stress(1) + share; g = stress(0); h = 1e-6
                    a += h; fa = (stress(1) + share - f) / h; ga = (stress(0) - g) / h; a -= h
                    b += h; fb = (stress(1) + share - f) / h; gb = (stress(0) - g) / h; b -= h
                    det = fa * gb - fb * ga; a -= 0.5 * (f * gb - g * fb) / det; b -= 0.5 * (fa * g - ga * f) / det } }
            { for (k = 1; k <= dim; k++) { d = $(dim + k) - ((k == 1 ? a : b) - 1) * $k; worst = d * d > worst ? d * d : worst } }
            END { print dim, nu, share, a, b, sqrt(worst) / 0.1; exit !(NR == 7 ^ dim && worst < (2e-6 * 0.1) ^ 2) }'
    done
}

@test "a volume that grows by half, nearly incompressible: the closed form, by each volumetric energy" {
    cloud -d 3 -k jittered --jitter 0.2 -n 5 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    block quasi-static | sed 's/dim = 2/dim = 3/; s/^nu = .*/nu = 0.49/' > head
    # P of the stretch l = 1.15, of E = 3000 Pa: kappa (J - 1) l^2; mu (l - 1 / l) + lambda ln J / l
    while read -r model law; do
        { sed "s/^E = /model = $model\nE = /" head; for at in min max; do for side in x y z; do
            printf '[displacement %s]\nfacets = %s\nnormal = %s\n' $side$at $side$at $([ $at = min ] && echo 0 || echo 0.015); done; done
            printf '[output]\nreactions = yes\n[solver]\ntolerance = 1e-7\n'; } > grown.scene
        mtled -q grown.scene cube.mts > u.dat
        paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) | awk '{ for (a = 1; a <= 3; a++) { d = $(a + 3) - 0.15 * $a; worst = d * d > worst ? d * d : worst } }
            END { print sqrt(worst); exit !(NR == 125 && worst < 1e-9 ^ 2) }'
        rows reactions u.dat | awk -v law="$law" 'NR == 4 { l = 1.15; mu = 1500 / 1.49; J = l ^ 3
            P = law == "linear" ? 50000 * (J - 1) * l * l : mu * (l - 1 / l) + 49 * mu * log(J) / l
            print $1, P / 100; exit !(($1 / P * 100 - 1) ^ 2 < 1e-12) }'
    done << 'END'
neo-hookean linear
neo-hookean-log logarithmic
END
}

@test "groups that are not there, surfaces that are none: the line of the section" {
    mv held.scene block.scene
    { cat block.scene; printf '%b\n' '[traction a]\nfacets = ymax\ncomponents = 0, 1\ncurve = smooth' '[pressure b]\nfacets = xmax\nvalue = 1\ncurve = smooth' \
        '[force c]\nnodes = corner\ncomponents = 0, 1\ncurve = smooth' '[contact d]\nfacets = xmin\nrigid = floor.tsv\nunit = m\nside = left'; } > all.scene
    mv all.scene block.scene
    printf -- '-1 -0.005\n2 -0.005\n' > floor.tsv
    for section in 'traction a' 'contact d'; do
        with "/^\[$section/,/^facets/s/^facets = .*/facets = roof/"
        refused 2 "[$section]: no facet group 'roof'; there are: " mtled edited.scene square.mts
        sed -i 's/roof/*, ymax/' edited.scene
        refused 2 "[$section]: *, the whole boundary, stands alone" mtled edited.scene square.mts
    done
    with 's/^nodes = corner/nodes = edge/'
    refused 2 "[force c]" mtled edited.scene square.mts
    [[ $stderr == *"'edge'"*corner* ]]
    printf '0 0\n' > floor.tsv
    refused 2 "floor.tsv:1: curve of one point" mtled block.scene square.mts
    mts drop sets.ptr square.mts | mts drop sets.idx > none.mts
    printf -- '-1 -0.005\n2 -0.005\n' > floor.tsv
    refused 2 "[force c]: no node sets: run tag -n" mtled block.scene none.mts
}
