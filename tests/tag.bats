# tag: facets, node sets and regions chosen by place, shape and connection.

load common.bash

setup() { enter_loosely; }

# A block of .1 x .1 x .2 m whose names are taken away, as bare.mts.
bare_block() { cloud -d 3 -k regular -n 6,6,11 --box 0,0.1,0,0.1,0,0.2 | mts drop 'facets*' > bare.mts; }

# What -v tells of a group: report KIND NAME, from the file said.
report() { sed -n "s/^tag: $1 $2: //p" said; }

@test "ends, boxes, balls, planes, normals: counts, areas, boxes and mean normals" {
    bare_block
    tag -u mm -v -f held=low:long,12% -f pushed=high:z,12% -f 'probe=ball:50,50,200,30 and normal:0,0,1,60' \
        -f flat=plane:0,0,0,0,0,1 -f side=box:100,0,0,100,100,200 -f upper=half:0,0,100,0,0,1 bare.mts > g.mts 2> said
    [ "$(report facets held)" = "90, area 0.018 m2, box 0 0 0 to 0.1 0.1 0.02 m, mean normal 0 0 -0.556" ]
    [ "$(report facets pushed)" = "90, area 0.018 m2, box 0 0 0.18 to 0.1 0.1 0.2 m, mean normal 0 0 0.556" ]
    [ "$(report facets probe)" = "16, area 0.0032 m2, box 0.02 0.02 0.2 to 0.08 0.08 0.2 m, mean normal 0 0 1" ]
    [ "$(report facets flat)" = "50, area 0.01 m2, box 0 0 0 to 0.1 0.1 0 m, mean normal 0 0 -1" ]
    [ "$(report facets side)" = "100, area 0.02 m2, box 0.1 0 0 to 0.1 0.1 0.2 m, mean normal 1 0 0" ]
    [ "$(report facets upper)" = "250, area 0.05 m2, box 0 0 0.1 to 0.1 0.1 0.2 m, mean normal 0 0 0.2" ]
    mts check g.mts
    # the facets of cloud are found again, and oriented as they were
    cloud -d 3 -k regular -n 6,6,11 --box 0,0.1,0,0.1,0,0.2 -t | rows facets > all
    tag -f bottom=plane:0,0,0,0,0,1 -t bare.mts | rows facets | awk '
        NR == FNR { seen[$1 " " $2 " " $3] = seen[$2 " " $3 " " $1] = seen[$3 " " $1 " " $2] = 1; next }
        !($0 in seen) { exit 1 }' all -
}

@test "or, and, without; rings; groups of groups; sides; the same in 2D" {
    bare_block
    tag -v -f top=plane:0,0,0.2,0,0,1 -f 'rest=all without top' -f 'both=rest or top' -f 'wide=top grown:1' \
        -f 'back=wide shrunk:1' -f 'inner=top shrunk:1' -f largest=side:1,30 -f near=side:0.05,0.05,0.3,30 \
        -f skin=side:1,180 -n tip=facets:top -f again=nodes:tip -n 'rim=boundary and plane:0,0,0.2,0,0,1' \
        -n 'grown=tip grown:1' bare.mts 2> said | mts check
    [[ "$(report facets top)" == "50, "* ]]
    [[ "$(report facets rest)" == "450, "* ]]
    [[ "$(report facets both)" == "500, "* ]]
    [[ "$(report facets wide)" == "90, "* ]]
    [ "$(report facets back)" = "$(report facets top)" ]
    # the ring at the edges is gone: 3 x 3 of 5 x 5 squares
    [[ "$(report facets inner)" == "18, area 0.0036 m2, box 0.02 0.02 0.2 to 0.08 0.08 0.2 m"* ]]
    [[ "$(report facets largest)" == "100, area 0.02 m2"* ]]
    [ "$(report facets near)" = "$(report facets top)" ]
    [ "$(report facets skin)" = "$(report facets both)" ]
    [[ "$(report nodes tip)" == "36, "* ]]
    [ "$(report facets again)" = "$(report facets top)" ]
    [[ "$(report nodes rim)" == "36, "* ]]
    [[ "$(report nodes grown)" == "72, "* ]]
    # cells and nodes shrink from the boundary of the body: 3 x 3 x 8 of 5 x 5 x 10 blocks of 6 cells, less the corners that touch it
    tag -v -r 'core=all shrunk:1' -n 'inside=all shrunk:1' bare.mts 2> said | mts check
    [[ "$(report nodes inside)" == "144, "*"box 0.02 0.02 0.02 to 0.08 0.08 0.18 m"* ]]
    [[ "$(report region core)" == *"box 0.02 0.02 0.02 to 0.08 0.08 0.18 m"* ]]
    cloud -d 2 -k regular -n 6,11 --box 0,0.1,0,0.2 |
        tag -v -f left=plane:0,0,1,0 -f up=normal:0,1,10 -f long=side:1,30 -n half=half:0,0.1,0,1 2> said | mts check
    [ "$(report facets left)" = "10, length 0.2 m, box 0 0 to 0 0.2 m, mean normal -1 0" ]
    [ "$(report facets up)" = "5, length 0.1 m, box 0 0.2 to 0.1 0.2 m, mean normal 0 1" ]
    [[ "$(report facets long)" == "10, length 0.2 m"* ]]
    [[ "$(report nodes half)" == "36, "* ]]
}

