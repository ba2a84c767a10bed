# tovtk: what ParaView and gmsh are given is what the stream holds.

bats_require_minimum_version 1.5.0

setup() {
    cd "$BATS_TEST_TMPDIR"
}

# A triangle mesh of two cells in two regions, with a field, two frames of it, and a CSR list that is no field.
two_triangles() {
    cat <<'END'
# mts 1
# nodes.x f8 4 2 enc=text unit=m cols=x,y
0 0
1 0
1 1
0 0.1


# cells i4 2 3 enc=text
0 1 2
0 2 3


# cells.region i4 2 1 enc=text names=grey<&"matter,white
1
0


# sets.idx i4 4 1 enc=text
0
1
2
3


# u f8 4 2 enc=text unit=m cols=x,y
0 0
0 0
0 0.25
0 -0.1


# stress f8 2 3 enc=text unit=Pa cols=xx,yy,xy
1 2 3
4 5 6


# u.frame.1 f8 4 2 enc=text unit=m time=0.5
0 0
0 0
0 0.125
0 -0.05


# u.frame.2 f8 4 2 enc=text unit=m time=1
0 0
0 0
0 0.25
0 -0.1


# end 8
END
}

# Every tag closed in order, one root: enough XML for what tovtk writes.
well_formed() {
    awk 'BEGIN { RS = "<" }
         NR == 1 { if ($0 != "") exit bad = 1; next }
         { if (!match($0, />/)) exit bad = 1
           tag = substr($0, 1, RSTART - 1)
           if (tag ~ /^\?/ || tag ~ /\/$/) next
           split(tag, word, /[ \n]/)
           if (tag ~ /^\//) { if (stack[depth--] != substr(word[1], 2)) exit bad = 1 }
           else { if (depth == 0 && roots++ > 0) exit bad = 1; stack[++depth] = word[1] } }
         END { exit bad || depth != 0 || roots != 1 }' "$1"
}

# The content of the DataArray named $2 of file $1.
array() {
    awk -v name="Name=\"$2\"" '/^<DataArray/ && index($0, name) { inside = 1; next }
                               /^<\/DataArray/ { inside = 0 } inside' "$1"
}

@test "a text vtu holds nodes, cells, regions and padded displacements" {
    two_triangles | tovtk -t -o out.vtu
    well_formed out.vtu
    [ "$(array out.vtu Points)" = $'0 0 0\n1 0 0\n1 1 0\n0 0.10000000000000001 0' ]
    [ "$(array out.vtu connectivity | xargs)" = "0 1 2 0 2 3" ]
    [ "$(array out.vtu offsets | xargs)" = "3 6" ]
    [ "$(array out.vtu types | xargs)" = "5 5" ]
    [ "$(array out.vtu u | tail -1)" = "0 -0.10000000000000001 0" ]
    [ "$(array out.vtu cells.region | xargs)" = "1 0" ]
    [ "$(array out.vtu stress)" = $'1 2 3\n4 5 6' ]
    grep -q 'Name="stress" NumberOfComponents="3" ComponentName0="xx" ComponentName1="yy" ComponentName2="xy"' out.vtu
    run -1 grep 'sets.idx\|frame' out.vtu
    # points before cells: the displacement is a field of the points, the stress one of the cells
    awk '/<PointData/ { p = 1 } /<\/PointData/ { p = 0 } /Name="u"/ && p { u = 1 } /Name="stress"/ && !p { s = 1 }
         END { exit !(u && s) }' out.vtu
}

@test "the names of the regions are there as characters, whatever they contain" {
    two_triangles | tovtk -o out.vtu
    well_formed out.vtu
    codes=$(awk '/<Array/ { inside = 1; next } /<\/Array/ { inside = 0 } inside' out.vtu | head -1)
    [ "$codes" = "$(printf 'grey<&"matter\0' | od -An -v -tu1 | xargs)" ]
}

@test "base64 holds the same bytes as the numbers in the text form" {
    cloud -d 3 -k jittered -n 4 --box 0,1,0,1,0,1 --jitter 0.1 --field quadratic -o cloud.mts
    tovtk -o binary.vtu cloud.mts
    tovtk -t -o text.vtu cloud.mts
    well_formed binary.vtu
    for name in Points:8 connectivity:8 offsets:8 types:1 u:8; do
        size=${name#*:} name=${name%:*}
        array binary.vtu "$name" | base64 -d > bytes
        [ "$(od -An -v -tu8 -N8 bytes | xargs)" -eq $(($(stat -c %s bytes) - 8)) ]
        case $name in Points | u) format=f8 ;; *) format=u$size ;; esac
        tail -c +9 bytes | od -An -v -w"$size" -t"$format" | awk '{ printf "%.14g\n", $1 }' > from_binary
        array text.vtu "$name" | tr ' ' '\n' | awk '{ printf "%.14g\n", $1 }' > from_text
        [ -s from_text ]
        cmp from_binary from_text
    done
}

@test "a pvd lists the frames with their times, each with its own field" {
    mkdir sub
    two_triangles | tovtk -t -o sub/run.pvd
    [ "$(ls sub | xargs)" = "run-0001.vtu run-0002.vtu run.pvd" ]
    for file in sub/*; do well_formed "$file"; done
    [ "$(grep -c '<DataSet' sub/run.pvd)" -eq 2 ]
    grep -q 'timestep="0.5" part="0" file="run-0001.vtu"' sub/run.pvd
    grep -q 'timestep="1" part="0" file="run-0002.vtu"' sub/run.pvd
    [ "$(array sub/run-0001.vtu u | tail -2 | head -1)" = "0 0.125 0" ]
    [ "$(array sub/run-0002.vtu u | tail -2 | head -1)" = "0 0.25 0" ]
    [ "$(array sub/run-0001.vtu cells.region | xargs)" = "1 0" ]
    run -1 grep stress sub/run-0001.vtu # known at the end only
}

@test "a single file says that there are frames" {
    two_triangles > stream
    run --separate-stderr tovtk stream
    [ "$status" -eq 0 ]
    [ "$stderr" = "tovtk: only the final state is written: name a .pvd file for all 2 frames" ]
}

@test "a stream without frames makes a series of one" {
    cloud -d 2 -k regular -n 3 --box 0,1,0,1 | tovtk -o one.pvd
    [ "$(ls one* | xargs)" = "one-0000.vtu one.pvd" ]
}

@test "nodes without cells become points" {
    cloud -d 2 -k halton -n 5 --box 0,1,0,1 --field linear | tovtk -t > out.vtu
    well_formed out.vtu
    [ "$(array out.vtu types | xargs)" = "1 1 1 1 1" ]
    [ "$(array out.vtu connectivity | xargs)" = "0 1 2 3 4" ]
    [ "$(array out.vtu u | wc -l)" -eq 5 ]
}

@test "gmsh reads back the same nodes and cells" {
    cloud -d 3 -k jittered -n 4 --box 0,1,0,1,0,1 --jitter 0.1 --field linear -t -o cloud.mts
    tovtk -f gmsh cloud.mts > body.msh
    nodes -u m -t body.msh > back.mts
    for name in nodes.x cells cells.region; do
        for file in cloud back; do
            awk -v name="$name" '/^# / { inside = $2 == name; next } inside' $file.mts > $file.part
        done
        [ -s cloud.part ]
        cmp cloud.part back.part
    done
}

@test "gmsh views: all frames in one view, a vector for the displacement" {
    two_triangles | tovtk -f gmsh -o views.msh
    [ "$(grep -c '^"u"$' views.msh)" -eq 2 ]
    [ "$(grep -c '^"cells.region"$' views.msh)" -eq 1 ]
    # string tags, real tags (time), integer tags (step, components, rows), rows
    expected=$'1\n"u"\n1\n0.5\n3\n0\n3\n4\n1 0 0 0\n2 0 0 0\n3 0 0.125 0\n4 0 -0.050000000000000003 0'
    [ "$(awk '/^\$NodeData/ { if (seen++) exit; inside = 1; next } /^\$/ { inside = 0 } inside' views.msh)" = "$expected" ]
    grep -q "^2 1 \"grey<&'matter\"$" views.msh
    two_triangles | awk '/^# / { cut = /u\.frame/; sub("end 8", "end 6") } !cut' | tovtk -f gmsh > final.msh
    [ "$(grep -c '^"stress xx"$\|^"stress yy"$\|^"stress xy"$' final.msh)" -eq 3 ]
}

@test "the same bytes from a file, from standard input, to a file, to standard output" {
    two_triangles > stream
    for options in "-f vtu" "-t" "-f gmsh"; do
        tovtk $options stream 2> note > from_file
        tovtk $options < stream 2> note > from_stdin
        tovtk $options -o to_file stream 2> note
        cmp from_file from_stdin
        cmp from_file to_file
    done
}

@test "an output stays as it was when the input is cut" {
    two_triangles > stream
    echo before > out.vtu
    for size in 0 7 100 400 $(($(stat -c %s stream) - 1)); do
        run --separate-stderr tovtk -o out.vtu <(head -c "$size" stream)
        [ "$status" -eq 2 ]
        [ "${#stderr_lines[@]}" -eq 1 ]
        [ "$(cat out.vtu)" = before ]
    done
    [ "$(ls -A | grep -v separate-stderr | xargs)" = "out.vtu stream" ] # nothing temporary left
}

@test "a full device is reported" {
    two_triangles > stream
    for options in "-f vtu" "-f gmsh"; do
        run --separate-stderr bash -c "tovtk $options stream 2> err > /dev/full; echo \$?; tail -1 err"
        [ "${lines[0]}" = 3 ]
        [[ ${lines[1]} == "tovtk: standard output: "* ]]
    done
}

@test "wrong use: one line and status 2" {
    two_triangles > stream
    for options in "-f vtk" "-f gmsh -t" "-f gmsh -o x.pvd" "-x" "-t -t" "stream stream" "missing"; do
        run --separate-stderr tovtk $options
        [ "$status" -eq 2 ]
        [ -z "$output" ]
        [ "${#stderr_lines[@]}" -eq 1 ]
    done
    run -0 tovtk -h
    [[ $output == "tovtk - "* ]]
}

@test "regions that do not match the cells are refused" {
    two_triangles | sed '/^# cells.region/ { s/ 2 1 / 1 1 /; n; d }' > stream
    run --separate-stderr tovtk stream
    [ "$status" -eq 2 ]
    [[ $stderr == *"cells.region: has 1 rows, cells 2"* ]]
}
