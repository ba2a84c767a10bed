#!/bin/bash
# Meshes as other programs make them, none with a named boundary: bash mesh.sh NAME OUT.msh (gmsh and awk; lengths in mm).
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
name=$1
out=$(realpath -m "$2")
cd "$work"

# geo [OPTION...]: mesh the geometry on standard input.
geo() {
    { echo 'SetFactory("OpenCASCADE");'; cat; } > body.geo
    gmsh -v 1 -3 body.geo -format msh22 "$@" -o body.msh > /dev/null
}

# random SEED COUNT: points in the unit cube.
random() { awk -v seed="$1" -v count="$2" 'BEGIN { srand(seed); for (i = 0; i < count; i++) print rand(), rand(), rand() }'; }

# delaunay SEED COUNT: the Delaunay mesh of random points in a bar of 60 x 30 x 30 mm and on its faces, without any
# improvement: slivers.
delaunay() {
    {
        echo 'Box(1) = {0, 0, 0, 60, 30, 30};'
        random "$1" "$2" | awk '{ printf "Point(%d) = {%.9g, %.9g, %.9g};\nPoint{%d} In Volume{1};\n", NR + 100, 60 * $1, 30 * $2, 30 * $3, NR + 100 }'
        # faces 1 to 6 of a box: x low, x high, y low, y high, z low, z high
        random $(($1 + 1)) $(($2 / 2)) | awk -v first=$(($2 + 200)) '{
            face = (NR - 1) % 6 + 1; axis = int((face - 1) / 2); size[0] = 60; size[1] = size[2] = 30
            p[axis] = (face % 2 == 0) * size[axis]
            p[(axis + 1) % 3] = $1 * size[(axis + 1) % 3]; p[(axis + 2) % 3] = $2 * size[(axis + 2) % 3]
            printf "Point(%d) = {%.9g, %.9g, %.9g};\nPoint{%d} In Surface{%d};\n", NR + first, p[0], p[1], p[2], NR + first, face }'
        printf 'Mesh.%s;\n' 'MeshSizeFromPoints = 0' 'MeshSizeExtendFromBoundary = 0' 'MeshSizeMax = 1000' 'MeshSizeMin = 1000' \
            'Optimize = 0' 'Algorithm3D = 1'
    } | geo
}

# voxels KIND: voxels of 4 mm whose centre is within an ellipsoid of half axes 40, 22, 18 mm, as hexahedra or as six
# tetrahedra each (MSH 2.2).
voxels() {
    awk -v kind="$1" '
    function node(i, j, k,  key) {
        key = i " " j " " k
        if (!(key in number)) { number[key] = ++nodes; at[nodes] = i * h " " j * h " " k * h }
        return number[key]
    }
    BEGIN {
        h = 4
        split("0 1 3 7 0 1 5 7 0 2 3 7 0 2 6 7 0 4 5 7 0 4 6 7", kuhn, " ")
        for (k = -6; k < 6; k++) for (j = -7; j < 7; j++) for (i = -11; i < 11; i++) {
            if (((i + .5) * h / 40) ^ 2 + ((j + .5) * h / 22) ^ 2 + ((k + .5) * h / 18) ^ 2 > 1) continue
            for (c = 0; c < 8; c++) corner[c] = node(i + c % 2, j + int(c / 2) % 2, k + int(c / 4))
            if (kind == "hex") {
                cell[++cells] = "5 2 1 1 " corner[0] " " corner[1] " " corner[3] " " corner[2] " " \
                    corner[4] " " corner[5] " " corner[7] " " corner[6]
                continue
            }
            for (t = 0; t < 6; t++) {
                text = "4 2 1 1"
                for (v = 1; v <= 4; v++) text = text " " corner[kuhn[4 * t + v]]
                cell[++cells] = text
            }
        }
        print "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" nodes
        for (n = 1; n <= nodes; n++) print n, at[n]
        print "$EndNodes\n$Elements\n" cells
        for (c = 1; c <= cells; c++) print c, cell[c]
        print "$EndElements"
    }' > body.msh
}

