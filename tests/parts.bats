# A body in parts: cutting, then computing tables, gives the bytes of computing, then cutting.

load common.bash

# A stream as text, without its provenance; not empty.
plain() {
    mts text "$1" | bare > "$2"
    [ "$(wc -l < "$2")" -gt 20 ]
}

# same_stream A B: the same bytes but for the provenance.
same_stream() {
    plain "$1" a.text
    plain "$2" b.text
    cmp a.text b.text
}

# cut_and_compute CLOUD PARTS [OPTIONS OF part]: parts, then ipoints, support and shapefn on each part and on the whole, by the options in
# the arrays of these names; after each stage the parts make the bytes of the whole.
ipoints=() support=() shapefn=()
cut_and_compute() {
    local cloud=$1 parts=$2 stage k
    shift 2
    rm -f part.* whole.*
    part -k "$parts" -o part.%d.mts "$@" "$cloud"
    [ "$(find . -name 'part.*.mts' | wc -l)" -eq "$parts" ]
    unpart -o joined.mts part.*.mts
    same_stream joined.mts "$cloud"
    cp "$cloud" whole.mts
    for stage in ipoints support shapefn; do
        local -n options=$stage
        $stage "${options[@]}" -o whole.next whole.mts
        mv whole.next whole.mts
        for ((k = 0; k < parts; k++)); do
            $stage "${options[@]}" -o part.$k.next part.$k.mts
            mv part.$k.next part.$k.mts
            mts check part.$k.mts
        done
        unpart -o joined.mts part.*.mts
        same_stream joined.mts whole.mts || { echo "$cloud in $parts parts: $stage differs"; return 1; }
    done
}

@test "a square of gmsh with a node set: 2, 3 and 8 parts, to the byte" {
    square_msh
    nodes -u mm body.msh > square.mts
    [ -n "$(mts print sets.idx square.mts)" ]
    for parts in 2 3 8; do cut_and_compute square.mts $parts; done
}

@test "a brain section, with re-entrant corners and a cavity: 2, 3 and 8 parts, to the byte" {
    gmsh -2 -v 1 "$top/examples/brain2d/brain2d.geo" -setnumber lc 9 -o brain.msh
    nodes -u mm brain.msh > brain.mts
    for parts in 2 3 8; do cut_and_compute brain.mts $parts; done
    [ "$(mts print facepoint.around <(support brain.mts 2> note) | wc -l)" -gt 10 ]
}

@test "cubes, jittered and graded: 2, 3 and 8 parts, to the byte" {
    cloud -d 3 -k jittered --jitter 0.15 -n 7 --box 0,0.1,0,0.1,0,0.1 > jittered.mts
    cloud -d 3 -k graded --ratio 3 -n 12,5,5 --box 0,0.3,0,0.1,0,0.1 > graded.mts
    cut_and_compute jittered.mts 2
    cut_and_compute jittered.mts 8
    cut_and_compute graded.mts 3
}

@test "interfaces at which supports stop: 2 to 13 parts, to the byte, also where a halo has only a corner of a side" {
    gmsh -2 -v 1 "$top/examples/block/block.geo" -o block.msh
    nodes -u mm block.msh > block.mts
    support=(-i lump)
    for parts in 2 3 8; do cut_and_compute block.mts $parts; done
    support=(-i tissue,lump)
    cut_and_compute block.mts 13
    gmsh -2 -v 1 "$top/examples/brain2d/brain2d.geo" -setnumber lc 9 -o brain.msh
    nodes -u mm brain.msh > brain.mts
    support=(-i tumour)
    for parts in 5 13; do cut_and_compute brain.mts $parts; done
    "$BUILD/tests/helper/phantom" two > two.nii.gz
    voxels -h 9mm two.nii.gz > two.mts
    support=(-i label_2)
    for parts in 3 8; do cut_and_compute two.mts $parts; done
}

