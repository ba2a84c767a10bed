# The scripts of pipelines/ and examples/: reading streams in awk, decks for CalculiX, tables of the studies.

load common.bash

setup() {
    cd "$BATS_TEST_TMPDIR" || return
    pipelines="$BATS_TEST_DIRNAME/../pipelines"
}

# A square of 4 x 4 nodes whose sides follow u = (.05 x + .02 y, -.03 x - .04 y).
make_patch() {
    cloud -d 2 -k jittered -n 4 --box 0,0.1,0,0.1 --jitter 0.3 -t -o square.dat
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n' > patch.scene
    printf '[material all]\nregion = body\nE = 3000\nnu = 0.49\nrho = 1000\n' >> patch.scene
    for side in xmin xmax ymin ymax; do
        printf '[displacement %s]\nfacets = %s\ntable = %s.tsv\nunit = cm\n' $side $side $side >> patch.scene
    done
    side() { awk -v OFS='\t' '{ print $1, $2, .05 * $1 + .02 * $2, -.03 * $1 - .04 * $2 }'; }
    printf '0 0\n0 10\n' | side > xmin.tsv
    printf '10 0\n10 10\n' | side > xmax.tsv
    printf '0 0\n10 0\n' | side > ymin.tsv
    printf '0 10\n10 10\n' | side > ymax.tsv
}

# A cube of 3 x 3 x 3 nodes whose sides follow u = (.05 x + .02 y, -.03 y + .01 z, .02 x - .04 z).
make_cube() {
    cloud -d 3 -k jittered -n 3,3,3 --box 0,0.1,0,0.1,0,0.1 --jitter 0.15 --seed 4 -t -o cube.dat
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n' > cube.scene
    printf '[material all]\nregion = body\nE = 3000\nnu = 0.49\nrho = 1000\n' >> cube.scene
    for side in xmin xmax ymin ymax zmin zmax; do
        printf '[displacement %s]\nfacets = %s\ntable = %s.tsv\nunit = cm\n' $side $side $side >> cube.scene
        awk -v side=$side 'BEGIN {
            axis = index("xyz", substr(side, 1, 1))
            for (i = 0; i <= 10; i += 2.5) for (j = 0; j <= 10; j += 2.5) {
                x[axis] = side ~ /max/ ? 10 : 0
                x[axis % 3 + 1] = i
                x[(axis + 1) % 3 + 1] = j
                print x[1], x[2], x[3], .05 * x[1] + .02 * x[2], -.03 * x[2] + .01 * x[3], .02 * x[1] - .04 * x[3]
            }
        }' > $side.tsv
    done
}

@test "CalculiX passes the linear patch test in 3D, and its reactions balance" {
    make_cube
    bash "$pipelines/calculix/solve.sh" cube.scene cube.dat 1 > u.dat 2> log
    mts check u.dat
    grep -q "^points	$((4 * $(mts print cells cube.dat | wc -l)))$" log
    paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '
        { a = $4 - .05 * $1 - .02 * $2; b = $5 + .03 * $2 - .01 * $3; c = $6 - .02 * $1 + .04 * $3; error = sqrt(a * a + b * b + c * c); n++ }
        !(error < 1e-7) { print "node", n - 1, "is off by", error; failed = 1 }
        END { exit failed || n != 27 }'
    # The sides share their edges, whose nodes count for the first side only: all of them together balance.
    mts print reactions u.dat | awk '
        { for (d = 1; d <= 3; d++) { sum[d] += $d; size += $d < 0 ? -$d : $d } n++ }
        END { for (d = 1; d <= 3; d++) if (!(sum[d] ^ 2 < (1e-4 * size) ^ 2)) exit 1; exit n != 6 || !(size > 0) }'
}

@test "deck: the strip of a rigid curve lies behind it, its elements counter-clockwise, on either side" {
    make_patch
    printf '0 0\n1 0\n2 0.5\n' > left.tsv
    printf '2 0.5\n1 0\n0 0\n' > right.tsv
    for side in left right; do
        (cat patch.scene; printf '[contact floor]\nfacets = ymin\nrigid = %s.tsv\nunit = cm\nside = %s\n' $side $side) > contact.scene
        awk -f "$pipelines/stream.awk" -f "$pipelines/scene.awk" -f "$pipelines/table.awk" -f "$pipelines/calculix/deck.awk" -f "$pipelines/calculix/deck2d.awk" -v scene=contact.scene -v mesh=square.dat > deck.inp
        awk -F, '
            /^\*/ { part = $0; next }
            part ~ /^\*NODE/ { x[$1] = $2; y[$1] = $3 }
            part ~ /CPE4/ {
                n++
                area = (x[$4] - x[$2]) * (y[$5] - y[$3]) - (x[$5] - x[$3]) * (y[$4] - y[$2])
                if (!(area > 0)) { print "element", $1, "is turned"; exit 1 }
                if (!(y[$3] < y[$2] && y[$4] < y[$5])) { print "element", $1, "lies before the curve"; exit 1 }
            }
            END { if (n != 2) exit 1 }' deck.inp
    done
}

