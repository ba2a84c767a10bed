# nodes: a gmsh mesh becomes a cloud, cells, facets and sets; and no mesh file, however broken, does harm.

load common.bash

setup() { enter_loosely; }

# The unit square of common.bash with a named corner and a diagonal.
square() {
    mesh | sed 's/^2$/4/; s/^1 2 "bottom"/0 1 "corner"\n&\n1 3 "diagonal"/
        s/^3$/5/; s/^2 1 2 2 1 20 10/1 15 2 1 1 30\n&\n3 1 2 3 2 10 30/'
}

# A unit cube by gmsh: $1 "hex" or "tet", $2 more options.
cube() {
    cat > cube.geo <<'END'
Point(1) = {0, 0, 0}; line() = Extrude {1, 0, 0} { Point{1}; Layers{3}; Recombine; };
face() = Extrude {0, 1, 0} { Line{line(1)}; Layers{3}; Recombine; };
body() = Extrude {0, 0, 1} { Surface{face(1)}; Layers{3}; Recombine; }; Physical Volume("body", 1) = {body(1)};
Physical Surface("top", 2) = {body(0)}; Physical Surface("bottom", 3) = {face(1)};
Physical Curve("edge", 4) = {line(1)};
END
    if [ "$1" = tet ]; then
        sed -i 's/Recombine; //' cube.geo
    fi
    gmsh -v 1 -3 cube.geo "${@:2}" -o cube.msh
}

# Sum of the volumes of the cells, and the least one.
volumes() {
    awk '
    /^# / { section = $2; next }
    NF == 0 { next }
    section == "nodes.x" { for (k = 1; k <= NF; k++) x[n + 0, k] = $k; n++; dim = NF }
    section == "cells" {
        for (i = 1; i <= dim; i++) for (k = 1; k <= dim; k++) e[i, k] = x[$(i + 1), k] - x[$1, k]
        if (dim == 2) v = (e[1,1] * e[2,2] - e[1,2] * e[2,1]) / 2
        else v = (e[1,1] * (e[2,2] * e[3,3] - e[2,3] * e[3,2]) - e[1,2] * (e[2,1] * e[3,3] - e[2,3] * e[3,1]) \
                + e[1,3] * (e[2,1] * e[3,2] - e[2,2] * e[3,1])) / 6
        sum += v; least = (count++ == 0 || v < least) ? v : least
    }
    END { printf "%.9g %d\n", sum, (least > 0) }' "$1"
}

@test "a square: cells, facets and sets" {
    square > square.msh
    nodes -u cm -t square.msh > square.mts 2> notes
    [ "$(rows nodes.x square.mts | tr '\n' ' ')" = "0 0 0.01 0 0.01 0.01 0 0.01 " ]
    [ "$(rows cells square.mts | wc -l)" -eq 2 ]
    [ "$(volumes square.mts)" = "0.0001 1" ]
    [ "$(rows facets square.mts)" = "0 1" ]
    grep -q '^# facets.set .* names=bottom$' square.mts
    grep -q '^# sets.ptr .* names=corner,diagonal$' square.mts
    [ "$(rows sets.idx square.mts | tr '\n' ' ')" = "2 0 2 " ]
    grep -q '^# cells.region .* names=body$' square.mts
    grep -q "nodes: midside nodes, and nodes of no cell, left out: 1" notes
    grep -q "nodes: group 'diagonal': facets between two cells, made a set of nodes: 1" notes
    grep -q "nodes: 100 % of the boundary is on parts one cell thick, as at (" notes
    [ "$(wc -l < notes)" -eq 3 ]
    { printf '$Comments\nby hand\n$EndComments\n'; sed 's/^$MeshFormat/& /' square.msh; } | nodes -u cm -t 2> notes | diff <(bare square.mts) <(bare)
    sed -e '1i$Comments\nof no format\n$EndComments' -e '/^$MeshFormat/,/^$End/d' square.msh > none.msh
    refused 2 'comes before $MeshFormat' nodes -u cm none.msh
}

