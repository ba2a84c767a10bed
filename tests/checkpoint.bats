# mtled -c: a run that is ended by a signal, killed or cut off goes on to the same bytes; nothing else is taken for it.

load common.bash

setup() {
    enter_alone
    cloud -d 2 -k jittered -n 8 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
    scene > run.scene
}

# A block pressed onto a floor, slowly, such that there is time to end it.
scene() {
    block quasi-static | sed 's/^nu = .*/nu = 0.49/'
    cat << 'SCENE'
[displacement top]
facets = ymax
table = top.tsv
unit = m
[contact floor]
facets = ymin
rigid = floor.tsv
unit = m
side = left
[output]
frames = 4
reactions = yes
gaps = yes
[solver]
method = relaxation
ramp_steps = 15000
SCENE
    printf '0 0.1 0 -0.02\n0.1 0.1 0 -0.02\n' > top.tsv
    printf -- '-1 -0.005\n2 -0.005\n' > floor.tsv
}

@test "a checkpoint is a stream that can be looked into" {
    begin_and_end TERM run.scene
    mts list run.ckpt | has '^checkpoint	i8	1	1	version='
    mts list run.ckpt | has '^state.contact.0.multiplier	f8'
    mts check run.ckpt
    mts print u.last run.ckpt | awk 'END { exit NR != 64 }'
    tovtk -o last.vtu run.ckpt
    run -2 fieldcmp run.ckpt run.ckpt # it is no result
}

@test "without -c a signal ends the run in one line, and an existing output stays" {
    printf 'old\n' > out.dat
    mtled -q -o out.dat run.scene table.mts 2> said 3>&- &
    worked $! 10
    kill -TERM $!
    status=0
    wait $! || status=$?
    [ $status -eq 143 ]
    [ "$(wc -l < said)" -eq 1 ]
    grep -q "^mtled: ended by SIGTERM after step " said
    [ "$(cat out.dat)" = old ]
    [ -z "$(find . -name '.out.dat*')" ]
}

@test "another file of the scene, another version, no checkpoint, a damaged one: refused, and left as it is" {
    begin_and_end TERM run.scene
    cp run.ckpt kept
    cp floor.tsv true.tsv
    printf -- '-1 -0.006\n2 -0.006\n' > floor.tsv
    refused 2 "or its tables have changed: remove it" mtled -c run.ckpt run.scene table.mts
    cp true.tsv floor.tsv
    mts text run.ckpt | sed '/^# checkpoint/s/version=[0-9.]*/version=0.0.9/' | mts binary > old.ckpt
    refused 2 "old.ckpt: checkpoint of version 0.0.9, this is" mtled -c old.ckpt run.scene table.mts
    cp table.mts copy.mts
    refused 2 "copy.mts: a stream, but not a checkpoint" mtled -c copy.mts run.scene table.mts
    mts drop state.preconditioner.mass run.ckpt > less.ckpt
    run -2 --separate-stderr mtled -c less.ckpt run.scene table.mts
    [[ $stderr == *"less.ckpt.frames: not the frames that less.ckpt goes on from: remove both to begin anew" ]]
    cp run.ckpt.frames less.ckpt.frames
    run -2 --separate-stderr mtled -c less.ckpt run.scene table.mts
    [[ $stderr == *"state.preconditioner.mass is missing or does not fit" ]]
    refused 2 "no regular file" mtled -c /dev/null run.scene table.mts
    cmp run.ckpt kept
    printf 'x' | dd of=run.ckpt bs=1 seek=3000 conv=notrunc 2> note
    run -2 --separate-stderr mtled -c run.ckpt run.scene table.mts
    [[ $stderr == "mtled: run.ckpt: "*"; remove it to begin anew" ]]
}

@test "a place that cannot be written is reported at once; one that fills up later leaves the last checkpoint" {
    run -3 --separate-stderr mtled -c no/such/folder/run.ckpt run.scene table.mts
    [[ $stderr == "mtled: no/such/folder/run.ckpt.frames: No such file or directory" ]]
    run -3 --separate-stderr bash -c 'ulimit -f 4; mtled -c run.ckpt run.scene table.mts > /dev/null'
    [[ $stderr == "mtled: run.ckpt: cannot write: File too large" ]]
    [ -z "$(find . -name 'run.ckpt*')" ]
    begin_and_end TERM run.scene
    cp run.ckpt kept
    export -f worked
    run -143 --separate-stderr bash -c 'ulimit -f 4; mtled -c run.ckpt run.scene table.mts > /dev/null & worked $! 10; kill -TERM $!; wait $!'
    [[ $stderr == *"no checkpoint: run.ckpt: cannot write: File too large"* ]]
    cmp run.ckpt kept
    [ ! -e run.ckpt.part ]
    printf torn > run.ckpt.part # of a run that was killed as it wrote
    mtled -q -c run.ckpt run.scene table.mts 2> said > again.dat
    [ -z "$(find . -name 'run.ckpt*')" ]
}

# from_each_step SCENE LEAST: a run that goes on from the checkpoint of any of its steps, of which there are at least LEAST, ends with the same bytes.
from_each_step() {
    local kept ended=0
    rm -f run.ckpt*
    LD_PRELOAD=$BUILD/tests/helper/keep.so mtled -q -c run.ckpt -e 0 "$1" small.mts > whole.dat
    for kept in run.ckpt.*; do
        mv "$kept" run.ckpt
        mtled -q -c run.ckpt "$1" small.mts > again.dat
        cmp whole.dat again.dat
        ended=$((ended + 1))
    done
    echo "$1: $ended steps"
    [ "$ended" -ge "$2" ]
}

@test "from each step of a run on to the same bytes: with friction, with memory, with the boundary prescribed" {
    cloud -d 2 -k jittered -n 9,5 --box 0,0.1,0,0.05 --jitter 0.2 2> note | shapefn > small.mts 2>> note
    printf -- '-1 0\n9 0\n' > floor.tsv
    printf '0 0\n.5 1\n4 1\n' > press.tsv
    printf '0 0\n.5 0\n1 1\n' > drag.tsv
    { block quasi-static
        printf '[contact floor]\nfacets = ymin\nrigid = floor.tsv\nunit = m\nside = left\nfriction = 0.3\ntranslation = 0.01, 0\ncurve = drag.tsv\n'
        printf '[displacement press]\nfacets = ymax\ncomponents = free, -0.005\n[displacement hold]\nfacets = ymax\ncomponents = 0, free\n'; } > friction.scene
    from_each_step friction.scene 20
    { block quasi-static 'duration = 4' | sed 's/^E = .*/&\nprony = .3 .2, .4 2/; s/^nu = .*/nu = 0.49/'
        held_below
        printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.01\ncurve = press.tsv\n'; } > memory.scene
    from_each_step memory.scene 5
    { block quasi-static | sed 's/^nu = .*/nu = 0.499/'
        printf '[displacement all]\nfacets = *\ntable = bent.tsv\nunit = m\n'; } > bent.scene
    awk 'BEGIN { for (i = 0; i <= 20; i++) for (j = 0; j <= 10; j++) { x = i / 200; y = j / 200; print x, y, 5 * x * y - .02 * x, -2 * x * x + .1 * y } }' > bent.tsv
    from_each_step bent.scene 4
}