@test "Gauss points, other supports, a field that travels along" {
    cloud -d 2 -k jittered --jitter 0.3 -n 14,6 --box 0,0.2,0,0.1 --field quadratic > field.mts
    ipoints=(-g 3)
    support=(-k 2.2 -w regularised --mu 1e-5)
    cut_and_compute field.mts 3 -f 2.2
    ipoints=()
    support=(-R 30mm --reach distance)
    shapefn=(-b mls1)
    cut_and_compute field.mts 4 -R 30mm
    mts print u joined.mts | cmp - <(mts print u field.mts)
}

@test "in one go, and side by side" {
    cloud -d 2 -k jittered --jitter 0.3 -n 12 --box 0,0.1,0,0.1 > square.mts
    part -k 4 -o part.%d.mts square.mts
    printf '%s\n' part.?.mts | xargs -P 4 -I {} shapefn -o {}.table {} 2> note
    unpart part.?.mts.table > joined.mts
    same_stream joined.mts <(shapefn square.mts 2> note)
    block quasi-static > held.scene
    held_below >> held.scene
    printf '[displacement top]\nfacets = ymax\ncomponents = 0, -0.005\n' >> held.scene
    cmp <(mtled -q held.scene joined.mts | bare) <(mtled -q held.scene square.mts 2> note | bare)
}

@test "the same cut for any number of threads; parts in any order" {
    cloud -d 3 -k jittered --jitter 0.15 -n 8 --box 0,0.1,0,0.1,0,0.1 > cube.mts
    OMP_NUM_THREADS=1 part -k 5 -o one.%d.mts cube.mts
    OMP_NUM_THREADS=3 part -k 5 -o part.%d.mts cube.mts
    for k in 0 1 2 3 4; do cmp one.$k.mts part.$k.mts; done
    unpart part.{3,0,4,1,2}.mts > joined.mts
    same_stream joined.mts cube.mts
    # Own nodes are all nodes, each once.
    for k in 0 1 2 3 4; do
        paste -d ' ' <(mts print part.node part.$k.mts) <(mts print part.owner part.$k.mts) | awk -v k=$k '$2 == k { print $1 }'
    done | sort -n | cmp - <(seq 0 511)
}

@test "part -v: a table of halo, bytes and imbalance" {
    cloud -d 3 -k jittered --jitter 0.15 -n 20,8,8 --box 0,0.2,0,0.08,0,0.08 > beam.mts
    part -k 2 -v beam.mts 2> two
    part -k 8 -v beam.mts 2> eight
    [ ! -e part.0.mts ]
    cat two eight | awk -F '\t' '
        NF != 12 { exit 1 }
        /^parts/ { next }
        # Own nodes are 1280 in all; 24 bytes come and 24 go for each node that is needed; work is balanced to 5 %.
        { n++; if ($2 * $1 != 1280 || $10 < 47 * $6 || $10 > 49 * $6 || !($12 >= 0 && $12 < 0.05)) bad = 1; needed[n] = $6 }
        END { exit bad || n != 2 || !(needed[1] > 100 && needed[1] < 640) }'
    # Two halves of a beam of 20 x 8 x 8 nodes: what is needed is at least the layers within two spacings, and less than twice these.
    awk -F '\t' '!/^parts/ { exit !($6 >= 2 * 64 * 0.9 && $6 <= 4 * 64) }' two
}

@test "parts that do not belong together, or are not whole" {
    cloud -d 2 -k jittered --jitter 0.3 -n 12 --box 0,0.1,0,0.1 > square.mts
    part -k 3 -o part.%d.mts square.mts
    part -k 3 -w 2 -o wide.%d.mts square.mts
    refused 2 "part 1 of 3 is missing" unpart part.0.mts part.2.mts
    refused 2 "part.1.mts and part.1.mts are the same part, 1" unpart part.0.mts part.1.mts part.1.mts part.2.mts
    refused 2 "part.0.mts and wide.1.mts are parts of different cuts: cut again" unpart part.0.mts wide.1.mts part.2.mts
    refused 2 "square.mts: no section part.node: not a part of a body" unpart square.mts
    ipoints -o points.1.mts part.1.mts
    refused 2 "part.0.mts: no section points.x, but in points.1.mts: run the same stages on all parts" unpart part.0.mts points.1.mts part.2.mts
    for k in 0 1 2; do shapefn -o table.$k.mts part.$k.mts 2> note; done
    support -k 1.9 part.1.mts 2> note | shapefn -o other.1.mts
    unpart table.?.mts > joined.mts
    shapefn -b mls1 -o other.1.mts part.1.mts 2> note
    refused 2 "other.1.mts: support.radius: not made as in table.0.mts: run the same stages on all parts" unpart table.0.mts other.1.mts table.2.mts
    head -c 3000 part.1.mts > torn.1.mts
    run -2 --separate-stderr unpart part.0.mts torn.1.mts part.2.mts
    [ -z "$output" ]
    shortened part.facet part.1.mts > facets.1.mts
    refused 2 "facets.1.mts: part.facet: " unpart part.0.mts facets.1.mts part.2.mts
    mts text part.1.mts | awk '/^# part.owner/ { on = 1; print; next } on && NF == 1 && !done { print ($1 + 1) % 3; done = 1; next } { print }' > owner.1.mts
    run -2 --separate-stderr unpart part.0.mts owner.1.mts part.2.mts
    [ -z "$output" ]
}

