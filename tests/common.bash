# shellcheck shell=bash
# What suites of command-line tests share.

bats_require_minimum_version 1.5.0

# The programs of the build, also where bats is called by hand.
: "${BUILD:=$(realpath "$BATS_TEST_DIRNAME/../build")}"
export BUILD PATH="$BUILD/bin:$PATH"

# A test begins in a folder of its own; $top is the repository; a pipe fails when any of its stages does.
enter() {
    cd "$BATS_TEST_TMPDIR" || return
    set -o pipefail
    # shellcheck disable=SC2034 # for the suites
    top=$BATS_TEST_DIRNAME/..
}

# The same, but a pipe ends as its last stage does: for programs that refuse what they are given, and grep -q, which stops reading.
enter_loosely() {
    enter
    set +o pipefail
}

# The same with one thread.
enter_alone() {
    enter
    export OMP_NUM_THREADS=1
}

# For suites whose tests need no more.
setup() {
    enter
}

# has [OPTION] PATTERN: a line of all of the input matches; grep -q would end before what writes into the pipe.
has() { grep "$@" > /dev/null; }

# section HEADER ROW...: of a text stream
section() {
    printf '# %s\n' "$1"
    printf '%s\n' "${@:2}" '' ''
}

# Rows of section $1 of a text stream.
rows() { awk -v name="$1" '/^# / { on = $2 == name; next } on && NF' "${2:--}"; }

# A text stream without its provenance.
bare() { grep -v '^# @' "$@"; }

# A stream without the last row of section $1, as text.
shortened() {
    mts text "$2" | awk -v name="$1" '
        /^# / { on = $2 == name && NF > 4; if (on) { left = $4 - 1; sub(" " $4 " ", " " left " ") } print; next }
        on && NF && left-- <= 0 { next }
        { print }'
}

# with_section FILE NAME TYPE ROWS [ATTRIBUTES]: a stream as text, with one more section, its rows from the file ROWS
with_section() {
    cat "$4" > "rows.$2"
    mts text "$1" | awk -v file="rows.$2" -v head="# $2 $3 $(wc -l < "rows.$2") $(awk '{ print NF; exit }' "rows.$2") enc=text ${5-}" '
        /^# end/ { print head; while ((getline line < file) > 0) print line; printf "\n\n# end %d\n", $3 + 1; next }
        { print }'
}

# value NAME: that line's value in $output, a table of fieldcmp or fielderr.
value() {
    awk -F '\t' -v name="$1" '$1 == name { print $2; found = 1 } END { exit !found }' <<< "$output"
}

# refused STATUS TEXT COMMAND...: that status, nothing on standard output, one line on standard error, PROGRAM: ...TEXT...,
# besides the note on stages that were run.
refused() {
    local expected=$1 text=$2
    shift 2
    run --separate-stderr "$@"
    stderr=$(grep -v "ran with defaults" <<< "$stderr" || true)
    [ "$status" -eq "$expected" ] || { echo "status $status: $stderr"; return 1; }
    [ -z "$output" ] || { echo "output: $output"; return 1; }
    [ "$(wc -l <<< "$stderr")" -eq 1 ] || { echo "not one line: $stderr"; return 1; }
    [[ "$stderr" == "$1: "*"$text"* ]] || { echo "message: $stderr"; return 1; }
}

# each_fault FILE COMMAND... < CASES: each "LINE|TEXT|MESSAGE": with that text in FILE, the command refuses it, and names the line unless that is 0
each_fault() {
    local line text message status where
    while IFS='|' read -r line text message; do
        printf '%b' "$text" > "$1"
        status=0
        "${@:2}" < /dev/null > out 2> said || status=$?
        where="$1:$line: "
        [ "$line" != 0 ] || where="$1: "
        [[ $status -eq 2 && $(wc -l < said) -eq 1 && ! -s out && $(cat said) == "$2: $where"*"$message"* ]] || { echo "$where$message; not: $(cat said)"; return 1; }
    done
}

# The head of a scene of a block, on a cloud of 0.1 x 0.1 m: block ANALYSIS [MORE LINES OF scene]
block() {
    cat << END
[scene]
dim = 2
analysis = $1
${2:+$2
}
[material body]
region = body
E = 3000
nu = 0.45
rho = 1000

END
}

held_below() { printf '[displacement bottom]\nfacets = ymin\ncomponents = 0, 0\n'; }

# A block held at its bottom, its top pushed down; sections may be appended.
pressed_block() {
    block quasi-static
    held_below
    printf '\n[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n'
}

# The same block under its weight, in time.
swinging_block() {
    block dynamic 'gravity = 0, -9.81'
    held_below
    printf '\n[solver]\nend_time = 0.05\n'
}

