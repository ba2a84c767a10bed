# Newton's method: the fields of the plain relaxation in fewer evaluations, verdicts, interruptions, processes.

load common.bash

setup() { enter_alone; }

# both SCENE STREAM SHARE [TOLERANCE]: solve it both ways; the fields are the same to TOLERANCE of the largest displacement (1e-4), and Newton's
# method takes at most SHARE of the evaluations. Leaves u.dat of Newton's method.
both() {
    mtled -v "$1" "$2" 2> said.newton > u.dat
    { cat "$1" && printf '[solver]\nmethod = relaxation\n'; } > relaxed.scene
    mtled -v relaxed.scene "$2" 2> said > relaxed.dat
    fieldcmp relaxed.dat u.dat | awk -v tolerance="${4:-1e-4}" '$1 == "max_relative" { print; exit !($2 < tolerance) }'
    awk -F '\t' -v most="$3" '$1 == "force evaluations" { n[NR == FNR] = $2 } END { print n[1], n[0]; exit !(n[0] > 0 && n[0] < most * n[1]) }' said said.newton
}

clamped() { # clamped DIM NU MOVE: a block between clamped ends
    printf '[scene]\ndim = %s\nanalysis = quasi-static\n[material m]\nregion = body\nE = 3000\nnu = %s\n' "$1" "$2"
    [ "$1" = 2 ] && set -- "$1" "$2" "$3" ymin ymax '0, 0' || set -- "$1" "$2" "$3" zmin zmax '0, 0, 0'
    printf '[displacement low]\nfacets = %s\ncomponents = %s\n[displacement high]\nfacets = %s\ncomponents = %s\n' "$4" "$6" "$5" "$3"
}

@test "the same fields in a third of the evaluations: compressible or not, in 2D and 3D, under loads and conditions" {
    cloud -d 2 -k jittered -n 13 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > 2.mts 2> note
    cloud -d 3 -k jittered -n 7 --box 0,0.1,0,0.1,0,0.1 --jitter 0.2 | shapefn > 3.mts 2> note
    clamped 2 0.49 '0.01, -0.02' > a.scene
    both a.scene 2.mts 0.34
    clamped 2 0.4999 '0, 0.01' > b.scene
    both b.scene 2.mts 0.34
    clamped 3 0.49 '0, 0, -0.02' > c.scene
    both c.scene 3.mts 0.34
    clamped 3 0.4999 '0.01, 0, -0.01' > d.scene
    both d.scene 3.mts 0.34
    { clamped 3 0.3 '0, 0, 0' | sed '/^\[displacement high/,$d'
        printf '[pressure top]\nfacets = zmax\nvalue = 400\n[pressure side]\nfacets = xmax\nvalue = 300\n'; } > e.scene
    both e.scene 3.mts 0.34
}

@test "forces converge as the body becomes incompressible, in no more evaluations" {
    cloud -d 2 -k jittered -n 13 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > 2.mts 2> note
    for nu in 0.4999 0.49999 0.499999; do
        { clamped 2 $nu '0.01, -0.01' && printf '[output]\nreactions = yes\n'; } > limit.scene
        mtled -v limit.scene 2.mts 2> said > u.dat
        echo "$(rows reactions u.dat | awk 'NR == 2 { print $2 }') $(awk -F '\t' '$1 == "force evaluations" { print $2 }' said)" >> forces
    done
    awk '{ f[NR] = $1; n[NR] = $2 } END { q = (f[3] - f[2]) / (f[2] - f[1]); print q, f[3]
        exit !(q > .08 && q < .12 && f[3] < -50 && (f[3] / f[1] - 1) ^ 2 < 1e-3 ^ 2 && n[3] > 0 && n[3] < 1.2 * n[1]) }' forces
}

@test "contacts: a moving lid, a plate with friction-free sides, two bodies: the same fields and forces" {
    cloud -d 2 -k jittered -n 13 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > 2.mts 2> note
    printf -- '-1 0.1\n2 0.1\n' > lid.tsv
    { clamped 2 0.45 '0, 0' | sed '/^\[displacement high/,$d'
        printf '[contact lid]\nfacets = ymax\nrigid = lid.tsv\nunit = m\nside = right\ntranslation = 0, -0.02\ncurve = smooth\n[output]\nreactions = yes\n'; } > lid.scene
    # Each way may leave contacts to give way by a thousandth of the motion.
    both lid.scene 2.mts 0.34 3e-4
    force=$(rows reactions relaxed.dat | awk 'NR == 1 { print $2 }')
    rows reactions u.dat | awk -v force="$force" 'NR == 1 { d = $2 / force - 1; print $2, force; exit !(force > 10 && d < 1e-3 && -d < 1e-3) }'
}

@test "an interruption, threads and processes change no bit; each frame is an equilibrium" {
    cloud -d 3 -k jittered -n 6 --box 0,0.1,0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    { clamped 3 0.4999 '0.01, 0, -0.02'; printf '[output]\nframes = 2\n'; } > run.scene
    mtled run.scene table.mts > whole.dat
    however whole.dat run.scene table.mts
    goes_on whole.dat run.scene
    { cat run.scene; printf '[solver]\nmethod = relaxation\n'; } > slow.scene
    mtled -q slow.scene table.mts > slow.dat
    goes_on slow.dat slow.scene
    clamped 3 0.4999 '0.005, 0, -0.01' > half.scene
    mtled half.scene table.mts > half.dat
    mts print u half.dat > half
    mts print u.frame.1 whole.dat | paste - half | awk '{ for (i = 1; i <= 3; i++) if ((d = $i - $(i + 3)) > 1e-7 || -d > 1e-7) exit 1 }'
}