@test "the brain section has 702 nodes and 1247 triangles, in every format" {
    local geo=$BATS_TEST_DIRNAME/../examples/brain2d/brain2d.geo
    for format in "msh41 0" "msh41 1" "msh2 0" "msh2 1"; do
        set -- $format
        sed 's/Mesh.MshFileVersion *= *4.1;//' "$geo" > brain2d.geo
        gmsh -v 1 -2 brain2d.geo -format "$1" -setnumber Mesh.Binary "$2" -o "$1-$2.msh"
        gmsh -v 1 -2 brain2d.geo -format "$1" -setnumber Mesh.Binary "$2" -setnumber Mesh.SaveParametric 1 -o parametric.msh
        nodes -u mm -t < parametric.msh > parametric.mts
        nodes -u mm -t < "$1-$2.msh" > "$1-$2.mts"
        cmp parametric.mts "$1-$2.mts"
        [ "$(rows nodes.x "$1-$2.mts" | wc -l)" -eq 702 ]
        [ "$(rows cells "$1-$2.mts" | wc -l)" -eq 1247 ]
        [ "$(rows facets "$1-$2.mts" | wc -l)" -eq 157 ]
        grep -q '^# cells.region .* names=parenchyma,tumour$' "$1-$2.mts"
        grep -q '^# facets.set .* names=brain_surface,craniotomy,ventricles$' "$1-$2.mts"
    done
    cmp msh41-0.mts msh2-0.mts
    cmp msh41-1.mts msh2-1.mts
    gmsh -v 1 -2 "$geo" -setnumber part 2 -o both.msh
    nodes -u mm -t both.msh 2> notes | cmp - msh41-0.mts
    grep -q "group 'skull': facets of no cell, left out: 81" notes
}

@test "-l lists the groups" {
    square > square.msh
    run -0 --separate-stderr nodes -l square.msh
    [ "$output" = "$(printf 'name\tdim\ttag\telements\ncorner\t0\t1\t1\nbottom\t1\t2\t1\ndiagonal\t1\t3\t1\nbody\t2\t4\t2')" ]
    [ -z "$stderr" ]
    refused 2 "-l goes with no other option" nodes -l -u mm square.msh
}

@test "usage errors" {
    square > square.msh
    refused 2 "unit of the mesh is missing: give -u m, cm, mm or um" nodes square.msh
    refused 2 "-u: 'inch' is none of m, cm, mm, um, nor a number of metres" nodes -u inch square.msh
    refused 2 "-u: '-1' is none of" nodes -u -1 square.msh
    refused 2 "unexpected operand" nodes -u mm square.msh square.msh
    ([[ "$BUILD" == *san* ]] || ulimit -v 4000000 # a sanitizer reserves more than any limit
    refused 2 "standard input: not a mesh of gmsh" nodes -u mm < /dev/zero)
}

@test "names: blanks become underscores, groups without names are numbered, two that become one name are refused" {
    square | sed 's/"body"/"the body"/' > blank.msh
    run -0 --separate-stderr nodes -u mm -t blank.msh
    [[ "$stderr" == *"group 'the body' is named 'the_body' here"* ]]
    [[ "$output" == *"names=the_body"* ]]
    nodes -l blank.msh | has '^the_body'
    square | sed 's/"diagonal"/"a b"/; s/"bottom"/"a,b"/' > same.msh
    run -0 --separate-stderr nodes -u mm -t same.msh
    [[ "$stderr" == *"group 'a,b' is named 'a_b_2' here"*"group 'a b' is named 'a_b_3' here"* ]]
    square | sed 's/"diagonal"/"bottom"/' > twice.msh
    nodes -l twice.msh | has -x "$(printf 'bottom_3\t1\t3\t1')"
    nodes -u mm -t twice.msh 2> said | has '^# facets.set .* names=bottom_2$'
    square | sed '/^\$PhysicalNames/,/^\$EndPhysicalNames/d' > unnamed.msh
    nodes -u mm -t unnamed.msh | has '^# cells.region .* names=group_4$'
}

