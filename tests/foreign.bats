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
    [ "$(names "$corpus/inp/solid")" = "Low,top skin,side,shell Nall,base,some,upper,points" ]
    grep -q "is left out: \*MATERIAL, \*ELASTIC" said
    grep -q "sets of elements that are not regions, left out: both" said
    [ "$(mts print sets.ptr body.mts | paste -sd' ')" = "0 7 10 14 18 21" ]
    [ "$(mts print facets.set body.mts | sort | uniq -c | awk '{ print $1 }' | paste -sd' ')" = "1 3 1" ]
    printf '%s\n' '*ELSET, ELSET=all' Low '*SOLID SECTION, ELSET=Low' '*SOLID SECTION, ELSET=all' | cat "$corpus/inp/solid" - > overlaid
    names overlaid > list
    grep -q "elements in several sets, taken for the last: [1-9]" said
    printf '*NSET, NSET=gen, GENERATE\n1, 3\n2, 200, 2\n' | cat "$corpus/inp/solid" - > ranges
    names ranges | has ,gen
    grep -q "set 'gen': of what its lines of GENERATE name, only [4-9] of 103 exist" said
    [ "$(names "$corpus/inp/part")" = "Set-1 edge Set-1" ]
    [ "$(mts print facets body.mts)" = "1 2" ]
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 3" ]
    [ "$(names "$corpus/inp/second")" = "a s n" ]
    grep -q "group 'n': midside nodes or nodes of no cell, left out: 1" said
    # lines of second order: end, middle, end
    printf '%s\n' '*NODE' 1,0,0 2,1,0 3,1,1 4,0,1 5,.5,0 6,1,.5 7,.5,1 8,0,.5 '*ELEMENT,TYPE=CPE8,ELSET=b' 1,1,2,3,4,5,6,7,8 \
        '*ELEMENT,TYPE=t2d3,ELSET=low' 2,1,5,2 > line
    [ "$(names line)" = "b low" ]
    [ "$(mts print facets body.mts)" = "0 1" ]
    names - < "$corpus/inp/solid" | has Low
    sed 's/NSET=base/NSET="the base"/; s/^base/"the base"/' "$corpus/inp/solid" | names - | has Nall,the_base,some,upper,points
}

@test "decks of Abaqus: nodes of the assembly, reference points, are left out, and not taken for those of the part" {
    sed '/^.End Instance/r /dev/stdin' "$corpus/inp/part" > points.inp << 'END'
*Node
1, 5., 0., 0.
*Node, nset=rp2
2, 5., 0., 0.
*Nset, nset=RP-1
1,
*Nset, nset=gen, generate
1, 2, 1
*Nset, nset=picked, instance=plate-1
1, 2
*Nset, nset=mixed
plate-1.3, RP-1, 4
*Element, type=MASS, elset=m
1, 1
END
    [ "$(names points.inp)" = "Set-1 edge picked,mixed,Set-1" ]
    grep -q "left out: \*NODE of the assembly, \*ELEMENT, " said
    grep -q "group 'RP-1' of dimension 0 is empty: left out" said
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 1 2 0 3" ]
}