# stl GEOMETRY NAME SIZE: its surface in STL.
stl() {
    printf 'SetFactory("OpenCASCADE");\n%s\n' "$1" > "$2.geo"
    gmsh -v 1 -2 "$2.geo" -setnumber Mesh.MeshSizeMax "$3" -o "$2.stl" > /dev/null
}

case $name in
cylinder)
    geo << 'END'
Cylinder(1) = {0, 0, 0, 0, 0, 100, 25};
Mesh.MeshSizeMax = 9;
END
    ;;
graded) # 1 to 15
    geo << 'END'
Cylinder(1) = {0, 0, 0, 100, 0, 0, 20};
Field[1] = MathEval;
Field[1].F = "1.5 + .15 * sqrt((x - 50) ^ 2 + (y - 20) ^ 2 + z ^ 2)";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
END
    ;;
second-order)
    geo -order 2 << 'END'
Torus(1) = {0, 0, 0, 40, 14};
Mesh.MeshSizeMax = 10;
END
    ;;
ring)
    geo << 'END'
Torus(1) = {0, 0, 0, 40, 14};
Mesh.MeshSizeMax = 8;
END
    ;;
cup) # half a shell, one to two cells thick
    geo << 'END'
Sphere(1) = {0, 0, 0, 40, 0, Pi / 2, 2 * Pi};
Sphere(2) = {0, 0, 0, 34, 0, Pi / 2, 2 * Pi};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMax = 7;
END
    ;;
slit)
    geo << 'END'
Box(1) = {0, 0, 0, 80, 30, 30};
Box(2) = {38, 12, -1, 1.5, 30, 32};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMax = 8;
END
    ;;
cavity) # surfaces of two STL files, the outer one meshed anew
    stl 'Sphere(1) = {0, 0, 0, 40};' outer 7
    stl 'Sphere(1) = {5, 3, 0, 15};' inner 6
    cat > fill.geo << 'END'
Merge "outer.stl";
Merge "inner.stl";
ClassifySurfaces{Pi / 4, 1, 1, Pi};
CreateGeometry;
Surface Loop(1) = Surface{:};
Volume(1) = {1};
Mesh.MeshSizeMax = 9;
Mesh.Algorithm = 6;
END
    gmsh -v 1 -3 fill.geo -format msh41 -o body.msh > /dev/null
    ;;
stl-volume) # an STL surface as it is
    stl 'Cylinder(1) = {0, 0, 0, 90, 20, 10, 20};' body 8
    printf 'Merge "body.stl";\nSurface Loop(1) = {1};\nVolume(1) = {1};\n' > fill.geo
    gmsh -v 1 -3 fill.geo -o body.msh > /dev/null
    ;;
voxels-hex) voxels hex ;;
voxels-tet) voxels tet ;;
delaunay-*) delaunay "${name##*-}" 400 ;;
squeezed) # flat cells: meshed at eight times the width
    geo << 'END' > /dev/null
Sphere(1) = {0, 0, 0, 40};
Dilate {{0, 0, 0}, {1, 4, 1}} { Volume{1}; }
Mesh.MeshSizeMax = 22;
END
    awk '$1 == "$Nodes" { on = 1 } $1 == "$EndNodes" { on = 0 } on && NF == 4 { $3 /= 8 } { print }' body.msh > squeezed.msh
    mv squeezed.msh body.msh
    ;;
jittered-*)
    geo << 'END'
Sphere(1) = {0, 0, 0, 20};
Dilate {{0, 0, 0}, {2, 1, .8}} { Volume{1}; }
Mesh.MeshSizeMax = 6;
END
    awk -v seed="${name##*-}" -f "$here/jitter.awk" body.msh > jittered.msh
    mv jittered.msh body.msh
    ;;
gap-beside)
    geo << 'END'
Box(1) = {0, 0, 0, 60, 14, 20};
Box(2) = {0, 14.5, 0, 60, 14, 20};
Mesh.MeshSizeMax = 6;
END
    ;;
gap-behind)
    geo << 'END'
Box(1) = {0, 0, 0, 40, 20, 20};
Box(2) = {40.5, 0, 0, 40, 20, 20};
Mesh.MeshSizeMax = 6;
END
    ;;
coincident) # two bodies with nodes of their own on the face where they touch
    geo << 'END'
