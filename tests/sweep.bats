# Many cases of one scene, from a table of parameters: pipelines/sweep, and the study of an uncertain brain shift.

load common.bash

setup() {
    enter
    sweep=$top/pipelines/sweep
    pressed_block | sed 's/^E = .*/E = @E@/; s/^nu = .*/nu = @nu@/; s/^components = 0, -.*/table = top.tsv\nunit = mm/' > block.scene
    printf '0 100 0 -8\n100 100 0 -8\n' > top.tsv
}

# Stream of N x N nodes, and a table of as many cases as there are values of nu.
prepare() {
    cloud -d 2 -k jittered -n "$1" --box 0,0.1,0,0.1 --jitter 0.2 | shapefn -o table.mts 2> note
    shift
    printf '# comment\ncase\tE\tnu\n' > cases.tsv
    for nu in "$@"; do printf 'nu%s\t%d\t%s\n' "$nu" 3000 "$nu"; done >> cases.tsv
}

run_sweep() { bash "$sweep/sweep.sh" "$@" cases.tsv block.scene table.mts out; }

# Bytes of all results, and that nothing else is left.
results() {
    [ -z "$(find out -name '.*.dat.*' -o -name '*.ckpt*' -o -name '*.new')" ]
    (cd out && bare sweep.tsv ./*.dat)
}

@test "sweep: each row gives what mtled gives for its scene, the result does not depend on -j" {
    prepare 8 0.1 0.3 0.49
    run_sweep -j 2
    [ "$(cut -f 1,4 out/sweep.tsv)" = "$(printf 'case\tstatus\nnu0.1\tdone\nnu0.3\tdone\nnu0.49\tdone')" ]
    for nu in 0.1 0.3 0.49; do
        sed "s/@E@/3000/; s/@nu@/$nu/" block.scene > own.scene
        mtled -q own.scene table.mts | cmp <(bare out/nu$nu.dat) <(bare -)
    done
    run ! cmp -s <(mts print u out/nu0.1.dat) <(mts print u out/nu0.3.dat)
    results > first
    rm -r out
    run_sweep
    results | cmp first -
}

@test "sweep: a row that fails does not stop the others, and is reported; mended, it alone is computed" {
    prepare 8 0.1 0.3 0.6 0.4
    run -1 --separate-stderr run_sweep -j 2
    [[ "$stderr" == *"sweep: nu0.6: mtled: "*"0.6 is not below 0.5"* ]]
    [[ "$stderr" == *"sweep: 3 done, 1 not: out/sweep.tsv" ]]
    [ "$(cut -f 4 out/sweep.tsv | xargs)" = "status done done 2 done" ]
    [[ "$(sed -n '4p' out/sweep.tsv)" == *"nu0.6"*"0.6 is not below 0.5"* ]]
    [ ! -e out/nu0.6.dat ]
    stat -c '%n %y' out/*.dat > before
    sed -i 's/\t0.6$/\t0.45/' cases.tsv
    run_sweep -j 2
    [ "$(cut -f 4 out/sweep.tsv | xargs)" = "status done done done done" ]
    [ ! -e out/nu0.6.failed ]
    stat -c '%n %y' out/nu0.[134].dat | cmp before -
    # A changed row, and a stream written anew.
    sed -i 's/^nu0.4\t3000/nu0.4\t3100/' cases.tsv
    mts print u out/nu0.4.dat > old.u
    run_sweep
    [ "$(stat -c '%n %y' out/nu0.[134].dat | comm -13 before - | wc -l)" -eq 1 ]
    grep -q '^E = 3100' out/nu0.4.scene
    touch table.mts
    run_sweep
    [ "$(stat -c '%n %y' out/nu0.[134].dat | comm -13 before - | wc -l)" -eq 3 ]
}

# kill_when COUNT: begin the sweep in a session of its own; when COUNT results are there, end all of it by SIGKILL.
kill_when() {
    local tries
    setsid bash "$sweep/sweep.sh" -j 2 cases.tsv block.scene table.mts out 2> killed.log 3>&- &
    local leader=$!
    for ((tries = 0; tries < 6000; tries++)); do
        [ "$(find out -name '*.dat' -not -name '.*' 2> /dev/null | wc -l)" -lt "$1" ] || break
        sleep 0.02
    done
    kill -KILL -- -$leader
    wait $leader || true
}

@test "sweep: killed twice and resumed, it is complete, with the bytes of one that was left alone" {
    prepare 16 0.2 0.3 0.4 0.41 0.42 0.43 0.44 0.45 0.46 0.47 0.48 0.49
    run_sweep -j 2
    results > alone
    rm -r out
    kill_when 2
    [ "$(find out -name 'nu*.dat' | wc -l)" -lt 12 ]
    [ ! -e out/sweep.tsv ]
    kill_when 6
    [ "$(find out -name 'nu*.dat' | wc -l)" -lt 12 ]
    run_sweep -j 2
    results | cmp alone -
}

@test "sweep: cases by their rows, as in an array of jobs, and by xargs; the same case twice at once" {
    prepare 8 0.1 0.3 0.4
    run_sweep
    results > first
    rm -r out
    for row in 1 2 3; do bash "$sweep/case.sh" cases.tsv block.scene table.mts out row=$row; done
    run_sweep
    results | cmp first -
    rm -r out
    (bash "$sweep/sweep.sh" -l cases.tsv block.scene; echo nu0.3; echo nu0.3) |
        xargs -P 4 -I {} bash "$sweep/case.sh" cases.tsv block.scene table.mts out {}
    run_sweep
    results | cmp first -
    run -2 --separate-stderr bash "$sweep/case.sh" cases.tsv block.scene table.mts out row=4
    [ "$stderr" = "sweep: cases.tsv: no row=4" ]
    run -2 --separate-stderr bash "$sweep/case.sh" cases.tsv block.scene table.mts out nu0.7
    [ "$stderr" = "sweep: cases.tsv: no case 'nu0.7'" ]
}

@test "sweep: a stream for each case" {
    prepare 8 0.3
    cp table.mts square.mts
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn -o fine.mts 2> note
    printf 'case\tE\tnu\tbody\na\t3000\t0.3\tsquare\nb\t3000\t0.3\tfine\n' > cases.tsv
    bash "$sweep/sweep.sh" cases.tsv block.scene @body@.mts out
    [ "$(mts print u out/a.dat | wc -l) $(mts print u out/b.dat | wc -l)" = "64 81" ]
    printf 'c\t3000\t0.3\tlost\n' >> cases.tsv
    run -1 --separate-stderr bash "$sweep/sweep.sh" cases.tsv block.scene @body@.mts out
    [[ "$(tail -n 1 out/sweep.tsv)" == "c"*"lost.mts"* ]]
}

# wrong TEXT: the sweep is refused with that line, and nothing is computed.
wrong() {
    run -2 --separate-stderr run_sweep
    [ "$stderr" = "sweep: $1" ] || { echo "$stderr"; return 1; }
    [ ! -e out ]
}

@test "sweep: tables and templates that are wrong" {
    prepare 8 0.3 0.4
    cp cases.tsv good.tsv
    edited() { sed "$1" good.tsv > cases.tsv; }
    edited '2s/case/name/' && wrong "cases.tsv: line 2: the first column is called 'name', not case"
    edited '2s/nu/E/' && wrong "cases.tsv: line 2: two columns are called 'E'"
    edited '3s/\t0.3//' && wrong "cases.tsv: line 3: 2 values, but 3 columns"
    edited '4s/nu0.4/nu0.3/' && wrong "cases.tsv: line 4: a second case 'nu0.3'"
    edited '3s,nu0.3,../x,' && wrong "cases.tsv: line 3: '../x' is no name for a case: letters, digits, . _ -"
    edited '2s/$/\trho/; 3,$s/$/\t1000/' && wrong "cases.tsv: column 'rho' is nowhere in block.scene: write @rho@ there, or take the column away"
    edited '3,$d' && wrong "cases.tsv: no cases below the line of names"
    edited 'd' && wrong "cases.tsv: no line of names"
    cp good.tsv cases.tsv
    sed -i 's/@nu@/@Nu@/' block.scene && wrong "block.scene: line 8: '@Nu' is no column of cases.tsv"
    rm table.mts && wrong "table.mts: no such stream: write one by shapefn -o"
    rm cases.tsv && wrong "cases.tsv: cannot be read"
    run -2 --separate-stderr bash "$sweep/sweep.sh" -j 0 a b c d
    [[ "$stderr" == usage:* ]]
}

@test "percentiles, and where a region comes to lie" {
    awk -f "$top/pipelines/uncertainty/percentile.awk" -f <(cat << 'AWK'
        BEGIN {
            for (i = 1; i <= 41; i++) list[i] = (i * 17) % 41 # 0..40 in disorder
            sort(list, 41)
            print percentile(list, 41, 0.025), percentile(list, 41, 0.5), percentile(list, 41, 0.98), percentile(list, 41, 1)
        }
AWK
    ) > values
    [ "$(cat values)" = "1 20 39.2 40" ]
    # A square of 100 mm that is moved to the right by 1 to 41 mm, and widens by a tenth.
    square_msh
    nodes -u mm -t body.msh > mesh.dat
    for i in $(seq 1 41); do
        echo "case $i"
        mts print nodes.x mesh.dat | awk -v i="$i" '{ print i / 1e3 + .1 * $1, 0 }'
    done | awk -f "$top/pipelines/stream.awk" -f "$top/pipelines/uncertainty/percentile.awk" -f "$top/pipelines/uncertainty/place.awk" \
        -v mesh=mesh.dat -v region=body > place.dat
    awk -f "$top/pipelines/uncertainty/percentile.awk" -f "$top/pipelines/uncertainty/table.awk" -v region=body place.dat | tee table.tsv
    [ "$(sed -n '2p' table.tsv | cut -f 3-)" = "$(printf '41\t26.0000\t11.9791\t7.0000\t45.0000')" ]
    [ "$(sed -n '3p' table.tsv | cut -f 4-)" = "$(printf '0.0000\t0.0000\t0.0000\t0.0000')" ]
    # The band of a node on the right side is 38 mm wide along the normal, on the upper side it is none.
    [ "$(sed -n '5p' table.tsv | cut -f 6-)" = "$(printf '0.0000\t38.0000')" ]
    mts print nodes.x mesh.dat | awk 'BEGIN { print "case short" } NR > 1' | (! awk -f "$top/pipelines/stream.awk" \
        -f "$top/pipelines/uncertainty/percentile.awk" -f "$top/pipelines/uncertainty/place.awk" -v mesh=mesh.dat -v region=body) 2> said
    grep -q 'case short: [0-9]* rows, but the mesh has [0-9]* nodes' said
}