# pressed_cube HELD PUSHED WAY: a body in 3D, one group of facets held, the other moved by WAY along z; sections may be appended.
pressed_cube() {
    block quasi-static | sed 's/^dim = 2/dim = 3/'
    printf '[displacement held]\nfacets = %s\ncomponents = 0, 0, 0\n' "$1"
    printf '[displacement pushed]\nfacets = %s\ncomponents = 0, 0, %s\n' "$2" "$3"
}

# Images to test with, and what is in them: see helper/nifti.py.
nifti() { /usr/bin/python3 "$BATS_TEST_DIRNAME/helper/nifti.py" "$@"; }

# with SED-SCRIPT: block.scene edited, as edited.scene.
with() { sed "$1" block.scene > edited.scene; }

# A square of 100 mm meshed by gmsh, as body.msh, its sides and a corner named.
square_msh() {
    cat > square.geo << 'END'
Point(1) = {0, 0, 0, 25}; Point(2) = {100, 0, 0, 25}; Point(3) = {100, 100, 0, 25}; Point(4) = {0, 100, 0, 25};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1}; Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1}; Physical Surface("body") = {1}; Physical Point("corner") = {3}; Physical Curve("ymin") = {1};
Physical Curve("xmax") = {2}; Physical Curve("ymax") = {3}; Physical Curve("xmin") = {4};
END
    gmsh -v 1 -2 square.geo -o body.msh
}

# The unit square in MSH 2.2: two triangles, a named side, a node of no cell, gaps in the tags.
mesh() {
    cat << 'END'
$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
1 2 "bottom"
2 4 "body"
$EndPhysicalNames
$Nodes
5
10 0 0 0
20 1 0 0
30 1 1 0
7 0 1 0
99 5 5 0
$EndNodes
$Elements
3
2 1 2 2 1 20 10
4 2 2 4 1 10 30 20
5 2 2 4 1 10 30 7
$EndElements
END
}

# begin_and_end SIGNAL SCENE [SECTION]: begin a run on table.mts with a checkpoint after every step, and end it when one is there, or
# when SECTION of it is not 0 any more; leaves status, part.dat and what was said. The run may be over before that is seen: then once more.
begin_and_end() {
    local run tries
    for _ in 1 2 3 4 5; do
        rm -f run.ckpt*
        env --default-signal=INT,HUP mtled -q -c run.ckpt -e 0 "$2" table.mts > part.dat 2> said 3>&- &
        run=$!
        for ((tries = 0; tries < 3000; tries++)); do
            [ -n "$(jobs -rp)" ] || break
            if [ -z "${3:-}" ]; then
                [ ! -e run.ckpt ] || break
            elif [ "$(mts print "$3" run.ckpt 2> note || echo 0)" -gt 0 ] 2> note; then
                break
            fi
            sleep 0.02
        done
        kill -s "$1" $run 2> kill.said || true
        status=0
        wait $run || status=$?
        [ $status -eq 0 ] || return 0
    done
}

# goes_on WHOLE SCENE [SIGNAL [SECTION]]: ended on the way, as begin_and_end does it, and begun again, a run on table.mts gives what WHOLE has.
goes_on() {
    begin_and_end "${3:-TERM}" "$2" "${4-}"
    [ "$status" -eq $((128 + $(kill -l "${3:-TERM}"))) ]
    mtled -c run.ckpt -o resumed.dat "$2" table.mts 2> resumed.said
    grep -q '^mtled: going on from step' resumed.said
    cmp <(bare "$1") <(bare resumed.dat)
}

# processes COUNT ARGUMENTS OF mtled: also as root in a container, more than there are cores, and without mpirun's own words.
processes() {
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun --quiet --oversubscribe --bind-to none -n "$1" mtled-mpi "${@:2}"
}

# however WHOLE ARGUMENTS OF mtled: threads and, where MPI is there, processes give what WHOLE has.
however() {
    OMP_NUM_THREADS=3 mtled -q -o again.dat "${@:2}"
    cmp <(bare "$1") <(bare again.dat)
    [ -x "$BUILD/bin/mtled-mpi" ] || return 0
    processes 2 -q -o again.dat "${@:2}"
    cmp <(bare "$1") <(bare again.dat)
}

# worked PID HUNDREDTHS: wait until it has had so many hundredths of a second of a processor, or has ended.
worked() {
    local tries
    for ((tries = 0; tries < 6000; tries++)); do
        [ "$(awk '{ print $3 == "Z" ? 1e6 : $14 + $15 }' "/proc/$1/stat")" -lt "$2" ] || return 0
        sleep 0.02
    done
}
