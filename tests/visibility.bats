# Supports see only what is connected: two blocks, a slit, bodies that touch, and what the stream records of it.

load common.bash

setup() { enter_alone; }

# blocks GAP: blocks.mts, two blocks of 20 x 10 mm with nodes every 2 mm, GAP mm apart.
blocks() {
    cat > blocks.geo <<END
Point(1) = {0, 0, 0, 2}; Point(2) = {20, 0, 0, 2}; Point(3) = {20, 10, 0, 2}; Point(4) = {0, 10, 0, 2};
Point(5) = {0, 10 + $1, 0, 2}; Point(6) = {20, 10 + $1, 0, 2}; Point(7) = {20, 20 + $1, 0, 2};
Point(8) = {0, 20 + $1, 0, 2}; Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 1};
Line(5) = {5, 6}; Line(6) = {6, 7}; Line(7) = {7, 8}; Line(8) = {8, 5}; Curve Loop(1) = {1, 2, 3, 4};
Curve Loop(2) = {5, 6, 7, 8}; Plane Surface(1) = {1}; Plane Surface(2) = {2}; Physical Surface("body", 1) = {1, 2};
Physical Curve("bottom", 11) = {1}; Physical Curve("top", 12) = {7};
END
    gmsh -2 -v 0 blocks.geo -o blocks.msh > /dev/null
    nodes -u mm blocks.msh > blocks.mts
}

@test "a slit: the same bytes for any number of threads" {
    gmsh -2 -v 0 -setnumber h 2 "$top/examples/hard/slit.geo" -o slit.msh > /dev/null
    nodes -u mm slit.msh | ipoints -g 4 > points.mts
    for threads in 1 2 3; do
        OMP_NUM_THREADS=$threads support points.mts | OMP_NUM_THREADS=$threads shapefn > $threads.mts
        cmp 1.mts $threads.mts
    done
    mts check 1.mts
    mts text 1.mts | grep '^# support.radius' | has 'reach=cells'
}

@test "a body too small for the basis is named, however near the others are" {
    blocks 0.5
    sed -i 's/Physical Surface[^;]*;//' blocks.geo
    cat >> blocks.geo <<END
Point(21) = {20.4, 4, 0, 9}; Point(22) = {22.4, 4, 0, 9}; Point(23) = {20.4, 6, 0, 9}; Line(21) = {21, 22};
Line(22) = {22, 23}; Line(23) = {23, 21}; Curve Loop(21) = {21, 22, 23}; Plane Surface(21) = {21};
Physical Surface("body", 1) = {1, 2, 21};
END
    gmsh -2 -v 0 blocks.geo -o blocks.msh > /dev/null
    nodes -u mm blocks.msh > blocks.mts
    support blocks.mts > lists.mts 2> notes
    support --reach distance -b mls2 blocks.mts > lists.mts 2> notes
    run -1 --separate-stderr support -b mls2 blocks.mts
    [[ "$stderr" == *"x: row "*" at (0.02"*"nodes within reach through the cells"* ]]
}

@test "--reach is recorded, and refused where it cannot be" {
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 > square.mts
    support --reach distance -t square.mts 2> notes | grep '^# support.radius' | has 'reach=distance'
    support -v --reach distance -o lists.mts square.mts 2> notes
    grep -q 'neighbours by distance alone' notes
    # Nothing is between the nodes of a square: the same lists.
    ipoints square.mts | support -t | grep -v '^# [@s]' > a.txt
    ipoints square.mts | support -t --reach distance | grep -v '^# [@s]' | cmp - a.txt
    refused 2 "--reach: " support --reach sight square.mts
    # Without cells: by distance, and cells cannot be asked for.
    mts text square.mts | awk '/^# [^@]/ { skip = $2 == "cells" || $2 ~ /^(facets|cells)/ } !skip' | sed '/^# end/d' > cloud.dat
    printf '# points.x f8 1 2 enc=text unit=m\n0.05 0.05\n\n\n# end 2\n' >> cloud.dat
    support -v -t cloud.dat 2> notes | grep '^# support.radius' | has 'reach=distance'
    grep -q 'neighbours by distance alone' notes
    refused 2 "the input has no cells" support --reach cells cloud.dat
}

@test "tables of displacements act neither across a gap nor across a slit" {
    blocks 0.5
    printf '[scene]\ndim = 2\nanalysis = quasi-static\n[material body]\nregion = body\nE = 3000\nnu = 0.49\nrho = 1000\n' > head
    { cat head; printf '[displacement all]\nfacets = bottom, top\ntable = both.tsv\nunit = mm\n[output]\nreactions = yes\n[solver]\ntolerance = 1e-8\n'; } > both.scene
    # Few points, so that the nearest to each place are those of both blocks.
    awk 'BEGIN { for (x = 0; x <= 20; x += 10) { print x, 0, 0, 0; print x, 10, 0, 0; print x, 10.5, 0.3, 0.5; print x, 20.5, 0.3, 0.5 } }' > both.tsv
    shapefn blocks.mts 2> notes > table.mts
    mtled both.scene table.mts > u.dat
    paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '
        { up = $2 > 0.0102; n[up]++; if (!(($3 - up * 0.3e-3) ^ 2 + ($4 - up * 0.5e-3) ^ 2 < 1e-9 ^ 2)) bad++ }
        END { exit !(n[0] > 40 && n[1] > 40 && bad + 0 == 0) }'
    # Points of the other block alone.
    awk '$2 <= 10' both.tsv > lower.tsv
    sed 's/both.tsv/lower.tsv/; s/bottom, top/top/' both.scene > lower.scene
    run -2 --separate-stderr mtled lower.scene table.mts
    [[ "$stderr" == *"[displacement all]: table lower.tsv: at ("*"none of its points is within reach through the cells"* ]]
    # The arms of a slit: the upper one's end is lifted, the lower one's was measured as well.
    gmsh -2 -v 0 -setnumber h 2 "$top/examples/hard/slit.geo" -o slit.msh > /dev/null
    nodes -u mm slit.msh | shapefn 2> notes > slit.mts
    awk 'BEGIN { for (x = 36; x <= 40; x += 2) { print x, 0, 0, 0; print x, 9.7, 0, 0; print x, 10.3, 0, 3; print x, 20, 0, 3 } }' > arms.tsv
    { cat head; printf '[displacement held]\nfacets = held\ncomponents = 0, 0\n[displacement lifted]\nfacets = lifted\n'; } > slit.scene
    { cat slit.scene; printf 'components = 0, 3e-3\n'; } > constant.scene
    { cat slit.scene; printf 'table = arms.tsv\nunit = mm\n'; } > arms.scene
    mtled constant.scene slit.mts > constant.dat
    mtled arms.scene slit.mts > arms.dat
    fieldcmp --tol-max 1e-8 constant.dat arms.dat > /dev/null
}
