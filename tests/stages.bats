# ipoints, support and shapefn: command lines, stage order, equal bytes whichever way, and hostile streams.

load common.bash

tools="ipoints support shapefn"

setup() {
    enter
    cloud -d 2 -k jittered -n 7 --box 0,0.1,0,0.1 --jitter 0.3 > square.mts
}

@test "values out of range are refused with status 2, before the input is read" {
    for command in "ipoints -g 5x" "ipoints -c -g 3" "ipoints --lattice 1" "ipoints --lattice 3,x" "ipoints --lattice 2.5" \
        "ipoints -g 3 --lattice 4,4" "support -k 0" "support -k nan" "support -R 8parsec" "support -R -3mm" \
        "support -k 2 -R 8mm" "support -m 9 -n 5" "support -n 0" "support -b mls3" "support -w gauss" "support --mu -1" \
        "support --mu 1,2" "support --mu-unit mm" "support --bound 0.1" \
        "shapefn --mu 1,2,3,4" "shapefn -b spline" \
        "shapefn --mu 1e-7 --mu-unit foot"; do
        run -2 --separate-stderr $command < /dev/null
        [[ "$stderr" == "${command%% *}: "* ]]
        [[ "$stderr" != *"standard input"* ]]
    done
    refused 2 "no rule of 5 points; there are 1, 3, 4" ipoints -g 5 square.mts
    refused 2 "--lattice: 3 numbers, not 1 or 2" ipoints --lattice 3,3,3 square.mts
    refused 2 "--lattice: more than 2147483647 points" ipoints --lattice 50000 square.mts
    refused 2 "--lattice: 2 numbers, not 1 or 3" ipoints --lattice 3,3 <(cloud -d 3 -k regular -n 3 --box 0,1,0,1,0,1)
    refused 2 "--mu: 2 values; give one, or in 2D 3, in 3D 6" shapefn --mu 1,2
    refused 2 "-R: 'mm' is not a length" support -R mm
    refused 2 "--mu: 6 values; in 2D" shapefn --mu 1,2,3,4,5,6 square.mts # six in 2D
}

@test "the number of threads changes no byte" {
    cloud -d 3 -k jittered -n 8 --box 0,0.1,0,0.1,0,0.1 --jitter 0.1 > cube.mts
    for cloud in square cube; do
        for rule in -c "-g 4"; do
            for threads in 1 2 3; do
                export OMP_NUM_THREADS=$threads
                ipoints $rule $cloud.mts | support | shapefn > $threads.mts
                cmp 1.mts $threads.mts
            done
        done
    done
}

@test "missing stages run by themselves: the same bytes as spelled out, and a note" {
    ipoints square.mts | support | shapefn | mts text | grep -v '^# @' > spelled.txt
    run -0 --separate-stderr shapefn -o table.mts square.mts
    [ "$stderr" = "shapefn: no sections of ipoints, support in the input: ran with defaults" ]
    mts text table.mts | grep -v '^# @' | cmp - spelled.txt
    ipoints square.mts | support -o lists.mts
    run -0 --separate-stderr shapefn -o table.mts lists.mts
    [ -z "$stderr" ]
    mts text table.mts | grep -v '^# @' | cmp - spelled.txt
    support -o lists2.mts square.mts 2> /dev/null
    mts text lists2.mts | grep -v '^# @' | cmp - <(mts text lists.mts | grep -v '^# @')
}

@test "unknown sections pass through unchanged" {
    mts text square.mts | sed '/^# end/d' > with.txt
    sections=$(mts text square.mts | awk '/^# end/ { print $3 }')
    printf '# my.notes i4 2 3 enc=text unit=none\n1 2 3\n4 5 6\n\n\n# end %d\n' $((sections + 1)) >> with.txt
    for tool in $tools; do
        "$tool" with.txt 2> /dev/null | mts print my.notes > notes
        [ "$(xargs < notes)" = "1 2 3 4 5 6" ]
        "$tool" with.txt 2> /dev/null | mts list | grep 'my.notes.*unit=none'
    done
}

@test "a later stage follows the settings of support" {
    ipoints -g 3 square.mts | support -b mls1 -w regularised -k 1.5 > lists.mts
    shapefn lists.mts | mts print shape.phi > followed
    shapefn -b mls1 -w regularised lists.mts | mts print shape.phi | cmp - followed
    run ! bash -c 'shapefn -b mmls2 lists.mts | mts print shape.phi | cmp -s - followed'
}

@test "running a stage again replaces what depends on it" {
    shapefn square.mts 2> /dev/null > table.mts
    ipoints -g 3 table.mts > again.mts
    run -0 mts list again.mts
    [[ "$output" != *nbr.* ]]
    [[ "$output" != *shape.* ]]
    [[ "$output" != *support.radius* ]]
    ipoints -g 3 square.mts | support | shapefn | mts text | grep -v '^# @' > direct.txt
    support again.mts | shapefn | mts text | grep -v '^# @' | cmp - direct.txt
}