@test "no equilibrium, and too few steps, are verdicts; keys of the relaxation are refused" {
    clamped 2 0.3 '0, -0.0999' > flat.scene
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > 2.mts 2> note
    run --separate-stderr mtled flat.scene 2.mts
    [ "$status" -eq 1 ]
    { clamped 2 0.3 '0, -0.02'; printf '[solver]\nmax_steps = 3\n'; } > few.scene
    refused 1 'few.scene: not converged after 3 steps' mtled few.scene 2.mts
    sed -i 's/max_steps = 3/ramp_steps = 3/' few.scene
    refused 2 "few.scene:15: [solver]: ramp_steps: not allowed: it goes with method = relaxation: Newton's method chooses its increments" mtled few.scene 2.mts
}

@test "a curve that begins with the whole of its load, or a half, ends where a smooth one does" {
    cloud -d 2 -k jittered -n 7 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > 2.mts 2> note
    printf '0 .5\n1 1\n' > half.tsv
    for curve in smooth step half.tsv; do
        { clamped 2 0.45 '0, -0.01' && printf 'curve = %s\n[traction side]\nfacets = xmax\ncomponents = 50, 0\ncurve = %s\n' $curve $curve; } > $curve.scene
        mtled $curve.scene 2.mts > $curve.dat
        fieldcmp smooth.dat $curve.dat | awk -F '\t' '$1 == "max_relative" { print; exit !($2 < 2e-5) }' # two tolerances
    done
}

# stressed STREAM SIDES HEIGHT STRESS [KEY = VALUE]: the stress (Pa) on the top of a cube of .1 m that slides on SIDES, by its closed form.
stressed() {
    { clamped 3 0.49 '0, 0, 0' | sed '/^\[displacement low/,$d'
        printf '%s\n[displacement sides]\nfacets = %s\nnormal = 0\n[displacement top]\nfacets = zmax\nnormal = %s\n[output]\nreactions = yes\n' "${5:-}" "$2" "$3"; } > run.scene
    mtled run.scene "$1" > u.dat
    rows reactions u.dat | awk -v stress="$4" 'NR == 2 { e = $3 / .01 / stress - 1; print $3 / .01, stress; exit !(e < 1e-4 && -e < 1e-4) }'
}

@test "homogeneous states stay so: tension to 6 times the length and by Ogden to 3, confined compression to .3" {
    cloud -d 3 -k jittered -n 5 --box 0,0.1,0,0.1,0,0.1 --jitter 0.15 --seed 11 | shapefn > 5.mts 2> note
    cloud -d 3 -k regular -n 6 --box 0,0.1,0,0.1,0,0.1 | shapefn > 6.mts 2> note
    stressed 5.mts 'xmin, ymin, zmin' 0.5 5373.9267
    stressed 5.mts 'xmin, ymin, zmin' 0.2 5450.1672 $'model = ogden\nalpha = 3'
    stressed 6.mts 'xmin, xmax, ymin, ymax, zmin' -0.07 -39542.759
}

# A cube between plates: parameters that alternate from node to node, which the field on a lattice does not show, took 215 evaluations.
@test "a lattice takes about as many evaluations as an irregular cloud" {
    cloud -d 3 -k jittered -n 14 --box 0,0.1,0,0.1,0,0.1 --jitter 0.15 | shapefn > 14.mts 2> note
    clamped 3 0.49 '0, 0, -0.001' > cube.scene
    mtled -v cube.scene 14.mts 2> said > /dev/null
    awk -F '\t' '$1 == "force evaluations" { print; exit !($2 < 90) }' said
}

@test "a body that snaps through under the largest load of a curve is found beyond it when the load has fallen, with frames and without" {
    cat > arch.geo << 'END'
Point(1) = {0, -12, 0}; Point(2) = {-5, 0, 0}; Point(3) = {5, 0, 0}; Point(4) = {5.0769, 0.1846, 0}; Point(5) = {-5.0769, 0.1846, 0};
Circle(1) = {2, 1, 3}; Line(2) = {3, 4}; Circle(3) = {4, 1, 5}; Line(4) = {5, 2}; Curve Loop(1) = {-1, -4, -3, -2}; Plane Surface(1) = {1};
Transfinite Curve{2, 4} = 3; Transfinite Curve{1, 3} = 61; Transfinite Surface{1};
Physical Surface("body") = {1}; Physical Curve("over") = {3}; Physical Curve("ends") = {2, 4};
END
    gmsh -v 1 -2 arch.geo -o arch.msh
    nodes -u m arch.msh 2> note | shapefn > arch.mts 2>> note
    printf '0 0\n.5 1\n1 .5\n' > fall.tsv
    printf '0 0\n.5 .1\n1 .5\n' > rise.tsv
    for run in 'fall energy = yes' 'fall frames = 10' 'rise frames = 10'; do
        { block quasi-static | sed 's/^E = .*/E = 1e6/; s/^nu = .*/nu = 0.3/'
            printf '[displacement ends]\nfacets = ends\ncomponents = 0, 0\n[pressure p]\nfacets = over\nvalue = 60\ncurve = %s.tsv\n[output]\n%s\n' "${run% * = *}" "${run#* }"; } > arch.scene
        mtled -q arch.scene arch.mts 2> note | mts print u - | awk '{ least = $2 < least ? $2 : least } END { print least }' >> least
    done
    # 30 Pa alone leave it where it was
    awk '{ u[NR] = $1 } END { print u[1], u[2], u[3]; exit !(u[1] < -1.6 && (u[1] - u[2])^2 < 1e-10 && u[3] > -0.1) }' least
}
