# sample: values of images at points, and the stiffness made of them.

load common.bash

setup_file() {
    cd "$BATS_FILE_TMPDIR" || return
    nifti smooth scan.nii.gz
    cloud -d 3 -k jittered -n 5 --box 0,0.06,0,0.06,0,0.06 --jitter 0.12 > cube.mts
    cloud -d 2 -k jittered -n 7 --box 0,0.1,0,0.1 --jitter 0.2 > square.mts
    nifti step step.nii 0 100
}

setup() {
    enter
    cp "$BATS_FILE_TMPDIR"/{scan.nii.gz,cube.mts,square.mts,step.nii} .
}

# The test image, at the places in columns 1 to 3.
exact='{ e = 100 + 50 * sin(300 * $1) * cos(200 * $2 + 1) + 30 * sin(250 * $3) }'

@test "usage, and wrong command lines" {
    printf '0.01 0.01 0.01\n' > points.tsv
    for arguments in "" "scan.nii.gz cube.mts more" "--nonsense scan.nii.gz" "-i quintic scan.nii.gz cube.mts" \
        "--outside x scan.nii.gz cube.mts" "-p points.tsv scan.nii.gz cube.mts" "-p points.tsv -a nodes.x scan.nii.gz" \
        "-p points.tsv --section T scan.nii.gz" "-p missing scan.nii.gz" "-t scan.nii.gz cube.mts" "-u foot scan.nii.gz cube.mts" \
        "-a nothing scan.nii.gz cube.mts" "-a cells scan.nii.gz cube.mts" "-r body -a nodes.x scan.nii.gz cube.mts" \
        "-r nowhere scan.nii.gz cube.mts" "--material missing scan.nii.gz cube.mts" "--tissue 3000 scan.nii.gz cube.mts" \
        "--tissue 3000,0.5 scan.nii.gz cube.mts" "--tissue 3000,.4 --material points.tsv scan.nii.gz cube.mts" \
        "--tissue 3000,.4 --tissue 1000,.4 scan.nii.gz" "missing.nii cube.mts" "cube.mts cube.mts" "scan.nii.gz scan.nii.gz" \
        "--section T -u mm scan.nii.gz cube.mts" "--section no/name scan.nii.gz cube.mts" "--section end scan.nii.gz cube.mts" "scan.nii.gz square.mts"; do
        run -2 --separate-stderr sample $arguments < /dev/null
        stderr=$(grep -av "ran with defaults" <<< "$stderr")
        [[ "$stderr" == "sample: "* && $(wc -l <<< "$stderr") -eq 1 ]] || { echo "$arguments: $stderr"; false; }
        [ -z "$output" ]
    done
}

@test "the nodes by default, integration points, and a table of landmarks in its own unit" {
    sample -i cubic scan.nii.gz cube.mts > nodes.tsv
    head -n 1 nodes.tsv | has -x '# x y z value'
    tail -n +2 nodes.tsv | cut -d ' ' -f 1-3 | cmp - <(mts print nodes.x cube.mts)
    ipoints cube.mts | sample -i cubic -a points.x scan.nii.gz > points.tsv
    [ "$(wc -l < points.tsv)" -gt "$(wc -l < nodes.tsv)" ]
    printf '30 20 10 # a landmark\n31.5 22.25 40.125\n' > landmarks.tsv
    sample -i cubic -u mm -p landmarks.tsv scan.nii.gz > landmarks.out
    tail -n +2 landmarks.out | cut -d ' ' -f 1-3 | cmp - <(printf '30 20 10\n31.5 22.25 40.125\n')
    awk '!/^#/ { print $1 / 1e3, $2 / 1e3, $3 / 1e3, $4 }' landmarks.out > landmarks.m
    for file in nodes.tsv points.tsv landmarks.m; do
        awk "/^#/ { next } $exact"' { d = $4 - e; bad += !(d * d < .04); n++ } END { exit bad || !n }' $file
    done
    printf '# CoordinateSystem = LPS\n# columns = label,x,y,z\na,-30,-20,10\nb,-31.5,-22.25,40.125\n' > landmarks.fcsv
    sample -i cubic -u mm -p landmarks.fcsv scan.nii.gz | cmp - landmarks.out
    sample -i nearest -u mm -p landmarks.tsv scan.nii.gz | awk 'NR == 2 { print $4 }' > at
    awk -v a="$(cat at)" -v b="$(nifti value scan.nii.gz 38 28 18)" 'BEGIN { d = a - b; exit !(d * d < 1e-10) }'
}