@test "any unit, a body of an implausible size, and a report" {
    square > square.msh
    nodes -u 0.0254 -t square.msh 2> said > inch.mts
    [ "$(rows nodes.x inch.mts | tail -n 1)" = "0 0.025399999999999999" ]
    nodes -u 20 square.msh 2>&1 > /dev/null | has "nodes: the body is 28.3 m across: is the unit of -u right?"
    nodes -u um square.msh 2>&1 > /dev/null | has "nodes: the body is 1.41e-06 m across"
    run ! grep -q across said
    nodes -u m -v square.msh 2> said > /dev/null
    grep -q "nodes: 4 nodes, 2 cells, box 0 0 to 1 1 m, area 1 m2, 1 connected body" said
    grep -q "nodes: quality of the cells: least 0.83, median 0.83" said
    grep -q "nodes: cell 0: quality 0.83 at (0.666667, 0.333333) m" said
    # the corner of a cube: V = 1/6, surface (3 + sqrt 3) / 2, R = sqrt 3 / 2; 3 r / R is sqrt 3 - 1
    printf '%s\n' '*NODE' 1,0,0,0 2,1,0,0 3,0,1,0 4,0,0,1 '*ELEMENT, TYPE=C3D4' 1,1,2,3,4 | nodes -u m -v 2> said > /dev/null
    grep -q "nodes: quality of the cells: least 0.73, median 0.73" said
}

@test "a plate of one cell is reported, one of two cells and a cube are not" {
    for counts in 7,5,2 7,5,3 3,3,3 4,4,4; do
        cloud -d 3 -k regular -n "$counts" --box 0,6,0,4,0,1 2>> said > plate.mts
    done
    grep -q '^cloud: [0-9]* % of the boundary is on parts one cell thick, as at (.*, .*, .*) m: they bend too stiffly' said && [ "$(wc -l < said)" = 1 ]
}

@test "no physical groups: the entities of the geometry are groups, a single one of cells is the region body" {
    cube tet
    sed -i 's/Physical [^;]*;//g' cube.geo
    gmsh -v 1 -3 cube.geo -o bare.msh
    nodes -u m -t bare.msh > bare.mts
    grep -q "^# cells.region .* names=body$" bare.mts
    [ "$(grep '^# facets.set ' bare.mts | grep -o group_ | wc -l)" -eq 6 ]
    [ "$(nodes -u m -r body bare.msh 2> /dev/null | mts list | grep -c cells)" -eq 2 ]
    refused 2 "no region with cells 'skin'; there are: body" nodes -u m -r skin bare.msh
    # References of MEDIT, 0 among them.
    printf 'MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n0 0 -1 1\n' > two.mesh
    printf 'Tetrahedra\n2\n1 2 3 4 7\n1 3 2 5 0\nEnd\n' >> two.mesh
    for format in msh22 msh41; do
        gmsh -v 1 two.mesh -save -format $format -o two.msh
        nodes -u m -t two.msh > two.mts 2> said
        grep -q "^# cells.region .* names=group_0,group_7$" two.mts
        grep -q "nodes: no part of the boundary has a name: the program tag makes names" said
    done
    nodes -l two.msh > list
    grep -qx "$(printf 'group_7\t3\t7\t1')" list
}

@test "second-order cells lose their midside nodes" {
    cube tet
    nodes -u m -t cube.msh > plain.mts
    for order in "" "-setnumber Mesh.SecondOrderIncomplete 1"; do
        cube tet -order 2 $order
        nodes -u m -t cube.msh 2> said > cut.mts
        grep -q "midside nodes, and nodes of no cell, left out: [0-9]" said
        for section in nodes.x cells facets sets.idx; do
            cmp <(rows $section plain.mts) <(rows $section cut.mts)
        done
    done
    cube hex -order 2
    nodes -u m -t cube.msh 2> said | volumes /dev/stdin | has -x '1 1'
    cube hex -order 2 -setnumber Mesh.SecondOrderIncomplete 1
    nodes -u m -t cube.msh 2> said | volumes /dev/stdin | has -x '1 1'
    cube tet -order 3
    refused 2 "mesh with order 1" nodes -u m cube.msh
}