@test "decks of Abaqus: errors name keyword and line" {
    faulty inp << 'END'
solid|s/^2, 1.D0/2, nan/|*NODE: line 6: coordinate: 'nan' is not a finite number
solid|s/^9, 0.*/&\n6, 5, 5, 5/|nodes: line 12: node tag 6 stands twice
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6/|*ELEMENT: line 18: element 7 ends after 3 of 4 nodes
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6, 9, 1/|*ELEMENT: line 17: element 7 has more than 4 nodes
solid|s/^7, 4, 5, 6, 9/7, 4, 5, 6, 8/|*NSET: line 29: there is no node 8 as yet
solid|s/type=C3D4/type=C3D7/|TYPE=C3D7: no element that is read
solid|s/type=C3D4/type=SPRINGA/|TYPE=SPRINGA: no element that is read
solid|s/type=C3D4/type=F3D4/|TYPE=F3D4: no element that is read
solid|s/type=C3D4/type=C3D27/|TYPE=C3D27: no element that is read (C3D4, C3D20, CPE3, S3, ...; no beams, fluids, C3D27): take it out
solid|s/^base, 9/base, 8/|*NSET: line 28: there is no node 8 as yet
solid|s/^base, 9/upper, 9/|*NSET: line 28: there is no set 'upper' as yet
solid|s/^.NODE, /*NODE, INPUT=x, /|*NODE: line 4: other files are not read: put the lines of that file in its place
solid|s/^base, 9/bass, 9/|*NSET: line 28: there is no set 'bass' as yet
solid|s/=top, MATERIAL/=tip, MATERIAL/|sets: line 38: there is no set 'tip'
solid|s/^Low, S3/Low, S6/|*SURFACE: line 31: a prism has no face 'S6'
solid|s/^Low, S3/Low/|*SURFACE: line 31: no face is named
solid|s/^.NSET, NSET=some/*NSET, NSET=some, GENERATE/|*NSET: line 28: GENERATE
solid|s/^.MATERIAL, NAME=m/*NSET, NSET=back, GENERATE\n8, 1, 1/|*NSET: line 40: GENERATE: 8 is behind 1
solid|s/^.MATERIAL, NAME=m/*INCLUDE, INPUT=x/|*INCLUDE: line 39: other files are not read: put the lines of that file in its place
solid|s/^.MATERIAL, NAME=m/*NGEN/|write all of them out
solid|s/^.NODE,/*NODE, SYSTEM=C,/|write them with SYSTEM=R
part|s/^ 0., 0., 0./ 0., 0., 1./|*INSTANCE: line 20: the instance is moved: write the deck without parts
part|s/^.Amplitude.*/*Part, name=b/|more than one part or instance: write the deck without parts
END
    printf '*NODE\n1,0,0\n2,1,0\n3,0,1\n*NSET,NSET=2nd\n1\n*NSET,NSET=n\n2nd,2\n*ELEMENT,TYPE=CPE3\n1,1,2,3' > open
    [ "$(names open)" = "body 2nd,n" ]
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 0 1" ]
    head -c -2 open > changed
    refused 2 "*ELEMENT: line 10: element 1 ends after 2 of 3 nodes" nodes -u m changed
}

@test "models of FEBio: parts, surfaces, sets of nodes of versions 2.5, 3.0 and 4.0" {
    [ "$(names "$corpus/feb/v25")" = "brick,material_3 shell held" ]
    grep -q "left out: MeshData" said
    [ "$(mts print sets.idx body.mts | paste -sd' ')" = "0 1" ]
    [ "$(names "$corpus/feb/v40")" = "low,top side base,rim" ]
    grep -q "left out: Material, SurfacePair, MeshDomains" said
    sed 's|<NodeSet name="base">|<NodeSet name="none"/><Surface name="bare"/>&|' "$corpus/feb/v40" > empty
    [ "$(names empty)" = "low,top side base,rim" ]
    [ "$(grep -c "group '\(none\|bare\)' of dimension [02] is empty: left out" said)" -eq 2 ]
    [ "$(mts print cells.region body.mts | paste -sd' ')" = "0 0 0 1 0" ]
    [ "$(mts print sets.ptr body.mts | paste -sd' ')" = "0 3 5" ]
    [ "$(mts print facets body.mts | wc -l)" -eq 3 ]
    [ "$(names "$corpus/feb/hex27")" = "h low" ]
    [ "$(mts print facets body.mts | wc -l)" -eq 2 ]
}

