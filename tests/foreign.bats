# nodes: meshes of other programs come in with their names, or are refused by a line that says what to do.

load common.bash

setup() {
    enter_loosely
    corpus=$BATS_TEST_DIRNAME/fuzz/corpus
}

# names FILE...: the names of regions, facets and sets of what nodes makes of a mesh
names() {
    nodes -u m "$@" > body.mts 2> said || { cat said; return 1; }
    mts list body.mts | sed -n 's/.*names=//p' | paste -sd' '
}

# faulty < CASES: each "FILE|SED|MESSAGE", a change of a file of the corpus that is refused with that message
faulty() {
    while IFS='|' read -r file change message; do
        sed "$change" "$corpus/$1/$file" > changed
        refused 2 "$message" nodes -u m changed || { echo "$file $change: $stderr"; return 1; }
    done
}

@test "decks of Abaqus: keywords in any case, lines continued, sets of sets, surfaces, sections, one part" {
    [ "$(names "$corpus/inp/solid")" = "Low,top skin,side,shell Nall,base,some,points" ]
    grep -q "is left out: \*MATERIAL, \*ELASTIC" said
    grep -q "sets of elements that are not regions, left out: both" said
    [ "$(mts print sets.ptr body.mts | paste -sd' ')" = "0 7 10 14 17" ]
    [ "$(mts print facets.set body.mts | sort | uniq -c | awk '{ print $1 }' | paste -sd' ')" = "1 3 1" ]
    [ "$(names "$corpus/inp/part")" = "Set-1 edge Set-1" ]
    [ "$(mts print facets body.mts)" = "1 2" ]
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 3" ]
    [ "$(names --midside use "$corpus/inp/second")" = "a s" ]
    [ "$(mts print facets body.mts | wc -l)" -eq 8 ]
    names - < "$corpus/inp/solid" | grep -q Low
}

@test "decks of Abaqus: what is wrong is told by keyword and line" {
    faulty inp << 'END'
solid|s/^2, 1.D0/2, nan/|*NODE: line 6: coordinate: 'nan' is not a finite number
solid|s/^9, 0/6, 0/|nodes: node tag 6 stands twice
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6/|*ELEMENT: line 18: element 7 ends after 3 of 4 nodes
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6, 9, 1/|*ELEMENT: line 17: element 7 has more than 4 nodes
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6, 8/|element 7 names the node 8, which is not in the file
solid|s/type=C3D4/type=C3D7/|TYPE=C3D7: no element that is read
solid|s/^base, 9/base, 8/|sets: line 28: there is no node 8
solid|s/^base, 9/bass, 9/|sets: line 28: there is no set 'bass'
solid|s/^Low, S3/Low, S6/|sets: line 30: a prism has no face 'S6'
solid|s/^Low, S3/Low/|*SURFACE: line 30: no face is named
solid|s/^.NSET, NSET=some/*NSET, NSET=some, GENERATE/|*NSET: line 28: GENERATE
solid|s/^.MATERIAL, NAME=m/*INCLUDE, INPUT=x/|*INCLUDE: line 38: other files are not read: put the lines of that file in its place
solid|s/^.MATERIAL, NAME=m/*NGEN/|write all of them out
solid|s/^.NODE,/*NODE, SYSTEM=C,/|write them with SYSTEM=R
part|s/^ 0., 0., 0./ 0., 0., 1./|*INSTANCE: line 20: the instance is moved: write the deck without parts
part|s/^.Amplitude.*/*Part, name=b/|more than one part or instance: write the deck without parts
END
    printf '*NODE\n1, 0, 0\n2, 1, 0' > changed
    refused 2 "line 3: no newline at the end: truncated?" nodes -u m changed
}

@test "models of FEBio: parts, surfaces, sets of nodes of versions 2.5, 3.0 and 4.0" {
    [ "$(names "$corpus/feb/v25")" = "brick,material_3 shell held" ]
    grep -q "left out: MeshData" said
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 1" ]
    [ "$(names "$corpus/feb/v40")" = "low,top side base,rim" ]
    grep -q "left out: Material, SurfacePair, MeshDomains" said
    [ "$(mts print cells.region body.mts | paste -sd' ')" = "0 0 0 1 0" ]
    [ "$(mts print sets.ptr body.mts | paste -sd' ')" = "0 3 5" ]
    [ "$(mts print facets body.mts | wc -l)" -eq 3 ]
    [ "$(names --midside use "$corpus/feb/hex27")" = "h low" ]
    nodes -u m -v --midside use "$corpus/feb/hex27" > body.mts 2> said
    grep -q "volume 8 m3" said
    [ "$(mts print facets body.mts | wc -l)" -eq 8 ]
}

@test "models of FEBio: what is wrong is told by element and line" {
    faulty feb << 'END'
v25|s/version="2.5"/version="1.2"/|<febio_spec>: line 3: version '1.2': open it in FEBio Studio
v25|s/ 2, 1, 0</ 2, inf, 0</|<Nodes>: line 6: coordinate: 'inf' is not a finite number
v25|s/ 2, 1, 0</ 2, 1</|<Nodes>: line 6: coordinate: '' is not
v25|s/id="4"> 2/id="3"> 2/|nodes: node tag 3 stands twice
v25|s/"hex8"/"hex9"/|<Elements>: line 11: type 'hex9': no element that is read
v25|s/"hex8"/"tet8"/|type 'tet8': no element
v25|s/3, 4, 5, 6, 13/3, 4, 5, 13/|<Elements>: line 11: 7 nodes, where hexahedron has 8
v25|s/3, 4, 5, 6, 13/3, 4, 5, 7, 13/|element 1 names the node 7, which is not in the file
v25|s/node id="4".>/node id="7"\/>/|a set or surface names the node 7
v25|s/<node id="4".>/<node\/>/|<NodeSet>: line 14: 'node' is no <node id=...>
v25|s/<Geometry>/<Geometry from="x">/|other files are not read: put the content of that file in its place
v25|s/<NodeSet name="held">/<Part name="held">/|parts with instances are not read
v25|s/<.Geometry>//|XML: line 17: mismatched tag
v25|s/^<.-- a/<!DOCTYPE a><!-- a/|XML: line 2: the file declares a document type: take
v40|s/<tri3/<tri8/|<Surface>: line 13: 'tri8' is no face that is read
v40|s/^<Mesh>/<Mesh>\&x;/|XML: line 4: undefined entity
END
    size=$(wc -c < "$corpus/feb/v40")
    for at in $(seq 200 97 $((size - 3))); do
        head -c "$at" "$corpus/feb/v40" > changed
        refused 2 "changed: XML: line" nodes -u m changed
    done
}