@test "bodies and parts whose numbers are damaged" {
    square_msh
    nodes -u mm -t body.msh > square.dat
    # damage SECTION VALUE FILE: the first number of its first row.
    damage() { awk -v name="$1" -v value="$2" '/^# / { on = $2 == name } !/^#/ && NF && on { $1 = value; on = 0 } { print }' "$3"; }
    refuse() { # TEXT SECTION VALUE
        damage "$2" "$3" square.dat > damaged.dat
        run ! cmp -s damaged.dat square.dat
        refused 2 "$1" part -k 2 -v damaged.dat
    }
    refuse "facets: row 0: no node 900" facets 900
    refuse "facets: row 0: no node -1" facets -1
    refuse "sets.idx: row 0: no node 900" sets.idx 900
    refuse "sets.ptr: does not fit its lists and sets.idx" sets.ptr 1
    refuse "sets.ptr: does not fit its lists and sets.idx" sets.ptr -1
    refuse "cells: row 0: " cells 900
    shortened facets.set square.dat > damaged.dat
    refused 2 "facets.set: does not fit facets" part -k 2 -v damaged.dat
    shortened cells.region square.dat > damaged.dat
    refused 2 "cells.region: does not fit cells: 41 rows instead of 42" part -k 2 -v damaged.dat
    part -t -k 2 -o part.%d.dat square.dat
    for section in part.node part.owner part.cell part.facet facets sets.idx sets.ptr; do
        for value in -1 900 2000000000; do
            damage $section $value part.1.dat > damaged.dat
            run -2 --separate-stderr unpart part.0.dat damaged.dat
            [ -z "$output" ]
        done
    done
    # Heads that promise what is not there are found out before memory is asked for.
    for lie in 's/nodes=[0-9]*/nodes=2000000000/' 's/cells=[0-9]*/cells=2000000000/' 's/parts=2/parts=2000000000/'; do
        for k in 0 1; do sed "$lie" part.$k.dat > lie.$k.dat; done
        run -2 --separate-stderr bash -c 'ulimit -v 2000000; unpart lie.0.dat lie.1.dat'
        [ -z "$output" ]
    done
}

@test "a halo that is too narrow is reported, and a wider one does" {
    cloud -d 2 -k jittered --jitter 0.3 -n 24 --box 0,0.1,0,0.1 > square.mts
    part -k 6 -w 1 -o part.%d.mts square.mts
    for k in 0 1 2 3 4 5; do support -k 7 -o list.$k.mts part.$k.mts 2> note; done
    run -2 --separate-stderr unpart list.?.mts
    [ -z "$output" ]
    [[ "$stderr" == *"a neighbour at the edge of the halo: cut again with a wider one (part -w, now 1)" ]]
    part -k 6 -f 7 -o part.%d.mts square.mts
    for k in 0 1 2 3 4 5; do support -k 7 -o list.$k.mts part.$k.mts 2> note; done
    unpart -o joined.mts list.?.mts
    same_stream joined.mts <(support -k 7 square.mts 2> note)
}

