#!/bin/bash
# kills.sh COUNT [SEED]: kill mtled at random moments, COUNT times, each time going on from its checkpoint; check after
# every kill that a whole checkpoint is there, not older than what was seen, and at the end that the results are those of a run that was left alone. Checkpoints are written at every opportunity, so that most kills hit one being
# written. The programs are those on PATH. Prints what it saw.
set -eu -o pipefail
count=$1
RANDOM=${2:-1}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export OMP_NUM_THREADS=1

cloud -d 2 -k jittered -n 20 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
cat > dynamic.scene << 'SCENE'
[scene]
dim = 2
analysis = dynamic
gravity = 0, -0.5
[material body]
region = body
E = 3000
nu = 0.45
rho = 1000
[contact floor]
facets = ymin
rigid = floor.tsv
unit = m
side = left
[output]
frames = 20
energy = yes
[solver]
end_time = 10
damping = 1
SCENE
printf -- '-1 -0.01\n2 -0.01\n' > floor.tsv
sed -e 's/analysis = dynamic/analysis = quasi-static/; /^gravity/d; /^end_time/d; /^damping/d; s/^\[solver\]/&\nmethod = relaxation\ntolerance = 0.003\nramp_steps = 8000/' \
    dynamic.scene > quasi-static.scene
printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.02\n' >> quasi-static.scene

# The step of the checkpoint, which is whole; 0 if there is none.
kept() { [ ! -e run.ckpt ] && echo 0 || mts print checkpoint run.ckpt; }

report() { printf '%s\t%d kills\t%d with a file half written\t%d whole runs\n' "$@"; }

for analysis in quasi-static dynamic; do
    mtled -q $analysis.scene table.mts > alone.dat
    kills=0 torn=0 runs=0 step=0
    while [ $kills -lt $(((count + 1) / 2)) ]; do
        mtled -q -c run.ckpt -e 0 $analysis.scene table.mts > u.dat 2> said &
        sleep "0.$(printf %03d $((40 + RANDOM % 260)))"
        kill -KILL $! 2> note || true
        status=0
        wait $! 2> note || status=$?
        if [ $status -eq 0 ]; then
            cmp u.dat alone.dat
            runs=$((runs + 1)) step=0
            continue
        fi
        [ $status -eq 137 ] || { cat said; exit 1; }
        kills=$((kills + 1))
        if [ -e run.ckpt.part ]; then torn=$((torn + 1)); fi
        now=$(kept)
        if [ "$now" -lt "$step" ]; then
            echo "$analysis: step $now is kept, where $step was" && exit 1
        fi
        step=$now
    done
    mtled -q -c run.ckpt -e 1000 $analysis.scene table.mts > u.dat 2> said
    cmp u.dat alone.dat
    [ -z "$(find . -name 'run.ckpt*')" ]
    report $analysis $kills $torn $runs
done
