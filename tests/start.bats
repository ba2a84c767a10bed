# mtled --start: from the field of another run, on other nodes or with another scene, to the same state.

load common.bash

setup() { enter_alone; }

# clouds DIM COARSE FINE: coarse.mts and fine.mts, of a cube or square of .1 m, with so many nodes along an edge.
clouds() {
    local box=0,0.1,0,0.1
    [ "$1" -eq 2 ] || box=$box,0,0.1
    cloud -d "$1" -k jittered -n "$2" --box $box --jitter 0.2 | shapefn > coarse.mts 2> note
    cloud -d "$1" -k jittered -n "$3" --box $box --jitter 0.2 | shapefn > fine.mts 2> note
}

# evaluations FILE: of forces, in a report.
evaluations() {
    awk -F '\t' '$1 == "force evaluations" { print $2 }' "$1"
}

# same_state SCENE TOLERANCE: begun from the coarser cloud's field, the finer one's run ends where it does without, to so much of the
# largest displacement.
same_state() {
    mtled -q -o coarse.dat "$1" coarse.mts
    mtled -v -o cold.dat "$1" fine.mts 2> cold.said
    mtled -v -s coarse.dat -o warm.dat "$1" fine.mts 2> warm.said
    fieldcmp cold.dat warm.dat | awk -F '\t' '$1 == "max_relative" { print "off by " $2; exit !($2 <= tolerance) }' tolerance="$2"
}

# as_soon: and not in many more evaluations: what a coarser field saves is the first, cheap increments.
as_soon() {
    echo "$(evaluations warm.said) evaluations for $(evaluations cold.said)"
    [ "$(evaluations warm.said)" -lt $((4 * $(evaluations cold.said) / 3)) ]
}

@test "a block that is pressed, in 2D and 3D, and with a pressure: the same state" {
    clouds 2 16 31
    pressed_block > push.scene
    same_state push.scene 2e-5 && as_soon
    { block quasi-static && held_below && printf '[pressure top]\nfacets = ymax\nvalue = 300\n'; } > pressure.scene
    same_state pressure.scene 2e-5 && as_soon
    clouds 3 6 11
    pressed_cube zmin zmax -0.005 > cube.scene
    same_state cube.scene 2e-5 && as_soon
}

@test "from the field of a coarser cloud, and of quite another load: the same state, and nothing has buckled" {
    clouds 3 4 6
    pressed_cube zmin zmax "0.02, 0, -0.015" | sed 's/^nu = .*/nu = 0.49/; s/components = 0, 0, 0.02/components = 0.02/' > sheared.scene
    same_state sheared.scene 1e-5
    [ "$(grep -c '^mtled' warm.said)" -eq 0 ]
    sed 's/-0.015/0.06/' sheared.scene > pulled.scene
    mtled -q -o coarse.dat pulled.scene coarse.mts
    mtled -s coarse.dat -o warm.dat sheared.scene fine.mts 2> warm.said
    [ ! -s warm.said ]
    fieldcmp --tol-max 1e-6 cold.dat warm.dat
}

@test "a field that turns the body inside out: begun at rest, the same state" {
    cloud -d 2 -k jittered -n 12 --box 0,0.1,0,0.1 --jitter 0.2 > body.mts
    with_section body.mts u f8 <(mts print nodes.x body.mts | awk '{ print -1.2 * $1, 0 }') 'unit=m cols=x,y' > inside_out.dat
    pressed_block > push.scene
    mtled -q -o cold.dat push.scene body.mts 2> note
    mtled -q -s inside_out.dat -o warm.dat push.scene body.mts 2> said
    grep -q 'u inverts a cell: begun at rest' said
    fieldcmp cold.dat warm.dat | awk -F '\t' '$1 == "max_relative" { exit !($2 <= 2e-5) }'
}

