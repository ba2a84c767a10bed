# Friction: Coulomb's law on rigid surfaces and between bodies, at rest and in time.

load common.bash

setup() {
    enter_alone
    printf -- '-1 0\n9 0\n' > floor.tsv
    printf -- '-1 -1 0 1 -1 0 1 1 0\n-1 -1 0 1 1 0 -1 1 0\n' > floor3.tsv
    printf '0 0\n.5 1\n1 1\n' > press.tsv
    printf '0 0\n.5 0\n1 1\n' > drag.tsv
}

# on_floor ANALYSIS MU [GRAVITY]: a block of 30 kPa that stands on a rigid floor.
on_floor() {
    block "$1" "${3:+gravity = $3}" | sed 's/^E = .*/E = 30000/'
    printf '[contact floor]\nfacets = ymin\nrigid = floor.tsv\nunit = m\nside = left\nfriction = %s\n' "$2"
    printf '[output]\nreactions = yes\nenergy = yes\ngaps = yes\n'
}

# in_space: a scene, in 3D, with z for y.
in_space() {
    sed 's/^dim = 2/dim = 3/; s/= ym/= zm/; s/floor.tsv/floor3.tsv/; s/left/front/; s/free, -/free, free, -/; s/\(-*[0-9.]*\), \(free\|-9.81\)$/\1, 0, \2/'
}

@test "a block on a slope sticks up to the angle of friction, to a thousandth of its tangent, and slides beyond" {
    cloud -d 2 -k regular -n 6 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    for along in 4.9001 -4.9001; do
        on_floor quasi-static 0.5 "$along, -9.81" > slope.scene
        mtled -q slope.scene block.mts > u.dat
        rows reactions u.dat | awk -v along="$along" '{ print; x = $1 + 10 * along; y = $2 - 98.1; exit !(x * x + y * y < 1e-4) }'
    done
    on_floor quasi-static 0.5 '4.9099, -9.81' > slope.scene
    refused 1 'friction may not hold the body, which slides then' mtled -q slope.scene block.mts
    # Nor does a block of more nodes slide on the way; the verdict on one that slides takes a fraction of a run's steps.
    cloud -d 2 -k regular -n 16 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    on_floor quasi-static 0.5 '4.9, -9.81' > slope.scene
    mtled -q slope.scene block.mts | rows u | awk '{ bad += $1 * $1 + $2 * $2 > 1e-4 } END { exit bad || NR < 256 }'
    { on_floor quasi-static 0.5 '8, -9.81'; printf '[solver]\nmax_steps = 120\n'; } > slope.scene
    refused 1 'friction may not hold the body, which slides then' mtled -q slope.scene block.mts
    cloud -d 3 -k regular -n 4 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    on_floor quasi-static 0.5 '4.88, -9.81' | in_space > slope.scene
    mtled -q slope.scene cube.mts > u.dat
    rows reactions u.dat | awk '{ print; exit !($1 < -4.8798 && $1 > -4.8802 && $2 < 1e-4 && $2 > -1e-4 && $3 < 9.8102 && $3 > 9.8098) }'
}