@test "wrong stage order is named with its remedy" {
    mts print nodes.x square.mts > rows
    { printf '# mts 1\n# other f8 %d 2 enc=text\n' "$(wc -l < rows)"; cat rows; printf '\n\n# end 1\n'; } > other.txt
    for tool in $tools; do
        run -2 --separate-stderr "$tool" other.txt
        [[ "$stderr" == *"nodes.x: "*"nodes"* || "$stderr" == *"no section nodes.x"*"nodes"* ]]
    done
    sed 's/^# other/# nodes.x/' other.txt > bare.txt
    run -2 --separate-stderr ipoints bare.txt
    [[ "$stderr" == *"no section cells"*"run nodes"* ]]
    shapefn square.mts 2> /dev/null > table.mts # has taken up what lay at the points of faces
    for tool in support shapefn; do
        run -2 --separate-stderr "$tool" table.mts
        [ "$stderr" = "$tool: no section facepoints.x: run ipoints" ]
    done
    ipoints square.mts | mts drop faces.cell | support > lists.mts
    run -2 --separate-stderr shapefn lists.mts
    [ "$stderr" = "shapefn: no section faces.cell: run ipoints" ]
    # in 3D faces share edges: of a stream without them
    cloud -d 3 -k regular -n 4 --box 0,1,0,1,0,1 | ipoints > box.mts
    support box.mts > lists.mts
    for stream in 'support box.mts' 'shapefn lists.mts'; do
        mts drop faces.edge "${stream#* }" > old.mts
        run -2 --separate-stderr "${stream% *}" old.mts
        [ "$stderr" = "${stream% *}: no section faces.edge: run ipoints" ]
    done
}

# hostile STATUS TOOL STREAM WORDS: refused with that status and words, without output.
hostile() {
    run --separate-stderr "$2" "$3"
    echo "$2: status $status: $stderr"
    [ "$status" -eq "$1" ]
    [ -z "$output" ]
    [[ "$stderr" == *"$4"* ]]
}

# edit SECTION ROW TEXT FILE: replace one row (from 0) of a section of a text stream.
edit() {
    awk -v section="$1" -v row="$2" -v text="$3" '
        /^# / { at = $2 == section ? 0 : -1; print; next }
        at >= 0 && NF > 0 { if (at++ == row) { print text; next } }
        { print }' "$4"
}

@test "indices and numbers out of range are refused" {
    mts text square.mts > square.txt
    ipoints -t square.mts > points.txt
    support -t points.txt > lists.txt
    edit nodes.x 3 "nan 0" square.txt > bad.txt
    for tool in $tools; do hostile 2 $tool bad.txt "nodes.x: row 3"; done
    edit cells 5 "0 1 49" square.txt > bad.txt
    for tool in $tools; do hostile 2 $tool bad.txt "cells: row 5: no row 49 of nodes.x"; done
    edit cells 5 "0 0 1" square.txt > bad.txt
    hostile 2 ipoints bad.txt "cells: row 5"
    ipoints -g 3 -t square.mts > gauss.txt
    edit points.x 2 "inf 0" gauss.txt > bad.txt
    hostile 2 support bad.txt "points.x: row 2"
    edit facepoints.x 2 "nan 0" points.txt > bad.txt
    hostile 2 support bad.txt "facepoints.x: row 2"
    for node in 49 -1; do
        edit facepoint.idx 7 "$node" lists.txt > bad.txt
        hostile 2 shapefn bad.txt "facepoint.idx: row 7: no row $node of nodes.x"
        edit node.idx 7 "$node" lists.txt > bad.txt
        hostile 2 shapefn bad.txt "node.idx: row 7: no row $node of nodes.x"
        edit faces 1 "$node 3" lists.txt > bad.txt
        hostile 2 shapefn bad.txt "faces: row 1: no row $node of nodes.x"
    done
    edit faces.cell 1 "72 3" lists.txt > bad.txt
    hostile 2 shapefn bad.txt "faces.cell: row 1"
    cloud -d 3 -k regular -n 4 --box 0,1,0,1,0,1 | ipoints | support -t > box.txt
    while read -r row text; do
        edit faces.edge "$row" "$text" box.txt > bad.txt
        hostile 2 shapefn bad.txt "faces.edge: row "
        [[ "$stderr" == *": not the edges of this face: run ipoints again" ]]
    done << END
0 1 1 1
0 0 2 1
4 1 0 2
5 -1 0 1
7 2147483647 0 1
END
    edit facepoint.ptr 4 0 lists.txt > bad.txt
    hostile 2 shapefn bad.txt "facepoint.ptr: row 4: decreases"
    edit facepoint.ptr 4 9223372036854775807 lists.txt > bad.txt
    hostile 2 shapefn bad.txt "facepoint.ptr: row 5: decreases"
    edit support.radius 4 -1 lists.txt > bad.txt
    hostile 2 shapefn bad.txt "support.radius: row 4"
    edit facepoint.widen 4 nan lists.txt > bad.txt
    hostile 2 shapefn bad.txt "facepoint.widen: row 4"
    sed 's/ mu=[^ ]*/ mu=1,2/' lists.txt > bad.txt
    hostile 2 shapefn bad.txt "support.radius: --mu: 2 values; in 2D give one, or 3"
    sed 's/basis=[^ ]*/basis=cubic/' lists.txt > bad.txt
    hostile 2 shapefn bad.txt "support.radius: -b: "
    support -t gauss.txt > lists.txt
    edit nbr.idx 7 1000 lists.txt > bad.txt
    hostile 2 shapefn bad.txt "nbr.idx: row 7: no row 1000 of nodes.x"
    cloud -d 2 -k regular -n 11,3 --box 0,1,0,0.01 2> note | support -t > flat.txt 2> note
    edit support.stretch 7 "0 0 0 0" flat.txt > bad.txt
    hostile 2 shapefn bad.txt "support.stretch: row 7: not a symmetric matrix without eigenvalues below 1"
    mts drop support.stretch flat.txt > bad.txt
    hostile 2 shapefn bad.txt "no section support.stretch: run support"
    edit points.x 2 "nan 0" lists.txt > bad.txt
    hostile 2 shapefn bad.txt "points.x: row 2"
}

