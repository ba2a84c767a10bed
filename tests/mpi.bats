# mtled-mpi: several processes under mpirun give the bytes of one, of one stream; one message, one status; a process that
# dies loses little.

load common.bash

setup() {
    [ -x "$BUILD/bin/mtled-mpi" ] || skip "MPI is not installed (make deps)"
    enter_alone
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
}

# processes in the background; what is said goes to `said`, and the processes are the children of $!.
begin() {
    local count=$1
    shift
    mpirun --quiet --oversubscribe --bind-to none -n "$count" mtled-mpi "$@" 2> said 3>&- &
    for ((tries = 0; tries < 3000; tries++)); do
        [ ! -e run.ckpt ] || break
        sleep 0.02
    done
}

cube() { cloud -d 3 -k jittered -n "$1" --box 0,0.1,0,0.1,0,0.1 --jitter 0.2; }

# same COUNTS SCENE: what so many processes write is what one does, on table.mts; and what they say.
same() {
    mtled -q -o one.dat "$2" table.mts 2> one.said
    for count in $1; do
        processes "$count" -q -o many.dat "$2" table.mts 2> many.said
        cmp one.dat many.dat
        cmp one.said many.said
        rm many.dat
    done
}

# A cube with every kind of load and condition, and all outputs.
every_load() {
    cat << 'SCENE'
[scene]
dim = 3
analysis = quasi-static
gravity = 0, 0, -9.81
[material body]
region = body
model = ogden
alpha = 3
E = 3000
nu = 0.4995
rho = 1000
fibre = 1, 1, 0
active = 200
[displacement bottom]
facets = zmin
components = 0, 0, 0
[displacement needles]
points = needles.tsv
unit = m
[contact floor]
facets = xmin
rigid = wall.tsv
unit = m
side = front
translation = 0.004, 0, 0
curve = smooth
[support back]
facets = ymax
normal = 2000
tangential = 500
[membrane skin]
facets = xmax, ymax
thickness = 1e-4
E = 1e5
nu = 0.4
[pressure side]
facets = xmax
value = 100
[pressure fluid]
facets = ymin
density = 1000
level = 0.05, 0.05, 0.06
[traction top]
facets = zmax
components = 20, 0, -50
[output]
frames = 2
stress = yes
strain = yes
pressure = yes
volume_ratio = yes
energy = yes
reactions = yes
moments = yes
gaps = yes
[solver]
tolerance = 1e-3
SCENE
    printf '0.05 0.05 0.05 0.001 0 -0.001 0.0005\n0.06 0.03 0.07 0.001 0 -0.002 0\n' > needles.tsv
    printf -- '0 -1 -1 0 2 -1 0 0 2\n' > wall.tsv
}

@test "2, 3 and 7 processes: the same bytes as one, in 2D with contact and frames" {
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    { pressed_block; printf '[contact wall]\nfacets = xmax\nrigid = wall.tsv\nunit = m\nside = left\n[output]\nframes = 2\nstress = yes\nreactions = yes\ngaps = yes\n'; } > run.scene
    printf '0.1005 -1\n0.1005 1\n' > wall.tsv
    same '1 2 3 7' run.scene
}

@test "the same in 3D with every load, near incompressibility" {
    cube 6 | shapefn > table.mts 2> note
    every_load > run.scene
    same '2 4' run.scene
    OMP_WAIT_POLICY=active same 2 run.scene # processes that wait do so at work
}

@test "the same of a brain section with contact, of a stream as text, and of tables that mtled makes itself" {
    cp "$BATS_TEST_DIRNAME"/../examples/brain2d/{brain2d.geo,brain2d.scene,load.tsv,skull.tsv} .
    gmsh -2 -v 1 brain2d.geo -setnumber lc 9 -o brain.msh
    nodes -u mm brain.msh > brain.mts
    shapefn -t brain.mts > table.mts 2> note
    same '7' brain2d.scene
    processes 2 -q -o many.dat brain2d.scene brain.mts 2> said
    [ "$(wc -l < said)" -eq 1 ]
    cmp <(bare one.dat) <(bare many.dat)
}

# one_line STATUS TEXT COMMAND...: that status, nothing on standard output, that one line.
one_line() {
    local expected=$1 text=$2
    shift 2
    run --separate-stderr "$@"
    [ "$status" -eq "$expected" ] && [ -z "$output" ] && [ "$(wc -l <<< "$stderr")" -eq 1 ] && [[ $stderr == "mtled: "*"$text"* ]] ||
        { echo "status $status: $stderr"; return 1; }
}

@test "a full disk on one process: one line at once, nothing half-written" {
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    pressed_block > block.scene
    one_line 3 'No space left on device' processes 3 -o /dev/full block.scene table.mts
    one_line 2 '/dev/full: is no regular file' processes 3 -c /dev/full block.scene table.mts
    one_line 3 'nowhere/run.ckpt: No such file' processes 3 -c nowhere/run.ckpt block.scene table.mts
    printf 'trap "" XFSZ\nulimit -f 8\nexec mtled-mpi "$@"\n' > full.sh
    one_line 3 'run.ckpt: cannot write: File too large' mpirun --quiet --mca btl self,tcp --oversubscribe --bind-to none \
        -n 1 bash full.sh -c run.ckpt -o out.dat block.scene table.mts : -n 2 mtled-mpi -c run.ckpt -o out.dat block.scene table.mts
    [ -z "$(find . -name 'run.ckpt*' -o -name 'out.dat*')" ]
}