@test "versions that are not read, and partitioned meshes, are refused with the command that converts them" {
    # converted COMMAND: what it makes of cube.msh is the whole cube
    converted() {
        refused 2 "gmsh FILE $1 -o NEW.msh" nodes -u m cube.msh
        gmsh -v 1 cube.msh $1 -o new.msh
        nodes -u m -t new.msh > new.mts 2> said
        [ "$(volumes new.mts) $(rows nodes.x new.mts | wc -l) $(rows facets new.mts | wc -l)" = "1 1 64 36" ]
    }
    for format in msh1 msh40; do
        cube tet -format $format
        converted "-save -format msh41"
    done
    cube tet -format msh22
    sed -i '2s/^2.2/2.1/' cube.msh
    refused 2 "cube.msh: MSH version 2.1: convert it: gmsh FILE" nodes -u m cube.msh
    converted "-save -format msh41"
    for format in "msh41" "msh41 -bin"; do
        cube tet -part 3 -format $format
        refused 2 "cube.msh: \$PartitionedEntities: the mesh is partitioned: write it whole: gmsh FILE" nodes -u m cube.msh
        converted "-save -format msh22"
        grep -q '^# facets.set .* names=top,bottom$' new.mts
        grep -q '^# cells.region .* names=body$' new.mts
    done
}

@test "bodies that touch stay two, cells in two groups are of the first, and both are reported" {
    cat > touching.geo << 'END'
SetFactory("OpenCASCADE"); Box(1) = {0, 0, 0, 1, 1, 1}; Box(2) = {1, 0, 0, 1, 1, 1}; Physical Volume("left") = {1};
Physical Volume("all") = {1, 2}; Mesh.MeshSizeMin = 1;
END
    gmsh -v 1 -3 touching.geo -o touching.msh
    nodes -u m -v -t touching.msh 2> said > touching.mts
    mts check touching.mts | has -x 'cells: 2 connected bodies'
    grep -q "nodes at the same place, of different bodies: [0-9]* pairs: the bodies are not joined there" said
    grep -q "2 connected bodies" said
    grep -q "cells in two physical groups, or there twice, taken once: [0-9]" said
    grep -q '^# cells.region .* names=left,all$' touching.mts
    [ "$(volumes touching.mts)" = "2 1" ]
}

@test "a mesh with a slit, whose faces have a name, is read as such" {
    gmsh -v 1 -2 -setnumber meshed 1 -setnumber h 4 "$top/pipelines/incision/slit.geo" -o "$PWD/whole.msh"
    gmsh -v 1 -setstring mesh "$PWD/whole.msh" -setstring cracked "$PWD/slit.msh" "$top/pipelines/incision/crack.geo" -parse_and_exit
    nodes -u mm -t slit.msh > slit.mts
    mts check slit.mts
    [ "$(mts print facets.set slit.mts | grep -c '^0$')" = 10 ]
}

