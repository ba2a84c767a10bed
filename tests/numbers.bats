# Runs that go wrong stop at that step and say where and what to change; frames asked for are kept in a stream that says
# that it is not whole; and a long run neither drifts nor grows.

load common.bash

setup() {
    enter_loosely
    export OMP_NUM_THREADS=1
    cloud -d 2 -k jittered -n 6 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
}

# A square held at its bottom, its top displaced: scene ANALYSIS NU DISPLACEMENT SOLVER_LINES
scene() {
    block "$1" | sed "s/^nu = .*/nu = $2/"
    held_below
    printf '[displacement top]\nfacets = ymax\n%b\n' "$3"
    printf '[output]\nframes = 20\nenergy = yes\n[solver]\n%b\n' "$4"
}

# stops TEXT: status 1, one line with the step, TEXT, a place and a remedy; the frames so far are whole, the stream is not.
stops() {
    run -1 --separate-stderr bash -c 'mtled run.scene table.mts > u.dat'
    [ "$(wc -l <<< "$stderr")" -eq 1 ]
    [[ $stderr =~ ^mtled:\ run.scene:\ step\ [0-9]+ ]]
    [[ $stderr == *"$1"* ]] || { echo "$stderr"; return 1; }
    [[ $stderr =~ (point|node)\ [0-9]+\ at\ \([-0-9.e]+,\ [-0-9.e]+\) ]]
    [[ $stderr == *": "*"refine there"* || $stderr == *"or apply the load more slowly"* ]]
    [ "$(tail -n 1 u.dat)" = "# stopped ${stderr#mtled: }" ]
    for command in "mts list u.dat" "tovtk -o u.vtu u.dat" "fieldcmp u.dat u.dat"; do
        run -2 --separate-stderr $command
        [[ $stderr == *"not whole, stopped: run.scene: step "*"; mts recover takes what there is" ]]
    done
    mts recover -o whole.mts u.dat 2> said
    grep -q '^mts: u.dat: not whole' said
    mts check whole.mts
    run -1 grep -q '^u	' <(mts list whole.mts) # no final field
    mts list whole.mts > list
}

frames() { grep -c '^u\.frame\.' list; }

# The whole boundary is turned inside out: somewhere on the way a point must be inverted.
turn_over() {
    printf '%s\n' '0 0 0.12 0' '0.1 0 -0.12 0' '0 0.1 0.12 0' '0.1 0.1 -0.12 0' > flip.tsv
    scene quasi-static 0.3 'table = flip.tsv\nunit = m' '' |
        sed '/^\[displacement bottom/,/^components/d; s/^facets = ymax/facets = xmin, xmax, ymin, ymax/' > run.scene
}

@test "inversion of a sliver: its quality, and what helps" {
    turn_over
    cloud -t -d 2 -k regular -n 6 --box 0,0.1,0,0.1 |
        awk '/^# nodes.x/ { row = -1; on = 1 } on && row == 14 { $1 = 0.04999; $2 = 0.03001 } { print; row++ }' > sliver.mts
    mts check sliver.mts | grep -q '^cells: row 15: poor: quality 2e-06'
    shapefn sliver.mts > table.mts
    stops "integration point 15 at"
    tail -n 1 u.dat | grep -qF 'refine there; its cell is a sliver of quality 2e-06: improve the mesh, or take Gauss points (ipoints -g 1)'
}

@test "inversion, quasi-static: the point, its place, J; the state before it" {
    turn_over
    stops "is inverted (J = -"
    [ "$(frames)" -ge 3 ]
    time=$(sed -n 's/^u\.frame\..*time=//p' list | tail -n 1)
    awk -v time="$time" 'BEGIN { exit !(time > 0 && time < 1) }'
}

@test "inversion, dynamic: the state one step before it" {
    scene dynamic 0.3 'components = 0.07, 0.07\ncurve = step' 'end_time = 1\ntime_step_margin = 0.5' > run.scene
    stops "is inverted (J = -"
    [ "$(frames)" -ge 2 ]
    # It is good: F of the linear interpolants of the cells is not inverted there.
    last=$(sed -n 's/^\(u\.frame\.[0-9]*\)	.*/\1/p' list | tail -n 1)
    paste <(mts print nodes.x whole.mts) <(mts print "$last" whole.mts) | awk '
        NF != 4 || $3 ^ 2 > 1 || $4 ^ 2 > 1 { exit 1 }'
}

