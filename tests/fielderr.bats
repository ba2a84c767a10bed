# fielderr: an estimate of the discretisation error from two or three clouds; sizefield: sizes of a graded mesh; make refine.

load common.bash

# about VALUE EXPECTED SHARE
about() {
    awk -v a="$1" -v b="$2" -v share="$3" 'BEGIN { exit !((a - b) ^ 2 <= (share * b) ^ 2) }' || { echo "$1 is not about $2"; return 1; }
}

# [FORM=...] field FILE N ERROR [VALUES]: a lattice of N nodes per axis with the linear field (1 + x, y), or (FORM, y), off by ERROR along x.
field() {
    cloud -d 2 -k regular -n "$2" --box 0,1,0,1 -t -o cloud.dat
    with_section cloud.dat u f8 <(mts print nodes.x cloud.dat | awk "{ print ${FORM:-1 + \$1} + $3, \$2 }") unit=m |
        with_section - reactions f8 <(awk "BEGIN { print 3, 4 + $3; print 0, -5 }") "unit=N/m rows=${4:-foot,head}" |
        with_section - energy f8 <(awk "BEGIN { print 10 - 2 * $3, 0 }") 'unit=J/m cols=internal,contact' > "$1"
    mts check "$1"
}

@test "an error that falls by a known order is found, of the field, of forces and of the energy" {
    field fine.dat 17 0.01
    field coarse.dat 9 0.04
    field coarser.dat 5 0.16
    run -0 --separate-stderr fielderr -p 2 fine.dat coarse.dat
    about "$(value avg)" 0.01 1e-5
    about "$(value max)" 0.01 1e-5
    about "$(value mean)" 0.01 1e-5
    about "$(value avg.body)" 0.01 1e-5
    [ "$(value n)" = 289 ]
    [ "$(value order)" = 2 ]
    [ "$(value ratio)" = 2 ]
    [ "$(value cells_ratio)" = 2 ]
    about "$(value force.foot)" 0.01 1e-5
    about "$(value force_relative.foot)" "$(awk 'BEGIN { print 0.01 / sqrt(9 + 4.01 ^ 2) }')" 1e-5
    [ "$(value force.head)" = 0 ]
    [ "$(value force_relative.head)" = 0 ]
    about "$(value energy)" 0.02 1e-5
    about "$(value energy_relative)" "$(awk 'BEGIN { print 0.02 / 9.98 }')" 1e-5
    about "$(value reference)" "$(awk 'BEGIN { print sqrt(2.01 ^ 2 + 1) }')" 1e-5
    # Of two results the gradients tell the order: of a smooth field, of a singular one.
    for form in 2:'exp($1)' 1.5:'(1e-9 + $1 ^ 2 + $2 ^ 2) ^ 0.25'; do
        FORM=${form#*:} field fine2.dat 33 0
        FORM=${form#*:} field coarse2.dat 17 0
        run -0 --separate-stderr fielderr fine2.dat coarse2.dat
        about "$(value order)" ${form%:*} 0.05
    done
    run -0 --separate-stderr fielderr fine.dat coarse.dat coarser.dat
    about "$(value order)" 2 1e-5
    about "$(value avg)" 0.01 1e-5
    run -0 --separate-stderr fielderr -r 4 -p 1 fine.dat coarser.dat
    about "$(value avg)" 0.05 1e-5
    run -0 --separate-stderr fielderr -p 2 - coarse.dat < fine.dat
    about "$(value avg)" 0.01 1e-5
}

@test "both errors: what the iteration leaves, carried by the result, beside that of the discretisation" {
    pressed_block > block.scene
    printf '[solver]\ntolerance = 1e-7\n' >> block.scene
    sed 's/1e-7/1e-10/' block.scene > exact.scene
    for n in 9 17; do
        cloud -d 2 -k jittered --jitter 0.2 -n $n --box 0,0.1,0,0.1 | shapefn > $n.mts 2> log
        mtled -v block.scene $n.mts > $n.dat 2> $n.log
    done
    told=$(mts print iteration 17.dat)
    about "$(awk -F '\t' '$1 == "iteration error, m" { print $2 }' 17.log)" "$told" 0.01
    grep -q '^discretisation error, m' 17.log
    # It is a bound, of the order of the tolerance.
    mtled -q exact.scene 17.mts > exact.dat
    run -0 --separate-stderr fieldcmp 17.dat exact.dat
    awk -v max="$(value max)" -v told="$told" 'BEGIN { exit !(max <= told && told <= 1e-7 * 0.006) }'
    [ "$(value iteration_a)" = "$(printf '%.9g' "$told")" ]
    awk -v b="$(value iteration_b)" -v a="$told" 'BEGIN { exit !(b > 0 && b < a / 100) }'
    run -0 --separate-stderr fielderr 17.dat 9.dat
    [ "$(value dominant)" = discretisation ]
    awk -v both="$(value iteration)" -v told="$told" 'BEGIN { exit !(both > told && both < 10 * told) }'
    [ -z "$stderr" ]
    # A linear field has no error of discretisation: the iteration is what two results differ by.
    sed -e 's/1e-7/0.3/' -e 's/^components = 0, 0$/normal = 0/' -e 's/^components = 0, -0.005/normal = -0.005/' block.scene > rough.scene
    printf '[displacement left]\nfacets = xmin\nnormal = 0\n' >> rough.scene
    for n in 9 17; do mtled -q rough.scene $n.mts > rough$n.dat; done
    run -0 --separate-stderr fielderr rough17.dat rough9.dat
    [ "$(value dominant)" = iteration ]
    [[ $stderr == "fielderr: the iterations may have left "*" m: a smaller tolerance in [solver]"* ]]
    # A result of another program does not tell.
    mts drop iteration 17.dat > untold.dat
    run -0 --separate-stderr fielderr untold.dat 9.dat
    run ! value dominant
    run -0 --separate-stderr fieldcmp untold.dat 9.dat
    run ! value iteration_a
}

@test "fielderr: a map, tolerances, conditions that only one result has" {
    field fine.dat 17 0.01
    field coarse.dat 9 0.04 foot,other
    run -0 --separate-stderr fielderr -p 2 -t -m map.dat --tol-avg 10.1mm --tol-max 0.0101 fine.dat coarse.dat
    mts check map.dat
    mts print error map.dat | awk '($1 - 0.01) ^ 2 > 1e-16 { exit 1 } END { exit NR != 289 }'
    value force.foot
    run ! value force.head
    run -1 --separate-stderr fielderr -p 2 --tol-avg 9.9mm fine.dat coarse.dat
    [[ $stderr == "fielderr: avg 0.01"*" is beyond 0.0099" ]]
    mts text fine.dat | sed 's/^1\.01 0$/nan 0/; s/^1\.01 -\?0$/nan 0/' > nan.dat
    grep -q '^nan' nan.dat
    run -1 --separate-stderr fielderr nan.dat coarse.dat
    [[ $stderr == *"not a finite number"* ]]
}

@test "fielderr: the wrong way round, the same cloud, other ratios, wrong command lines" {
    field fine.dat 17 0.01
    field coarse.dat 9 0.04
    refused 2 "coarse.dat has 81 nodes, fine.dat 289: the coarser result comes second" fielderr coarse.dat fine.dat
    refused 2 "the coarser result comes second" fielderr fine.dat fine.dat
    refused 2 "-p: of three results the order is observed" fielderr -p 1 fine.dat coarse.dat coarse.dat
    refused 2 "the coarser result comes second" fielderr fine.dat coarse.dat fine.dat
    for arguments in "-p 0" "-p nan" "-r 1" "-r 0.5" "-r x" "--tol-avg -1" "--field none" "--region none" "-t"; do
        # shellcheck disable=SC2086 # several arguments
        refused 2 "" fielderr $arguments fine.dat coarse.dat
    done
    run -0 --separate-stderr fielderr -r 8 fine.dat coarse.dat
    [[ $stderr == "fielderr: fine.dat has 2 times as many cells per direction as coarse.dat, not 8: see -r" ]]
    cloud -d 3 -k regular -n 3 --box 0,1,0,1,0,1 --field linear -o cube.mts
    refused 2 "1 columns in 3D" fielderr fine.dat cube.mts
}

@test "sizefield: finer at the plates' corners, a view that gmsh takes, and its limits" {
    pressed_block > block.scene
    cloud -d 2 -k regular -n 21 --box 0,0.1,0,0.1 | shapefn 2> log | mtled -q block.scene -o u.dat
    run -0 --separate-stderr sizefield -v -s 0.25 -u mm u.dat
    [[ ${lines[0]} == 'View "size" {' ]]
    [ "${lines[-1]}" = "};" ]
    [ "$(grep -c '^ST(' <<< "$output")" -eq $((2 * 20 * 20 + 2 * 80)) ]
    [ "$(wc -l <<< "$stderr")" -eq 3 ]
    least=$(awk -F '\t' '$1 == "least size" { print $2 }' <<< "$stderr")
    awk -v least="$least" 'BEGIN { exit !(least > 1 && least < 3) }'
    # The least sizes are at the corners of the block, in mm.
    sed -n 's/^ST(\([^)]*\)){\([^}]*\)};/\1,\2/p' <<< "$output" | awk -F , '
        { for (k = 0; k < 3; k++) if (best == "" || $(10 + k) < best) { best = $(10 + k); x = $(3 * k + 1); y = $(3 * k + 2) } }
        END { print x, y; exit !((x < 10 || x > 90) && (y < 10 || y > 90)) }'
    sizefield -s 0.25 -u mm -o sizes.pos u.dat
    printf 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 100, 100};\nPhysical Surface("body") = {1};\nMerge "sizes.pos";\nBackground Mesh View[0];\n' > graded.geo
    gmsh -v 1 -2 graded.geo -setnumber Mesh.MeshSizeExtendFromBoundary 0 -setnumber Mesh.MeshSizeFromPoints 0 -o graded.msh
    asked=$(awk -F '\t' '$1 == "nodes" { print $2 }' <<< "$stderr")
    about "$(nodes -u mm graded.msh | mts print nodes.x | wc -l)" "$asked" 0.25
    run -0 --separate-stderr sizefield -v -s 1e-6 -n 500 u.dat
    [[ $stderr == "sizefield: these sizes ask for "*" nodes: made larger for 500 (-n)"* ]]
    run -0 --separate-stderr sizefield -v -s 0.25 --least 4mm u.dat
    [[ $stderr == *"least size	0.004"* ]]
    sizefield u.dat | cmp - <(OMP_NUM_THREADS=3 sizefield u.dat)
    for arguments in "-s 0" "-n 0" "-n 1e9" "-u foot" "--least 0" "--sag -1mm" "--field nodes.y"; do
        # shellcheck disable=SC2086 # several arguments
        refused 2 "" sizefield $arguments u.dat
    done
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 --field quadratic -o cube.mts
    run -0 --separate-stderr sizefield cube.mts
    [ "$(grep -c '^SS(' <<< "$output")" -eq $(($(mts print cells cube.mts | wc -l) + 3 * 6 * 2 * 2 * 2)) ]
    mts keep nodes.x,u u.dat > bare.dat
    refused 2 "cells" sizefield bare.dat
}

@test "make refine: a round at a time until the estimate is below the tolerance" {
    export UNIT=mm
    run -0 bash "$top/pipelines/refine/refine.sh" "$top/examples/block/block.scene" "$top/examples/block/block.geo" 0.01mm out
    mts check out/u.dat
    [ -s out/body.msh ]
    [ -s out/sizes.pos ]
    awk -F '\t' 'NR == 2 { first = $2 } { nodes = $2; mean = $3 } END { exit !(NR > 2 && nodes > first && mean <= 0.01) }' out/rounds.tsv
    # The result is that of the last round.
    [ "$(mts print nodes.x out/u.dat | wc -l)" -eq "$(tail -n 1 out/rounds.tsv | cut -f 2)" ]
}

@test "make refine: wrong tolerance, budget, size, files: one line; a budget that is spent keeps the last good round" {
    export UNIT=mm
    scene=$top/examples/block/block.scene geometry=$top/examples/block/block.geo
    for tolerance in 0 1foot '1 mm'; do
        run -2 bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" "$tolerance" out
        [ "${#lines[@]}" -eq 1 ]
        [[ $output == "refine: TOL: "* ]]
    done
    for setting in NODES=0 NODES=1e9 ROUNDS=0 START=x; do
        run -2 env "$setting" bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 1mm out
        [ "${#lines[@]}" -eq 1 ]
        [[ $output == "refine: ${setting%%=*}: "* ]]
    done
    run -2 bash "$top/pipelines/refine/refine.sh" missing.scene "$geometry" 1mm out
    [ "$output" = "refine: SCENE: no file missing.scene" ]
    run -2 bash "$top/pipelines/refine/refine.sh" "$scene" missing.geo 1mm out
    [ "$output" = "refine: GEO: no file missing.geo" ]
    run -2 env UNIT= bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 1mm out
    [ "$output" = "refine: UNIT: say in which unit $geometry is, as UNIT=mm" ]
    run -2 env REFINE_GROUPS="-f 'held=low:z" bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 1mm out
    [ "$output" = "refine: GROUPS: -f 'held=low:z: a quote is not closed" ]
    [ ! -e out ]
    run -1 --separate-stderr env NODES=400 bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 0.001mm out
    [[ $stderr == "refine: the budget of 400 nodes (NODES) is spent; kept: round "* ]]
    mts check out/u.dat
    run -1 --separate-stderr bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 1e-12 other
    [[ $stderr == "refine: TOL: 1e-12 is less than the error that the scene's [solver] tolerance of 1e-5 leaves; kept: round 1, "* ]]
    mts check other/u.dat
    # A scene that is no good ends the first round, and what was there before stays.
    cp -r out before
    sed 's/^E = .*/E = -1/' "$scene" > bad.scene
    run -1 --separate-stderr bash "$top/pipelines/refine/refine.sh" bad.scene "$geometry" 0.1mm out
    [ "$(wc -l <<< "$stderr")" -eq 1 ]
    [[ $stderr == "refine: round 1: the scene: mtled: "*"kept: none" ]]
    cmp out/u.dat before/u.dat
    run -1 --separate-stderr env UNIT=parsec bash "$top/pipelines/refine/refine.sh" "$scene" "$geometry" 0.1mm out
    [[ $stderr == "refine: round 1: the scene: nodes: "*"kept: none" ]]
}

# refine VARIABLE...: through make, as a user does, into ./out
refine() {
    make -C "$top" --no-print-directory BUILD="$(realpath --relative-to "$top" "$BUILD")" REFINE_OUT="$PWD/out" refine "$@"
}

@test "make refine: variables reach the stages, through make" {
    run -2 refine
    [[ $output == *"refine: usage: make refine SCENE=FILE GEO=FILE UNIT=UNIT TOL=LENGTH, or GEO=IMAGE SPACING=LENGTH"* ]]
    "$BUILD/tests/helper/phantom" sphere > sphere.nii.gz
    printf '1 flesh\n' > names.tsv
    {
        printf '[scene]\ndim = 3\nanalysis = quasi-static\n[material body]\nregion = flesh\nE = 3000\nnu = 0.49\nrho = 1000\n'
        printf '[displacement held]\nfacets = low_end\ncomponents = 0, 0, 0\n[displacement pushed]\nfacets = pushed\ncomponents = 0, 0, -0.002\n'
    } > press.scene
    run -0 refine SCENE="$PWD/press.scene" GEO="$PWD/sphere.nii.gz" SPACING=8mm VOXELS="-l $PWD/names.tsv" TOL=1mm \
        GROUPS="-u mm -f 'low_end=all and ball:0,0,-24,14' -f pushed=ball:0,0,24,12"
    mts check out/u.dat
    [ "$(wc -l < out/rounds.tsv)" -eq 2 ]
}

@test "make refine: rounds that are over keep the one of least estimate, and say which" {
    # Stand-ins: each round has more nodes; the second estimate is the least.
    mkdir bin
    for tool in gmsh sizefield mtled nodes ipoints support shapefn; do
        printf '#!/bin/bash\n[ ! -p /dev/stdin ] || cat > /dev/null\n' > bin/$tool
        printf 'while [ $# -gt 0 ]; do [ "$1" != -o ] || { echo %s >> calls; wc -l < calls > "$2"; }; shift; done\n' $tool >> bin/$tool
    done
    printf 'printf "least size\\t0.001\\n" >&2\n' >> bin/sizefield
    cat > bin/fielderr << 'END'
#!/bin/bash
echo x >> rounds
n=$(wc -l < rounds)
printf 'n\t%d\nmean\t%s\nmax\t1\nreference\t1\n' $((1000 * n)) "$(sed -n "${n}p" estimates)"
END
    printf '0 0\n1 1\n' > places
    printf '#!/bin/bash\ncat places\n' > bin/mts
    chmod +x bin/*
    printf '0.0005\n0.0002\n0.0003\n' > estimates
    printf '[scene]\ndim = 2\n' > some.scene
    touch some.geo
    run -1 --separate-stderr env PATH="$PWD/bin:$PATH" PLACES="$PWD/places" UNIT=m ROUNDS=3 KEEP_ROUNDS=1 \
        bash "$top/pipelines/refine/refine.sh" some.scene some.geo 0.1mm out
    [ "$stderr" = "refine: 3 rounds (ROUNDS) are over; kept: round 2, 2000 nodes, 0.2 mm" ]
    [ "$(wc -l < out/rounds.tsv)" -eq 4 ]
    cmp out/u.dat out/u-2.dat
    run -1 cmp out/u.dat out/u-3.dat
}

@test "sizefield: the same sizes as a stream" {
    cloud -d 3 -k regular -n 4 --box 0,0.1,0,0.1,0,0.1 --field quadratic -o cube.mts
    sizefield -t cube.mts > sizes.dat
    mts list sizes.dat | cut -f 1 | tr '\n' ' ' | has -x 'nodes.x cells size '
    mts print cells sizes.dat | wc -l > count
    [ "$(cat count)" -eq $(($(mts print cells cube.mts | wc -l) + 3 * 6 * 3 * 3 * 2)) ]
    # Corners and sizes of the simplices of the view, but for the order.
    sizefield cube.mts | sed -n 's/^SS([^)]*){\([^}]*\)};/\1/p' | tr , '\n' | sort -g > of_view
    awk 'NR == FNR { size[FNR - 1] = $1; next } { for (k = 1; k <= 4; k++) printf "%.6g\n", size[$k] }' \
        <(mts print size sizes.dat) <(mts print cells sizes.dat) | sort -g | cmp - of_view
    sizefield -b cube.mts | mts text | grep -v '^# @' | cmp - <(grep -v '^# @' sizes.dat)
    refused 2 "one of -b and -t" sizefield -b -t cube.mts
    refused 2 "-u goes without -b and -t" sizefield -b -u mm cube.mts
}
