# fieldcmp: the table and the verdict; clouds that coincide and clouds that do not; nan never passes.

load common.bash

# field FILE ROWS...: a text stream of nodes.x, cells of two regions and u; rows "x y ux uy".
field() {
    local file=$1
    shift
    printf '%s\n' "$@" > rows
    {
        echo "# mts 1"
        echo "# nodes.x f8 $# 2 enc=text unit=m"
        awk '{ print $1, $2 }' rows
        printf '\n\n# cells i4 2 3 enc=text\n0 1 2\n0 2 3\n\n\n# cells.region i4 2 1 enc=text names=grey,white\n0\n1\n\n\n'
        echo "# u f8 $# 2 enc=text unit=m"
        awk '{ print $3, $4 }' rows
        printf '\n\n# end 4\n'
    } > "$file"
}

square() {
    field a.txt "0 0 0 0" "1 0 3 4" "1 1 0 0" "0 1 0 1"
    field b.txt "0 0 0 0" "1 0 0 0" "1 1 0 0" "0 1 0 0"
}

@test "wrong command lines" {
    square
    for arguments in "" "a.txt" "a.txt b.txt b.txt" "--nonsense a.txt b.txt" "--tol-avg a.txt b.txt" "--tol-avg 1e-3" \
        "--tol-avg -1 a.txt b.txt" "--tol-avg nan a.txt b.txt" "--tol-max inf a.txt b.txt" "--tol-max 1foot a.txt b.txt" \
        "--tol-max 1 --tol-max 1 a.txt b.txt" "--field none a.txt b.txt" "--field nodes a.txt b.txt" "--region none a.txt b.txt" \
        "-t a.txt b.txt" "missing.txt b.txt" "a.txt missing.txt" "a.txt ." "--field cells a.txt b.txt"; do
        run -2 --separate-stderr fieldcmp $arguments < /dev/null
        [[ "$stderr" == "fieldcmp: "* ]]
        [ "$(wc -l <<< "$stderr")" -eq 1 ]
        [ -z "$output" ]
    done
    refused 2 "standard input cannot be read twice" fieldcmp - - < a.txt
}

@test "average, maximum, rmse, percentiles, place and regions" {
    square
    run -0 --separate-stderr fieldcmp a.txt b.txt
    echo "$output"
    [ "$(head -3 <<< "$output" | cut -f 1 | xargs)" = "avg max rmse" ]
    [ "$(value avg)" = 1.5 ]
    [ "$(value max)" = 5 ]
    [ "$(value rmse)" = 2.54950976 ]
    [ "$(value n)" = 4 ]
    [ "$(value max_at)" = "1 0" ]
    [ "$(value clouds)" = coincide ]
    [ "$(value p50)" = 0.5 ]
    [ "$(value p95)" = 4.4 ]
    [ "$(value p99)" = 4.88 ]
    [ "$(value n.grey)" = 3 ]
    [ "$(value max.grey)" = 5 ]
    [ "$(value max.white)" = 1 ]
    [ "$(value reference)" = 0 ]
    [ "$(value avg_relative)" = inf ]
    run -0 --separate-stderr fieldcmp b.txt a.txt
    [ "$(value reference)" = 5 ]
    [ "$(value avg_relative)" = 0.3 ]
    [ "$(value max_relative)" = 1 ]
    run -0 --separate-stderr fieldcmp --percentiles --region white a.txt b.txt
    [ "$(value n)" = 3 ]
    [ "$(value max)" = 1 ]
    [ "$(value p75)" = 0.5 ]
    [[ "$output" != *grey* ]]
}

@test "exit status: within, at the edge, beyond" {
    square
    fieldcmp --tol-avg 1.5 --tol-max 5 a.txt b.txt
    fieldcmp --tol-avg 1500mm --tol-max 500cm a.txt b.txt
    fieldcmp --tol-avg 0 --tol-max 0 a.txt a.txt
    run -1 --separate-stderr fieldcmp --tol-avg 1.49 a.txt b.txt
    [ "$stderr" = "fieldcmp: avg 1.5 is beyond 1.49" ]
    [ "$(value avg)" = 1.5 ]
    run -1 --separate-stderr fieldcmp --tol-avg 1.5 --tol-max 4.999 a.txt b.txt
    [ "$stderr" = "fieldcmp: max 5 is beyond 4.999" ]
    run -1 fieldcmp --tol-max 499cm a.txt b.txt
    run -0 fieldcmp --tol-max 1 --region white a.txt b.txt
}