@test "part and its options; mtled and groups refuse a part" {
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 > square.mts
    refused 2 "give -k PARTS" part -o part.%d.mts square.mts
    refused 2 "nothing to do: give -o NAME or -v" part -k 2 square.mts
    refused 2 "-o part.mts: has to have one %d" part -k 2 -o part.mts square.mts
    refused 2 "-o %d%d.mts: has to have one %d" part -k 2 -o %d%d.mts square.mts
    refused 2 "26 parts of 25 nodes" part -k 26 -v square.mts
    cloud -d 2 -k halton -n 25 --box 0,0.1,0,0.1 > halton.mts
    refused 2 "no section cells" part -k 2 -v halton.mts
    part -k 2 -o part.%d.mts square.mts
    refused 2 "the input is a part already" part -k 2 -v part.0.mts
    pressed_block > block.scene
    refused 2 "the input is one part of a body: name all, as part.%d.mts" mtled block.scene part.0.mts
    refused 2 "the input is one part of a body: make groups before it is cut" groups -f 'a=all' part.0.mts
    # One part is the whole; tables are left out.
    shapefn square.mts 2> note | part -k 1 -o one.%d.mts 2> said
    grep -q '^part: left out: .*support.radius' said
    unpart one.0.mts > joined.mts
    same_stream joined.mts square.mts
    # Where nothing can be written.
    refused 3 "nowhere/0.mts" part -k 2 -o nowhere/%d.mts square.mts
    run -3 --separate-stderr unpart -o /dev/full part.0.mts part.1.mts
}

@test "model of an evaluation on many processes: one part, no messages; two parts, by hand" {
    printf 'stage\tnodes\tus_per_node\nmtled, an evaluation\t1000\t9\nmtled, an evaluation\t8000\t2\n' > stages.tsv
    printf 'parts\towns\n1\t8000\t8000\t8000\t8000\t0\t0\t0\t0\t0\t0\t0\n2\t4000\t4000\t5000\t5000\t600\t600\t1\t1\t28800\t28800\t0.05\n' > parts.tsv
    awk -f "$top/pipelines/scale/model.awk" stages.tsv parts.tsv > model.tsv
    # 8000 nodes at 2 us; on two: 4000 x 2 us x 1.05, and 10 + 2 messages of 10 us, 28 800 + 8 x 8 x 300 bytes at 10 GB/s.
    [ "$(sed -n 2p model.tsv)" = "$(printf 'strong\t1\t8000\t0\t16000.0\t0.0\t0.0\t1.0\t100')" ]
    [ "$(sed -n 3p model.tsv)" = "$(printf 'strong\t2\t4000\t600\t8400.0\t124.8\t1.5\t1.9\t94')" ]
    # 50 000 nodes a part, in a cube of 36.84 spacings, a halo 0.38 deep on all sides.
    awk -F '\t' '$1 == "weak" && $2 == 1024 { exit !($4 > 3140 && $4 < 3150 && $5 == 103000) }' model.tsv
    run -1 awk -f "$top/pipelines/scale/model.awk" <(head -n 1 stages.tsv) parts.tsv
}

@test "make scale: every stage, halos and the model" {
    at=$PWD/out/scale
    make -C "$top" BUILD="$(realpath --relative-to "$top" "$BUILD")" OUT="$PWD/out" SCALE_SIZES=6 SCALE_CUT=8 SCALE_PARTS="2 4" \
        "$at"/{stages,parts,model}.tsv > log 2>&1 || { cat log; false; }
    [ "$(cut -f 1 "$at/stages.tsv" | paste -s -d /)" = "stage/cloud/ipoints/support/shapefn/mtled, one step/mtled, an evaluation/part, 8 parts" ]
    awk -F '\t' 'NR > 1 && $1 != "part, 8 parts" && !($2 == 216 && $3 > 0) { exit 1 } $1 == "shapefn" { exit !($4 > 5000 && $4 < 12000) }' "$at/stages.tsv"
    [ "$(cut -f 1 "$at/parts.tsv" | paste -s -d /)" = parts/2/4 ]
    [ "$(grep -c '^strong' "$at/model.tsv") $(grep -c '^weak' "$at/model.tsv")" = "2 10" ]
}
