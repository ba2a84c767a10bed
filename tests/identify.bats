# Parameters of a scene from displacements that were measured at points: pipelines/identify.

load common.bash

setup() {
    enter
    identify=$top/pipelines/identify/identify.sh
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.2 | shapefn -o table.mts 2> note
    { block quasi-static 'gravity = @gx@, @gy@' | sed 's/^E = .*/E = @E@/'; held_below; } > weight.scene
    printf 'name\tmean\tdeviation\ngx\t0\t3\ngy\t0\t3\n' > weight.tsv
    sed 's/@E@/3000/' weight.scene > known_E.scene
}

# measure GX GY E: displacements at 20 points inside, mm.
measure() {
    sed "s/@gx@/$1/; s/@gy@/$2/; s/@E@/$3/" weight.scene > true.scene
    mtled -q true.scene table.mts > true.dat
    awk 'BEGIN { for (i = 1; i <= 4; i++) for (j = 1; j <= 5; j++) print 20 * i + 3, 19 * j - 5 }' > places
    paste <(tr ' ' '\t' < places) <(interp -f u -p places -u mm true.dat | mts print u - | awk '{ print 1e3 * $1 "\t" 1e3 * $2 }') > measured.tsv
}

# close_to VALUE TRUTH PERCENT
close_to() { awk -v value="$1" -v truth="$2" -v percent="$3" 'BEGIN { off = 100 * (value / truth - 1); print value; exit !(off < percent && off > -percent) }'; }

# value NAME COLUMN of what was found
value() { awk -F '\t' -v name="$1" -v column="$2" '$1 == name { print $column }' out/identified.tsv; }

@test "identify: gravity that bends a block is found in size and direction, from no load at all" {
    measure 2.5 -4 3000
    bash "$identify" -j 2 -u mm -d 0.1 weight.tsv known_E.scene table.mts measured.tsv out | tee rounds
    close_to "$(value gx 2)" 2.5 1
    close_to "$(value gy 2)" -4 2
    awk -F '\t' '{ split($2, misfit, " "); last = misfit[2]; if (NR == 1) first = last } END { exit !(first > 20 && last < 0.1 && NR <= 8) }' rounds
    # The scene that was found gives the result that lies beside it.
    mtled -q out/identified.scene table.mts | cmp <(bare out/identified.dat) <(bare -)
    grep -q "^gravity = 2\.[45]" out/identified.scene
    # The same again, whatever was there, and however many at once.
    cp out/identified.tsv first
    bash "$identify" -u mm -d 0.1 weight.tsv known_E.scene table.mts measured.tsv out > again
    cmp rounds again
    cmp first out/identified.tsv
}

@test "identify: noise moves what is found by about its deviation, which is reported" {
    measure 2.5 -4 3000
    echo '{ print $1, $2, $3 + 0.5 * normal(), $4 + 0.5 * normal(), 0.5 }' > noise.awk
    awk -f "$top/pipelines/neurosurgery/random.awk" -f noise.awk measured.tsv > noisy.tsv
    bash "$identify" -u mm weight.tsv known_E.scene table.mts noisy.tsv out | tail -n 1 | tee last
    awk -F '\t' '{ split($2, misfit, " "); exit !(misfit[2] > 0.7 && misfit[2] < 1.3) }' last
    for name in gx gy; do
        truth=$([ $name = gx ] && echo 2.5 || echo -4)
        awk -v value="$(value $name 2)" -v deviation="$(value $name 3)" -v truth="$truth" \
            'BEGIN { off = (value - truth) / deviation; print off; exit !(deviation < 1 && off < 3.5 && off > -3.5) }'
    done
}

@test "identify: what the points do not determine stays where it was believed to be" {
    # Weight and stiffness: displacements know their ratio alone.
    measure 0 -4 3000
    printf 'name\tmean\tdeviation\ngy\t0\t5\nE\t6000\t60\n' > weight.tsv
    sed 's/@gx@/0/' weight.scene > both.scene
    bash "$identify" -u mm -d 0.1 weight.tsv both.scene table.mts measured.tsv out 2> said
    grep -q "parameter 'E': the points hardly tell it" said
    close_to "$(value E 2)" 6000 2
    close_to "$(value gy 2)" -8 4
}

@test "identify: a file that is wrong, a scene that fails, a point outside: one line each" {
    measure 2.5 -4 3000
    wrong() {
        run -"$1" --separate-stderr bash "$identify" -u mm "${@:3}" out
        [ "${#stderr_lines[@]}" -eq 1 ]
        [[ "$stderr" == "identify: "*"$2"* ]]
        [ ! -e out/identified.tsv ]
    }
    wrong 2 "measured.tsv: line 1: 4 values: 4 for place and displacement, and one for the deviation, or -d" weight.tsv known_E.scene table.mts measured.tsv
    wrong 2 "deviation '0': a positive number" -d 0 weight.tsv known_E.scene table.mts measured.tsv
    wrong 2 "unit 'foot'" -u foot -d 1 weight.tsv known_E.scene table.mts measured.tsv
    wrong 2 "nothing.tsv: cannot be read" -d 1 nothing.tsv known_E.scene table.mts measured.tsv
    sed 's/^\(gy.*\)\t3/\1\t-3/' weight.tsv > negative.tsv
    wrong 2 "negative.tsv: line 3: a name, a mean and a positive deviation" -d 1 negative.tsv known_E.scene table.mts measured.tsv
    sed 1d weight.tsv > headless.tsv
    wrong 2 "the first line is not: name, mean, deviation" -d 1 headless.tsv known_E.scene table.mts measured.tsv
    sed '3s/\t.*/\tx\t1\t1/' measured.tsv > word.tsv
    wrong 2 "word.tsv: line 3: 'x' is no number" -d 1 weight.tsv known_E.scene table.mts word.tsv
    : > empty.tsv
    wrong 2 "empty.tsv: no points in it" -d 1 weight.tsv known_E.scene table.mts empty.tsv
    wrong 1 "'@E' is no column" -d 1 weight.tsv weight.scene table.mts measured.tsv
    printf 'name\tmean\tdeviation\ngx\t0\t3\ngy\t-4e9\t3\n' > heavy.tsv
    wrong 1 "trial: mtled: " -d 1 heavy.tsv known_E.scene table.mts measured.tsv
    for wrong in "-j 0" "-q" "weight.tsv"; do
        run -2 --separate-stderr bash "$identify" $wrong weight.tsv known_E.scene table.mts measured.tsv out
        [[ "$stderr" == *"usage: identify.sh "* ]]
    done
    # A point far from the body.
    sed '2s/^[0-9]*/500/' measured.tsv > outside.tsv
    run -2 --separate-stderr bash "$identify" -u mm -d 1 weight.tsv known_E.scene table.mts outside.tsv out
    echo "$stderr"
    [[ "$stderr" == "interp: "*"(0.5, "*"identify: outside.tsv: not all of its points are in the body" ]]
    [ ! -e out/identified.tsv ]
}
