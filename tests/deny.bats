# Fault 25: whichever allocation of a program fails, the status is 3, one line tells so, and nothing that is written passes for whole.
# Denied is the first allocation of each path of calls; thoroughly, and under sanitizers, which find what is lost then, see `every`.

load common.bash
load faults.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    export OMP_NUM_THREADS=1
    mesh > square.msh
    printf '1 a\n2 b\n' > labels.tsv
    printf -- '-1 -0.001\n2 -0.001\n' > floor.tsv
    printf '0 -1 -1 0 2 -1 0 0 3\n' > wall.tsv
    printf '0 0\n0.5 0.7\n1 1\n' > curve.tsv
    printf '0 0.1 0 -0.005\n0.1 0.1 0 -0.005\n' > load.tsv
    nifti step slice.nii 1 2
    "$BUILD/tests/helper/phantom" sphere 0 10 > sphere.nii
    cloud -d 2 -k regular -n 3 --box 0,0.1,0,0.1 | shapefn > coarse.mts 2> note
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 > cloud.mts
    ipoints cloud.mts > points.mts
    support points.mts > lists.mts
    shapefn lists.mts > table.mts
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    { pressed_block; printf '[output]\nstress = yes\nreactions = yes\nframes = 2\n[solver]\ntolerance = 1e-3\n'; } > block.scene
    { block quasi-static; loads; printf '[displacement low]\nfacets = ymin\ntable = load.tsv\nunit = m\ncurve = curve.tsv\n'; } > loaded.scene
    { block dynamic 'gravity = 0, -9.81' | sed 's/^rho/prony = .4 .01\n&/'; loads; contact; printf '[support side]\nfacets = xmin\nnormal = 10\ndamping = 1\n[membrane skin]\nfacets = xmax\nthickness = 1e-4\nE = 1e5\nnu = 0\n[solver]\nend_time = 0.01\n[output]\nenergy = yes\ngaps = yes\n'; } > moving.scene
    { pressed_cube zmin zmax -0.002; printf '[contact wall]\nfacets = xmin\nrigid = wall.tsv\nunit = m\nside = front\n'; } > cube.scene
    pair | nodes -u m | tag -f 'low=low:y,1%' -f 'high=high:y,1%' | shapefn > pair.mts 2> note
    { pressed_block | sed 's/= ymin/= low/; s/= ymax/= high/; s/^dim = 2/&\nduration = 1/; s/^nu = .*/&\nprony = .5 1/'; printf '[contact faces]\nfacets = *\nagainst = *\nfriction = 0.1\n[solver]\ntime_steps = 2\n[output]\ngaps = yes\n'; } > pair.scene
    mtled block.scene table.mts > u.mts
    mtled block.scene coarse.mts > u.coarse.mts
}

# Two blocks of 0.1 x 0.04 m, 0.001 m apart, as a mesh.
pair() {
    awk 'BEGIN {
        print "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n18"
        for (k = 0; k < 18; k++) print k + 1, .05 * (k % 3), int(k / 3) * .02 + (k > 8 ? -.019 : 0), 0
        print "$EndNodes\n$Elements\n16"
        for (b = 0; b < 2; b++) for (j = 0; j < 2; j++) for (i = 0; i < 2; i++) {
            a = 9 * b + 3 * j + i + 1
            print ++n, 2, 0, a, a + 1, a + 4
            print ++n, 2, 0, a, a + 4, a + 3
        }
        print "$EndElements" }'
}

loads() { printf '[%s top]\nfacets = ymax\n%s\n' pressure 'value = 10' traction 'components = 0, -10'; }
contact() { printf '[contact floor]\nfacets = ymin\nrigid = floor.tsv\nunit = m\nside = left\nfriction = 0.1\n'; }

setup() {
    [[ $BUILD != *-coverage* ]] || skip "gcov allocates as well"
    [[ $BUILD != *-san*-clang ]] || skip "clang's sanitizers are in the programs, and come before what is preloaded"
    cp -r "$BATS_FILE_TMPDIR"/. "$BATS_TEST_TMPDIR"
    enter_alone
    set +o pipefail
}

# The command with its allocation number DENY failing; under sanitizers, a leak or any other finding is status 99.
deny() {
    LD_PRELOAD=$BUILD/tests/helper/deny.so UBSAN_OPTIONS=exitcode=99 \
        ASAN_OPTIONS=verify_asan_link_order=0:allocator_may_return_null=1:detect_leaks=1:fast_unwind_on_malloc=0:exitcode=99 "$@"
}

