# Results are whole or not there, for every program: a full disk, a limit on file sizes, a closed pipe or output, a signal.

load common.bash

setup() {
    enter_loosely
    export OMP_NUM_THREADS=1
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 > square.mts
    shapefn square.mts > table.mts 2> note
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n[material all]\nregion = body\nE = 3000\nnu = 0.45\nrho = 1000\n' > run.scene
    printf '[displacement low]\nfacets = ymin\ncomponents = 0, 0\n[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n' >> run.scene
    mtled run.scene table.mts > u.dat
    cp "$BATS_TEST_DIRNAME"/fuzz/corpus/msh/ascii22 body.msh
    /usr/bin/python3 "$BATS_TEST_DIRNAME/helper/nifti.py" step slice.nii 1 2
    "$BUILD/tests/helper/phantom" sphere > sphere.nii.gz
    writers=("nodes -u mm body.msh" "cloud -d 2 -k regular -n 9 --box 0,1,0,1" "ipoints square.mts" "support square.mts"
        "shapefn square.mts" "mtled run.scene table.mts" "interp -f u u.dat" "mts text square.mts" "mts keep nodes.x square.mts"
        "tovtk u.dat" "warp slice.nii u.dat" "sample slice.nii square.mts"
        "voxels -h 6mm sphere.nii.gz" "voxels -h 6mm --surface label_1 sphere.nii.gz")
    printers=("fieldcmp u.dat u.dat" "mts list square.mts" "mts print nodes.x square.mts" "mtled -h" "cloud --version")
    for command in "${writers[@]}" "${printers[@]}"; do # they work, or the tests below mean nothing
        $command > out 2> note || { echo "$command: $(cat note)"; return 1; }
        [ -s out ]
    done
}

# The last line on standard error is from the program and contains TEXT; what stages ran by themselves is said before.
told() {
    [[ ${stderr_lines[-1]} == "${1%% *}: "*"$2"* ]] || { echo "$1: $stderr"; return 1; }
}

@test "a full device, or a limit on file sizes, is status 3 with a message; the file that was there stays, no other appears" {
    mkdir folder
    for command in "${writers[@]}"; do
        run -3 --separate-stderr $command -o /dev/full
        told "$command" "/dev/full: "
        echo precious > folder/kept
        # Through a pipe: the limit is on the file in which bats keeps the messages, too.
        run bash -c "set -o pipefail; (ulimit -f 0; $command -o folder/kept) 2>&1 | cat"
        [ "$status" -eq 3 ] || { echo "$command: $status"; false; }
        stderr_lines=("${lines[@]}")
        told "$command" "File too large"
        [ "$(cat folder/kept)" = precious ]
        [ "$(ls -A folder)" = kept ]
    done
}

@test "a file, standard input, a pipe and -o, in one thread or in several: the same bytes" {
    for command in "${writers[@]}" "ipoints -a 0.1 -k 2.4 square.mts" "interp -p square.mts u.dat" "warp --field slice.nii u.dat"; do
        $command > file 2> note
        OMP_NUM_THREADS=3 $command -o named 2> note
        cmp file named
        [[ $command != cloud* ]] || continue
        ${command% *} < "${command##* }" 2> note | cmp - file
        cat "${command##* }" | OMP_NUM_THREADS=2 ${command% *} - 2> note | cmp - file
    done
}

@test "a closed standard output is status 3" {
    for command in "${writers[@]}" "${printers[@]}"; do
        run -3 --separate-stderr bash -c "$command >&-"
        told "$command" "standard output: "
    done
}

@test "a failure in any stage leaves what -o names as it was, and nothing beside it" {
    mkdir folder
    head -c 2000 table.mts > cut.mts
    for command in "ipoints" "support" "shapefn" "mtled run.scene" "interp -f u" "mts text" "tovtk" "warp slice.nii" "sample slice.nii"; do
        echo precious > folder/kept
        run -2 --separate-stderr $command -o folder/kept cut.mts
        [ "$(cat folder/kept)" = precious ]
        [ "$(ls -A folder)" = kept ]
    done
}

@test "-o: the file is there whole or not at all, whenever the writer is killed" {
    mkdir folder
    cloud -d 2 -k regular -n 150 --box 0,1,0,1 > large.mts
    mts text large.mts > whole
    for delay in 1 2 3 5 8 12 20 30; do
        mts text -o folder/text large.mts &
        sleep "0.0$(printf %02d $delay)"
        kill -KILL $! 2> note || true
        wait $! 2> note || true
        [ ! -e folder/text ] || cmp folder/text whole
        rm -rf folder/text folder/.text*
    done
}