@test "a contact: the same state, to what it may penetrate" {
    clouds 2 12 23
    { block quasi-static && printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.01\n[contact floor]\nfacets = ymin\nrigid = floor.tsv\nunit = m\nside = left\n'; } > floor.scene
    printf -- '-1 0\n2 0\n' > floor.tsv
    same_state floor.scene 2e-3
}

@test "a field in which the body has swallowed a roller, or only begins beyond its surface: begun at rest, the same state" {
    clouds 2 12 12
    awk 'BEGIN { for (k = 0; k <= 200; k++) print 0.05 + 0.02 * cos(-k * 0.01 * 3.14159265358979), 0.1202 + 0.02 * sin(-k * 0.01 * 3.14159265358979) }' > roller.tsv
    held() { block quasi-static && held_below; }
    { held && printf '[contact roller]\nfacets = ymax\nrigid = roller.tsv\nunit = m\nside = left\ntranslation = 0, -0.012\ncurve = smooth\n'; } > roller.scene
    { held && printf '[displacement top]\nfacets = ymax\ncomponents = 0, 0.03\n'; } > pulled.scene
    { held && printf '[pressure top]\nfacets = ymax\nvalue = 1\n'; } > still.scene
    mtled -q -o cold.dat roller.scene fine.mts
    local kind
    for kind in pulled still; do
        mtled -q -o other.dat $kind.scene fine.mts
        mtled -q -s other.dat -o warm.dat roller.scene fine.mts 2> said
        grep -q 'u goes through the surface of \[contact roller\]: begun at rest$' said
        cmp <(mts print u cold.dat) <(mts print u warm.dat)
    done
}

@test "from its own result a run ends where it was, at once" {
    clouds 2 8 12
    { pressed_block && printf '[output]\nreactions = yes\n'; } > push.scene
    mtled -v -o cold.dat push.scene fine.mts 2> cold.said
    mtled -v -s cold.dat -o warm.dat push.scene fine.mts 2> warm.said # one correction of what cold.dat lacks, 5e-7 m at most; it was 1e-8 with (10) by gradients
    fieldcmp --tol-max 2e-8 cold.dat warm.dat > compared
    paste <(rows reactions cold.dat) <(rows reactions warm.dat) | awk '{ d = $2 - $4; exit !(d * d < 1e-8 * $2 * $2) }'
    as_soon
}

@test "a load curve that ends elsewhere than at 1: its end is what counts" {
    clouds 2 8 12
    printf '0 0\n0.5 2\n1 0.5\n' > curve.tsv
    pressed_block | sed '/^\[displacement top/,$s/^components = .*/&\ncurve = curve.tsv/' > curve.scene
    same_state curve.scene 2e-5
}

@test "the same bytes for any number of threads and processes; from a checkpoint, too" {
    clouds 2 8 12
    pressed_block > push.scene
    mtled -q -o coarse.dat push.scene coarse.mts
    mtled -q -s coarse.dat -o one.dat push.scene fine.mts
    however one.dat -s coarse.dat push.scene fine.mts
    cp coarse.mts other.mts && mv fine.mts table.mts
    pressed_block | sed 's/-0.005$/-0.004/' > less.scene
    mtled -q -o other.dat less.scene other.mts
    { cat push.scene && printf '[solver]\nmethod = relaxation\nramp_steps = 15000\n'; } > slow.scene
    begin_from_coarse
    refused 2 "run.ckpt: checkpoint of another cloud or table" mtled -c run.ckpt -s other.dat slow.scene table.mts
    refused 2 "run.ckpt: checkpoint of another cloud or table" mtled -c run.ckpt slow.scene table.mts
    mtled -q -c run.ckpt -s coarse.dat -o resumed.dat slow.scene table.mts 2> said
    grep -q 'going on from step' said
    mtled -q -s coarse.dat -o whole.dat slow.scene table.mts
    cmp whole.dat resumed.dat
}

# A run with a checkpoint that SIGTERM ends on the way.
begin_from_coarse() {
    mtled -q -c run.ckpt -e 0 -s coarse.dat slow.scene table.mts > part.dat 2> said 3>&- &
    local run=$! tries
    for ((tries = 0; tries < 3000; tries++)); do
        [ ! -e run.ckpt ] || break
        sleep 0.02
    done
    kill -s TERM $run
    status=0
    wait $run || status=$?
    [ $status -eq 143 ]
}

@test "a start that cannot be: one line" {
    clouds 2 4 6
    pressed_block > push.scene
    mtled -q -o coarse.dat push.scene coarse.mts
    { cat push.scene && printf '[output]\nframes = 3\n'; } > frames.scene
    refused 2 "--start: the run begins at the whole load: a scene in time, with friction, or that asks for frames, has states before" \
        mtled -s coarse.dat frames.scene fine.mts
    swinging_block > swing.scene
    refused 2 "--start: the run begins at the whole load" mtled -s coarse.dat swing.scene fine.mts
    refused 2 "coarse.mts: no section u" mtled -s coarse.mts push.scene fine.mts
    refused 2 "none.dat: No such file or directory" mtled -s none.dat push.scene fine.mts
    mts drop cells coarse.dat > bare.dat
    refused 2 "bare.dat: has no cells" mtled -s bare.dat push.scene fine.mts
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    pressed_cube zmin zmax -0.005 > cube.scene
    mtled -q -o cube.dat cube.scene cube.mts
    refused 2 "cube.dat: u has 3 columns in 3D, where 2 in 2D are wanted" mtled -s cube.dat push.scene fine.mts
    cloud -d 2 -k regular -n 4 --box 0,0.1,0,0.05 | shapefn > half.mts 2> note
    mtled -q -o half.dat push.scene half.mts
    refused 2 "--start: half.dat: node " mtled -s half.dat push.scene fine.mts
    awk '/^# / { on = $2 == "u" || $2 == "parameters"; print; next } on && NF { print "nan nan"; next } { print }' coarse.dat > nan.dat
    refused 2 "nan.dat: u has values that are not finite numbers" mtled -s nan.dat push.scene fine.mts
}