@test "colours are three columns; a section goes with the stream" {
    nifti change scan.nii.gz rgb.nii rgb
    sample -i nearest rgb.nii cube.mts > rgb.tsv
    awk '{ exit !(NF == 6 || /^#/) }' rgb.tsv
    sample --section T1 scan.nii.gz cube.mts > with.mts
    mts check with.mts
    [ "$(mts list with.mts | grep -c .)" -eq $(($(mts list cube.mts | grep -c .) + 1)) ]
    mts print T1 with.mts | cmp - <(sample scan.nii.gz cube.mts | awk '!/^#/ { print $4 }')
    for name in cells nodes.x points.weight u u.frame.2; do
        refused 2 "--section $name: other programs make this section: give another name" sample --section $name scan.nii.gz cube.mts
    done
    sample --section T1 -t scan.nii.gz < cube.mts | has '^# T1 f8 125 1'
}

@test "outside of the image: an error that names the first, or a value that is reported" {
    printf '10 10 10\n100 0 0\n0 0 -9\n' > points.tsv
    refused 2 "points.tsv: row 1 at (0.1, 0, 0) m, one of 2 of 3: outside of scan.nii.gz" sample -u mm -p points.tsv scan.nii.gz
    run -0 --separate-stderr sample --outside -3 -u mm -p points.tsv scan.nii.gz
    [[ $stderr == *"2 of 3 points are outside of scan.nii.gz"*"-3 taken" ]]
    [ "$(tail -n 2 <<< "$output" | awk '{ print $4 }' | xargs)" = "-3 -3" ]
    nifti change scan.nii.gz nan.nii nan
    printf '30 30 30\n' > points.tsv
    refused 2 "or not finite there" sample -u mm -p points.tsv nan.nii
    run -2 --separate-stderr sample -p points.tsv scan.nii.gz # in m
    [ -z "$output" ]
}

@test "an image a thousand times larger than the body, which one voxel would hold, is refused" {
    "$BUILD/tests/helper/phantom" sphere@metres > metres.nii.gz
    voxels -u mm -h 8mm metres.nii.gz > sphere.mts
    printf '0 1000 0.3\n1 3000 0.49\n' > stiffness
    refused 2 "nodes.x: all points lie within 0.048 of a voxel of metres.nii.gz: another space, or unit?" sample metres.nii.gz sphere.mts
    refused 2 "another space, or unit" sample --material stiffness metres.nii.gz sphere.mts
    printf '0 0 0\n1 0 0\n' > points.tsv
    sample -u mm -p points.tsv metres.nii.gz
    # A region may be as small.
    tag -r small=ball:0.03,0.03,0.03,0.012 cube.mts | ipoints > points.mts
    /usr/bin/python3 -c 'import nibabel as n, numpy as m; n.save(n.Nifti1Image(m.ones((4, 4, 4)), 40 * m.eye(4)), "coarse.nii")'
    sample -r small coarse.nii points.mts 2> said > values.tsv
    awk '!/^#/ { n++; for (d = 1; d < 4; d++) { if (n == 1 || $d < low[d]) low[d] = $d; if (n == 1 || $d > high[d]) high[d] = $d } }
        END { exit !(n > 1 && high[1] - low[1] < .04) }' values.tsv
}