@test "energy drift: the fastest node; the frames before it" {
    scene dynamic 0.49 'components = 0.1, 0.1' 'end_time = 0.5\ntime_step_margin = 0.96' > run.scene
    stops "the energy balance is off by "
    [ "$(frames)" -ge 4 ]
    grep -q '^energy	f8' list
}

@test "step collapse: the node of the fastest mode; the state then" {
    scene dynamic 0.3 'components = 0, 1' 'end_time = 20' | sed 's/^nu.*/&\nmodel = ogden\nalpha = 60/' > run.scene
    stops "the critical step has fallen below 0.001 of the first one"
    [ "$(frames)" -ge 5 ]
}

@test "not a number: stopped at that step" {
    scene dynamic 0.3 'components = 0, 0' 'end_time = 1' | sed 's/^analysis.*/&\ngravity = 0, 1e300/' > run.scene
    stops "nan"
    scene quasi-static 0.3 'components = 0, 0' '' | sed 's/^analysis.*/&\ngravity = 0, 1e300/' > run.scene
    stops "is inverted"
}

@test "without frames nothing is written; with -o what there is goes beside the file" {
    scene dynamic 0.49 'components = 0.1, 0.1' 'end_time = 0.3\ntime_step_margin = 0.999' > run.scene
    echo precious > u.dat
    run -1 mtled -o u.dat run.scene table.mts
    [ "$(cat u.dat)" = precious ]
    grep -q '^# stopped run.scene: step' u.dat.part
    run -1 mtled -b -o v.dat run.scene table.mts
    [ ! -e v.dat ]
    cmp <(mts recover -t u.dat.part 2> note | grep -v '^# @') <(mts recover -t v.dat.part 2> note | grep -v '^# @')
    sed -i '/^frames/d' run.scene
    rm u.dat.part
    run -1 --separate-stderr mtled run.scene table.mts
    [ -z "$output" ]
    run -1 mtled -o u.dat run.scene table.mts
    [ ! -e u.dat.part ]
}

@test "ended by a signal: the frames so far are kept, too" {
    # Long enough for any processor, its first frames soon.
    scene dynamic 0.3 'components = 0, 0.01' 'end_time = 2e4\nmax_steps = 1000000000' | sed 's/^frames.*/frames = 2000/' > run.scene
    mtled -q run.scene table.mts > u.dat 2> said &
    sleep 0.7
    kill -TERM $!
    status=0
    wait $! || status=$?
    [ $status -eq 143 ]
    [ "$(tail -n 1 u.dat)" = "# stopped $(sed 's/^mtled: //' said)" ]
    mts recover u.dat 2> note | mts list | grep -q '^u.frame.1	'
}

@test "mts recover: what is whole in front of a cut or a damage; nothing of what has no whole section" {
    mts recover table.mts 2> said | cmp - <(mts recover < table.mts)
    [ ! -s said ]
    mts list table.mts > all
    for size in 1000 3000 9000; do
        head -c $size table.mts | mts recover 2> said | mts list > some
        grep -q 'cut short' said
        head -n "$(wc -l < some)" all | cmp - some
        [ "$(wc -l < some)" -lt "$(wc -l < all)" ]
    done
    run -2 --separate-stderr bash -c 'head -c 100 table.mts | mts recover'
    [ -z "$output" ]
    run -2 --separate-stderr mts recover /dev/null
}

@test "a long run: memory as at the begin, energy kept" {
    bash "$BATS_TEST_DIRNAME/soak.sh" 200000 > table
    growth=1.02
    ! nm "$(type -P mtled)" | grep -q ' __asan_init$' || growth=10 # it keeps what is freed for a while
    awk -v growth=$growth 'NR == 2 && $1 >= 200000 && $2 > 0 && $3 <= $2 * growth && $4 < 2e-3 { good = 1 } END { exit !good }' table
}
