#!/bin/bash
# soak.sh STEPS: a small block swings without damping for about so many steps; prints the steps done, the memory (kB) that
# mtled held after a quarter of the time and at its end, and the largest error of the energy balance relative to the
# largest energy, which is of second order in the time step. The programs are those on PATH.
set -eu -o pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
export OMP_NUM_THREADS=1

cloud -d 2 -k jittered -n 4 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn > table.mts 2> note
swing() {
    cat << SCENE
[scene]
dim = 2
analysis = dynamic
gravity = 0, -1
[material body]
region = body
E = 3000
nu = 0.3
rho = 1000
[displacement bottom]
facets = ymin
components = 0, 0
[output]
energy = yes
[solver]
end_time = $1
time_step_margin = 0.5
SCENE
}

# Run for so long; writes "steps drift begin_kB end_kB".
run() {
    swing "$1" > run.scene
    mtled -q -v run.scene table.mts > u.dat 2> report &
    local program=$! samples=() now
    while now=$(awk '/^VmRSS/ { print $2 }' /proc/$program/status 2> note) && [ -n "$now" ]; do
        samples+=("$now")
        sleep 0.05
    done
    wait $program
    [ ${#samples[@]} -gt 0 ] || samples=(0)
    awk -F '\t' -v begin="${samples[${#samples[@]} / 4]}" -v end="${samples[-1]}" '
        $1 == "steps" { steps = $2 }
        $1 == "largest energy error" { drift = $2 }
        END { print steps, drift, begin, end }' report
}

read -r steps _ < <(run 1)
end_time=$(awk -v wanted="$1" -v steps="$steps" 'BEGIN { print wanted / steps * 1.02 }')
read -r steps drift begin end < <(run "$end_time")
printf 'steps\tbegin_kB\tend_kB\tlargest_energy_error\n%d\t%d\t%d\t%s\n' "$steps" "$begin" "$end" "$drift"