@test "models of FEBio: errors name element and line" {
    faulty feb << 'END'
v25|s/version="2.5"/version="1.2"/|<febio_spec>: line 3: version '1.2': open it in FEBio Studio
v25|s/ 2, 1, 0</ 2, inf, 0</|<Nodes>: line 6: coordinate: 'inf' is not a finite number
v25|s/ 2, 1, 0</ 2, 1, 0, 0</|<Nodes>: line 6: node 5 has more than three coordinates
v25|s/brick/&&&&&&&&&&&&&&&&&&&&&&&&&&/|<Elements>: line 11: the name 'brickbrickbrickbrickbrickbrickbrickbrick...' is longer than 127 bytes
v25|s/ 2, 1, 0</ 2, 1</|<Nodes>: line 6: coordinate: '' is not
v25|s/id="4"> 2/id="3"> 2/|nodes: line 6: node tag 3 stands twice
v25|s/"hex8"/"hex9"/|<Elements>: line 11: type 'hex9': no element that is read
v25|s/"hex8"/"tet8"/|type 'tet8': no element
v25|s/3, 4, 5, 6, 13/3, 4, 5, 13/|<Elements>: line 11: 7 nodes, where hexahedron has 8
v25|s/3, 4, 5, 6, 13/3, 4, 5, 7, 13/|element 1 names the node 7, which is not in the file
v25|s/node id="4".>/node id="7"\/>/|elements: the set or surface 'held' names the node 7
v25|s/<node id="4".>/<node\/>/|<NodeSet>: line 14: 'node' is no <node id=...>
v25|s/<node id="4".>/<NodeSet node_set="heldd"\/>/|<NodeSet>: line 14: there is no set of nodes 'heldd' as yet
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

# variants BODY.vtu: what VTK and meshio make of a file
variants() {
    /usr/bin/python3 - "$1" 2>> said << 'END'
import itertools, meshio, sys, vtk
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
texts = vtk.vtkStringArray()
texts.SetName("texts")
for i in range(reader.GetOutput().GetNumberOfCells()): texts.InsertNextValue(["", "a", "long " * 20][i % 3])
reader.GetOutput().GetCellData().AddArray(texts)
for mode, packed, wide, big, encoded in itertools.product((0, 1, 2), (0, 1), (0, 1), (0, 1), (0, 1)):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(reader.GetOutput())
    writer.SetDataMode(mode) # text, base64, appended
    writer.SetCompressorTypeToZLib() if packed else writer.SetCompressorTypeToNone()
    writer.SetBlockSize(264)
    writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
    writer.SetByteOrderToBigEndian() if big else writer.SetByteOrderToLittleEndian()
    writer.SetEncodeAppendedData(encoded)
    writer.SetFileName("vtk%d%d%d%d%d.vtu" % (mode, packed, wide, big, encoded))
    writer.Write()
for version, kind in itertools.product((42, 51), (1, 2)):
    writer = vtk.vtkUnstructuredGridWriter()
    writer.SetInputData(reader.GetOutput())
    writer.SetFileVersion(version)
    writer.SetFileType(kind)
    writer.SetFileName("vtk%d%d.vtk" % (version, kind))
    writer.Write()
mesh = meshio.read(sys.argv[1])
mesh.write("meshio.vtu")
meshio.vtu.write("meshio-text.vtu", mesh, binary=False)
mesh.write("meshio.vtk")
meshio.vtk.write("meshio42.vtk", mesh, fmt_version="4.2")
END
}

@test "VTU and VTK, in all forms that VTK and meshio write: the body that tovtk wrote, with its regions" {
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.2 | tag -n tip=ball:0.1,0.1,0.03 -r lump=ball:0.05,0.05,0.03 > plane.mts 2> note
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | tag -n tip=ball:0.1,0.1,0.1,0.03 -r lump=ball:0,0,0,0.06 > solid.mts 2> note
    for body in plane solid; do
        tovtk -t -o text.vtu $body.mts
        tovtk -o binary.vtu $body.mts
        [ $body = plane ] || variants binary.vtu
        for file in *.vt?; do
            [[ $file != vtk* ]] || { names "$file" > /dev/null; grep -q "left out: .*texts" said; }
            [[ $(names "$file") =~ ^(body,lump|cells.region_0,cells.region_1)" xmin,xmax,ymin,ymax,"(zmin,zmax,)?tip$ ]]
            for section in nodes.x cells cells.region; do mts print $section body.mts | cmp - <(mts print $section $body.mts); done
        done
        [ "$(mts print sets.idx body.mts | tail -n 1)" = "$(mts print sets.idx $body.mts | tail -n 1)" ]
    done
    [ "$(printf '%s\n' *.vt? | wc -l)" -eq 58 ]
}

@test "VTU and VTK: the array of the regions, facets of meshio, cells of second order" {
    cat > two.geo << 'END'
SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 1, 1, 1}; Box(2) = {1, 0, 0, 1, 1, 0.5}; Coherence;
Mesh.MeshSizeMax = 0.5; Physical Volume("left", 3) = {1}; Physical Volume("right", 7) = {2}; Physical Surface("end", 5) = {1};
END
    gmsh -v 1 -3 two.geo -order 2 -o two.msh
    /usr/bin/python3 -c 'import meshio as m; a = m.read("two.msh"); a.write("two.vtu"); a.write("two.vtk")
m.Mesh(a.points, [("tetra", a.cells_dict["tetra10"][:, :4])], cell_data={"id": [[*range(len(a.cells_dict["tetra10"]))]]}).write("numbered.vtu")' 2> said
    nodes -u m two.msh > two.mts
    for file in two.vtu two.vtk; do
        [ "$(names $file)" = "gmsh_physical_3,gmsh_physical_7 gmsh_physical_surface_5" ]
        grep -q "the regions are those of the cells' array 'gmsh:physical'" said
        for section in cells.region facets; do mts print $section body.mts | sort | cmp - <(mts print $section two.mts | sort); done
        [[ $(names --regions-of gmsh:geometrical $file) == gmsh_geometrical_1,gmsh_geometrical_2* ]]
    done
    sed 's/gmsh:physical/one/; s/gmsh:geometrical/other/' two.vtu > unknown.vtu
    refused 2 "several arrays of whole numbers: --regions-of names the one with the regions: one, other" nodes -u m unknown.vtu
    refused 2 "the cells have no array 'none' of whole numbers" nodes -u m --regions-of none two.vtu
    /usr/bin/python3 -c 'import meshio as m; a = m.read("two.vtu"); d = a.cell_data["gmsh:physical"]
a.cell_data = {"real": [x.astype("f4") * (1 + 1e-7) for x in d], "half": [x / 2 for x in d]}; a.write("real.vtu"); a.write("real.vtk", binary=False)' 2> said
    [[ $(names --regions-of real real.vtu) == real_3,real_7* && $(names --regions-of real real.vtk) == real_3,real_7* ]]
    refused 2 "half: 2.5 is not a whole number" nodes -u m --regions-of half real.vtu
    [ "$(names numbered.vtu)" = body ]
    sed 's/$/\r/' "$corpus/vtk/text.vtk" > windows.vtk
    [ "$(names windows.vtk)" = "a,b n" ]
    printf '\xef\xbb\xbf' | cat - "$corpus/vtk/text.vtk" > marked.vtk
    [ "$(names marked.vtk)" = "a,b n" ]
    # facets of tovtk are not nodes of a set of that name
    sed 's/^<PointData>/&<DataArray type="Int8" Name="facets.n">0 1 0 0 1<\/DataArray><DataArray type="Int8" Name="set.">1 1 1 1 1<\/DataArray>/' \
        "$corpus/vtk/text.vtu" > both.vtu
    [ "$(names both.vtu)" = "a,b n_3,n_4" ]
    grep -q "left out: set\.$" said
    # one cell of each type, each of volume 1
    [ "$(names "$corpus/vtk/types.vtk")" = "a_b_-1,a_b_2" ]
    nodes -u m -v "$corpus/vtk/types.vtk" > body.mts 2> said
    grep -q "volume 5 m3" said
}

