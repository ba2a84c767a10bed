# tomesh: a body as a mesh for other programs, with its groups.

load common.bash

# same_body A B: nodes, cells, facets and sets of two streams, and the names of their groups
same_body() {
    for section in nodes.x cells cells.region facets facets.set sets.ptr sets.idx; do
        cmp <(mts print $section "$1") <(mts print $section "$2")
        cmp <(mts list "$1" | grep "^$section") <(mts list "$2" | grep "^$section")
    done
}

# placed SECTION FILE: its rows, sorted, with the places of the nodes that it names
placed() {
    awk 'NR == FNR { x[NR - 1] = sprintf("%.9g %.9g %.9g;", $1, $2, $3); next } { for (i = 1; i <= NF; i++) printf "%s", x[$i]; print "" }' \
        <(mts print nodes.x "$2") <(mts print "$1" "$2") | sort
}

@test "msh: nodes reads the same body again, and gmsh a mesh that is the same, in 2D and 3D" {
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.2 |
        tag -n tip=ball:0.1,0.1,0.03 -n mid=ball:0.05,0.05,0.03 -r lump=ball:0.05,0.05,0.03 > plane.mts 2> note
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | tag -n tip=ball:0.1,0.1,0.1,0.03 -r lump=ball:0,0,0,0.06 > solid.mts 2> note
    for body in plane solid; do
        tomesh -u 0.5 -o $body.msh $body.mts
        nodes -u 0.5 $body.msh > again.mts
        same_body $body.mts again.mts
        gmsh -v 1 $body.msh -save -format msh22 -o other.msh
        nodes -u 0.5 other.msh > other.mts # gmsh writes one entity after the other
        for section in cells facets sets.idx; do cmp <(placed $section again.mts) <(placed $section other.mts); done
        for section in cells.region facets.set sets.ptr; do
            cmp <(mts print $section again.mts | sort) <(mts print $section other.mts | sort)
            cmp <(mts list again.mts | grep "^$section") <(mts list other.mts | grep "^$section")
        done
    done
}

@test "inp: nodes reads the same body again, in 2D and 3D, and as well what gmsh and meshio write" {
    cloud -d 2 -k jittered -n 5 --box 0,0.1,0,0.1 --jitter 0.2 |
        tag -n tip=ball:0.1,0.1,0.03 -n mid=ball:0.05,0.05,0.03 -n low=plane:0,0,0,1 -r lump=ball:0.1,0.1,0.03 > plane.mts 2> note
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 |
        tag -n tip=ball:0.1,0.1,0.1,0.03 -n mid=ball:0.05,0.05,0.05,0.03 -n low=plane:0,0,0,0,0,1 -r lump=ball:0.1,0.1,0.1,0.06 > solid.mts 2> note
    for body in plane solid; do
        mts list $body.mts | has 'sets.ptr.*names=tip,mid,low'
        tomesh -u 0.5 -o $body.msh $body.mts
        nodes -u 0.5 $body.msh | tomesh -u 0.5 -o $body.inp
        nodes -u 0.5 $body.inp > again.mts
        same_body $body.mts again.mts
    done
    gmsh -v 1 solid.msh -save -o gmsh.inp # with an element set for each physical group behind those of the entities
    nodes -u 0.5 gmsh.inp 2> said > gmsh.mts
    mts list gmsh.mts | has '^cells.region.*names=body,lump$'
    mts list gmsh.mts | has '^facets.set.*names=xmin,xmax,ymin,ymax,zmin,zmax$'
    /usr/bin/python3 -c 'import meshio as m; a = m.read("solid.msh"); m.Mesh(a.points, [c for c in a.cells if c.type != "vertex"]).write("meshio.inp")' > said 2>&1
    nodes -u 0.5 meshio.inp 2> said | mts print nodes.x | cmp - <(mts print nodes.x solid.mts)
}

@test "inp: CalculiX finds nodes, element sets, node sets and surfaces" {
    cloud -d 3 -k regular -n 3 --box 0,0.1,0,0.1,0,0.1 | tag -n base=plane:0,0,0,0,0,1 -r low=box:-1,-1,-1,1,1,0.05 > solid.mts 2> note
    tomesh -o solid.inp solid.mts
    [ "$(grep -c '^\*SURFACE' solid.inp)" -eq 6 ]
    {
        printf '*INCLUDE, INPUT=solid.inp\n*MATERIAL, NAME=m\n*ELASTIC\n3000., 0.3\n'
        printf '*SOLID SECTION, ELSET=%s, MATERIAL=m\n' body low
        printf '*BOUNDARY\nbase, 1, 3\n*STEP\n*STATIC\n*DSLOAD\nzmax, P, 100.\n*NODE PRINT, NSET=base, TOTALS=ONLY\nRF\n*END STEP\n'
    } > run.inp
    ccx run > said
    # 100 Pa on 0.01 m2
    awk '/total force/ { getline; getline; good = $3 > 0.9999 && $3 < 1.0001 } END { exit !good }' run.dat
}

@test "a name without a known ending, and a stream without cells, are refused" {
    cloud -d 2 -k halton -n 20 --box 0,1,0,1 > points.mts
    refused 2 "ends in .msh or .inp" tomesh points.mts
    refused 2 "ends in .msh or .inp" tomesh -o body.vtk points.mts
    refused 2 "no section cells" tomesh -o body.msh points.mts
    [ ! -e body.msh ]
}
