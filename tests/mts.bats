# mts: list, print, keep, drop and check.

load common.bash

setup() { enter_loosely; }

# A square of two triangles, with everything that mts check checks.
square() {
    printf '%s\n' '# mts 1' '# @ test 1 test'
    section 'nodes.x f8 4 2 enc=text unit=m cols=x,y' '0 0' '1 0' '1 1' '0 1'
    section 'cells i4 2 3 enc=text' '0 1 2' '0 2 3'
    section 'cells.region i4 2 1 enc=text names=grey,white' 0 1
    section 'facets i4 1 2 enc=text' '0 1'
    section 'facets.set i4 1 1 enc=text names=bottom' 0
    section 'sets.ptr i8 2 1 enc=text names=corner' 0 2
    section 'sets.idx i4 2 1 enc=text' 1 3
    section 'points.x f8 2 2 enc=text unit=m' '0.6 0.3' '0.3 0.6'
    section 'points.weight f8 2 1 enc=text unit=m2' 0.5 0.25
    section 'points.cell i4 2 1 enc=text' 0 -1
    section 'support.radius f8 4 1 enc=text unit=m' 2 2 2 2
    section 'nbr.ptr i8 3 1 enc=text' 0 2 5
    section 'nbr.idx i4 5 1 enc=text' 0 1 0 2 3
    section 'nbr.widen f8 2 1 enc=text' 1 1.5
    section 'shape.phi f8 5 1 enc=text' 0.75 0.25 -0.5 1 0.5
    section 'shape.dphi f8 5 2 enc=text unit=1/m' '1 1' '-1 -1' '1 0' '-1 0' '0 0'
    section 'u f8 4 2 enc=text unit=m' '0 0' '0 0' '0 0' '0 1'
    echo '# end 17'
}

@test "list prints a line per section, with -v the provenance first" {
    run -0 mts list -v <(square)
    [ "${lines[0]}" = "# @ test 1 test" ]
    [ "${lines[1]}" = $'nodes.x\tf8\t4\t2\tunit=m cols=x,y' ]
    [ "${#lines[@]}" -eq 18 ]
    square | mts binary > binary
    mts list binary | cmp - <(square | mts list)
}

@test "print writes a bare table, for awk and for itself" {
    square > text
    run -0 mts print cells text
    [ "$output" = $'0 1 2\n0 2 3' ]
    mts print nbr.widen < text | awk '{ sum += $1 } END { exit sum != 2.5 }'
    run -2 --separate-stderr mts print cell text
    [ "$stderr" = "mts: no section cell: see mts list" ]
}

@test "keep and drop select by patterns; one that matches nothing is an error" {
    square > text
    [ "$(mts keep 'nodes.x,u' text | mts list | cut -f1 | paste -sd,)" = nodes.x,u ]
    [ "$(mts drop '*.*' text | mts list | cut -f1 | paste -sd,)" = cells,facets,u ]
    mts keep '*' -t text | grep -v '^# @ mts' | cmp - <(mts text text)
    run -2 --separate-stderr mts keep 'u,node.x' text
    [ "$stderr" = "mts: no section matches 'node.x': see mts list" ]
    [ "$output" = "" ]
    run -2 mts drop 'u,' text
    run -2 mts drop '' text
}

@test "check passes what the stages make" {
    run -0 mts check <(square)
    [ "$output" = "" ]
    cloud -d 2 -k regular -n 5 --box 0,1,0,1 | shapefn 2> /dev/null > table2
    cloud -d 3 -k regular -n 4 --box 0,1,0,1,0,1 | shapefn 2> /dev/null > table3
    run -0 mts check table2
    run -0 mts check table3
}

# violates EXPECTED SECTION SED-COMMAND: with the command applied to the lines of the section, check says EXPECTED.
violates() {
    square | sed -E "/^# $2 /,/^\$/ { $3
    }" > damaged
    run -1 mts check damaged
    [[ "${lines[0]}" == "$1"* ]] || { echo "expected $1"; echo "got $output"; return 1; }
}

@test "check finds each violation and names section and row" {
    violates 'nodes.x: row 3: nan is not finite' nodes.x 's/^0 1$/nan 1/'
    violates 'cells: row 1: no row 4 of nodes.x' cells 's/^0 2 3/0 2 4/'
    violates 'cells: row 0: no row -1' cells 's/^0 1 2/-1 1 2/'
    violates 'cells: row 1: inverted or of no volume (-0.5)' cells 's/^0 2 3/0 3 2/'
    violates 'cells: type i8 instead of i4' cells 's/ i4 / i8 /'
    violates 'cells.region: row 1: no region 1 in names=' cells.region 's/,white//'
    violates 'cells.region: row 0: no region 0 in names=' cells.region 's/ names=.*//'
    violates 'facets: row 0: no row 9' facets 's/^0 1/0 9/'
    violates 'sets.ptr: does not fit its lists and sets.idx' sets.ptr 's/^2$/1/'
    violates 'sets.idx: row 1: 1 does not ascend to 1' sets.idx 's/^3$/1/'
    violates 'points.weight: row 1: 0 is not finite and positive' points.weight 's/^0.25/0/'
    violates 'points.cell: row 1: no row -2' points.cell 's/^-1/-2/'
    violates 'support.radius: row 0: inf' support.radius '2s/.*/inf/;s/^2$/inf/'
    violates 'nbr.ptr: row 2: decreases' nbr.ptr 's/^2$/7/'
    violates 'nbr.ptr: does not fit its lists and nbr.idx' nbr.ptr 's/^5/1/'
    violates 'nbr.ptr: does not fit its lists and nbr.idx' nbr.ptr 's/^0/1/'
    violates 'nbr.idx: row 4: 2 does not ascend to 2' nbr.idx 's/^3/2/'
    violates 'nbr.widen: row 0: 0.5 is not finite and at least 1' nbr.widen 's/^1$/0.5/'
    violates 'shape.phi: list 1: sums to 1 +1e-06' shape.phi 's/^1$/1.000001/'
    violates 'shape.dphi: row 2: nan' shape.dphi 's/^1 0/nan 0/'
    violates 'u: row 3: inf' u 's/^0 1/0 inf/'
}