@test "VTU and VTK: errors name array and line" {
    faulty vtk << 'END'
text.vtu|s/="UnstructuredGrid" /="PolyData" /|type 'PolyData': only UnstructuredGrid is read
text.vtu|s/byte_order/compressor="vtkLZ4DataCompressor" byte_order/|compressor vtkLZ4DataCompressor: only zlib is read
text.vtu|s/NumberOfPoints="5"/NumberOfPoints="6"/|numbers, not 18
text.vtu|s/NumberOfPoints="5"/NumberOfPoints="-5"/|Piece: line 12: NumberOfPoints: -5 is not
text.vtu|s/NumberOfCells="2"/NumberOfCells="2147483648"/|NumberOfCells: 2147483648 is not within
text.vtu|s/^4$/9/|grid: cell 0: its offset 9 is not within
text.vtu|s/^10$/99/|type 99 of VTK with 4 points is no element
text.vtu|s/Name="types"/Name="kinds"/|grid: no types: the file is truncated
text.vtu|0,/^0 0 0$/s/^0 0 0$/0 nan 0/|'nan' is not a finite number
text.vtu|s/UInt8/Float32/|numbers of a type that has no place here
packed.vtu|s/ AgAAAEA/ Ag*AAEA/|12 bytes, where there are 0: the file is
packed.vtu|s/ AgAAAEA/ AQAAAEA/|Points: line
raw.vtu|s/encoding="raw">/encoding="raw">?/|AppendedData: it is missing, or does not begin
raw.vtu|s/offset="0"/offset="4000"/|AppendedData: region.a: its offset 4000 is behind the end
text.vtk|s/UNSTRUCTURED_GRID/POLYDATA/|'POLYDATA' is no UNSTRUCTURED_GRID
text.vtk|s/^POINTS 5/POINTS 2147483647/|POINTS: 6442450941 numbers cannot be in
text.vtk|s/^4 0 1 2 3/7 0 1 2 3/|CELLS: cell 1: more points than there are
text.vtk|s/^CELLS/CELLZ/|CELLZ: what this is, is not known
text.vtk|s/ double/ triple/|numbers of type 'triple' are not read
text.vtk|s/^CELLS 2 10/CELLS 2 11/;s/^4 1 2 3 4/& 0/|CELLS: 11 numbers, where 2 cells take 10
text.vtk|s/^CELLS 2 10/CELLS 12 10/|CELLS: 12 cells cannot have 10 numbers
text.vtk|s/^CELLS/&&&&&&&&&&&&&&/|a word of more than 63 bytes
text.vtk|s/^set.n 1 5/set.n 1 4/;s/^1 1 0 0 0/1 1 0 0/|set.n: 4 numbers, not one for each of 5 points
text.vtu|s/region.a/&&&&&&&&&&&&&&&&&&&/|FieldData: line 5: the name 'region.aregion.aregion.aregion.aregion.a...' is longer than 127 bytes
text.vtk|s/^4 0 1 2 3/4 0 1 2 9/|elements: element 0 names the node 9
END
    for file in text.vtu packed.vtu raw.vtu text.vtk binary.vtk; do
        size=$(wc -c < "$corpus/vtk/$file")
        for at in $(seq 50 83 $((size - 20))); do
            head -c "$at" "$corpus/vtk/$file" > changed
            refused 2 "changed: " nodes -u m changed
        done
    done
}