@test "sides end at sharp turns, and at a node that two bodies share" {
    { echo '# mts 1' # two squares that touch in a node, and a third one apart
        section 'nodes.x f8 11 2 enc=text' '0 0' '1 0' '1 1' '0 1' '2 1' '2 2' '1 2' '5 0' '7 0' '7 2' '5 2'
        section 'cells i4 6 3 enc=text' '0 1 2' '0 2 3' '2 4 5' '2 5 6' '7 8 9' '7 9 10'
        echo '# end 2'; } > islands.mts
    for sides in 180:3 90:3 89:12; do
        refused 2 "there are ${sides#*:}, counted from 1" tag -f "a=side:13,${sides%:*}" islands.mts
    done
}

@test "near the points and along the surface of a file" {
    bare_block
    echo '0 0 200' > points.tsv
    printf -- '-100 -100 0 400 -100 0 -100 400 0\n' > surface.tsv
    tag -u mm -v -n corner=near:21,points.tsv -f bottom=along:1,surface.tsv bare.mts 2> said | mts check
    [[ "$(report nodes corner)" == "4, "* ]]
    [ "$(report facets bottom)" = "50, area 0.01 m2, box 0 0 0 to 0.1 0.1 0 m, mean normal 0 0 -1" ]
    printf '0 0\n100 0\n' > curve.tsv
    cloud -d 2 -k regular -n 6,11 --box 0,0.1,0,0.2 |
        tag -u mm -v -f bottom=along:1,curve.tsv -f ends=near:11,curve.tsv 2> said | mts check
    [[ "$(report facets bottom)" == "5, length 0.1 m"* ]]
    [[ "$(report facets ends)" == "4, length 0.08 m"* ]]
    refused 2 "none.tsv: No such file" tag -f a=near:1,none.tsv bare.mts
    refused 2 "takes DISTANCE,FILE with a positive distance" tag -f a=near:-1,points.tsv bare.mts
}

@test "cavities and separate bodies" {
    cat > two.geo << 'END'
SetFactory("OpenCASCADE"); Sphere(1) = {0, 0, 0, 10}; Sphere(2) = {0, 0, 0, 4};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; }; Box(4) = {20, 0, 0, 5, 5, 5};
Mesh.MeshSizeMax = 3;
END
    gmsh -v 1 -3 two.geo -o two.msh
    nodes -u mm two.msh 2> /dev/null | tag -v -f outer=side:1,180 -f cavity=side:2,180 -f box=side:3,180 -r cube=body:2 \
        -f of_cube=region:cube -n in_cube=body:0.022,0.002,0.002 2> said | mts check
    awk '{ exit !($1 > 1.0e-3 && $1 < 1.26e-3) }' <<< "$(report facets outer | sed 's/.*area \([^ ]*\).*/\1/')"
    awk '{ exit !($1 > 1.5e-4 && $1 < 2.02e-4) }' <<< "$(report facets cavity | sed 's/.*area \([^ ]*\).*/\1/')"
    [[ "$(report facets box)" == *"area 0.00015 m2, box 0.02 0 0 to 0.025 0.005 0.005 m"* ]]
    [ "$(report facets of_cube)" = "$(report facets box)" ]
    [[ "$(report region cube)" == *"volume 1.25e-07 m3"* ]]
    [[ "$(report nodes in_cube)" == *"box 0.02 0 0 to 0.025 0.005 0.005 m" ]]
}

@test "regions part the cells; replaced and deleted groups" {
    bare_block
    tag -v -r lump=ball:0.05,0.05,0.1,0.04 -f a=low:z,10% -f b=high:z,10% bare.mts 2> said > g.mts
    [[ "$(report region body)" == "1308, volume 0.001744 m3"* ]]
    [[ "$(report region lump)" == "192, volume 0.000256 m3"* ]]
    tag -f floor=a -d a -d b g.mts > h.mts
    mts list h.mts | has 'facets.set.*names=floor$'
    mts print cells.region g.mts | cmp - <(mts print cells.region h.mts)
    mts print facets h.mts | cmp - <(mts print facets g.mts | head -n "$(mts print facets h.mts | wc -l)")
    refused 2 "there is one of that name already: --replace replaces it" tag -f a=all g.mts
    tag --replace -f a=all -v g.mts 2> said > /dev/null
    [[ "$(report facets a)" == "500, "* ]]
    tag --replace -r lump=half:0,0,0,1,0,0 g.mts 2> said > i.mts
    grep -q "region 'body' has no cells left: its name is dropped" said
    mts check i.mts
    refused 2 "104 of 1500 cells belong to no region" tag --replace -r lump=ball:0.05,0.05,0.1,0.03 g.mts
    refused 2 "its cells would belong to no region" tag -d lump g.mts
    tag -r a=high:x,10% g.mts > twice.mts 2> /dev/null
    refused 2 "both facets and region have that name: write facets:a or region:a" tag -d a twice.mts
    tag -r c=region:a twice.mts 2> said | mts list | has 'cells.region.*names=body,lump,c$'
    tag -d a -d b g.mts | mts list > list
    run -1 grep -q facets list
}

