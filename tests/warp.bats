# warp: images moved by a displacement, judged by nibabel and by plastimatch, a program of others.

load common.bash

# with_u FILE AWK: stream FILE with a section u, the components printed by AWK from each row of nodes.x.
with_u() {
    with_section "$1" u f8 <(mts print nodes.x "$1" | awk "{ $2 }" OFMT=%.17g) unit=m
}

# A cube of 60 mm, moved by the field of nifti.py.
smooth_u='s = .06; pi = atan2(0, -1); b = .004 * sin(pi * $1 / s) * sin(pi * $2 / s) * sin(pi * $3 / s)
    printf "%.17g %.17g %.17g\n", .3 * b, -.5 * b * cos(2 * $1 / s), -b'

setup() {
    enter
    cp "$BATS_FILE_TMPDIR"/{cube.mts,u.dat} .
}

setup_file() {
    cd "$BATS_FILE_TMPDIR"
    nifti smooth scan.nii.gz
    nifti ball ball.nii.gz
    cloud -d 3 -k jittered -n 13 --box 0,0.06,0,0.06,0,0.06 --jitter 0.12 > cube.mts
    with_u cube.mts "$smooth_u" > u.dat
}

@test "usage, and wrong command lines" {
    scan=$BATS_FILE_TMPDIR/scan.nii.gz
    for arguments in "" "$scan u.dat more" "--nonsense $scan u.dat" "-i quintic $scan u.dat" "--fill x $scan u.dat" \
        "--field --fill 1 $scan u.dat" "--field -i linear $scan u.dat" "--frame -1 $scan u.dat" "-o x.png $scan u.dat" \
        "missing.nii u.dat" "$scan cube.mts" ". u.dat" "$scan missing.dat" "u.dat u.dat" "$scan $scan"; do
        run -2 --separate-stderr warp $arguments < /dev/null
        [[ "$stderr" == "warp: "* && ${#stderr_lines[@]} -eq 1 ]] || { echo "$arguments: $stderr"; false; }
        [ -z "$output" ]
    done
    refused 2 "standard input cannot be read twice" warp - - < "$scan"
    refused 2 "no section u.frame.3" warp --frame 3 "$scan" u.dat
}

@test "a known field: the error is that of the interpolation, however the image lies in space" {
    for way in oblique swapped; do
        nifti smooth scan.nii.gz $way
        warp -o moved.nii.gz scan.nii.gz u.dat
        nifti moved scan.nii.gz moved.nii.gz > errors
        awk '{ exit !(NF == 2 && $2 > .01 && $1 <= 1.01 * $2) }' errors || { echo "$way: $(cat errors)"; false; }
    done
    warp -i cubic -o cubic.nii.gz "$BATS_FILE_TMPDIR/scan.nii.gz" u.dat
    nifti moved "$BATS_FILE_TMPDIR/scan.nii.gz" cubic.nii.gz | awk '{ exit !($1 <= .1 * $2) }'
}

@test "fields to and back agree to .05 voxel, and lead to the places of the known field" {
    nifti smooth scan.nii.gz oblique
    warp --field scan.nii.gz u.dat > to.nii.gz
    warp --field --inverse scan.nii.gz u.dat > back.nii.gz
    nifti fields to.nii.gz back.nii.gz > distances
    awk '{ print; exit !(NF == 2 && $1 < .05 && $2 < .02) }' distances
    run --separate-stderr warp -v -o moved.nii.gz scan.nii.gz u.dat
    [[ $stderr == *"inverse map: largest residual "*" voxels; Newton did not converge to 1e-04 in "*" voxels, where the linear inverse of the cell is taken"* ]]
    awk '/inverse map/ { split($0, part, "residual "); exit !(part[2] + 0 < .05) }' <<< "$stderr"
}

@test "NRRD and MetaImage: the same voxels and places, to plastimatch and from it" {
    with_u cube.mts 'print 0, 0, 0' > still.dat
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" rgb.nii rgb
    nifti smooth oblique.nii oblique
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" slice.nii coronal
    cloud -d 2 -k regular -n 3 --box 0,0.06,0,0.06 > square.mts
    with_u square.mts 'print 0, 0' > still2.dat
    for image in rgb oblique slice; do
        still=still.dat
        [ $image != slice ] || still=still2.dat
        warp -o ours.nii $image.nii $still
        for end in nrrd mha; do
            warp -o $image.$end $image.nii $still
            warp $image.$end $still > again.$end # as the input
            cmp $image.$end again.$end
            warp --like $image.nii $image.$end $still | cmp - again.$end
            warp -o back.nii again.$end $still
            nifti same ours.nii back.nii 0
            pair=pair.$( [ $end = nrrd ] && echo nhdr || echo mhd) # and in two files
            rm -f pair.raw
            warp -o $pair $image.nii $still
            warp -o again.$end $pair $still
            cmp $image.$end again.$end
            [ $image = rgb ] && continue # which they take for something else
            plastimatch convert --input $image.$end --output-img theirs.nii > said
            nifti same $image.nii theirs.nii 0
        done
        [ $image = rgb ] && continue
        for end in nrrd nhdr mha mhd; do
            plastimatch convert --input $image.nii --output-img theirs.$end > said 2>&1
            warp -o back.nii theirs.$end $still
            nifti same ours.nii back.nii 0
        done
    done
    for image in oblique.{nii,nrrd,mha}; do sample -p <(echo 30 20 10) -u mm $image | awk 'NR == 2 { printf "%.6f\n", $4 }'; done | uniq > at
    [ "$(wc -l < at)" = 1 ]
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" scaled.nii scaled
    warp -o scaled.nrrd scaled.nii still.dat
    cmp <(nifti value scaled.nii 30 31 32) <(warp -o again.nii scaled.nrrd still.dat && nifti value again.nii 30 31 32)
    nifti segments "$BATS_FILE_TMPDIR/ball.nii.gz" ball.seg.nrrd 2 'Left lung' tumour > shared
    run -0 --separate-stderr warp -i nearest -o moved.seg.nrrd ball.seg.nrrd u.dat
    [[ $stderr == *"overlap in $(cat shared) voxels"* ]]
    [ "$(grep -aE '_(Name|LabelValue|Layer):' moved.seg.nrrd | cut -d= -f2 | xargs)" = "Left lung 1 0 tumour 2 0" ]
    refused 2 "-o x.png: images are written as .nii, .nii.gz, .nrrd, .nhdr, .mha or .mhd" warp -o x.png oblique.nii still.dat
    refused 2 "-o a%d.mhd: a header cannot name data of such a name" warp -o a%d.mhd oblique.nii still.dat
    echo > other.raw
    refused 2 "-o other.mhd: replaces other.raw, which may be of another image" warp -o other.mhd oblique.nii still.dat
    { printf 'a\nb\n-'; cat theirs.raw; } > skip.raw
    for skip in 'line skip: 2\nbyte skip: 1' 'byte skip: -1'; do
        sed "s/^data file: .*/$skip\ndata file: skip.raw/" theirs.nhdr > skip.nhdr
        warp -o back.nii skip.nhdr still2.dat
        nifti same ours.nii back.nii 0
    done
    for outside in ../theirs.raw a/../../theirs.raw .. /etc/passwd; do
        sed "s|theirs.raw|$outside|" theirs.mhd > outside.mhd
        refused 2 "outside.mhd: header: ElementDataFile= $outside: not a file in the folder of the header" warp outside.mhd still2.dat
    done
}

@test "plastimatch applies our field to the scan and gets our image" {
    nifti smooth scan.nii.gz oblique
    warp --fill 0 -o ours.nii.gz scan.nii.gz u.dat
    warp -o open.nii.gz scan.nii.gz u.dat
    for end in nii.gz nrrd mha; do
        warp --field -o field.$end scan.nii.gz u.dat
        plastimatch warp --input scan.nii.gz --xf field.$end --output-img theirs.nii.gz > said
        nifti same open.nii.gz theirs.nii.gz 0.002
    done
    grep -aqx 'kinds: vector domain domain domain' field.nrrd
    grep -aqx 'content: displacement, mm, LPS, from result to image' field.nrrd
    run -1 nifti same ours.nii.gz theirs.nii.gz 0.002
    run -1 nifti same scan.nii.gz theirs.nii.gz 5
    # And back: what was moved is brought back by the field of the inverse.
    nifti smooth scan.nii.gz
    warp -i cubic -o moved.nii.gz scan.nii.gz u.dat
    warp --inverse -o ours.nii.gz moved.nii.gz u.dat
    warp --field --inverse -o field.nii.gz scan.nii.gz u.dat
    # Points by the field of the inverse, at voxels: theirs are those of the nearest one.
    warp --field --inverse -o field.nrrd scan.nii.gz u.dat
    grep -aqx 'content: displacement, mm, LPS, from reference to moved' field.nrrd
    printf '30 20 25\n31 41 20\n' > points
    { printf '# CoordinateSystem = 0\n'; awk '{ printf "%d,%g,%g,%g,0,0,0,1,1,1,0,p,,\n", NR, $1, $2, $3 }' points; } > points.fcsv
    plastimatch warp --input points.fcsv --xf field.nrrd --output-pointset theirs.fcsv > said
    interp --deformed -p points -u mm -t u.dat > ours.mts
    paste <(grep -v '^#' theirs.fcsv | tr , ' ') <(mts print x.deformed ours.mts) | awk '
        { for (k = 2; k < 5; k++) if (($k - 1e3 * $(k + 5))^2 > .01^2) exit 1; n++ } END { exit n != 2 }'
    plastimatch warp --input moved.nii.gz --xf field.nii.gz --output-img theirs.nii.gz > said
    nifti same ours.nii.gz theirs.nii.gz 0.002
    nifti same scan.nii.gz theirs.nii.gz 2.5
}

@test "volumes of labels follow J" {
    # J = 1.15 * .9 * .98
    with_u cube.mts 'printf "%.17g %.17g %.17g\n", .15 * ($1 - .03) + .05 * ($2 - .03), -.1 * ($2 - .03), -.02 * ($3 - .03)' > u.dat
    warp -v -i nearest --vacated 9 "$BATS_FILE_TMPDIR/ball.nii.gz" u.dat 2> said > moved.nii.gz
    nifti volumes "$BATS_FILE_TMPDIR/ball.nii.gz" > before
    nifti volumes moved.nii.gz > after
    paste before after | awk '$1 > 0 && $1 != 9 { if ($3 != $1) exit 1; r = $4 / $2 / (1.15 * .9 * .98); if (r < .99 || r > 1.01) exit 1; n++ }
        END { exit n != 2 }'
}

@test "outside of the body: as it was, a fill value, what the body left" {
    # Twice as flat: it leaves the upper half.
    with_u cube.mts 'print 0, 0, -.5 * $3' > flat.dat
    scan=$BATS_FILE_TMPDIR/scan.nii.gz
    warp -o plain.nii "$scan" flat.dat 2> plain_said
    [ "$(cat plain_said)" = "warp: 111630 voxels that the body left keep their old value: see --vacated" ]
    warp --fill -7 -o filled.nii "$scan" flat.dat
    warp --vacated -8 -v -o vacated.nii "$scan" flat.dat 2> said
    warp --vacated -8 --fill -7 -o both.nii "$scan" flat.dat
    # Voxel (i, j, k) is at (i - 8) mm: 70 is beyond the body, 60 where it was, 30 in it.
    for file in "$scan" {plain,filled,vacated,both}.nii; do nifti value "$file" 30 30 70 30 30 60 30 30 30 | xargs; done | tee values
    awk '{ beyond[NR] = $1; left[NR] = $2; within[NR] = $3 } END { exit !(NR == 5 &&
        beyond[2] == beyond[1] && beyond[3] == -7 && beyond[4] == beyond[1] && beyond[5] == -7 &&
        left[2] == left[1] && left[3] == -7 && left[4] == -8 && left[5] == -8 &&
        within[3] == within[2] && within[4] == within[2] && within[5] == within[2]) }' values
    grep -q '^warp: 111630 voxels were left by the body$' said # 61 x 61 x 30
}

@test "outside of the body: values by label; a body that moves out of the image is not turned" {
    ball=$BATS_FILE_TMPDIR/ball.nii.gz
    with_u cube.mts 'print 0, 0, -.5 * $3' > flat.dat
    run -0 --separate-stderr warp -i nearest --vacated 2=7,5=8 --fill 0=1 -o filled.nii "$ball" flat.dat
    [[ $stderr == *"it shows a part of the body"* && $stderr != *"old value"* ]] # the grid is oblique
    run -0 --separate-stderr warp -i nearest --vacated 2=7,8 -o others.nii "$ball" flat.dat
    [ "$(nifti volumes filled.nii | cut -d' ' -f1 | xargs)" = "0 1 2 5 7 8" ]
    [ "$(nifti volumes others.nii | cut -d' ' -f1 | xargs)" = "0 2 5 7 8" ]
    refused 2 "--fill: no voxel of $ball has the label 3" warp --fill 3=1 -o out.nii "$ball" flat.dat
    refused 2 "--vacated 2=1,2=3: two values for 2" warp --vacated 2=1,2=3 -o out.nii "$ball" flat.dat
    with_u cube.mts 'print 0, 0, .02' > up.dat
    run -0 --separate-stderr warp --vacated 0 -o up.nii "$BATS_FILE_TMPDIR/scan.nii.gz" up.dat
    [ -z "$stderr" ]
}

@test "values that the type of the image cannot hold: one line" {
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" scaled.nii scaled
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" rgb.nii rgb
    refused 2 "--fill 1e+06: values of scaled.nii are from " warp --fill 1e6 -o moved.nii scaled.nii u.dat
    for option in --fill --vacated; do
        for value in -1 300; do refused 2 "$option $value: values of rgb.nii are from 0 to 255" warp $option $value -o moved.nii rgb.nii u.dat; done
        run -0 --separate-stderr warp $option 255 -o good.nii rgb.nii u.dat
    done
    [ ! -e moved.nii ]
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" nan.nii nan
    run -0 --separate-stderr warp -o moved.nii nan.nii u.dat
    [ "$stderr" = "warp: nan.nii: 1 values are not finite: neither is what is interpolated beside them" ]
}

@test "on the grid of another image" {
    nifti smooth coarse.nii coarse
    warp --like coarse.nii -o like.nii "$BATS_FILE_TMPDIR/scan.nii.gz" u.dat
    warp -o own.nii "$BATS_FILE_TMPDIR/scan.nii.gz" u.dat
    # Every other voxel of the fine grid.
    cmp <(nifti value like.nii 15 16 17 1 2 3) <(nifti value own.nii 30 32 34 2 4 6)
    run -0 --separate-stderr warp --like "$BATS_FILE_TMPDIR/scan.nii.gz" -o fine.nii coarse.nii u.dat
    nifti smooth oblique.nii oblique
    run -0 --separate-stderr warp --like oblique.nii -o fine.nii coarse.nii u.dat
    [[ $stderr == *"voxels show places outside of the image: 0 there"* ]]
}

@test "without the end of a name the format is that of the image" {
    nifti smooth scan.nii
    for end in nii nii.gz; do
        scan=scan.$end
        [ -e "$scan" ] || gzip -k scan.nii
        warp -o named.$end "$scan" u.dat
        warp "$scan" u.dat | cmp - named.$end
        warp -o bare "$scan" u.dat
        cmp bare named.$end
    done
}

@test "frames on the way" {
    sed 's/^# u f8/# u.frame.2 f8/' u.dat > frames.dat
    refused 2 "no section u" warp "$BATS_FILE_TMPDIR/scan.nii.gz" frames.dat
    warp --frame 2 "$BATS_FILE_TMPDIR/scan.nii.gz" frames.dat > frame.nii.gz
    warp "$BATS_FILE_TMPDIR/scan.nii.gz" u.dat | cmp - frame.nii.gz
}

@test "2D: a slice across any axis of the world" {
    cloud -d 2 -k jittered -n 13 --box 0,0.06,0,0.06 --jitter 0.2 > square.mts
    with_u square.mts 'print .004, .003' > u2.dat
    for what in slice coronal; do
        nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" $what.nii $what
        warp -o moved.nii $what.nii u2.dat
        cmp <(nifti value moved.nii 40 41 0 2 2 0) <(nifti value $what.nii 36 38 0 2 2 0)
    done
    nifti change "$BATS_FILE_TMPDIR/scan.nii.gz" sagittal.nii sagittal
    warp -o moved.nii sagittal.nii u2.dat
    [ "$(nifti value moved.nii 0 40 41)" = "$(nifti value sagittal.nii 0 36 38)" ]
    warp --field -o field.nii sagittal.nii u2.dat # to the left, to the back, up
    nifti value field.nii 0 40 41 0 1 1 | awk '
        NR == 1 { good = $1 == 0 && ($2 - 4)^2 < 1e-8 && ($3 + 3)^2 < 1e-8 } NR == 2 { exit !(good && $1 == 0 && $2 == 0 && $3 == 0) }'
    refused 2 "lies in another plane than" warp --like coronal.nii sagittal.nii u2.dat
    refused 2 "an image of one slice across a world axis, not one of several slices" \
        warp "$BATS_FILE_TMPDIR/scan.nii.gz" u2.dat
}

@test "units and spaces that cannot be" {
    scan=$BATS_FILE_TMPDIR/scan.nii.gz
    nifti change "$scan" far.nii far
    refused 2 "no voxel of the image (0.492 0.492 0.492 to 0.567 0.567 0.567 m) lies in the body (0 0 0 to 0.06 " warp far.nii u.dat
    # x to the left in one of the two
    cloud -d 3 -k regular -n 4 --box -0.06,0,0,0.06,0,0.06 > left.mts
    with_u left.mts 'print 0, 0, 0' > left.dat
    run -0 --separate-stderr warp -o out.nii "$scan" left.dat
    [[ $stderr == *"48 of 64 nodes of the body lie more than half a voxel outside of the image"* ]]
    cloud -d 3 -k regular -n 4 --box 0,60,0,60,0,60 > large.mts
    with_u large.mts 'print 0, 0, 0' > large.dat
    refused 2 "more than 100 times larger than the image" warp "$scan" large.dat
    cloud -d 3 -k regular -n 4 --box 0.0001,0.0009,0.0001,0.0009,0.0001,0.0009 > small.mts
    with_u small.mts 'print 0, 0, 0' > small.dat
    refused 2 "no voxel of the image" warp "$scan" small.dat
}

@test "folded cells are reported" {
    with_u cube.mts 'd = ($1 - .03)^2 + ($2 - .03)^2 + ($3 - .03)^2; print d < 1e-6 ? .02 : 0, 0, 0' > fold.dat
    run -0 --separate-stderr warp -o moved.nii "$BATS_FILE_TMPDIR/scan.nii.gz" fold.dat
    [[ $stderr == *" cells are folded (the first: row "* ]]
}

@test "a cloud too poor for gradients: linear in the cells, and reported" {
    cloud -d 3 -k regular -n 2 --box 0,0.06,0,0.06,0,0.06 > cells.mts
    with_u cells.mts 'print .1 * $2, 0, 0' > linear.dat
    run -0 --separate-stderr warp -o moved.nii "$BATS_FILE_TMPDIR/scan.nii.gz" linear.dat
    [[ $stderr == "warp: displacement taken as linear in each cell: "* ]]
}

@test "between the nodes: the field that mtled solved for, nearer than a fit of its values" {
    cloud -d 3 -k jittered -n 6 --box 0,0.06,0,0.06,0,0.06 --jitter 0.15 --seed 2 | shapefn > coarse.mts 2> note
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n[material body]\nregion = body\nE = 3000\nnu = 0.45\nrho = 1000\n[displacement low]\nfacets = zmin\ncomponents = 0, 0, 0\n[displacement high]\nfacets = zmax\ncomponents = 0.01, 0, -0.006\n' > bend.scene
    mtled bend.scene coarse.mts > u.dat
    mts keep nodes.x,cells,u u.dat > bare.dat
    awk 'BEGIN { for (x = 6; x <= 54; x += 6) for (y = 6; y <= 54; y += 6) for (z = 6; z <= 54; z += 6) print x, y, z }' > places
    interp -f u -p places -u mm u.dat | mts print u - > exact
    for field in u bare; do
        warp --field --inverse "$BATS_FILE_TMPDIR/scan.nii.gz" $field.dat > field.nii.gz
        sample -i linear -p places -u mm field.nii.gz | grep -v '^#' | paste - exact | # LPS, mm
            awk '{ s += ($4 + 1e3 * $7)^2 + ($5 + 1e3 * $8)^2 + ($6 - 1e3 * $9)^2 } END { print sqrt(s / NR) }' >> off
    done
    cat off
    awk '{ off[NR] = $1 } END { exit !(NR == 2 && off[1] < 0.9 * off[2] && off[1] < 0.05) }' off
}