# A block of a jittered cloud in D dimensions, pressed by a fifth between sides on which it slides: confined, the stress is uniform.
make_confined() {
    cloud -d "$1" -k jittered -n 4 --box 0,0.1,0,0.1"$([ "$1" -eq 2 ] || echo ,0,0.1)" --jitter 0.3 -t -o body.dat
    local walls=ymin top=ymax
    [ "$1" -eq 2 ] || { walls='ymin, ymax, zmin' && top=zmax; }
    { block quasi-static | sed "s/dim = 2/dim = $1/; s/0.45/0.49/"
        printf '[displacement walls]\nfacets = xmin, xmax, %s\nnormal = 0\n' "$walls"
        printf '[displacement lid]\nfacets = %s\nnormal = -0.02\n' $top; } > confined.scene
}

@test "mixed elements: a confined block, exact to round-off in 2D and 3D, nodes of the mesh first" {
    for dim in 2 3; do
        make_confined $dim
        bash "$pipelines/mixed/solve.sh" confined.scene body.dat > u.dat 2> log
        mts check u.dat
        grep -q '^solver seconds	[0-9]' log
        mts print nodes.x body.dat > corners
        mts print nodes.x u.dat | head -n "$(wc -l < corners)" | paste - corners | awk -v dim=$dim '
            { for (i = 1; i <= dim; i++) if (!(($i - $(i + dim)) ^ 2 < 1e-20)) { print; exit 1 } }'
        paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk -v dim=$dim '
            { for (i = 1; i <= dim; i++) if (!(($(i + dim) + (i == dim ? 0.2 * $i : 0)) ^ 2 < 1e-18)) { print; exit 1 } }
            END { if (NR <= 4 ^ dim) exit 1 }'
        mts print reactions u.dat | awk -v dim=$dim '
            NR == 2 { force = $dim / 0.1 ^ (dim - 1); if (!((force / -10350.4555 - 1) ^ 2 < 1e-14)) { print force; exit 1 } }
            END { if (NR != 2) exit 1 }'
    done
}

@test "mixed elements: a traction is what the held side bears, as by CalculiX; their field at places, quadratic within an element, beyond the mesh that at the nearest place" {
    make_patch
    # A bar that its weight of tractions bends: a field that is not linear in an element.
    {
        sed '/^\[displacement/,$d' patch.scene
        printf '[displacement foot]\nfacets = ymin\ncomponents = 0, 0\n[traction pull]\nfacets = ymax\ncomponents = 30, 0\n'
    } > pull.scene
    bash "$pipelines/mixed/solve.sh" pull.scene square.dat > u.dat 2> log
    mts print reactions u.dat | awk '!(($1 + 3)^2 < 1e-8 && $2^2 < 1e-8) { print; exit 1 }'
    bash "$pipelines/calculix/solve.sh" pull.scene square.dat > other.dat 2> log
    mts print reactions other.dat | awk '!(($1 + 3)^2 < 1e-8 && $2^2 < 1e-8) { print; exit 1 }'
    bash "$pipelines/mixed/solve.sh" pull.scene square.dat u.dat > at.dat 2> log
    mts check at.dat
    run -0 cmp <(mts print nodes.x u.dat) <(mts print nodes.x at.dat)
    paste <(mts print u u.dat) <(mts print u at.dat) | awk '
        { a = $3 - $1; b = $4 - $2; if (!(a * a + b * b < 1e-20)) { print; exit 1 } } END { if (NR != 49) exit 1 }'
    grep -q '^processor seconds	[0-9]' log
    run ! grep -q places log
    printf '# mts 1\n# nodes.x f8 2 2 enc=text unit=m\n0.1 0.1\n0.1 0.1001\n\n\n# end 1\n' > beyond.dat
    bash "$pipelines/mixed/solve.sh" pull.scene square.dat beyond.dat 2> log | mts print u |
        awk '{ u[NR] = $1 } END { exit !(NR == 2 && u[1] > 0 && (u[2] / u[1] - 1) ^ 2 < 1e-4) }'
    make_cube
    bash "$pipelines/mixed/solve.sh" cube.scene cube.dat cube.dat 2> log > at.dat
    paste <(mts print nodes.x at.dat) <(mts print u at.dat) | awk '
        { a = $4 - .05 * $1 - .02 * $2; b = $5 + .03 * $2 - .01 * $3; c = $6 - .02 * $1 + .04 * $3 }
        !(a * a + b * b + c * c < 1e-14) { print; exit 1 }
        END { if (NR != 27) exit 1 }'
}