@test "check sums the shape functions on edges" {
    cloud -d 2 -k regular -n 3 --box 0,1,0,1 | shapefn | mts text |
        awk '/^# / { on = $2 == "edge.phi" } !/^#/ && NF && on { $1 *= 1.01; on = 0 } { print }' > damaged
    run -1 mts check damaged
    [[ "$output" == "edge.phi: list 0: sums to 1 "* ]]
}

# finds TEXT [FILE]: check says so.
finds() {
    run -1 mts check "${2:-damaged}"
    [[ $output == *"$1"* ]] || { echo "$output"; return 1; }
}

@test "check compares the shapes of sections" {
    square | mts drop nbr.idx | mts binary > damaged
    finds "no section nbr.idx: run support"
    square | sed '/^# u /,$d' > damaged
    printf '# u f8 3 2 enc=text\n0 0\n0 0\n0 0\n\n\n# end 17\n' >> damaged
    finds "u: does not fit nodes.x: 3 rows instead of 4: run mtled again"
    square | mts drop points.weight -t | sed '$d' > damaged
    printf '# points.weight f8 1 2\n0.5 0.25\n\n\n# end 17\n' >> damaged
    finds "points.weight: 2 columns instead of 1"
    violates 'nbr.ptr: type i4 instead of i8' nbr.ptr 's/ i8 / i4 /'
    square > whole
    shortened nbr.ptr whole > damaged
    finds "nbr.ptr: does not fit points.x: 2 rows instead of 3: run support again"
    square | sed '/^# u /,$d' > damaged
    printf '# faces i4 2 2\n0 1\n0 2\n\n\n# faces.cell i4 2 2\n0 -1\n0 1\n\n\n' >> damaged
    printf '# facepoints.x f8 3 2\n0 0\n0 0\n0 0\n\n\n# end 19\n' >> damaged
    finds "facepoints.x: 3 rows, but the faces ask for 2"
    sed '/^# faces.cell/,/^$/ { s/^0 -1$/0 1 /; /^0 1$/ s/1/-1/; }' damaged > swapped
    finds "faces.cell: row 1: on the boundary, after faces between cells" swapped
    shapefn <(cloud -d 2 -k regular -n 3 --box 0,1,0,1) 2> note | mts text > whole
    mts check whole
    shortened boundary.ptr whole > damaged
    finds "boundary.ptr: 16 rows, but the faces ask for 17"
    shortened edge.ptr whole > damaged
    finds "edge.ptr: 24 rows, but the faces ask for 25"
    shapefn <(cloud -d 3 -k regular -n 4 --box 0,1,0,1,0,1) 2> note | mts text > whole
    awk '$2 == "faces.edge" { print; getline; print 0, 1, 0; next } { print }' whole > damaged
    finds ": not the edges of this face"
    printf '# mts 1\n# nodes.x f8 1 1\n0\n\n\n# end 1\n' > damaged
    finds "nodes.x: 1 columns instead of 2 or 3"
}

@test "command lines are strict" {
    square > text
    for command in 'mts' 'mts lists text' 'mts list -x text' 'mts list -v -v text' 'mts list text text' 'mts print' \
        'mts print u text text' 'mts text -t text' 'mts binary -v text' 'mts list -o out text' 'mts keep -o u text' \
        'mts check -t text' 'mts list nothere' 'mts list .' 'mts list --verbose=1 text'; do
        run -2 --separate-stderr bash -c "$command < /dev/null"
        [ "$output" = "" ]
        [ "${#stderr_lines[@]}" -eq 1 ]
        [[ "$stderr" == "mts: "* ]]
    done
    run -0 --separate-stderr mts -h
    [ "${lines[0]}" = "mts - list, print, convert, check and thin out streams" ]
    [ "$stderr" = "" ]
}

@test "check lists poor cells, the poorest first, and counts bodies, without a verdict; a face of three cells is one" {
    { printf '%s\n' '# mts 1'
        section 'nodes.x f8 8 2 enc=text unit=m cols=x,y' '0 0' '1 0' '0.5 1e-4' '0.5 -2e-5' '5 0' '6 0' '5 1' '5.0001 0.5'
        section 'cells i4 4 3 enc=text' '0 1 2' '1 0 3' '4 5 6' '4 6 7'
        echo '# end 2'; } > poor.mts
    run -1 mts check poor.mts
    [[ "${lines[0]}" == "cells: row 3: inverted or of no volume"* ]]
    [ ${#lines[@]} -eq 1 ]
    sed 's/^4 6 7$/5 7 6/; s/^5.0001 0.5/6 1/' poor.mts > good.mts
    run -0 mts check good.mts
    [[ "${lines[0]}" == "cells: row 1: poor: quality "*" at (0.5, -6.66667e-06) m" ]]
    [[ "${lines[1]}" == "cells: row 0: poor: quality "*" at (0.5, 3.33333e-05) m" ]]
    [ "${lines[2]}" = "cells: 2 connected bodies" ]
    [ ${#lines[@]} -eq 3 ]
    sed 's/^5 7 6$/0 1 6/' good.mts > three.mts
    run -1 mts check three.mts
    [[ "$output" == *"a face is shared by more than two cells"* ]]
}