@test "a block that is dragged slides at mu N and sticks below; what the drag does is stored or dissipated; a run that is ended goes on" {
    printf '%s\n' '0 0' '.5 0' '.6 .2' '.7 .4' '.8 .6' '.9 .8' '1 1' > drag.tsv
    cloud -d 2 -k regular -n 8 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    cloud -d 3 -k regular -n 4 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    on_floor quasi-static 0.4 > drag.scene
    printf 'frames = 10\n[displacement top]\nfacets = ymax\ncomponents = free, -0.002\ncurve = press.tsv\n' >> drag.scene
    printf '[displacement side]\nfacets = ymax\ncomponents = 0.02, free\ncurve = drag.tsv\n' >> drag.scene
    { in_space < drag.scene | sed 's/^components = 0.02, 0/components = 0.012, 0.016/'; printf '[solver]\ntime_steps = 10\ntolerance = 1e-8\n'; } > cube.scene
    mtled -q drag.scene block.mts > u.dat
    mtled -q cube.scene cube.mts > cube.dat
    # Columns: time, reactions of the top, of its drag, of the floor. From frame 8 on all slides; between two it moves by 4 mm.
    rows reactions.frames u.dat | awk '{ print; mu = -$6 / $7 } NR == 7 { stick = mu > 0.05 && mu < 0.39 } NR > 8 && (mu - 0.4) ^ 2 < 1e-8 { n++ } END { exit !(stick && n == 3) }'
    rows reactions cube.dat | awk 'NR == 3 { print; exit !((sqrt($1 * $1 + $2 * $2) / $3 / 0.4 - 1) ^ 2 < 1e-8 && ($2 / $1 - 4 / 3) ^ 2 < 1e-3) }'
    paste <(rows reactions.frames u.dat) <(rows energy.frames u.dat) | awk '
        NR == 9 { force = $4; had = $9 + $10 + $11 }
        NR == 10 { rise = $9 + $10 + $11 - had; print rise, force * 0.004; exit !((rise / (force * 0.004) - 1) ^ 2 < 1e-8) }'
    rows gaps u.dat | awk '$4 > 0 { bad += $8 < 0.4; n++ } END { exit bad || n < 7 }'
    OMP_NUM_THREADS=2 mtled -q drag.scene block.mts | cmp - u.dat
    mtled -q -c run.ckpt -e 0 -o out.dat drag.scene block.mts 2> said 3>&- &
    until [ -e run.ckpt ]; do sleep 0.01; done
    kill -TERM $!
    wait $! || [ $? -eq 143 ]
    mtled -q -c run.ckpt -o out.dat drag.scene block.mts 2> said
    cmp <(bare u.dat) <(bare out.dat)
}

@test "a block that slides in time comes to rest after v^2 / (2 mu g), and its energy is accounted for" {
    cloud -d 2 -k regular -n 17,5 --box 0,0.2,0,0.05 | shapefn > block.mts 2> note
    on_floor quasi-static 0 '0, -9.81' | sed 's/^E = .*/E = 1e6/' > rest.scene
    mtled -q rest.scene block.mts > rest.dat
    paste <(rows nodes.x <(mts text rest.dat)) <(rows parameters <(mts text rest.dat)) | awk '{ print $1, $2, $3, $4, 2, 0 }' > start.tsv
    # An elastic body that slides squeals (Adams 1995), if nothing damps it.
    { on_floor dynamic 0.3 '0, -9.81' | sed 's/^E = .*/E = 1e6\nprony = .5 .002/'; printf 'interval = 0.3\n[initial]\ntable = start.tsv\nunit = m\n[solver]\nend_time = 0.8\n'; } > slide.scene
    mtled -q slide.scene block.mts > u.dat
    mean() { rows "$1" u.dat | awk '{ s += $1 } END { print s / NR }'; }
    awk -v early="$(mean u.frame.1)" -v late="$(mean u)" 'BEGIN { mug = 0.3 * 9.81; there = 2 * 0.3 - mug * 0.3 ^ 2 / 2; far = 4 / (2 * mug)
        print early / there, late / far; exit !((early / there - 1) ^ 2 < 1e-6 && (late / far - 1) ^ 2 < 1e-6) }'
    rows energy u.dat | awk '{ if ($7 ^ 2 > worst) worst = $7 ^ 2 } END { print; exit !(worst < 1e-7 && $6 > 19.99) }'
}