@test "nan and infinity never pass, in A or in B" {
    square
    for bad in nan inf -inf; do
        field bad.txt "0 0 0 0" "1 0 $bad 0" "1 1 0 0" "0 1 0 0"
        for tolerances in "" "--tol-avg 1e300" "--tol-max 1e300" "--tol-avg 1e300 --tol-max 1e300" "--region white"; do
            run -1 --separate-stderr fieldcmp $tolerances bad.txt a.txt
            [[ "$stderr" == "fieldcmp: bad.txt: u: row 1: not a finite number"* ]]
            run -1 --separate-stderr fieldcmp $tolerances a.txt bad.txt
            [[ "$stderr" == "fieldcmp: bad.txt: u: row 1: not a finite number"* ]]
            run -1 --separate-stderr fieldcmp $tolerances bad.txt bad.txt
        done
    done
    field bad.txt "0 0 0 0" "1 0 nan 0" "1 1 0 0" "0 1 0 0"
    run -1 --separate-stderr fieldcmp bad.txt a.txt
    [ "$(value avg)" = nan ]
    [ "$(value max)" = nan ]
    [ "$(value rmse)" = nan ]
    # Also in a part of B that no node of A is near.
    cloud -d 2 -k regular -n 20 --box 0,1,0,1 --field linear -t > b.txt
    awk '/^# u / { at = 1; print; next } at && at++ == 400 { print "nan"; next } { print }' b.txt > bad.txt
    cloud -d 2 -k regular -n 4 --box 0,0.3,0,0.3 --field linear > a.mts
    run -0 fieldcmp --tol-max 1e-10 a.mts b.txt
    run -1 fieldcmp --tol-max 1e-10 a.mts bad.txt
}

@test "nodes outside of B's cloud are an error, or left out" {
    cloud -d 2 -k regular -n 9 --box 0,2,0,1 --field linear > a.mts
    cloud -d 2 -k regular -n 9 --box 0,1,0,1 --field linear > b.mts
    run -2 --separate-stderr fieldcmp a.mts b.mts
    [[ "$stderr" == *"36 nodes of A lie outside of B's cloud, the first is row 5 at (1.25, 0)"*"--skip-outside"* ]]
    [ -z "$output" ]
    run -0 --separate-stderr fieldcmp --skip-outside --tol-max 1e-9 a.mts b.mts
    [ "$(value outside)" = 36 ]
    [ "$(value n)" = 45 ]
    cloud -d 2 -k regular -n 9 --box 7,8,0,1 --field linear > far.mts
    refused 2 "no node of A to compare" fieldcmp --skip-outside far.mts b.mts
}

@test "fields of other shapes are refused" {
    square
    cloud -d 2 -k regular -n 3 --box 0,1,0,1 --field linear > scalar.mts
    cloud -d 3 -k regular -n 3 --box 0,1,0,1,0,1 --field linear > solid.mts
    refused 2 "2 columns in 2D against 1 columns in 2D" fieldcmp a.txt scalar.mts
    run -2 --separate-stderr fieldcmp scalar.mts solid.mts
    [[ "$stderr" == *"in 2D against"*"in 3D"* ]]
    mts drop u a.txt > bare.mts
    refused 2 "bare.mts: no section u" fieldcmp bare.mts b.txt
    sed 's/^# u f8 4 2/# u f8 3 2/' a.txt | awk '/^# u/ { at = 1 } at && $0 == "0 1" { next } { print }' > short.txt
    refused 2 "short.txt: u: 3 rows" fieldcmp short.txt b.txt
    sed 's/^# u f8 4 2/# u f8 2 4/; s/^0 0 *$/&/' a.txt > wide.txt
    run -2 --separate-stderr fieldcmp wide.txt b.txt
    run -2 --separate-stderr fieldcmp --field nodes.x a.txt <(sed 's/^# nodes.x f8/# nodes.x f4/' b.txt)
}

@test "a map of the differences" {
    square
    fieldcmp -t -m map.txt a.txt b.txt > table
    [ "$(mts print difference map.txt | xargs)" = "0 5 0 1" ]
    mts print cells map.txt | cmp - <(mts print cells a.txt)
    run -0 mts list map.txt
    [[ "$output" == *nodes.x* ]]
    [[ "$output" == *cells.region* ]]
    [[ "$output" != *" u "* ]]
    fieldcmp --map map.mts --region white a.txt b.txt | cmp - <(fieldcmp --region white a.txt b.txt)
    [ "$(mts print difference map.mts | xargs)" = "0 nan 0 1" ]
    run -1 fieldcmp -m map2.mts --tol-max 1 a.txt b.txt
    [ -s map2.mts ]
    run -3 --separate-stderr fieldcmp -m missing/map.mts a.txt b.txt
}

# Each moves as a rigid body, by at most 1 mm: what is left is the solver's tolerance of 1e-5.
@test "bodies that slide along each other, on two meshes: each node is compared on its own side" {
    for h in 2 3; do
        printf 'SetFactory("OpenCASCADE");\nRectangle(1) = {0, 0, 0, 10, 10};\nRectangle(2) = {10, 0, 0, 10, 10};\nMeshSize {:} = %s;\n' $h > two.geo
        printf 'Physical Surface("%s") = {%s};\nPhysical Curve("%s") = {%s};\n' one 1 left 4 other 2 right 6 >> two.geo
        gmsh -v 1 -2 two.geo -o two.msh > /dev/null
        { block quasi-static | sed 's/^region = .*/region = one, other/'
            printf '[displacement %s]\nfacets = %s\ncomponents = 0, %s\n' a left 0 b right 0.001; } > two.scene
        nodes -u mm two.msh | shapefn 2> note | mtled -q two.scene > $h.dat 2> note
    done
    run -0 --separate-stderr fieldcmp --tol-max 1e-8 2.dat 3.dat
}