@test "gradients beyond their bound with all radii: the least steep support is taken, with a note" {
    # A needle on a corner sees its three nodes alone.
    printf '# mts 1\n# nodes.x f8 6 2 enc=text unit=m\n0 0\n1 0\n1 1\n0 1\n2 1.01\n2 1.02\n\n\n' > needle.mts
    printf '# cells i4 3 3 enc=text\n0 1 2\n0 2 3\n2 4 5\n\n\n# end 2\n' >> needle.mts
    run -0 --separate-stderr bash -c 'ipoints needle.mts | support -R 1.5m > lists.mts && shapefn lists.mts > table.mts && mts check table.mts'
    [[ "$stderr" == "support: points on faces: 9 of "*" have gradients beyond the bound with all radii; "*": worst at ("*", 1.0"*" for 6"* ]]
    run -1 --separate-stderr support -m 7 needle.mts
    [[ "$stderr" == *"(4 nodes within"*": too few" ]]
}

@test "supports: constant radius in any unit, caps, widening reported" {
    ipoints square.mts > points.mts
    support -R 30mm points.mts | mts print support.radius | sort -u > mm
    support -R 0.03 points.mts | mts print support.radius | sort -u | cmp - mm
    support -R 3cm points.mts | mts print support.radius | sort -u | cmp - mm
    [ "$(cat mm)" = 0.029999999999999999 ]
    support -R 50mm -n 8 -m 8 points.mts | mts print facepoint.ptr > ptr
    awk 'NR > 1 && $1 - last != 8 { exit 1 } { last = $1 }' ptr
    run -0 --separate-stderr support -v -k 1.2 -o lists.mts points.mts
    [[ "${stderr_lines[0]}" =~ ^support:\ widened\ at\ [1-9][0-9]*\ points,\ at\ most\ 1\.[0-9]*\ times$ ]]
    [ "${#stderr_lines[@]}" -eq 3 ]
    for list in "facepoint:points on faces" "node:nodes"; do
        report=$(mts print "${list%%:*}.ptr" lists.mts | awk -v what="${list#*:}" '
            NR > 1 { n = $1 - last; sum += n; if (n > most) most = n; if (NR == 2 || n < fewest) fewest = n } { last = $1 }
            END { printf "support: %d %s: %d to %d neighbours, mean %.1f, widened at", NR - 1, what, fewest, most, sum / (NR - 1) }')
        widened=$(mts print "${list%%:*}.widen" lists.mts | awk '$1 > 1 { n++ } END { print n + 0 }')
        grep -Fx "$report $widened" <<< "$stderr"
    done
}

@test "integration points fill the body" {
    for rule in "-c" "-g 1" "-g 3" "-g 4" "-g 6" "-g 7" "-g 12"; do
        ipoints $rule square.mts | mts print points.weight | awk '{ s += $1 } END { exit !(s > 0.00999999999 && s < 0.01000000001) }'
    done
    cloud -d 3 -k regular -n 4 --box 0,0.1,0,0.1,0,0.2 > brick.mts
    for rule in "-c" "-g 1" "-g 4" "-g 8" "-g 14"; do
        ipoints $rule brick.mts | mts print points.weight | awk '{ s += $1 } END { exit !(s > 0.00199999999 && s < 0.00200000001) }'
    done
    ipoints --lattice 5,3 square.mts | mts print points.x | awk 'END { exit !(NR == 15 && $1 == 0.1 && $2 == 0.1) }'
}