@test "a block between a floor and a lid that meets it later is at rest until then" {
    printf '9 .051\n-3 .051\n' > lid.tsv
    printf '0 0\n1 1\n10 1\n' > late.tsv
    for seed in 1 2 3; do
        cloud -d 2 -k jittered -n 6 --seed $seed --jitter 0.12 --box 0,0.1,0,0.05 2> note | shapefn > block.mts 2> note
        on_floor quasi-static 0.3 | sed 's/^E = .*/E = 1e5/; s/^nu = .*/nu = 0.4/' > later.scene
        printf '[contact lid]\nfacets = ymax\nrigid = lid.tsv\nunit = m\nside = left\nfriction = 0.3\ntranslation = 0, -.005\ncurve = linear\n' >> later.scene
        mtled -q later.scene block.mts > u.dat
        rows reactions u.dat | awk '{ x += $1; y += $2; if ($2 > 0) up = $2 } END { print x, y, up; exit !(up > 1200 && x * x + y * y < 1e-6 * up * up) }'
        { sed '/^friction/d; s/^gaps.*/&\nframes = 5/' later.scene; printf '[displacement side]\nfacets = xmin\ncomponents = 0, free\n[solver]\nmethod = relaxation\n'; } > free.scene
        mtled -q free.scene block.mts > u.dat
        # In time, and away from the origin, where round-off is more.
        cloud -d 2 -k jittered -n 6 --seed $seed --jitter 0.12 --box 1000,1000.1,-700,-699.95 2> note | shapefn > there.mts 2> note
        printf '0 -700\n1009 -700\n' > floor_there.tsv
        printf '1009 -699.949\n0 -699.949\n' > lid_there.tsv
        sed 's/^analysis.*/&\nduration = 10/; s/^rho/prony = .5 2\n&/; s/linear/late.tsv/; s/floor.tsv/floor_there.tsv/; s/lid.tsv/lid_there.tsv/' later.scene > there.scene
        timeout 30 mtled -q there.scene there.mts > u.dat
    done
}

# Euler: exp(-mu pi/2), here with the middle of the belt, 1 mm farther from the axis than what it lies on. It bends at its ends.
@test "a thin belt around a quarter of a drum holds what friction leaves of the pull, up to coefficients beyond 1" {
    cat > belt.geo << 'END'
Point(1) = {0, 0, 0}; Point(2) = {100, 0, 0}; Point(3) = {102, 0, 0}; Point(4) = {0, 102, 0}; Point(5) = {0, 100, 0};
Line(1) = {2, 3}; Circle(2) = {3, 1, 4}; Line(3) = {4, 5}; Circle(4) = {5, 1, 2}; Curve Loop(1) = {1, 2, 3, 4}; Plane Surface(1) = {1};
Transfinite Curve{1, 3} = 3; Transfinite Curve{2, 4} = 81; Transfinite Surface{1};
Physical Surface("body") = {1}; Physical Curve("pulled") = {1}; Physical Curve("held") = {3}; Physical Curve("in") = {4};
END
    gmsh -v 1 -2 belt.geo -o belt.msh
    nodes -u mm belt.msh 2> note | shapefn > belt.mts 2>> note
    awk 'BEGIN { for (a = -0.3; a < 1.9; a += 0.005) printf "%.15g %.15g\n", 0.1 * cos(a), 0.1 * sin(a) }' > drum.tsv
    for mu in 0.3 1 1.5; do
        { block quasi-static | sed 's/^E = .*/E = 1e5/; s/^nu = .*/nu = 0/'
            printf '[displacement held]\nfacets = held\ncomponents = 0, 0\n[traction pull]\nfacets = pulled\ncomponents = 0, -500\n'
            printf '[contact drum]\nfacets = in\nrigid = drum.tsv\nunit = m\nside = right\nfriction = %s\n[output]\nreactions = yes\n[solver]\ntime_steps = 4\n' $mu; } > belt.scene
        mtled -q belt.scene belt.mts > belt.dat
        rows reactions belt.dat | awk -v mu=$mu 'NR == 1 { off = -$1 / exp(-mu * 1.5708 / 1.01) - 1; print off; exit off^2 > (0.08 * mu)^2 }'
    done
}

