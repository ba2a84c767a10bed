# interp: fields at the stream's own points, at those of another stream and of a table.

load common.bash

setup() {
    enter
    cloud -d 2 -k jittered -n 12 --box 0,1,0,1 --jitter 0.3 --field linear > linear.mts
    cloud -d 2 -k halton -n 60 --box 0,1,0,1 --field linear > points.mts
}

# near TOLERANCE A B: two lists of numbers agree.
near() {
    paste "$2" "$3" | awk -v tolerance="$1" '
        NF % 2 || NF == 0 { bad = 1 }
        { for (i = 1; i <= NF / 2; i++) { d = $i - $(i + NF / 2); if (!(d <= tolerance && -d <= tolerance)) bad = 1 } n++ }
        END { exit bad || n == 0 }'
}

@test "wrong command lines" {
    for arguments in "-f u -f u" "-p" "a b" "-u mm linear.mts" "-k 2 linear.mts" "-b mls1 linear.mts" \
        "-p x -k 2 -R 3 linear.mts" "-p x -k 0 linear.mts" "-p x -u foot linear.mts" "-p x -R 1foot linear.mts" \
        "-p missing.mts linear.mts" "-p missing.tsv -u mm linear.mts" "-p . linear.mts" "-p . -u m linear.mts" "missing.mts"; do
        refused 2 "" interp $arguments
    done
}

@test "a linear field is exact at other points, in 2 and 3 dimensions, in every basis" {
    cloud -d 3 -k jittered -n 6 --box 1,2,0,1,0,1 --jitter 0.3 --field linear > linear3.mts 2> /dev/null
    cloud -d 3 -k halton -n 60 --box 1,2,0,1,0,1 --field linear > points3.mts
    for basis in mls1 mmls2 "mls2 -k 2.6"; do
        interp -b $basis -p points.mts linear.mts | mts print u > u
        mts print u points.mts > expected
        near 1e-11 u expected
        interp -b $basis -p points3.mts linear3.mts | mts print u > u
        mts print u points3.mts > expected
        near 1e-11 u expected
    done
}

@test "a table of points in a unit, with comments; displaced points" {
    with_section linear.mts displacement f8 <(awk 'BEGIN { for (i = 0; i < 144; i++) print "0.25 -0.5" }') |
        sed 's/^# u /# scalar /; s/^# displacement /# u /' > moved.txt
    printf '# landmarks, mm\n500 500\n\n250\t125 # the second\n' > landmarks.tsv
    interp -p landmarks.tsv -u mm --deformed -t moved.txt > at.txt
    mts print nodes.x at.txt | xargs | { read -r line; [ "$line" = "0.5 0.5 0.25 0.125" ]; }
    mts print x.deformed at.txt > x
    printf '0.75 0\n0.5 -0.375\n' > expected
    near 1e-14 x expected
    mts print scalar at.txt > scalar
    printf '3.5\n1.875\n' > expected
    near 1e-13 scalar expected
    mts list at.txt | grep 'x.deformed.*unit=m'
}

@test "fields: all by default, chosen by name, nothing else passes" {
    with_section linear.mts heat f8 <(seq 144) | with_section - notes i4 <(seq 144) > two.txt
    interp -p points.mts -t two.txt > at.txt
    [ "$(grep -c '^# [a-z]* f8' at.txt)" -eq 2 ]
    [ "$(awk '/^# [a-z.]+ [fi][48]/ { print $2 }' at.txt | xargs)" = "nodes.x u heat" ]
    interp -f heat -p points.mts -t two.txt > at.txt
    [ "$(awk '/^# [a-z.]+ [fi][48]/ { print $2 }' at.txt | xargs)" = "nodes.x heat" ]
    interp -f heat,u -p points.mts -t two.txt > at.txt
    [ "$(awk '/^# [a-z.]+ [fi][48]/ { print $2 }' at.txt | xargs)" = "nodes.x heat u" ]
    for names in notes nodes.x none u, ,u u,,heat u,u; do
        run -2 --separate-stderr interp -f "$names" -p points.mts two.txt
        [ -z "$output" ]
    done
    mts drop u linear.mts > bare.mts
    refused 2 "no fields" interp -p points.mts bare.mts
}