@test "stiffness from values: a table that a scene reads, with the same result as its own numbers" {
    pressed_block > uniform.scene
    sed 's/^E = .*/table = stiffness.tsv/; s/^nu = .*/unit = m/' uniform.scene > table.scene
    printf '# value E nu\n-10 1000 .45\n50 3000 .45\n150 5000 .45\n' > law.tsv
    shapefn square.mts 2> note > table.mts
    nifti step same.nii 50 50
    sample --material law.tsv same.nii table.mts > stiffness.tsv
    head -n 1 stiffness.tsv | has -x '# x y E nu'
    mtled -b uniform.scene table.mts | mts print u > uniform.u
    mtled -b table.scene table.mts | mts print u > table.u
    paste uniform.u table.u | awk '{ for (i = 1; i <= 2; i++) { d = $i - $(i + 2); bad += !(d * d < 1e-24) } } END { exit bad || !NR }'
    # The two halves of the step.
    sample -i nearest --material law.tsv step.nii table.mts > stiffness.tsv
    awk '!/^#/ { d = $3 - ($1 < .05 ? 1000 + 2000 / 6 : 4000); bad += !(d * d < 1e-12); n++ } END { exit bad || !n }' stiffness.tsv
    mtled -q -b table.scene table.mts | mts print u > step.u
    run -1 cmp -s step.u uniform.u
    # Beyond the table its ends are taken, and that is reported.
    nifti step far.nii -20 170
    run -0 --separate-stderr sample -i nearest --material law.tsv far.nii table.mts
    [[ $stderr == *"values lie beyond the table of --material"* ]]
    awk '!/^#/ && $3 != 1000 && $3 != 5000 { exit 1 }' <<< "$output"
    for bad in '0 1000 .5' '0 -1 .4' '0 1000' '5 1000 .4\n5 2000 .4' '0 x .4'; do
        printf "$bad\n" > bad.tsv
        refused 2 "bad.tsv" sample --material bad.tsv step.nii table.mts
    done
    nifti change scan.nii.gz rgb.nii rgb
    refused 2 "stiffness comes from one" sample --material law.tsv rgb.nii cube.mts
}

@test "stiffness from probabilities of tissues: the means weighted by them" {
    nifti step first.nii 1 0.25
    nifti step second.nii 0 0.75
    sample -i nearest --tissue 1000,0.3 --tissue 5000,0.4 first.nii second.nii square.mts 2> note > stiffness.tsv
    grep -q "no sections of ipoints in the input: ran with defaults" note
    awk '!/^#/ { E = $1 < .05 ? 1000 : 4000; nu = $1 < .05 ? .3 : .375; d = $3 - E; e = $4 - nu
        bad += !(d * d < 1e-12 && e * e < 1e-24); n++ } END { exit bad || !n }' stiffness.tsv
    nifti step none.nii 0 0
    run -2 --separate-stderr sample --tissue 1000,0.3 none.nii square.mts
    [[ $stderr == *"points.x: row 0 at "*"no tissue has a probability above 0 there"* ]]
    for value in 1.01 -0.25 100; do
        nifti step beyond.nii 0.5 $value
        refused 2 "beyond.nii: a value of $value: probabilities of tissues are from 0 to 1" \
            sample --tissue 1000,0.3 --tissue 5000,0.4 first.nii beyond.nii square.mts
    done
}

@test "only the points of chosen regions" {
    tag -r 'left=box:-1,-1,0.05,1' square.mts > halves.mts
    ipoints halves.mts > points.mts
    regions=$(mts list points.mts | sed -n 's/^cells.region.*names=\([^ ]*\).*/\1/p')
    first=${regions%%,*}
    [[ $regions == *,* ]]
    sample -r "$first" step.nii points.mts > some.tsv
    sample -a points.x step.nii points.mts > all.tsv
    sample -r "$regions" step.nii points.mts | cmp - all.tsv
    index=$(mts print cells.region points.mts | awk '$1 == 0 { n++ } END { print n }')
    [ "$(grep -vc '^#' some.tsv)" -eq "$index" ]
    [ "$index" -lt "$(grep -vc '^#' all.tsv)" ]
    refused 2 'cells: 3 columns of i4: points have 2 or 3 coordinates, f8' sample -a cells step.nii points.mts
    refused 2 "no region 'nowhere'; there are: $regions" sample -r "$first,nowhere" step.nii points.mts
}