@test "the same in time; with Gauss points; in threads" {
    cube 5 | shapefn > table.mts 2> note
    { swinging_block | sed 's/^dim = 2/dim = 3/; s/^gravity.*/gravity = 0, 0, -9.81/; s/ymin/zmin/; s/components = 0, 0/&, 0/; s/^rho/prony = .4 .01, .4 1\n&/'
        printf '[support side]\nfacets = xmax\ntangential = 500\ndamping = 50\n[output]\nframes = 3\nenergy = yes\nstrain = yes\nstress = yes\n'; } > run.scene
    same '3' run.scene
    # So many Gauss points that the bound of the stiffness is summed in parts, which go from process to process.
    cloud -d 2 -k jittered -n 45 --box 0,0.1,0,0.1 --jitter 0.2 | ipoints -g 3 | shapefn > table.mts 2> note
    { pressed_block | sed 's/-0.005/-0.0001/'; printf '[solver]\ntolerance = 0.1\n'; } > run.scene
    OMP_NUM_THREADS=2 same 2 run.scene
}

@test "one message and the status of one process; nothing half-written" {
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    pressed_block > block.scene
    one_line 2 'none.scene: No such file' processes 3 none.scene table.mts
    one_line 2 "cannot share standard input: name the stream's file" processes 2 block.scene
    with 's/^region.*/region = bone/'
    one_line 2 "edited.scene:" processes 3 edited.scene table.mts
    { cat block.scene; printf '[solver]\nmax_steps = 3\n[output]\nframes = 2\n'; } > short.scene
    one_line 1 'not converged after 3 steps' processes 3 -o out.dat short.scene table.mts
    mts recover out.dat.part > frames.dat
    one_line 3 'No space left on device' processes 3 -o /dev/full block.scene table.mts
    [ ! -e out.dat ]
    run -0 processes 2 --version
    [ "$(wc -l <<< "$output")" -eq 1 ]
}

@test "processes that do not read the same are refused" {
    for n in 6 7; do cloud -d 2 -k regular -n $n --box 0,0.1,0,0.1 | shapefn > $n.mts 2> note; done
    pressed_block > block.scene
    run -2 --separate-stderr mpirun --quiet --oversubscribe -n 1 mtled-mpi block.scene 6.mts : -n 1 mtled-mpi block.scene 7.mts
    [ "$stderr" = "mtled: the processes do not read the same: give all the same scene, tables, stream and options, and processors of one kind" ]
}

@test "a process that is killed ends the run; it goes on from the last checkpoint, by any number of processes, to the same bytes" {
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    { pressed_block; printf '[solver]\nmethod = relaxation\nramp_steps = 4000\n[output]\nframes = 2\n'; } > run.scene
    mtled -q -o whole.dat run.scene table.mts
    for victim in 1 2; do
        rm -f run.ckpt*
        begin 2 -q -c run.ckpt -e 0 -o out.dat run.scene table.mts
        kill -KILL "$(pgrep -P $! | sed -n ${victim}p)"
        status=0
        wait $! || status=$?
        [ $status -eq 137 ]
        [ ! -e out.dat ]
        [ -e run.ckpt ]
    done
    processes 3 -q -c run.ckpt -o out.dat run.scene table.mts 2> said
    grep -qx 'mtled: going on from step [0-9]*, kept in run.ckpt' said
    cmp whole.dat out.dat
    [ -z "$(find . -name 'run.ckpt*')" ]
}

@test "SIGTERM to any process ends all after the same step, with a checkpoint from which one process goes on" {
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    { pressed_block; printf '[solver]\nmethod = relaxation\nramp_steps = 4000\n'; } > run.scene
    mtled -q -o whole.dat run.scene table.mts
    begin 2 -q -c run.ckpt -e 0 -o out.dat run.scene table.mts
    kill -TERM "$(pgrep -P $! | sed -n 2p)"
    status=0
    wait $! || status=$?
    [ $status -eq 143 ]
    [ "$(wc -l < said)" -eq 1 ]
    grep -qx 'mtled: ended by SIGTERM after step [0-9]*: the same command goes on from run.ckpt' said
    mtled -q -c run.ckpt -o out.dat run.scene table.mts 2> said
    cmp whole.dat out.dat
}

@test "mtled under mpirun is mtled-mpi; without it one line and no results" {
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    pressed_block > block.scene
    mtled -q block.scene table.mts > one.dat
    mpirun --quiet --oversubscribe --bind-to none -n 2 mtled -q block.scene table.mts > many.dat
    cmp one.dat many.dat
    mpirun --quiet -n 1 mtled -q -o lone.dat block.scene table.mts
    cmp one.dat lone.dat
    mkdir apart
    cp "$BUILD/bin/mtled" apart
    SECONDS=0
    one_line 2 'it is built by make mpi' mpirun --quiet --oversubscribe --bind-to none -n 3 apart/mtled -o out.dat block.scene table.mts
    [ ! -e out.dat ]
    [ $SECONDS -lt 10 ]
}

@test "the report has what was sent" {
    cube 6 | shapefn > table.mts 2> note
    { pressed_block | sed 's/^dim = 2/dim = 3/; s/ymin/zmin/; s/ymax/zmax/; s/^components = 0, /&0, /'; } > run.scene
    processes 2 -v -o out.dat run.scene table.mts 2> report
    awk -F '\t' '$1 == "processes" { n = $2 } $1 == "bytes sent by a process in an evaluation" { b = $2; m = $4 }
        END { exit !(n == 2 && b > 1000 && b < 1e6 && m >= b) }' report
}
