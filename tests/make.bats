# Under make, a stage that fails leaves no target behind, by .DELETE_ON_ERROR and pipefail of the Makefile: rules of one stage, of
# several, of studies that go on, with stand-ins for all programs.

bats_require_minimum_version 1.5.0

setup() {
    top=$BATS_TEST_DIRNAME/..
    cd "$BATS_TEST_TMPDIR"
    fake=$(realpath --relative-to "$top" .)/build
    mkdir -p build/bin
    tools=(gmsh gnuplot ccx FreeFem++-nw bats)
    for file in "$top"/tools/*.c; do tools+=("$(basename "$file" .c)"); done
    for tool in "${tools[@]}"; do stand_in good > build/bin/"$tool"; done
    chmod +x build/bin/*
}

# A program that reads its input and writes half of something where its input says, and then succeeds or fails; with
stand_in() {
    cat << 'END_OF_SCRIPT'
#!/bin/bash
[ ! -p /dev/stdin ] || cat > /dev/null
echo '# mts 1'
while [ $# -gt 0 ]; do
    case $1 in
        -o) echo half > "$2" ;;
        -e) [[ $2 != *out=* ]] || echo half > "$(sed "s/.*out='\([^']*\)'.*/\1/" <<< "$2")" ;;
    esac
    shift
done
END_OF_SCRIPT
    if [ "$1" = bad ]; then
        echo 'echo x >> "$FAILED"; exit 3'
    fi
}

# make GOALS with the stand-ins, all that can be made.
with_stand_ins() {
    local tool old=()
    for tool in "${tools[@]}"; do old+=(-o "$fake/bin/$tool"); done
    make -C "$top" -k -j1 BUILD="$fake" OUT="$fake/out" "${old[@]}" "$@" > log 2>&1
}

# The targets of recipes that failed.
failed() { sed -nE 's/^make.*\*\*\* \[[^]]*: ([^]]*)\] Error .*/\1/p' log; }

# fails TOOL GOALS -- TARGETS: with TOOL failing, no recipe that failed leaves its target, and these are not there.
fails() {
    local tool=$1 goals=()
    shift
    while [ "$1" != -- ]; do goals+=("$1") && shift; done
    shift
    rm -rf build/out failures
    export FAILED=$PWD/failures
    stand_in bad > build/bin/"$tool"
    run -2 with_stand_ins "${goals[@]}"
    stand_in good > build/bin/"$tool"
    [ -s failures ] || { cat log; echo "$tool was not run"; return 1; }
    [ -n "$(failed)" ]
    for target in $(failed); do
        [ ! -e "$top/$target" ] || { echo "$tool failed, and $target is there"; return 1; }
    done
    for target in "$@"; do
        [ ! -e "build/out/$target" ] || { echo "$tool failed, and $target is there"; return 1; }
    done
}

@test "brain2d: whichever program fails" {
    for tool in nodes ipoints support shapefn mtled; do
        fails $tool brain2d -- brain2d/default.dat brain2d/u.dat brain2d/paper-mls1.dat brain2d/compare.tsv
    done
    fails gmsh brain2d -- brain2d/body.msh brain2d/default.dat
    fails fieldcmp brain2d -- brain2d/default.errors brain2d/compare.tsv
    fails tovtk brain2d -- brain2d/u.vtu
}

@test "hard: a failed case fails the study, its rows say so" {
    cases=$(basename -s .sh "$top"/pipelines/hard/01-*.sh "$top"/pipelines/hard/17-*.sh)
    fails shapefn hard HARD_CASES="$(xargs <<< "$cases")" -- hard/hard.tsv
    fails mtled hard HARD_CASES="$(xargs <<< "$cases")" --
    [ ! -e build/out/hard/hard.tsv ] || grep -q 'FAIL$' build/out/hard/hard.tsv
}

@test "a target that was there before the failure is gone, too, and made again when nothing fails" {
    rm -rf build/out
    goal=$fake/out/brain2d/default.dat
    with_stand_ins "$goal"
    [ -e build/out/brain2d/default.dat ]
    [ "$(grep -v '^make\|^# mts' log | xargs)" = "MAKE $fake/out/brain2d/body.msh MAKE $goal" ] # a line for each file, no command
    touch -d tomorrow build/out/brain2d/body.msh
    export FAILED=$PWD/failures
    stand_in bad > build/bin/mtled
    run -2 with_stand_ins "$goal"
    [ ! -e build/out/brain2d/default.dat ]
    stand_in good > build/bin/mtled
    with_stand_ins V=1 "$goal"
    [ -e build/out/brain2d/default.dat ]
    grep -q '^(nodes -u mm .* | mtled -v ' log
}