@test "adaptive: what each mesh needs to an error, and what is a bound only" {
    {
        printf 'case\tmesh\tnodes\tseconds\tall_seconds\testimate_mm\terror_mm\teffectivity\n'
        printf 'c\teven\t100\t1\t1\t1\t4\t1\nc\teven\t1600\t16\t1\t1\t1\t1\n'
        printf 'c\tgraded\t100\t1\t1\t1\t4\t1\nc\tgraded\t400\t4\t1\t1\t1\t1\nc\tgraded\t800\t8\t1\t1\t0.5\t1\n'
        printf 'c\tmixed even\t500\t20\t1\t-\t1\t-\nc\tmixed graded\t100\t2\t1\t-\t4\t-\nc\tmixed graded\t400\t8\t1\t-\t1\t-\n'
        printf 'd\teven\t100\t1\t1\t1\t4\t1\nd\tgraded\t100\t3\t1\t1\t4\t1\n'
    } > table
    awk -v levels='c:2 c:0.5 c:0.1 d:8' -f "$pipelines/adaptive/reach.awk" table > reach
    [ "$(sed -n 2p reach)" = "c	2	400	200	0.50	4	2	<20	4	0.50" ]
    [ "$(sed -n 3p reach)" = "c	0.5	>1.6e+03	800	<0.50	>16	8	>20	>8	<0.40" ]
    [ "$(sed -n 4p reach)" = "c	0.1	>1.6e+03	>800	-	>16	>8	>20	>8	-" ]
    [ "$(sed -n 5p reach)" = "d	8	<100	<100	-	<1	<3	-	-	-" ]
}

@test "mixed elements: a block that lies on a curve, a gap below it at first" {
    make_confined 2
    # Held at its sides and pushed down by 3 mm, of which 2 mm are the gap: as a block that is pressed by 1 mm on what it slides on.
    sed 's/-0.02/-0.001/' confined.scene > held.scene
    bash "$pipelines/mixed/solve.sh" held.scene body.dat > held.dat 2> log
    sed -e 's/, ymin$//' -e 's/-0.02/-0.003/' confined.scene > pushed.scene
    printf '[contact floor]\nfacets = ymin\nrigid = floor.tsv\nunit = mm\nside = left\n' >> pushed.scene
    printf -- '-50 -2\n40 -2\n150 -2\n' > floor.tsv
    bash "$pipelines/mixed/solve.sh" pushed.scene body.dat > pushed.dat 2> log
    paste <(mts print u held.dat) <(mts print u pushed.dat) | awk '
        { a = $3 - $1; b = $4 - $2 + 0.002 } !(a * a + b * b < 1e-10) { print; exit 1 } END { if (NR < 20) exit 1 }'
}