# denied COMMAND...: let its allocations fail in turn. Where one does, status 3, one line, no whole stream; or it was not needed, and the
# output is what it is else.
denied() {
    local total bad=0 hit=0 spared=0 status said line step=1
    [ -n "${THOROUGH:-}" ] || export DENY_EACH=path
    DENY_COUNT=count deny "$@" > whole 2> whole.message
    mapfile -t said < <(grep . whole.message)
    local notes=${#said[@]}
    total=$(cat count)
    [[ $BUILD != *-san* ]] || step=$((total / 8 + 1))
    for ((i = 0; i < total; i += step)); do
        status=0
        DENY=$i deny "$@" > out 2> message || status=$?
        said=()
        while IFS= read -r line; do [ -z "$line" ] || said+=("$line"); done < message
        if [ "$status" -eq 0 ] && cmp -s out whole; then
            spared=$((spared + 1))
        elif [ "$status" -eq 3 ] && [ ${#said[@]} -gt 0 ] && [ ${#said[@]} -le $((notes + 1)) ] && [[ ${said[-1]} == *[a-z]": "* ]] &&
            { [ ! -s out ] || cmp -s out whole || ! mts list out > /dev/null 2>&1; }; then
            hit=$((hit + 1))
        else
            bad=$((bad + 1))
            echo "$*: allocation $i: status $status: ${said[*]}"
        fi
    done
    record "$*" 3 "$hit of $total allocations denied, each: status 3, one line; $spared not needed; $bad else" "$([ $bad -eq 0 ] && echo yes || echo no)"
    [ "$bad" -eq 0 ] && [ "$hit" -gt 0 ]
}

@test "fault 25: nodes, at each allocation" {
    for file in "$BATS_TEST_DIRNAME"/fuzz/corpus/{msh/{ascii22,binary41},inp/{solid,part,second},feb/{v40,sets25},vtk/{packed.vtu,text.vtk}}; do denied nodes -u mm "$file"; done
    denied nodes -l square.msh
}

@test "fault 25: cloud, ipoints, support, shapefn" {
    denied cloud -d 2 -k regular -n 5 --box 0,1,0,1
    denied cloud -d 3 -k halton -n 20 --box 0,1,0,1,0,1
    denied ipoints cloud.mts
    denied support points.mts
    denied shapefn lists.mts
}

@test "fault 25: mtled, displacements and contacts, at rest" {
    denied mtled block.scene table.mts
    denied mtled pair.scene pair.mts
}

# bats test_tags=thorough
@test "fault 25: mtled, contact with a rigid surface in 3D" {
    denied mtled cube.scene cube.mts
    mts print nodes.x cube.mts | sed 's/$/ 1 0 0/' > fibres.tsv
    sed 's/^E = .*/model = guccione\nC = 2000\nbf = 1\nbt = 1\nbfs = 1\nfibres = fibres.tsv\nunit = m/' cube.scene > fibres.scene
    denied mtled fibres.scene cube.mts
}

@test "fault 25: mtled, loads, in time" {
    denied mtled loaded.scene table.mts
    denied mtled moving.scene table.mts
}

@test "fault 25: mts, tag, interp, fieldcmp, fielderr, sizefield, tovtk" {
    for command in 'list table.mts' 'print u u.mts' 'text table.mts' 'binary u.mts' 'keep u u.mts' 'check table.mts'; do denied mts $command; done
    denied tag -n tip=side:1,30 -r lump=ball:0,0,0.05 --replace -f xmin=plane:0,0,1,0 cloud.mts
    denied interp u.mts
    printf '%s\n' '-1 .03' '.06 .03' > cut.txt
    denied incise -s cut.txt -d u.mts -l 1% cloud.mts
    printf '{"markups": [{"controlPoints": [{"label": "a", "position": [-50, -50, 50]}]}]}' > point.mrk.json
    mtled cube.scene cube.mts > u.cube.mts
    denied interp -p point.mrk.json u.cube.mts
    printf '.04 -1 -1 .04 2 -1 .04 0 3\n' > cut.tsv
    denied incise -s cut.tsv -d u.cube.mts cube.mts
    printf '[displacement seen]\npoints = point.mrk.json\nmoved = point.mrk.json\n' | cat cube.scene - > seen.scene
    denied mtled seen.scene cube.mts
    denied fieldcmp u.mts u.coarse.mts
    denied fielderr u.mts u.coarse.mts
    denied sizefield u.mts
    denied tovtk u.mts
}

@test "fault 25: voxels, warp, sample" {
    denied voxels -h 25mm -l labels.tsv slice.nii
    denied voxels -h 25mm --surface a -l labels.tsv slice.nii
    denied voxels -h 20mm sphere.nii
    denied warp slice.nii u.mts
    warp -o slice.nrrd slice.nii u.mts
    warp -o slice.mha slice.nii u.mts
    denied warp slice.nrrd u.mts
    denied warp slice.mha u.mts
    warp -o pair.mhd slice.nii u.mts
    denied warp -o pair.mhd slice.mha u.mts
    cp sphere.nii sphere.nii.gz
    nifti segments sphere.nii.gz sphere.seg.nrrd 1 sphere
    denied voxels -h 20mm sphere.seg.nrrd
    denied sample slice.nii points.mts
    /usr/bin/python3 -c 'import nibabel as n, numpy as m; n.save(n.Nifti1Image(m.ones((9, 9, 9, 3), m.float32), m.diag([50, 50, 50, 1])), "axes.nii")'
    denied sample --vector --outside 0 axes.nii cube.mts
    sample --vector --outside 0 -o along.mts axes.nii cube.mts 2> note
    sed 's/^E = .*/model = guccione\nC = 2000\nbf = 1\nbt = 1\nbfs = 1/' cube.scene > fibres.scene
    denied mtled fibres.scene along.mts
    printf '.04 -1 -1 .04 2 -1 .04 0 3\n' > across.tsv
    denied incise -s across.tsv along.mts
    denied fibres --from zmin,60 --to zmax,-60 --axis 1,0,0 cube.mts
}