Box(1) = {0, 0, 0, 60, 15, 20};
Box(2) = {0, 15, 0, 60, 15, 20};
Mesh.MeshSizeMax = 6;
END
    ;;
rod) # slender bodies from here on: they buckle
    geo << 'END'
Cylinder(1) = {0, 0, 0, 100, 0, 0, 2};
Mesh.MeshSizeMax = 1.6;
END
    ;;
taper)
    geo << 'END'
Cone(1) = {0, 0, 0, 0, 90, 0, 4, 1.5};
Mesh.MeshSizeMax = 1.7;
END
    ;;
pin)
    geo << 'END'
Cylinder(1) = {0, 0, 0, 0, 0, 90, 3};
Sphere(2) = {0, 0, 90, 9};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMax = 2.5;
END
    ;;
tube) # one cell thick
    geo << 'END'
Cylinder(1) = {0, 0, 0, 0, 0, 80, 20};
Cylinder(2) = {0, 0, -1, 0, 0, 82, 18};
BooleanDifference(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
Mesh.MeshSizeMax = 4;
END
    ;;
arch)
    geo << 'END'
Torus(1) = {0, 0, 0, 40, 2.5, Pi};
Mesh.MeshSizeMax = 1.9;
END
    ;;
portal)
    geo << 'END'
Box(1) = {0, 0, 0, 60, 4, 4};
Box(2) = {0, 36, 0, 60, 4, 4};
Box(3) = {0, 0, 0, 4, 40, 4};
Box(4) = {56, 0, 0, 4, 40, 4};
BooleanUnion{ Volume{1}; Delete; }{ Volume{2:4}; Delete; }
Mesh.MeshSizeMax = 1.9;
END
    ;;
ladder)
    geo << 'END'
Box(1) = {0, 0, 0, 100, 3, 3};
Box(2) = {0, 15, 0, 100, 3, 3};
For i In {0:4}
    Box(3 + i) = {10 + 19 * i, 0, 0, 3, 18, 3};
EndFor
BooleanUnion{ Volume{1}; Delete; }{ Volume{2:7}; Delete; }
Mesh.MeshSizeMax = 1.9;
END
    ;;
channel)
    geo << 'END'
Box(1) = {0, 0, 0, 90, 16, 2};
Box(2) = {0, 0, 0, 90, 2, 10};
Box(3) = {0, 14, 0, 90, 2, 10};
BooleanUnion{ Volume{1}; Delete; }{ Volume{2:3}; Delete; }
Mesh.MeshSizeMax = 2.2;
END
    ;;
cruciform)
    geo << 'END'
Box(1) = {-10, -1, 0, 20, 2, 80};
Box(2) = {-1, -10, 0, 2, 20, 80};
BooleanUnion{ Volume{1}; Delete; }{ Volume{2}; Delete; }
Mesh.MeshSizeMax = 2.2;
END
    ;;
fins) # that touch each other
    geo << 'END'
Box(1) = {0, 0, 0, 80, 30, 5};
For i In {0:3}
    Box(2 + i) = {5 + 17 * i, 0, 5, 4, 30, 25};
EndFor
Box(6) = {71, 0, 5, 4, 30, 25};
BooleanUnion(7) = { Volume{1}; Delete; }{ Volume{2:6}; Delete; };
Mesh.MeshSizeMax = 4;
END
    ;;
comb)
    geo << 'END'
Box(1) = {0, 0, 0, 80, 10, 10};
For i In {0:6}
    Box(10 + i) = {2 + 12 * i, 10, 2, 5, 30, 6};
EndFor
BooleanUnion(2) = { Volume{1}; Delete; }{ Volume{10:16}; Delete; };
Mesh.MeshSizeMax = 4;
END
    ;;
brain)
    cp "$here/../../examples/brain3d/brain3d.geo" .
    gunzip -c "$here/../../examples/brain3d/brain3d_surfaces.msh.gz" > brain3d_surfaces.msh
    gmsh -v 1 -3 brain3d.geo -setnumber lc 16 -o body.msh > /dev/null
    ;;
*)
    echo "mesh.sh: no mesh $name" >&2
    exit 2
    ;;
esac
mv body.msh "$out"
