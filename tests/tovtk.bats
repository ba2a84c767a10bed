# tovtk: what ParaView is given is what the stream holds.

load common.bash

setup() { enter_loosely; }

# A triangle mesh of two cells in two regions, with a field, two frames of it, and a CSR list that is no field.
two_triangles() {
    printf '%s\n' '# mts 1'
    section 'nodes.x f8 4 2 enc=text unit=m cols=x,y' '0 0' '1 0' '1 1' '0 0.1'
    section 'cells i4 2 3 enc=text' '0 1 2' '0 2 3'
    section 'cells.region i4 2 1 enc=text names=grey<&"matter,white' 1 0
    section 'sets.idx i4 4 1 enc=text' 0 1 2 3
    section 'u f8 4 2 enc=text unit=m cols=x,y' '0 0' '0 0' '0 0.25' '0 -0.1'
    section 'stress f8 2 3 enc=text unit=Pa cols=xx,yy,xy' '1 2 3' '4 5 6'
    section 'u.frame.1 f8 4 2 enc=text unit=m time=0.5' '0 0' '0 0' '0 0.125' '0 -0.05'
    section 'u.frame.2 f8 4 2 enc=text unit=m time=1' '0 0' '0 0' '0 0.25' '0 -0.1'
    echo '# end 8'
}

well_formed() { /usr/bin/python3 -c 'import sys, xml.dom.minidom; xml.dom.minidom.parse(sys.argv[1])' "$1"; }

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

# Reads a file as ParaView and as meshio do: tests/helper/vtu.py. A reader that is not installed is a failure that says so.
vtu() { /usr/bin/python3 "$BATS_TEST_DIRNAME/helper/vtu.py" "$@"; }