@test "points outside of the body are an error that names the first" {
    printf '0.5 0.5\n1.05 0.5\n' > near.tsv
    interp -p near.tsv -u m linear.mts | mts print u > u
    printf '3.5\n4.6\n' > expected
    near 1e-11 u expected
    printf '0.5 0.5\n1.12 0.5\n2 2\n' > far.tsv
    run -2 --separate-stderr interp -p far.tsv -u m linear.mts
    [[ "$stderr" == *"far.tsv: row 1 at (1.12, 0.5): farther from the body than the spacing"*"--skip-outside"* ]]
    [ -z "$output" ]
    mts drop 'cells*' linear.mts > bare.mts
    printf '0.5 0.5\n1.12 0.5\n' | interp -p /dev/stdin -u m bare.mts | mts print u | tail -n 1 | awk '!($1 > 4.73 && $1 < 4.75) { exit 1 }'
    refused 2 "far.tsv: row 2 at (2, 2)" interp -p far.tsv -u m bare.mts
    refused 2 "needs -u" interp -p far.tsv linear.mts
    refused 2 "points in 3D, the field is in 2D" interp -p <(cloud -d 3 -k regular -n 3 --box 0,1,0,1,0,1) linear.mts
    for row in "0.5" "0.5 0.5 0.5" "0.5 nan" "0,5 0,5" "x y"; do
        echo "$row" > bad.tsv
        refused 2 "bad.tsv:1: " interp -p bad.tsv -u m linear.mts
    done
}

@test "--skip-outside leaves out the points of a grid that lie in no cell, and lists which are there" {
    # A body of two legs with a gap between them: 0 to 1 and 2 to 3, joined above y = 1.
    cat > legs.geo << 'END'
SetFactory("OpenCASCADE"); Rectangle(1) = {0, 0, 0, 3, 2}; Rectangle(2) = {1, 0, 0, 1, 1};
BooleanDifference(3) = { Surface{1}; Delete; }{ Surface{2}; Delete; }; Physical Surface("body") = {3};
Mesh.MeshSizeMax = 0.2;
END
    gmsh -2 -v 1 legs.geo -o legs.msh
    nodes -u m legs.msh | mts text > legs.txt
    mts print nodes.x legs.txt | awk '{ print 1 + 2 * $1 - $2 }' > linear
    with_section legs.txt u f8 linear > field.txt
    awk 'BEGIN { for (i = -4; i < 35; i++) for (j = -4; j < 25; j++) print i / 10, j / 10 }' > grid.tsv
    refused 2 "grid.tsv: row 0 at (-0.4, -0.4): farther" interp -p grid.tsv -u m field.txt
    [ -z "$output" ]
    interp -p grid.tsv -u m --skip-outside -t field.txt > at.txt 2> said
    awk '{ inside = $1 >= 0 && $1 <= 3 && $2 >= 0 && $2 <= 2 && !($1 > 1.001 && $1 < 1.999 && $2 < 0.999) }
        inside { print NR - 1 > "rows"; print 1 + 2 * $1 - $2 > "expected" } !inside { n++ }
        END { printf "interp: grid.tsv: %d of %d points lie outside of the body: left out\n", n, NR }' grid.tsv > note
    cmp note said
    mts print points.row at.txt | cmp - rows
    mts print u at.txt > u
    near 0.1 u expected # exact but where nodes beyond the corners come into sight
    mts check at.txt
    # None there is an error; the option is for points of the user's.
    echo '9 9' > far.tsv
    refused 2 "far.tsv: no point lies in the body" interp -p far.tsv -u m --skip-outside field.txt
    refused 2 "--skip-outside needs -p" interp --skip-outside field.txt
}

@test "nan in a field stays nan; broken supports are refused" {
    ipoints -g 3 linear.mts | support | shapefn | mts text > table.txt
    awk '/^# u / { at = 1; print; next } at && at++ == 70 { print "nan"; next } { print }' table.txt > nan.txt
    interp nan.txt | mts print u | grep -c nan
    awk '/^# support.radius/ { at = 1; print; next } at && at++ == 70 { print "-1"; next } { print }' table.txt > bad.txt
    refused 2 "support.radius: row 69: -1 is not finite and positive" interp bad.txt
    awk '/^# support.radius/ { at = 1; $4--; print; next } at && at++ == 1 { next } { print }' table.txt > bad.txt
    run -2 --separate-stderr interp bad.txt
    [[ "$stderr" == *"support.radius: does not fit nodes.x: "*" rows instead of "* ]]
}