@test "what cannot be meant is refused in one line, with the remedy" {
    bare_block
    refused 2 "the box is inside out along y: the low corner comes first" tag -f a=box:0,1,0,1,0,1 bare.mts
    refused 2 "chooses none of 500 facets; the body's box is 0 0 0 to 0.1 0.1 0.2 m" tag -f a=ball:9,9,9,1 bare.mts
    refused 2 "takes the numbers X0,Y0,Z0,X1,Y1,Z1" tag -f a=box:1,2 bare.mts
    refused 2 "'bal:1' is no term" tag -f a=bal:1 bare.mts
    refused 2 "'free' is no term of -h, and no name of facets; there are: none" tag -f a=free bare.mts
    refused 2 "ends where a term should stand" tag -f 'a=all or' bare.mts
    refused 2 "ends where a term should stand" tag -f a= bare.mts
    refused 2 "'all' stands where or, and, without" tag -f 'a=all all' bare.mts
    refused 2 "'or' stands where a term should" tag -f 'a=or all' bare.mts
    refused 2 "0 is not within [1, 1000]" tag -f 'a=all grown:0' bare.mts
    refused 2 "takes AXIS,PART%, such as x,12%" tag -f a=low:w,3% bare.mts
    refused 2 "takes AXIS,PART%, such as x,12%" tag -f a=low:x,3 bare.mts
    refused 2 "there are 6, counted from 1" tag -f a=side:7,30 bare.mts
    refused 2 "the direction has no length" tag -f a=normal:0,0,0,30 bare.mts
    refused 2 "not within 0 and 180 degrees" tag -f a=normal:0,0,1,200 bare.mts
    refused 2 "chooses facets: not for regions" tag -r a=normal:0,0,1,20 bare.mts
    refused 2 "no blanks, commas, quotes" tag -f 'a b=all' bare.mts
    refused 2 "is a word of the expressions" tag -f or=all bare.mts
    refused 2 "lacks its '='" tag -f all bare.mts
    refused 2 "no group of that name" tag -d a bare.mts
    refused 2 "nothing to do" tag bare.mts
    refused 2 "-u: 'inch' is none of m, cm, mm, um, nor a number of metres" tag -u inch -f a=all bare.mts
    cloud -d 3 -k halton -n 50 --box 0,1,0,1,0,1 > points.mts
    refused 2 "the stream has no cells, only nodes can be grouped" tag -f a=all points.mts
    tag -n a=low:x,50% points.mts | mts check
    cloud -d 2 -k regular -n 3 --box 0,1,0,1 -t | awk '/^# facets i4/ { print; getline; print "0 8"; next } 1' > inside.mts
    refused 2 "facets: row 0: no face of exactly one cell" tag -f a=all inside.mts
}

@test "what depends on facets leaves the stream; the pipeline runs with groups" {
    bare_block
    shapefn bare.mts 2> /dev/null > table.mts
    tag -n tip=high:z,10% table.mts 2> said | mts list | has '^edge.phi'
    [ ! -s said ]
    tag -f tip=high:z,10% table.mts 2> said > stale.mts
    [ "$(cat said)" = "tag: facets have changed: the sections of support and shapefn are left out" ]
    run -1 grep -qE '^(shape|nbr|face|facepoint|boundary|node|support)\.' <(mts list stale.mts)
    { pressed_cube held pushed -0.005; printf '[output]\nreactions = yes\n'; } > push.scene
    cloud -d 3 -k regular -n 4,4,7 --box 0,0.1,0,0.1,0,0.2 | tag -f held=low:long,12% -f pushed=high:long,12% 2> /dev/null |
        shapefn 2> /dev/null | mtled -q push.scene > u.dat
    mts print reactions u.dat | awk '{ sum += $3 } $3 < 0 { n++ } END { exit !(n == 1 && sum ^ 2 < 1e-6) }'
}

@test "groups that are not changed keep their rows" {
    cloud -d 3 -k regular -n 4,4,4 --box 0,1,0,1,0,1 > c.mts
    tag -f a=low:x,10% c.mts 2> /dev/null | mts print facets | head -n 108 | cmp - <(mts print facets c.mts)
}