@test "Cattaneo: of two round bodies pressed and dragged the middle sticks, with his tractions; processes give the same bytes" {
    cat > two.geo << 'END'
L = 60; R = 2000; s = R - Sqrt(R * R - L * L);
For i In {0:1}
  q = 100 * i; d = i == 0 ? -1 : 1;
  Point(q + 1) = {-L, d * L, 0}; Point(q + 2) = {L, d * L, 0}; Point(q + 3) = {L, d * s, 0}; Point(q + 4) = {0, 0, 0}; Point(q + 5) = {-L, d * s, 0}; Point(q + 6) = {0, d * R, 0};
  Line(q + 1) = {q + 1, q + 2}; Line(q + 2) = {q + 2, q + 3}; Circle(q + 3) = {q + 3, q + 6, q + 4}; Circle(q + 4) = {q + 4, q + 6, q + 5}; Line(q + 5) = {q + 5, q + 1};
  Curve Loop(q + 1) = {q + 1, q + 2, q + 3, q + 4, q + 5}; Plane Surface(q + 1) = {q + 1};
EndFor
Physical Surface("body") = {1, 101}; Physical Curve("low") = {1}; Physical Curve("high") = {101}; Physical Curve("under") = {3, 4}; Physical Curve("over") = {103, 104};
Field[1] = Box; Field[1].VIn = 1.5; Field[1].VOut = 12; Field[1].XMin = -12; Field[1].XMax = 12; Field[1].YMin = -6; Field[1].YMax = 6; Field[1].Thickness = 50;
Background Field = 1; Mesh.MeshSizeExtendFromBoundary = 0; Mesh.MeshSizeFromPoints = 0;
END
    gmsh -v 1 -2 two.geo -o two.msh
    nodes -u mm two.msh 2> note | ipoints | support | shapefn > two.mts
    printf '0 0\n.5 0\n1 .55\n' > drag.tsv
    { block quasi-static | sed 's/^E = .*/E = 30000/; s/^nu = .*/nu = 0.3/'
        for side in 'low 0.00003 0.00005' 'high -0.00003 -0.00005'; do
            read -r name drag press <<< "$side"
            printf '[displacement %s along]\nfacets = %s\ncomponents = %s, free\ncurve = drag.tsv\n' "$name" "$name" "$drag" | sed 's/ along/_along/'
            printf '[displacement %s]\nfacets = %s\ncomponents = free, %s\ncurve = press.tsv\n' "$name" "$name" "$press"
        done
        printf '[contact round]\nfacets = over\nagainst = under\nfriction = 0.3\n[output]\ngaps = yes\nreactions = yes\n[solver]\ntime_steps = 80\n'; } > two.scene
    mtled -q two.scene two.mts > u.dat
    awk 'FNR == NR { Q = $1; P = $2; next }
        FNR == 1 { sub(/^-/, "", Q); sub(/^-/, "", P); a = sqrt(4 * P / (3.14159265 * 30000 / 2 / 0.91)); most = 0.3 * 2 * P / (3.14159265 * a); c = a * sqrt(1 - Q / (0.3 * P)) }
        $4 > 0 && $1 ^ 2 < (c - 0.0015) ^ 2 { q = most * (sqrt(1 - ($1 / a) ^ 2) - c / a * sqrt(1 - ($1 / c) ^ 2)); print $1, $6, q, $8; bad += $8 > 0 || ($6 ^ 2 - q ^ 2) ^ 2 > (0.1 * q * q) ^ 2; n++ }
        $4 > 0 && $1 ^ 2 > (c + 0.0015) ^ 2 { bad += $8 < 0.4 || ($6 / $4 / 0.3) ^ 2 < 0.999; m++ }
        END { print c, n, m, bad; exit !(n > 4 && m > 3 && !bad) }' <(rows reactions u.dat | tail -1) <(rows gaps u.dat)
    processes 3 -q two.scene two.mts > three.dat
    cmp <(bare u.dat) <(bare three.dat)
}

@test "a coefficient out of range, and what takes no friction, is refused with its key" {
    cloud -d 2 -k regular -n 4 --box 0,0.1,0,0.1 | shapefn > block.mts 2> note
    for value in -0.1 nan inf x; do
        on_floor quasi-static "$value" > bad.scene
        refused 2 'bad.scene:16: [contact floor]: friction: ' mtled bad.scene block.mts
    done
    { on_floor quasi-static 0.1; printf '[solver]\nmethod = relaxation\n'; } > bad.scene
    refused 2 '[contact floor]: friction: method = relaxation has none: leave method out' mtled bad.scene block.mts
    { on_floor quasi-static 0; printf '[solver]\ntime_steps = 9\n'; } > bad.scene
    refused 2 'time_steps: not allowed: the scene has neither duration nor friction' mtled bad.scene block.mts
    on_floor quasi-static 0.1 > good.scene
    refused 2 '--start: the run begins at the whole load' mtled --start block.mts good.scene block.mts
    { block quasi-static; printf '[displacement side]\nfacets = ymin\nnormal = 0\nfriction = 0.1\n'; } > bad.scene
    refused 2 '[displacement side]: friction: unknown key' mtled bad.scene block.mts
}