@test "mixed elements: what they do not understand, and a missing or failing FreeFEM, are one line" {
    make_confined 2
    try() { run --separate-stderr "$1" bash "$pipelines/mixed/solve.sh" "$2" body.dat; [ -z "$output" ]; }
    (cat confined.scene; printf '[pressure wall]\nfacets = ymin\nvalue = 3\n') > pressure.scene
    try -2 pressure.scene
    [[ $stderr == *"section [pressure] is not understood"* && ${#stderr_lines[@]} -eq 1 ]]
    (cat confined.scene; printf '[contact floor]\nfacets = ymin\nrigid = a.tsv\nunit = m\nside = left\ntranslation = 0, 1\n') > moved.scene
    try -2 moved.scene
    [[ $stderr == *"only one contact, with a curve that stays"* && ${#stderr_lines[@]} -eq 1 ]]
    sed 's/normal = -0.02/components = free, -0.02/; s/ymin$/ymax/' confined.scene > twice.scene
    try -2 twice.scene
    [[ $stderr == *"ymax is moved in two ways"* ]]
    sed 's/E = 3000/E = 3000\nmodel = mooney-rivlin/' confined.scene > other.scene
    try -2 other.scene
    sed 's/-0.02/-0.11/' confined.scene > through.scene # through the floor
    try -4 through.scene
    [[ $stderr == "solve.sh: through.scene: no equilibrium found beyond 0."*" of the load" ]]
    mkdir bin
    for program in bash awk sed mktemp rm dirname tail cat head; do ln -s "$(command -v $program)" bin; done
    PATH=$PWD/bin try -1 confined.scene
    [ "$stderr" = "solve.sh: no FreeFem++-nw: run make deps" ]
    printf '#!/bin/bash\nexit 1\n' > bin/FreeFem++-nw
    chmod +x bin/FreeFem++-nw
    PATH=$PWD/bin try -1 confined.scene
    [ "$stderr" = "solve.sh: FreeFEM failed on confined.scene" ]
}

@test "reference: a quarter of a table becomes the whole body" {
    printf '# head\n0.05 0 0.004 0\n0.05 0.05 0 -0.01\n' | awk -f "$pipelines/reference.awk" -v push=0.02 > whole.dat
    mts check whole.dat
    paste <(mts print nodes.x whole.dat) <(mts print u whole.dat) | awk '{ printf "%.4f %.4f %.4f %.4f\n", $1, $2, $3 + 1e-9, $4 + 1e-9 }' |
        sort > rows
    [ "$(cat rows)" = "0.0000 0.0000 0.0000 0.0000
0.0000 0.0500 -0.0040 -0.0100
0.0000 0.1000 0.0000 -0.0200
0.1000 0.0000 0.0000 0.0000
0.1000 0.0500 0.0040 -0.0100
0.1000 0.1000 0.0000 -0.0200" ]
}

@test "deck: what it does not understand, and a stream cut short, are errors" {
    make_patch
    deck() { awk -f "$pipelines/stream.awk" -f "$pipelines/scene.awk" -f "$pipelines/table.awk" -f "$pipelines/calculix/deck.awk" -f "$pipelines/calculix/deck2d.awk" -v scene="$1" -v mesh="$2"; }
    (cat patch.scene; printf '[pressure top]\nfacets = ymax\nvalue = 1\n') > pressure.scene
    run ! deck pressure.scene square.dat
    sed 's/facets = ymax/facets = roof/' patch.scene > roof.scene
    run ! deck roof.scene square.dat
    head -n 30 square.dat > short.dat
    run ! deck patch.scene short.dat
    deck patch.scene square.dat > deck.inp
}

@test "table1: a regular entry off by more than .0001, or singular where the paper's is not, fails" {
    paper=$pipelines/table1-paper.tsv
    awk -f "$pipelines/table1.awk" "$paper" "$paper"
    sed 's/0.0817/0.0818/' "$paper" > near.tsv
    awk -f "$pipelines/table1.awk" "$paper" near.tsv
    sed 's/0.0817/0.0819/' "$paper" > far.tsv
    run -1 awk -f "$pipelines/table1.awk" "$paper" far.tsv
    sed 's/0.0059/singular/' "$paper" > singular.tsv
    run -1 awk -f "$pipelines/table1.awk" "$paper" singular.tsv
    head -n 1 "$paper" > empty.tsv
    run -1 awk -f "$pipelines/table1.awk" "$paper" empty.tsv
}

@test "convergence: orders between sizes, and the slope over all" {
    for n in 100 400 1600; do
        printf 'avg\t%s\nmax\t0.01\n' "$(awk "BEGIN { print 1e-3 * 100 / $n }")" > "block-default-$n.errors"
        printf 'prepare\t0.1\nsolve\t1\nnodes\t%d\n' $n > "block-default-$n.time"
    done
    awk -f "$pipelines/convergence/table.awk" block-default-{100,400,1600}.errors | awk -F '\t' '
        NR == 2 && !($5 == 1 && $7 == "-" && $8 == 2) || NR > 2 && !($7 == 2 && $8 == 2) { print; exit 1 }
        END { if (NR != 4) exit 1 }'
    rm block-default-400.time
    run -1 awk -f "$pipelines/convergence/table.awk" block-default-{100,400,1600}.errors
}

@test "speed-error: the time to an error, on a line in log-log; none beyond what was computed" {
    printf 'case\tscheme\th\tnodes\tprepare_s\tsolve_s\ttotal_s\terror_percent\tforce_N\n' > table
    for s in 'default\t1\t8' 'calculix\t10\t80' 'dolfinx\t2\t16'; do
        printf "$s\n" | awk -F '\t' '{ printf "c\t%s\t2\t100\t0\t1\t%s\t4\t-\nc\t%s\t1\t400\t0\t8\t%s\t0.5\t-\n", $1, $2, $1, $3 }'
    done >> table
    awk -f "$pipelines/speed-error/reach.awk" table > reach
    grep -q "^c	default	4	>8	>8	8	4	>8	>8$" reach
    grep -q "^c	calculix	40	>80	>80	80	4	>8	>8$" reach
    grep -q "^c	dolfinx	8	>16	>16	16	4	>8	>8$" reach
}

@test "the tables of the brain section are those that its geometry gives" {
    mkdir brain2d
    cp "$BATS_TEST_DIRNAME"/../examples/brain2d/{brain2d.geo,make-tables.sh} brain2d
    bash brain2d/make-tables.sh
    for table in load skull; do
        paste "brain2d/$table.tsv" "$BATS_TEST_DIRNAME/../examples/brain2d/$table.tsv" | awk '
            /^#/ { next }
            { for (i = 1; i <= NF / 2; i++) if (!(($i - $(i + NF / 2)) ^ 2 < 1e-10)) exit 1; n++ }
            END { if (n < 65) exit 1 }'
    done
}

@test "foreign: meshes are as poor as they are meant to be; a row for each, of a mesh that is refused as well" {
    for name in jittered-1 voxels-hex; do bash "$pipelines/foreign/mesh.sh" $name $name.msh; done
    # between LEAST MOST MESH: its least quality
    between() {
        nodes -v -u mm "$3.msh" 2>&1 > "$3.mts" | sed -nE 's/^nodes: quality of the cells: least ([^,]*),.*/\1/p' |
            awk -v low="$1" -v high="$2" '{ bad = !($1 >= low && $1 <= high) } END { exit bad || NR != 1 }'
    }
    between 0.001 0.02 jittered-1
    between 0.5 1 voxels-hex
    run -2 bash "$pipelines/foreign/mesh.sh" none none.msh

    head -c 900 voxels-hex.msh > cut.msh
    bash "$pipelines/foreign/push.sh" cut cut.msh > row
    awk -F '\t' '{ exit !(NF == 9 && $2 == "-" && $5 == 2 && $9 ~ /^nodes: .*cut.msh: /) }' row
}

@test "brain2d-convergence: medians, the largest difference and the order of each size; what is missing is reported" {
    for k in 1 2 3; do
        for size in 8 4; do
            for ends in '' -ends; do
                mean=$((k * size))e-6
                [ -z "$ends" ] || mean=$((k * 2))e-6
                printf 'avg\t%s\nmax\t%s\n' $mean "$((k * size))e-5" > $size-$k$ends.errors
                printf 'avg\t%s\n' "$((k + size))e-6" > $size-$k$ends.even
                printf '# mts 1\n# nodes.x f8 %s 2 enc=text\n' $((1000 / size + k)) > $size-$k$ends.dat
            done
        done
    done
    awk -f "$pipelines/brain2d-convergence.awk" 8-{1,3,2}.errors 4-{1,3,2}.errors 8-{1,3,2}-ends.errors 4-{1,3,2}-ends.errors > table
    printf 'ends\tlc\tnodes\tmeans_mm\tmedian_mm\tmax_mm\teven_mm\torder\n' > wanted
    printf 'even\t8\t126-128\t0.0080-0.0240\t0.0160\t0.2400\t0.0100\t-\n' >> wanted
    printf 'even\t4\t251-253\t0.0040-0.0120\t0.0080\t0.1200\t0.0060\t1.00\n' >> wanted
    printf 'fine\t8\t126-128\t0.0020-0.0060\t0.0040\t0.2400\t0.0100\t-\n' >> wanted
    printf 'fine\t4\t251-253\t0.0020-0.0060\t0.0040\t0.1200\t0.0060\t0.00\n' >> wanted
    cmp table wanted
    echo > 4-1.even
    run -1 awk -f "$pipelines/brain2d-convergence.awk" 4-1.errors
    [[ "$output" == *'no avg in 4-1.even'* ]]
}

@test "make scale: every stage of the pipe" {
    top=$BATS_TEST_DIRNAME/..
    at=$PWD/out/scale
    make -C "$top" BUILD="$(realpath --relative-to "$top" "$BUILD")" OUT="$PWD/out" SCALE_SIZES=6 "$at/stages.tsv" > log 2>&1 || { cat log; false; }
    [ "$(cut -f 1 "$at/stages.tsv" | paste -s -d /)" = "stage/cloud/ipoints/support/shapefn/mtled, one step/mtled, an evaluation" ]
    awk -F '\t' 'NR > 1 && !($2 == 216 && $3 > 0) { exit 1 } $1 == "shapefn" { exit !($4 > 5000 && $4 < 12000) }' "$at/stages.tsv"
}
