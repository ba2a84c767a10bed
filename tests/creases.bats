# Contact with rigid surfaces that have creases: grooves, a corner, a bowl of facets.

load common.bash

setup() { enter_alone; }

# keel SLOPE: a body, 80 mm wide, whose lower side goes up from a keel to either side; groove.tsv, one that it fits in.
keel() {
    cat > keel.geo << END
s = $1; Mesh.MeshSizeMax = 8;
Point(1) = {0, 0, 0}; Point(2) = {40, 40 * s, 0}; Point(3) = {40, 60, 0}; Point(4) = {-40, 60, 0}; Point(5) = {-40, 40 * s, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 1};
Curve Loop(1) = {1:5}; Plane Surface(1) = {1};
Physical Surface("body") = {1}; Physical Curve("right") = {1}; Physical Curve("left") = {5}; Physical Curve("top") = {3};
END
    gmsh -v 1 -2 keel.geo -o keel.msh
    nodes -u mm keel.msh | shapefn > keel.mts 2> note
    awk -v s="$1" 'BEGIN { printf "-200 %.9g\n0 0\n200 %.9g\n", 200 * s, 200 * s }' > groove.tsv
}

# press SIDEWAYS: contact.scene, and held.scene, where each side of the keel is kept on its plane by a condition.
press() {
    { block quasi-static
        printf '[displacement top]\nfacets = top\ncomponents = %s, -0.003\n[output]\nreactions = yes\n[solver]\ntolerance = 1e-4\n' "$1"; } > one.scene
    { cat one.scene; printf '[contact groove]\nfacets = left, right\nrigid = groove.tsv\nunit = mm\nside = left\n'; } > contact.scene
    { cat one.scene; printf '[displacement l]\nfacets = left\nnormal = 0\n[displacement r]\nfacets = right\nnormal = 0\n'; } > held.scene
}

# The force on the top, down and sideways, agrees.
same_force() {
    rows reactions contact.dat | awk 'NR == 1 { print $1, $2 }' > forces
    rows reactions held.dat | awk 'NR == 1 { print $1, $2 }' >> forces
    cat forces
    awk -v share="$1" '{ x[NR] = $1; y[NR] = $2 } END { dx = x[1] - x[2]; dy = y[1] - y[2]; t = share * (y[2] < 0 ? -y[2] : y[2])
        exit !(y[2] < -0.1 && dx < t && -dx < t && dy < t && -dy < t) }' forces
}

@test "a keel in a groove of two planes moves as with each side kept on its plane, at several angles, pressed straight and askew" {
    for case in '0.05 2e-4' '0.43 0' '1 2e-4'; do
        read -r slope sideways <<< "$case"
        keel "$slope"
        press "$sideways"
        mtled contact.scene keel.mts > contact.dat
        mtled held.scene keel.mts > held.dat
        same_force 2e-3
        fieldcmp --tol-avg 2e-5 contact.dat held.dat
    done
}

@test "a cube in a corner of three planes stays there as when its sides are kept on them" {
    cloud -d 3 -k jittered -n 6 --jitter 0.15 --seed 3 --box 0,0.1,0,0.1,0,0.1 | shapefn > cube.mts 2> note
    awk 'BEGIN { for (k = 0; k < 3; k++) { split("0 0 0 1 0 0 1 1 0 0 0 0 1 1 0 0 1 0", q); for (i = 1; i <= 18; i += 9) {
        line = ""; for (c = 0; c < 3; c++) for (a = 0; a < 3; a++) line = line " " q[i + 3 * c + (a + k) % 3]; print line } } }' > corner.tsv
    { block quasi-static | sed 's/dim = 2/dim = 3/'
        for push in x:200 y:300 z:500; do printf '[pressure %s]\nfacets = %smax\nvalue = %s\n' "${push%:*}" "${push%:*}" "${push#*:}"; done
        printf '[solver]\ntolerance = 1e-5\n'; } > one.scene
    { cat one.scene; printf '[contact corner]\nfacets = xmin, ymin, zmin\nrigid = corner.tsv\nunit = m\nside = front\n'; } > contact.scene
    { cat one.scene; for side in x y z; do printf '[displacement %s]\nfacets = %smin\nnormal = 0\n' $side $side; done; } > held.scene
    mtled contact.scene cube.mts > contact.dat
    mtled held.scene cube.mts > held.dat
    fieldcmp --tol-avg 1e-5 --tol-max 2e-5 contact.dat held.dat # of .01 m
}

# bowl RINGS SEED: the lower half of a sphere of 55 mm, its facets as random as so many rings and sectors allow, as bowl.tsv.
bowl() {
    awk -v n="$1" -v seed="$2" 'BEGIN { srand(seed); pi = atan2(0, -1); m = 4 * n
        for (i = 0; i <= n; i++) for (j = 0; j < m; j++) {
            t = pi / 2 * (i + (i > 0 && i < n ? 0.6 * (rand() - 0.5) : 0)) / n; p = 2 * pi * (j + 0.6 * (rand() - 0.5)) / m
            v[i, j] = 55 * sin(t) * cos(p) " " 55 * sin(t) * sin(p) " " (-55 * cos(t)) }
        for (i = 0; i < n; i++) for (j = 0; j < m; j++) { k = (j + 1) % m
            if (i > 0) print v[i, j], v[i, k], v[i + 1, k]
            print v[i, j], v[i + 1, k], v[i + 1, j] } }' | awk '{ a = $1 " " $2 " " $3; b = $4 " " $5 " " $6; c = $7 " " $8 " " $9
        if (a != b && b != c && a != c) print }' > bowl.tsv
}

@test "a ball that sinks into a bowl of few random facets moves as in one of many" {
    printf 'SetFactory("OpenCASCADE");\nSphere(1) = {0, 0, 0, 50};\nMesh.MeshSizeMax = 13;\nPhysical Volume("body") = {1};\n' > ball.geo
    gmsh -v 1 -3 -nt 1 ball.geo -o ball.msh
    nodes -u mm ball.msh 2> note | tag -u mm -f 'cap=high:z,12%' -f 'low=low:z,60%' | shapefn > ball.mts 2> note
    { block quasi-static | sed 's/dim = 2/dim = 3/'
        printf '[displacement cap]\nfacets = cap\ncomponents = 0, 0, -0.012\n[contact bowl]\nfacets = low\nrigid = bowl.tsv\nunit = mm\nside = back\n'
        printf '[output]\nreactions = yes\n[solver]\ntolerance = 1e-3\n'; } > ball.scene
    bowl 60 1
    mtled ball.scene ball.mts > fine.dat
    for rings in 10 5; do
        bowl $rings 1
        mtled ball.scene ball.mts > coarse.dat 2> note
        fieldcmp coarse.dat fine.dat | awk -v rings=$rings '$1 == "avg" { print rings, $2 }' >> differences
    done
    cat differences
    cat differences
    # By no more than the sagitta of facets 1.6 times as wide as the rings are apart.
    awk '{ wide = 1.6 * atan2(0, -1) / 2 / $1; if (!($2 < 0.055 * wide ^ 2 / 8)) bad = 1 } END { exit bad || NR != 2 }' differences
}