@test "the regions have their names, whatever they contain, and their numbers" {
    two_triangles | tovtk -t -o out.vtu
    well_formed out.vtu
    grep -q 'Name="region.grey&#60;&#38;&#34;matter" NumberOfTuples="1"' out.vtu
    [ "$(vtu values out.vtu 'region.grey<&"matter')" = 0 ]
    [ "$(vtu values out.vtu region.white)" = 1 ]
    # of a mesh whose names are in Latin-1
    two_triangles | sed $'s/white/wei\xdf/' | tovtk -t -o out.vtu
    well_formed out.vtu
    [ "$(vtu values out.vtu region.weiß)" = 1 ]
}

@test "VTK and meshio read the same: binary, text, with cells and without, in 2D and 3D" {
    two_triangles > triangles
    cloud -d 2 -k halton -n 9 --box 0,1,0,1 --field linear > points
    squeezed_cube > cube
    for stream in triangles points cube; do
        for form in "" -t; do
            tovtk $form -o out.vtu $stream
            vtu arrays out.vtu > arrays$form
            [ -s arrays$form ]
        done
        cmp arrays arrays-t
    done
    for line in "u points 3 x y z" "stress cells 6 xx yy zz xy yz xz" "stress.von_mises cells 1 -" "stress.principal cells 3 1 2 3" \
        "pressure cells 1 -" "strain.principal cells 3 1 2 3" "J cells 1 -" "facets.xmin points 1 -" "region.body field 1 -"; do
        grep -qx "$line" arrays || { echo "no $line"; cat arrays; false; }
    done
    cut -d ' ' -f 1,2 arrays | sort | uniq -d | cmp - /dev/null # no name twice
}

# A cube of 27 nodes, its top pushed down and aside, with stress and strain in its stream.
squeezed_cube() {
    cloud -d 3 -k jittered -n 3 --box 0,0.1,0,0.1,0,0.1 --jitter 0.2 > cube.mts
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n[material all]\nregion = body\nE = 3000\nnu = 0.45\nrho = 1000\n' > cube.scene
    printf '[displacement low]\nfacets = zmin\ncomponents = 0, 0, 0\n' >> cube.scene
    printf '[displacement top]\nfacets = zmax\ncomponents = 0.01, 0.005, -0.01\n' >> cube.scene
    printf '[output]\nstress = yes\nstrain = yes\n%s' "$1" >> cube.scene
    mtled cube.scene cube.mts 2> note
}

@test "tensors in VTK's order: a glyph's principal stress is that of the stream" {
    { printf '%s\n' '# mts 1'
        section 'nodes.x f8 5 3 enc=text' '0 0 0' '1 0 0' '0 1 0' '0 0 1' '1 1 1'
        section 'cells i4 2 4 enc=text' '0 1 2 3' '1 2 3 4'
        section 'stress f8 2 6 enc=text unit=Pa cols=xx,yy,zz,xy,xz,yz' '0 0 0 0 100 0' '30 30 30 0 0 40'
        echo '# end 3'; } > shear
    tovtk -o shear.vtu shear
    [ "$(vtu largest shear.vtu stress)" = $'100.0\n70.0' ] # one pure shear along xz, one along yz in a pressure
    squeezed_cube > cube
    tovtk -o cube.vtu cube
    vtu largest cube.vtu stress > glyphs # in single precision
    vtu values cube.vtu stress.principal > principal
    vtu values cube.vtu stress.von_mises > mises
    vtu values cube.vtu pressure > pressure
    paste -d ' ' <(mts print stress cube) principal glyphs mises pressure > both
    awk 'function near(a, b, tolerance) { if (!((a - b) ^ 2 <= (tolerance * scale) ^ 2)) { print NR ": " a " is not " b; exit failed = 1 } }
        { xx = $1; yy = $2; zz = $3; xy = $4; xz = $5; yz = $6; a = $7; b = $8; c = $9
          i1 = xx + yy + zz; i2 = xx * yy + yy * zz + zz * xx - xy ^ 2 - xz ^ 2 - yz ^ 2
          i3 = xx * yy * zz + 2 * xy * xz * yz - xx * yz ^ 2 - yy * xz ^ 2 - zz * xy ^ 2
          scale = sqrt(a * a + b * b + c * c)
          near(a + b + c, i1, 1e-12); near((a * b + b * c + c * a) / scale, i2 / scale, 1e-12)
          near(a * b * c / scale ^ 2, i3 / scale ^ 2, 1e-12); near($10, a, 1e-6)
          near($11, sqrt(i1 ^ 2 - 3 * i2), 1e-12); near($12, -i1 / 3, 1e-12)
          if (!(a >= b && b >= c)) exit failed = 1 }
        END { exit failed || NR != 48 }' both
}

@test "J of the strain is that of a known deformation; what the stream has is not added" {
    two_triangles > plain
    sed 's/^# stress .*/# strain f8 2 4 enc=text cols=xx,yy,zz,xy/; s/^1 2 3$/0.22 -0.095 0 0/; s/^4 5 6$/0 0 0 0.1/' plain > strained
    tovtk -t -o out.vtu strained
    # F = diag(1.2, 0.9, 1) and C = (1 0.2; 0.2 1)
    array out.vtu J | awk 'NR == 1 { ok = ($1 - 1.08) ^ 2 < 1e-30 } NR == 2 { ok = ok && ($1 - sqrt(0.96)) ^ 2 < 1e-30 } END { exit !(ok && NR == 2) }'
    [ "$(array out.vtu strain)" = $'0.22 -0.095000000000000001 0 0 0 0\n0 0 0 0.10000000000000001 0 0' ]
    { sed '/^# end/d' strained; printf '# volume_ratio f8 2 1 enc=text\n1\n2\n\n\n# end 9\n'; } > given
    tovtk -t -o out.vtu given
    [ "$(array out.vtu volume_ratio | xargs)" = "1 2" ]
    run -1 grep 'Name="J"' out.vtu
    grep -q strain.principal out.vtu
}

@test "groups: the nodes of facets and of node sets; those that do not fit are refused" {
    { two_triangles | sed '/^# end/d; /^# sets.idx/,/^# u/{/^# u/!d}'
      printf '# facets i4 2 2 enc=text\n0 1\n1 2\n\n\n# facets.set i4 2 1 enc=text names=low,high\n0\n1\n\n\n'
      printf '# sets.ptr i8 2 1 enc=text names=corner\n0\n1\n\n\n# sets.idx i4 1 1 enc=text\n3\n\n\n# end 11\n'; } > groups
    tovtk -t -o out.vtu groups
    [ "$(array out.vtu facets.low | xargs)" = "1 1 0 0" ]
    [ "$(array out.vtu facets.high | xargs)" = "0 1 1 0" ]
    [ "$(array out.vtu set.corner | xargs)" = "0 0 0 1" ]
    tovtk -t -o run.pvd groups
    [ "$(array run-0001.vtu facets.high | xargs)" = "0 1 1 0" ]
    sed 's/names=low,high/names=low/' groups > bad
    refused 2 "facets.set: row 1: no group 1 in names=" tovtk bad
    sed '/^# facets i4/{n;s/0 1/0 9/}' groups > bad
    refused 2 "facets: row 0: no row 9 of nodes.x" tovtk bad
}

@test "the ending of a name says what is written" {
    two_triangles > stream
    for name in x.vtk folder.d/x.stl x.msh; do
        refused 2 "$name: .${name##*.} files are not written: name it .vtu or .pvd" tovtk -o $name stream
    done
    mkdir folder.d
    tovtk -o folder.d/plain stream 2> note # no ending: the default
    well_formed folder.d/plain
    [ "$(find . -name 'x.*')" = "" ]
}

@test "a pvd begins with frame 0 where there is one, and has every field of the frames, and what follows from them" {
    { two_triangles | sed '/^# end/d'
      printf '# u.frame.0 f8 4 2 enc=text time=0\n0 0\n0 0\n0 0\n0 0\n\n\n'
      printf '# stress.frame.1 f8 2 4 enc=text cols=xx,yy,zz,xy time=0.5\n4 1 2 0\n3 3 3 0\n\n\n# end 10\n'; } | tovtk -t -o run.pvd
    for file in run*; do well_formed "$file"; done
    [ "$(ls run* | xargs)" = "run-0000.vtu run-0001.vtu run-0002.vtu run.pvd" ]
    [ "$(sed -n 's/.*timestep="\([0-9.]*\)".*file="\(.*\)".*/\1 \2/p' run.pvd | xargs)" = "0 run-0000.vtu 0.5 run-0001.vtu 1 run-0002.vtu" ]
    [ "$(array run-0000.vtu u | tail -1)" = "0 0 0" ]
    [ "$(array run-0001.vtu stress)" = $'4 1 2 0 0 0\n3 3 3 0 0 0' ]
    [ "$(array run-0001.vtu stress.principal)" = $'4 2 1\n3 3 3' ]
    [ "$(array run-0001.vtu pressure | xargs)" = "-2.3333333333333335 -3" ]
    run -1 grep stress run-0000.vtu run-0002.vtu
    for file in run-000?.vtu; do vtu arrays $file | has -x 'u points 3 .*'; done
}

@test "wrong use: one line and status 2" {
    two_triangles > stream
    refused 2 "" tovtk -f vtu
    refused 2 "" tovtk stream stream
    sed '/^# cells.region/ { s/ 2 1 / 1 1 /; n; d }' stream > short
    refused 2 "cells.region: does not fit cells: 1 rows instead of 2" tovtk short
}