@test "nodes that hang on a facet of another cell are refused by place; between bodies they are noted" {
    printf '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 1 0.5 0\n' > hang.msh
    printf '6 2 0 0\n7 2 0.5 0\n8 2 1 0\n$EndNodes\n$Elements\n3\n' >> hang.msh
    printf '%s\n' '1 3 2 1 1 1 2 3 4' '2 3 2 2 2 2 6 7 5' '3 3 2 2 2 5 7 8 3' '$EndElements' >> hang.msh
    refused 2 "nodes on a facet of another cell, without being its corners: 1, the first at (0.01, 0.005) m: " nodes -u cm hang.msh
    sed 's/^8$/10/; s/^8 2 1 0$/&\n9 1 0 0\n10 1 1 0/; s/2 2 6 7 5/2 9 6 7 5/; s/8 3$/8 10/' hang.msh > apart.msh
    nodes -u cm apart.msh > apart.mts 2> said
    grep -q "^nodes: nodes on a facet of another body or face of a slit, without being its corners: 1, the first at (0.01, 0.005) m: " said
    mts check apart.mts | has '^cells: nodes on a facet of another body'
    sed 's/^3$/6/; s/^3 3 2.*/&\n4 1 2 9 9 2 3\n5 1 2 9 9 2 5\n6 1 2 9 9 5 3/' hang.msh | nodes -u cm > lips.mts 2> said
    grep -q "nodes on a facet of another body or face of a slit, without being its corners: 1, " said
    printf '# mts 1\n# nodes.x f8 5 2 enc=text unit=m\n0 0\n1 0\n0 1\n0.5 0.5\n1 1\n\n\n' > hang.mts
    printf '# cells i4 3 3 enc=text\n0 1 2\n1 4 3\n3 4 2\n\n\n# end 2\n' >> hang.mts
    run -1 mts check hang.mts
    [[ "$output" == *"cells: nodes on a facet of another cell, without being its corners: 1, the first at (0.5, 0.5) m: "* ]]
    # Cubes of 2 and 3 layers; their middles are open by a thousandth of a cell.
    for at in 1 1.001; do
        for side in "0 2" "$at 3"; do
            printf 'Geometry.AutoCoherence = 0;\n'
            printf 'p = newp; Point(p) = {%s, 0, 0}; l() = Extrude {1, 0, 0} { Point{p}; Layers{%s}; };\n' $side
            printf 'f() = Extrude {0, 1, 0} { Line{l(1)}; Layers{%s}; };\nExtrude {0, 0, 1} { Surface{f(1)}; Layers{%s}; }\n' "${side#* }" "${side#* }"
        done > cubes.geo
        printf 'Mesh 3;\nCoherence Mesh;\nSave "cubes%s.msh";\n' $at >> cubes.geo
        gmsh -v 1 -0 cubes.geo
    done
    refused 2 "nodes on a facet of another cell, without being its corners: 17, the first at (0.01, " nodes -u cm cubes1.msh
    nodes -u cm cubes1.001.msh > cubes.mts 2> said
    run ! grep corners said
}

@test "files of other programs are refused; the commands that nodes -h gives make meshes of them" {
    cube tet
    sed 's/Physical [^;]*;//g' cube.geo > bare.geo # with groups gmsh writes these only
    gmsh -v 1 -2 bare.geo -o body.stl
    refused 2 "not a mesh of gmsh, Abaqus, CalculiX, FEBio or VTK: nodes -h says how to make one" nodes -u m body.stl
    printf 'Merge "body.stl";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n' > fill.geo
    gmsh -v 1 -3 fill.geo -o filled.msh
    nodes -u m -t filled.msh 2> /dev/null | volumes /dev/stdin | has -x '1 1'
    for ending in mesh unv bdf; do
        gmsh -v 1 -3 bare.geo -o foreign.$ending
        gmsh -v 1 foreign.$ending -save -o body.msh
        nodes -u m -t body.msh 2> said | volumes /dev/stdin | has -x '1 1'
    done
    /usr/bin/python3 -c 'import meshio as m, numpy as n; a = m.read("filled.msh"); t = a.cells_dict["tetra"]
m.Mesh(a.points, [("tetra", t)], cell_data={"tetgen:ref": [n.arange(len(t)) // (len(t) - 1)]}).write("body.node")' > said 2>&1
    nodes -h | sed -n "s|^ *python3 -c '\(.*\)'$|\1|p" > command.py
    /usr/bin/python3 command.py 2> said
    nodes -u m -t body.vtu > body.mts 2> said
    grep -q '^# cells.region .* names=tetgen_ref_0,tetgen_ref_1$' body.mts
    [ "$(volumes body.mts)" = "1 1" ]
    /usr/bin/python3 -c 'import meshio as m; a = m.read("body.stl"); a.cell_data = {}; a.write("body.off"); a.write("body.obj")' > said 2>&1
    for surface in body.off body.obj; do
        /usr/bin/python3 -c "import meshio as m; m.write('body.stl', m.read('$surface'))" > said 2>&1
        gmsh -v 1 -3 fill.geo -o filled.msh
        nodes -u m -t filled.msh 2> said | volumes /dev/stdin | has -x '1 1'
    done
}
