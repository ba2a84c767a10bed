# Faults that the programs survive: with a status of their own, one line that names program, place and remedy, and no
# output that could be taken for whole. make faults prints what was observed.

load common.bash
load faults.bash # its `refused` is another one

setup() {
    enter_loosely
    mesh > square.msh
    /usr/bin/python3 "$BATS_TEST_DIRNAME/helper/nifti.py" step slice.nii 1 2
    pressed_block > block.scene
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.2 > cloud.mts
    ipoints cloud.mts > points.mts
    support points.mts > lists.mts
    shapefn lists.mts > table.mts
}

limit_memory() { [[ $BUILD == *san* ]] || echo 'ulimit -v 4000000;'; }

@test "fault 1: mesh missing, empty, or a directory" {
    : > empty.msh
    refused missing 2 "none.msh: No such file" 'nodes -u mm none.msh'
    refused empty 2 "empty.msh: empty" 'nodes -u mm empty.msh'
    refused directory 2 "is a directory" 'nodes -u mm .'
}

@test "fault 2: mesh truncated at any byte, ASCII and binary" {
    for file in "$BATS_TEST_DIRNAME"/fuzz/corpus/msh/{ascii,binary}{22,41}; do
        size=$(stat -c %s "$file")
        for ((at = 0; at < size - 1; at += $(every 40))); do
            head -c "$at" "$file" > cut.msh
            run -2 --separate-stderr nodes -u mm cut.msh
            [ -z "$output" ]
            [[ ${#stderr_lines[@]} -eq 1 && $stderr == "nodes: cut.msh: "* ]]
        done
        head -c $((size - 2)) "$file" > cut.msh
        refused "$(basename "$file") cut at $((size / $(every 40))) places, the last:" 2 cut.msh 'nodes -u mm cut.msh'
    done
}

@test "fault 3: a mesh that is really a script with SystemCall" {
    command="SystemCall \"touch $PWD/harm\";"
    { echo "$command"; mesh; } > script.msh
    { mesh; echo "$command"; } > behind.msh
    mesh | sed "s|\"body\"|\"body\"$command|" > inside.msh
    { mesh; printf '$Options\n%s\n$EndOptions\n' "$command"; } > section.msh
    refused "script in front" 2 "not a mesh of gmsh" 'nodes -u mm script.msh'
    refused "script behind" 2 "not a section" 'nodes -u mm behind.msh'
    refused "script inside" 2 "PhysicalNames" 'nodes -u mm inside.msh'
    accepted "script in a section of options: not looked at" 'nodes -u mm section.msh'
    [ ! -e harm ]
}

@test "fault 4: NaN or infinite coordinate" {
    for bad in nan inf 1e999; do
        mesh | sed "s/^20 1 0 0/20 $bad 0 0/" > bad.msh
        refused "$bad in a mesh" 2 "\$Nodes: node 2: coordinate: '$bad' is not a finite number" 'nodes -u mm bad.msh'
    done
    mts text cloud.mts | sed '/^# nodes.x/{n;s/.*/nan 0/}' > bad.mts
    refused "nan in a stream" 2 "nodes.x: row 0" 'ipoints bad.mts'
}

@test "fault 5: node count 1e11 in a header, under a memory limit" {
    mesh | sed 's/^5$/100000000000/' > many.msh
    refused "nodes of a mesh" 2 "\$Nodes: node 6: tag: '\$EndNodes' is not a whole number" "$(limit_memory) nodes -u mm many.msh"
    mesh | sed 's/^3$/100000000000/' > many.msh
    refused "elements of a mesh" 2 "\$Elements: element 4: tag: '\$EndElements' is not a whole number" "$(limit_memory) nodes -u mm many.msh"
    printf '# mts 1\n%-55s\n1 2 3\n' '# nodes.x f8 100000000000 2 enc=bin' > many.mts
    refused "rows of a stream" 2 "nodes.x" "$(limit_memory) ipoints many.mts"
    refused "rows of a stream in a pipe" 2 "nodes.x" "$(limit_memory) cat many.mts | ipoints"
}

@test "fault 6: element naming an unknown node" {
    mesh | sed 's/^4 2 2 4 1 10 30 20/4 2 2 4 1 10 30 21/' > bad.msh
    refused "in a mesh" 2 "names the node 21" 'nodes -u mm bad.msh'
    mts text cloud.mts | sed '/^# cells /{n;s/^[0-9]*/25/}' > bad.mts
    refused "in a stream" 2 "cells: row 0: no row 25 of nodes.x" 'ipoints bad.mts'
}

@test "fault 7: physical group absent, empty or misspelt" {
    refused "region absent" 2 "there are: body" 'nodes -u mm -r bdoy square.msh'
    mesh | sed 's/^2$/3/; s/^2 4 "body"/2 4 "body"\n2 5 "void"/' > void.msh
    refused "region empty" 2 "there are: body" 'nodes -u mm -r void void.msh'
    with 's/ymax/ymx/'
    refused "facets of a scene misspelt" 2 "no facet group 'ymx'; there are: xmin,xmax,ymin,ymax" 'mtled edited.scene table.mts'
    with 's/region = body/region = bdoy/'
    refused "region of a scene misspelt" 2 "no region 'bdoy'; there are: body" 'mtled edited.scene table.mts'
    with 's/facets = ymax/nodes = corner/'
    refused "node set absent" 2 "no node sets: run tag -n" 'mtled edited.scene table.mts'
}

@test "fault 8: duplicate nodes, orphan nodes, tags with gaps" {
    mesh | sed 's/^99 5 5 0/99 1 1 0/; s/^5 2 2 4 1 10 30 7/5 2 2 4 1 10 99 7/' > twin.msh
    refused "two nodes at one place" 2 "nodes at the same place, in one body: 1 pairs, the first at (0.001, 0.001) m" 'nodes -u mm twin.msh'
    mesh | sed 's/^99 5/30 5/' > twice.msh
    refused "one tag twice" 2 "node tag 30 stands twice" 'nodes -u mm twice.msh'
    accepted "orphan node, gaps in the tags" 'nodes -u mm square.msh'
}

@test "fault 9: inverted or zero-volume cells, a surface-only mesh" {
    mesh | sed 's/^7 0 1 0/7 0.9 0.2 0/' > folded.msh
    refused "inverted" 2 "elements 4 and 5 overlap: one is inverted" 'nodes -u mm folded.msh'
    mesh | sed 's/^7 0 1 0/7 0.5 0.5 0/' > flat.msh
    refused "no area" 2 "element 5 has no area" 'nodes -u mm flat.msh'
    mesh | sed 's/^7 0 1 0/7 0 1 0.5/' > surface.msh
    refused "surface in space" 2 "a surface in space" 'nodes -u mm surface.msh'
    mesh | sed 's/^3$/1/; /^[45] 2 2 4/d' > curve.msh
    refused "no cells" 2 "no cells" 'nodes -u mm curve.msh'
}

@test "fault 10: scene with unknown key, duplicate section, missing unit, comma decimal, CRLF, BOM" {
    with 's/^rho/colour = red\n&/'
    refused "unknown key" 2 "edited.scene:9: [material body]: colour" 'mtled edited.scene table.mts'
    { cat block.scene; sed -n '/material/,/rho/p' block.scene; } > edited.scene
    refused "section twice" 2 "edited.scene:18: [material body]: already in line 5" 'mtled edited.scene table.mts'
    with 's/^components = 0, -0.005/table = load.tsv/'
    printf '0 0.1 0 -0.005\n' > load.tsv
    refused "table without unit" 2 "unit" 'mtled edited.scene table.mts'
    with 's/0.45/0,45/'
    refused "comma decimal" 2 "edited.scene:8: [material body]: nu" 'mtled edited.scene table.mts'
    with 's/$/\r/'
    refused "CRLF" 2 "edited.scene:1: carriage return" 'mtled edited.scene table.mts'
    { printf '\xef\xbb\xbf'; cat block.scene; } > edited.scene
    refused "byte order mark" 2 "edited.scene:1: begins with a byte order mark" 'mtled edited.scene table.mts'
    refused "missing" 2 "none.scene: No such file" 'mtled none.scene table.mts'
}

@test "fault 11: nu >= .5, E <= 0, rho <= 0, NaN" {
    for entry in nu=0.5 nu=0.7 nu=-1 nu=nan E=0 E=-3000 E=nan E=inf rho=0 rho=-1 rho=nan; do
        with "s/^${entry%=*} = .*/${entry%=*} = ${entry#*=}/"
        refused "$entry" 2 "[material body]: ${entry%=*}" 'mtled edited.scene table.mts'
    done
    mts print points.x points.mts | awk '{ print $0, 3000, 0.45 }' > whole.tsv
    with 's/^E = .*/table = point.tsv/; s/^nu = .*/unit = m/'
    for entry in "3000 0.5" "0 0.45" "-1 0.45" "nan 0.45" "3000 nan" "inf 0.45" "3000 -1"; do
        sed "7s/3000 0.45/$entry/" whole.tsv > point.tsv
        refused "E nu of a point: $entry" 2 "point.tsv:7" 'mtled edited.scene table.mts'
    done
}

@test "fault 12: per-point material rows that do not match" {
    mts print points.x points.mts | awk '{ print $0, 3000, 0.45 }' > whole.tsv
    with 's/^E = .*/table = point.tsv/; s/^nu = .*/unit = m/'
    cp whole.tsv point.tsv
    accepted "as many rows as points, in their order" 'mtled edited.scene table.mts'
    sed '$d' whole.tsv > point.tsv
    refused "one row too few" 2 "31 rows do not match" 'mtled edited.scene table.mts'
    { cat whole.tsv; tail -n 1 whole.tsv; } > point.tsv
    refused "one row too many" 2 "33 rows for 32 integration points" 'mtled edited.scene table.mts'
    tac whole.tsv > point.tsv
    refused "another order" 2 "do not match" 'mtled edited.scene table.mts'
    sed 's/0.45$//' whole.tsv > point.tsv
    refused "a column too few" 2 "point.tsv:1" 'mtled edited.scene table.mts'
}

@test "fault 13: load curve not monotonic, of one point, or ending early" {
    with 's/0, -0.005/&\ncurve = curve.tsv/'
    printf '0 0\n0.7 1\n0.6 1\n1 1\n' > curve.tsv
    refused "time goes back" 2 "row 3" 'mtled edited.scene table.mts'
    printf '0 0\n0.5 1\n0.5 2\n1 1\n' > curve.tsv
    refused "two factors at one time" 2 "row 3" 'mtled edited.scene table.mts'
    printf '0 0\n' > curve.tsv
    refused "one point" 2 "[displacement top]" 'mtled edited.scene table.mts'
    printf '0 0\n0.5 1\n' > curve.tsv
    refused "ends early" 2 "[displacement top]" 'mtled edited.scene table.mts'
    printf '0.5 0\n1 1\n' > curve.tsv
    refused "begins late" 2 "[displacement top]" 'mtled edited.scene table.mts'
    printf '0 0\n1 nan\n' > curve.tsv
    refused "nan" 2 "curve.tsv:2" 'mtled edited.scene table.mts'
    printf '0 0 1\n1 1 1\n' > curve.tsv
    refused "three columns" 2 "curve.tsv:1" 'mtled edited.scene table.mts'
}

@test "fault 14: a node prescribed twice with different values" {
    { cat block.scene; printf '[displacement again]\nfacets = ymax\ncomponents = free, -0.006\n'; } > edited.scene
    refused "one boundary in two sections" 2 "prescribed twice: -0.006 m here, -0.005 m in [displacement top]" \
        'mtled edited.scene table.mts'
    { cat block.scene; printf '[displacement again]\nfacets = ymax\ncomponents = free, -0.005\n'; } > edited.scene
    accepted "one boundary in two sections that agree" 'mtled edited.scene table.mts'
    with 's/facets = ymax/facets = xmax/'
    refused "two boundaries that meet" 2 "prescribed twice: -0.005 m here, 0 m in [displacement bottom]" 'mtled edited.scene table.mts'
    { cat edited.scene; printf '[solver]\nconstraint_points = node\n'; } > nodal.scene
    refused "two boundaries that meet, by node" 2 "prescribed twice: -0.005 m here, 0 m in [displacement bottom]" 'mtled nodal.scene table.mts'
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    sed -i 's/dim = 2/dim = 3/; s/0, 0$/0, 0, 0/; s/0, -0.005/0, -0.005, 0/' edited.scene
    refused "two boundaries that meet, 3D" 2 "prescribed twice: -0.005 m here, 0 m in [displacement bottom]" 'mtled edited.scene cube.mts'
    sed -i 's/0, -0.005, 0/free, free, 0.005/; s/0, 0, 0/0, 0, free/' edited.scene
    accepted "two boundaries that meet, other components, 3D" 'mtled edited.scene cube.mts'
}

@test "fault 15: support with too few or coplanar nodes" {
    support -k 0.4 --no-widen points.mts > narrow.mts
    refused "too few neighbours" 1 "widen the support" 'shapefn narrow.mts'
    printf '# mts 1\n# nodes.x f8 5 2 enc=text\n0 0\n1 1\n2 2\n3 3\n4 4\n\n\n# end 1\n' | ipoints --lattice 3 > line.mts
    refused "nodes on a line" 1 "points.x: row 0 at (0, 0): no good support" 'support line.mts'
    awk 'BEGIN { print "# mts 1\n# nodes.x f8 25 3 enc=text"
        for (i = 0; i < 25; i++) print i % 5, int(i / 5), i % 5 + 2 * int(i / 5)
        print "\n\n# end 1" }' | ipoints --lattice 3 > plane.mts
    refused "nodes in a plane, 3D" 1 "no good support" 'support plane.mts'
}

@test "fault 16: upstream killed mid-pipe" {
    refused "killed while writing" 2 "cut short" '{ head -c 5000 table.mts; kill -9 $BASHPID; } 2> /dev/null | cat | mtled block.scene'
    refused "failed before writing" 2 "standard input: empty" 'nodes -u mm none.msh 2> /dev/null | ipoints'
    refused "stopped before its end line" 2 "cut short" 'mts text cloud.mts | head -n -1 | ipoints'
}

@test "fault 17: a bit flipped, or a byte missing, anywhere in a stream of any stage" {
    cloud -d 2 -k jittered -n 3 --box 0,0.1,0,0.1 > cloud.mts
    nodes -u mm square.msh > nodes.mts 2> note
    ipoints cloud.mts > points.mts
    support points.mts > lists.mts
    shapefn lists.mts > table.mts
    mtled -b block.scene table.mts > u.mts
    interp -b u.mts > interp.mts 2> note || interp u.mts > interp.mts 2> note
    streams=(nodes cloud points lists table u interp)
    for name in "${streams[@]}"; do mts text "$name.mts" > "$name.txt"; done
    run "$BUILD/tests/helper/damage" ${THOROUGH:+-a} "${streams[@]/%/.mts}" "${streams[@]/%/.txt}"
    for line in "${lines[@]}"; do record "${line%%:*}" "$status" "${line#*: }" "$([ "$status" -eq 0 ] && echo yes || echo no)"; done
    [ "$status" -eq 0 ]
    # The programs say so, too.
    for stage in 'ipoints:cloud' 'support:points' 'shapefn:lists' 'mtled block.scene:table' 'interp:u' 'fieldcmp u.mts:interp' 'mts text:nodes'; do
        file=${stage#*:}.mts
        at=$(($(stat -c %s "$file") / 2))
        byte=$(od -An -tu1 -j $at -N 1 "$file")
        { head -c $at "$file"; printf "\\x$(printf %x $((byte ^ 16)))"; tail -c +$((at + 2)) "$file"; } > bad.mts
        case $stage in
        fieldcmp*) run -2 --separate-stderr fieldcmp u.mts bad.mts
            record "fieldcmp" "$status" "$stderr" yes ;;
        *) refused "${stage%% *}" 2 "bad.mts" "${stage%:*} bad.mts" ;;
        esac
    done
}

@test "fault 18: wrong stage order, version or byte order" {
    refused "no shape functions of the stream's own, no cells" 2 "run nodes" 'cloud -d 2 -k halton -n 30 --box 0,0.1,0,0.1 | mtled block.scene'
    refused "a mesh for a stream" 2 "a gmsh mesh, not an mts stream: run nodes" 'mtled block.scene square.msh'
    refused "a stream for a mesh" 2 "not a mesh of gmsh" 'nodes -u mm cloud.mts'
    run -2 --separate-stderr fieldcmp cloud.mts cloud.mts
    record "no field to compare" "$status" "$stderr" "$([[ $stderr == "fieldcmp: "*mtled* ]] && echo yes || echo no)"
    [[ $stderr == "fieldcmp: "*mtled* ]]
    mts drop 'edge.*' table.mts > half.mts
    refused "tables missing in the middle" 2 "run" 'mtled block.scene half.mts'
    refused "version" 2 "stream version '2', this program reads version 1" "sed '1s/1/2/' cloud.mts | ipoints"
    # Bytes swapped in every number, as another machine would write them, with the right checksum.
    swap='{ for (i = 1; i <= NF; i++) { v = $i; s = 0; for (k = 0; k < 4; k++) { s = s * 256 + v % 256; v = int(v / 256) } $i = s >= 2147483648 ? s - 4294967296 : s } print }'
    mts text cloud.mts | awk "/^#/ { on = \$2 == \"cells\" } on && /^[0-9]/ $swap !(on && /^[0-9]/) { print }" | mts binary > swapped.mts
    refused "byte order of a stream" 2 "cells: row 0: no row" 'ipoints swapped.mts'
    # In a binary mesh the number 1 behind the version tells the order.
    sed 's/^\x01\x00\x00\x00$/\x00\x00\x00\x01/' "$BATS_TEST_DIRNAME/fuzz/corpus/msh/binary41" > swapped.msh
    refused "byte order of a mesh" 2 "byte" 'nodes -u mm swapped.msh'
}

# Every program with a command that writes, but for the place.
commands() {
    cat << 'END'
nodes -u mm square.msh
nodes -l square.msh
cloud -d 2 -k regular -n 5 --box 0,1,0,1
tag -n tip=side:1,30 -r lump=ball:0,0,0.05 --replace -f xmin=plane:0,0,1,0 cloud.mts
ipoints cloud.mts
support points.mts
shapefn lists.mts
mtled block.scene table.mts
interp u.mts
fieldcmp u.mts u.mts
fielderr u.mts coarse.mts
sizefield u.mts
mts list table.mts
mts print u u.mts
mts text table.mts
mts keep u u.mts
tovtk u.mts
warp slice.nii u.mts
sample slice.nii points.mts
mtled -h
mts --version
END
}

# What a command says besides notes.
but_notes() { grep -v -e 'left out' -e 'with defaults' -e 'one cell thick' -e 'keep their old value'; }

# each STATUS PATTERN COMMAND-LINE: every command, written @ there, has this status and says this behind its name; nothing if it is empty
each() {
    local command status message survived
    mtled block.scene table.mts > u.mts
    cloud -d 2 -k regular -n 3 --box 0,0.1,0,0.1 | shapefn 2> said | mtled block.scene > coarse.mts
    while IFS= read -r command; do
        status=0
        bash -c "${3//@/"$command"}" 2> said || status=$?
        message=$(but_notes < said || true)
        survived=$([[ $status -eq $1 && $message == ${2:+"${command%% *}: "$2} ]] && echo yes || echo no)
        record "$command" "$status" "$message" "$survived"
        [ "$survived" = yes ] || { echo "$command: $status: $message"; return 1; }
    done < <(commands)
}

@test "fault 19: a full device, also at the end of writing" {
    each 3 'standard output: *No space left on device' '@ > /dev/full'
}

@test "fault 20: a reader that stops early" {
    each 141 '' '{ sleep 0.1; exec @; } | true; exit ${PIPESTATUS[0]}' # by then the reader is gone
}

# A run that takes a while.
slow() { cat block.scene && printf '[solver]\nmethod = relaxation\nramp_steps = 40000\n'; }

@test "fault 21: SIGINT, SIGTERM mid-run" {
    slow > slow.scene
    mtled slow.scene table.mts > whole.dat
    for signal in INT TERM; do
        begin_and_end $signal slow.scene
        told=$(cat said)
        survived=no
        mtled -c run.ckpt slow.scene table.mts > again.dat 2> message
        if [[ $status -eq $((128 + $(kill -l $signal))) && $told == "mtled: ended by SIG$signal after step "* && $told != *$'\n'* ]] &&
            ! mts list part.dat > /dev/null 2>&1 && cmp whole.dat again.dat; then
            survived=yes
        fi
        record "SIG$signal; going on gives the same bytes" "$status" "$told" "$survived"
        [ "$survived" = yes ]
    done
}

@test "fault 22: SIGKILL while a checkpoint is written" {
    run bash "$BATS_TEST_DIRNAME/../pipelines/soak/kills.sh" "$([ -n "${THOROUGH:-}" ] && echo 40 || echo 3)"
    record "killed at random moments, going on from the checkpoint" "$status" "${lines[-1]}" "$([ "$status" -eq 0 ] && echo yes || echo no)"
    [ "$status" -eq 0 ]
}

@test "fault 23: checkpoint of another scene" {
    slow > slow.scene
    begin_and_end TERM slow.scene
    sed -i 's/E = 3000/E = 3001/' slow.scene
    refused "another scene" 2 "run.ckpt: checkpoint of another scene" 'mtled -c run.ckpt slow.scene table.mts'
    slow > slow.scene
    begin_and_end TERM slow.scene
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.21 | shapefn > other.mts 2> note
    refused "another cloud" 2 "run.ckpt: checkpoint of another cloud or table" 'mtled -c run.ckpt slow.scene other.mts'
}

walls() { printf '[displacement %s]\nfacets = %s\nnormal = 0\n' left xmin right xmax; }

@test "fault 24: instability: not finite, turned over, step collapse, out of balance, out of steps" {
    swinging_block | sed 's/-9.81/-981000/' > edited.scene
    refused "dynamic, pressed flat by its weight" 1 "edited.scene: step " 'mtled edited.scene table.mts'
    swinging_block | sed 's/-9.81/-70/' > edited.scene
    refused "dynamic, steps too coarse for the load" 1 "the energy balance is off" 'mtled edited.scene table.mts'
    { sed 's/quasi-static/dynamic/; s/-0.005/-0.0999/' block.scene; walls; printf '[solver]\nend_time = 10\ndamping = 1\n'; } > edited.scene
    refused "dynamic, pressed to a thousandth between walls" 1 "the critical step has fallen" 'mtled edited.scene table.mts'
    { sed 's/-0.005/-0.11/' block.scene; walls; } > edited.scene
    refused "quasi-static, pressed beyond its height between walls" 1 "edited.scene: step " 'mtled edited.scene table.mts'
    with 's/-0.005/-1e200/'
    refused "quasi-static, numbers out of range" 2 "times the size of the body" 'mtled edited.scene table.mts'
    { cat block.scene; printf '[solver]\nmax_steps = 2\n'; } > edited.scene
    refused "quasi-static, out of steps" 1 "not converged after 2 steps" 'mtled edited.scene table.mts'
    { swinging_block; printf 'max_steps = 3\n'; } > edited.scene
    refused "dynamic, out of steps" 1 "after 3 steps" 'mtled edited.scene table.mts'
}