@test "files that do not say where they end, or where and how large things are" {
    printf '# vtk DataFile Version 2.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n' > t.vtk
    nodes -u m t.vtk 2> note | mts check
    { cat t.vtk; printf 'CELL_DATA 1\nFIELD F 2\nmat 1 1 int\n1\n'; } > cut.vtk
    refused 2 "FIELD has 1 of 2 arrays" nodes -u m cut.vtk
    { cat t.vtk; printf 'CELL_DATA 1\nFIELD F 1\nmat 1 1 int\n123'; } > cut.vtk
    refused 2 "cut within its last number" nodes -u m cut.vtk
    for unit in cm mm; do
        printf '{"markups": [{"coordinateUnits": ["%s", "UCUM", "%s"], "controlPoints": [{"position": [-0.2, -0.2, 0.2]}]}]}\n' $unit $unit > $unit.mrk.json
    done
    cloud -d 3 -k regular -n 3 --box 0,0.001,0,0.001,0,0.001 > cube.mts
    tag -u mm -n tip=near:1,mm.mrk.json cube.mts > at.mts 2> note
    refused 2 "coordinateUnits is not mm" tag -u mm -n tip=near:1,cm.mrk.json cube.mts
    head='NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n'
    refused 2 "axis maxs without space directions" voxels -h 2mm <(printf "${head}axis maxs: 8 8 8\n\n%064d" 1)
    refused 2 "a space without space directions" voxels -h 2mm <(printf "${head}space: LPS\nspacings: 2 2 2\n\n%064d" 1)
    refused 2 "axis mins of cells without" voxels -h 2mm <(printf "${head}spacings: 2 2 2\ncenters: cell cell cell\naxis mins: 0 0 0\n\n%064d" 1)
    mkfifo data.raw
    timeout 5 bash -c 'echo > data.raw' 3>&- & # whoever reads it waits no longer than this
    printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: data.raw\n' > piped.nhdr
    refused 2 "its data, data.raw: is a folder, pipe or device, not a file" voxels -h 2mm piped.nhdr
    mkdir images images/in
    head -c 64 /dev/zero | tee images/in/own.raw > other.raw
    ln -s ../other.raw images/link.raw
    ln -s ../.. images/in/up
    ln -s in/own.raw images/own.raw
    for file in link.raw in/up/other.raw own.raw; do
        printf 'NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\ndata file: %s\n' $file > images/of.nhdr
        [ $file = own.raw ] || refused 2 "$file: is a link that leaves the folder of the header" voxels -h 2mm images/of.nhdr
    done
    (cd images && { voxels -h 2mm of.nhdr 2>&1 || :; } | has "no label")
    refused 2 "more data than 2 values" sample <(printf 'NRRD0004\ntype: uint8\ndimension: 2\nsizes: 1 2\nencoding: ascii\n\n1 2 300\n') cube.mts
    # A pipe by its name is read once.
    tomesh -u m -o body.msh <(cat cube.mts)
    nodes -u m body.msh 2> note | mts check
}

@test "memory is taken for what a compressed file holds, not for what it claims, and once for each of its bytes" {
    /usr/bin/python3 - << 'END'
import base64, struct, zlib
def vtu(name, points, array, tail=b""):
    open(name, "wb").write(b'<VTKFile type="UnstructuredGrid" header_type="UInt32"%s><UnstructuredGrid><Piece NumberOfPoints="%d" '
        b'NumberOfCells="0">%s</Piece></UnstructuredGrid>%s</VTKFile>' % (b' compressor="vtkZLibDataCompressor"' * (tail == b""), points, array, tail))
packed = bytes(range(256)) * 8000
head = base64.b64encode(struct.pack("<IIII", 1, 2**31 - 8, 0, len(packed)))
vtu("claim.vtu", 89478485, b'<Points><DataArray type="Float64" NumberOfComponents="3" format="binary">' + head + base64.b64encode(packed) + b'</DataArray></Points>')
packed = zlib.compress(bytes(1 << 29))
head = base64.b64encode(struct.pack("<IIII", 1, 1 << 29, 0, len(packed)))
vtu("bomb.vtu", 8, b'<Points><DataArray type="Float64" NumberOfComponents="3" format="binary">' + head + base64.b64encode(packed) + b'</DataArray></Points>')
array = b'<DataArray type="UInt8" Name="set.%d" format="appended" offset="0"/>'
vtu("shared.vtu", 9999, b"<PointData>" + b"".join(array % i for i in range(10)) + b"</PointData>",
    b'<AppendedData encoding="raw">_' + struct.pack("<I", 9999) + bytes(9999))
END
    # Sanitizers reserve terabytes of addresses: the limit is for builds without them.
    ([[ "$BUILD" == *san* ]] || ulimit -v 400000
    refused 2 "Points: line 1: a block of the compressed data is damaged" nodes -u m claim.vtu
    refused 2 "Points: line 1: 1 blocks of 536870912 bytes are more than the 192 that its numbers take" nodes -u m bomb.vtu)
    refused 2 "set.0: its offset 0 is behind the end of the file, or is also that of another array" nodes -u m shared.vtu
}
