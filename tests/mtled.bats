# mtled: a scene on a small cloud; the same bytes whichever way; each fault one line and no output; sections on request.

load common.bash

setup() {
    enter_alone
    cloud -d 2 -k jittered -n 6 --box 0,0.1,0,0.1 --jitter 0.2 > square.mts
    pressed_block > block.scene
}

@test "wrong command lines" {
    refused 2 "" mtled
    refused 2 "" mtled -b -b block.scene square.mts
    refused 2 "-e goes with -c" mtled -e 30 block.scene square.mts
    refused 2 "" mtled block.scene square.mts square.mts
    refused 2 "missing.mts" mtled block.scene missing.mts
}

@test "the literal pipe is the spelled-out one, from a file and from standard input" {
    square_msh
    nodes -u mm body.msh | shapefn 2> note | mtled block.scene > u.dat
    grep -q "no sections of ipoints, support in the input: ran with defaults" note
    nodes -u mm body.msh | ipoints | support | shapefn > table.mts
    mtled block.scene table.mts | bare > spelled.dat
    bare u.dat | cmp - spelled.dat
    mtled block.scene < table.mts | bare | cmp - spelled.dat
    mtled -o out.dat block.scene table.mts
    bare out.dat | cmp - spelled.dat
    mtled -b block.scene table.mts | mts text | bare | cmp - spelled.dat
    mtled -q -v block.scene table.mts 2> report | bare | cmp - spelled.dat
    grep -q "^steps" report
    nodes -u mm body.msh 2> note | mtled block.scene 2> note | bare | cmp - spelled.dat
    [ "$(rows u u.dat | wc -l)" -eq "$(rows nodes.x u.dat | wc -l)" ]
    run -1 grep -qE '^# (shape|nbr|node|face|boundary|points|support|facepoints?)\.' u.dat
}

@test "any number of threads gives the same bytes, quasi-static and dynamic" {
    shapefn square.mts > table.mts
    swinging_block > dynamic.scene
    for scene in block dynamic; do
        for threads in 1 2 3; do
            OMP_NUM_THREADS=$threads mtled $scene.scene table.mts > $scene.$threads
        done
        cmp $scene.1 $scene.2
        cmp $scene.1 $scene.3
    done
}

@test "the scene's own folder is where its files are" {
    mkdir folder
    printf '0 0\n1 1\n' > folder/ramp.txt
    with 's/0, -0.005/&\ncurve = ramp.txt/'
    mv edited.scene folder/
    mtled folder/edited.scene square.mts 2> note | rows u > far
    (cd folder && mtled edited.scene ../square.mts 2> note | rows u) | cmp - far
}

@test "sections come when they are asked for, and only then" {
    mtled block.scene square.mts 2> note > plain.dat
    run -1 grep -qE '^# (stress|strain|pressure|volume_ratio|reactions|energy|gaps|u.frame)' plain.dat
    printf '[output]\nframes = 3\nstress = yes\nstrain = yes\nenergy = yes\nreactions = yes\n' >> block.scene
    mtled block.scene square.mts 2> note > full.dat
    paste -d ' ' <(rows u plain.dat) <(rows u full.dat) | awk '{ if (!(($1 - $3) ^ 2 + ($2 - $4) ^ 2 < 5e-8 ^ 2)) exit 1 }'
    grep -q '^# stress f8 50 4 .*unit=Pa.* cols=xx,yy,zz,xy' full.dat
    grep -q '^# strain f8 50 4 .*cols=xx,yy,zz,xy' full.dat
    grep -q '^# reactions f8 2 2 .*unit=N/m.* rows=bottom,top' full.dat
    rows reactions full.dat | awk '{ for (i = 1; i <= 2; i++) s[i] += $i; y[NR] = $2 }
        END { exit !(y[1] > 1 && y[2] < -1 && s[1]^2 + s[2]^2 < 1e-6) }'
    grep -q '^# energy f8 1 2 .*unit=J/m,J/m cols=internal,contact' full.dat
    rows energy full.dat | awk '{ exit !($1 > 0 && $2 == 0) }'
    for k in 1 2 3; do
        grep -q "^# u.frame.$k f8 36 2 .*time=" full.dat
    done
    diff <(rows u.frame.3 full.dat) <(rows u full.dat)
    grep -q '^# u.frame.3 .*time=1$' full.dat
    [ "$(mts list full.dat | grep -oE '^[^	]*\.frames?[^	]*' | xargs)" = "u.frame.0 parameters.frame.0 stress.frame.0 strain.frame.0 u.frame.1 parameters.frame.1 stress.frame.1 strain.frame.1 u.frame.2 parameters.frame.2 \
stress.frame.2 strain.frame.2 u.frame.3 parameters.frame.3 stress.frame.3 strain.frame.3 reactions.frames energy.frames" ]
    for name in stress strain; do
        rows $name.frame.0 full.dat | awk '{ for (i = 1; i <= 4; i++) if ($i != 0) exit 1 } END { exit NR != 50 }'
        diff <(rows $name.frame.3 full.dat) <(rows $name full.dat)
    done
    # One row for each frame: time, and force on bottom and top; the last is the final state.
    grep -q '^# reactions.frames f8 4 5 .*unit=1,N/m,N/m,N/m,N/m cols=time,bottom.x,bottom.y,top.x,top.y' full.dat
    grep -q '^# energy.frames f8 4 3 .*unit=1,J/m,J/m cols=time,internal,contact' full.dat
    [ "$(rows reactions.frames full.dat | tail -n 1)" = "1 $(rows reactions full.dat | xargs)" ]
    [ "$(rows energy.frames full.dat | tail -n 1)" = "1 $(rows energy full.dat)" ]
    rows reactions.frames full.dat | awk 'NR == 1 { for (i = 1; i <= 5; i++) if ($i ^ 2 > 1e-12 ^ 2) exit 1 }' # of some 28 N/m
    rows reactions.frames full.dat | awk 'NR > 1 && $3 < last { exit failed = 1 } { last = $3 } END { exit failed }'
    # The results of an earlier run leave the stream.
    pressed_block > block.scene
    mtled block.scene full.dat 2> note | bare | cmp - <(bare plain.dat)
}

# scaled FACTOR: block.scene with its load times that.
scaled() {
    awk -v factor="$1" '/^components = 0, -0/ { print "components = 0, " (-0.02 * factor); next } { print }' block.scene | sed '/^\[output/,/^$/d'
    printf '[output]\nstress = yes\nreactions = yes\nenergy = yes\ngaps = yes\n[solver]\ntolerance = 1e-6\n'
}

# near TOLERANCE A B: two tables of vectors, which differ by so much of the longest of B.
near() {
    paste -d ' ' "$2" "$3" | awk -v tolerance="$1" '
        { d = m = 0; n = NF / 2; for (i = 1; i <= n; i++) { d += ($i - $(i + n)) ^ 2; m += $(i + n) ^ 2 }
          if (!(d <= worst)) worst = d
          if (m > most) most = m }
        END { if (!(NR && worst <= tolerance ^ 2 * most)) { print "off by " sqrt(worst / most); exit 1 } }'
}

@test "frames are states of equilibrium: each is what a run to its load comes to, within the tolerance" {
    sed -i 's/^nu = .*/nu = 0.49/; s/-0.005/-0.02/' block.scene
    shapefn square.mts > table.mts 2> note
    { cat block.scene; printf '[output]\nframes = 4\nstress = yes\nreactions = yes\nenergy = yes\ngaps = yes\n[solver]\ntolerance = 1e-6\n'; } > frames.scene
    mtled frames.scene table.mts > frames.dat
    [ "$(rows reactions.frames frames.dat | wc -l)" -eq 5 ]
    for k in 1 2 3 4; do
        factor=$(awk -v s=0.25 -v k=$k 'BEGIN { s *= k; printf "%.17g", s ^ 3 * (10 - 15 * s + 6 * s * s) }')
        scaled "$factor" > alone.scene
        mtled alone.scene table.mts > alone.dat
        near 1e-5 <(rows u.frame.$k frames.dat) <(rows u alone.dat)
        near 1e-5 <(rows stress.frame.$k frames.dat) <(rows stress alone.dat)
        near 1e-5 <(rows reactions.frames frames.dat | awk -v k=$k 'NR == k + 1 { for (i = 2; i < NF; i += 2) print $i, $(i + 1) }') <(rows reactions alone.dat)
        near 1e-5 <(rows energy.frames frames.dat | awk -v k=$k 'NR == k + 1 { print $2 }') <(rows energy alone.dat | cut -d ' ' -f 1)
    done
    tovtk -o curve.pvd frames.dat
    [ "$(grep -c '<DataSet' curve.pvd)" -eq 5 ]
    for k in 0 1 2 3 4; do
        grep -q 'Name="stress.von_mises"' curve-000$k.vtu
    done
}

@test "pressure is minus the mean of the normal stresses, volume_ratio the J of the material" {
    printf '[output]\npressure = yes\nvolume_ratio = yes\n' >> block.scene
    shapefn square.mts > table.mts 2> note
    mtled block.scene table.mts > asked.dat
    grep -q '^# pressure f8 50 1 .*unit=Pa' asked.dat
    grep -q '^# volume_ratio f8 50 1 .*unit=1' asked.dat
    run -1 grep -qE '^# (stress|strain)' asked.dat
    printf 'stress = yes\n' >> block.scene
    mtled block.scene table.mts > all.dat
    diff <(rows pressure asked.dat) <(rows pressure all.dat)
    paste -d ' ' <(rows pressure all.dat) <(rows stress all.dat) |
        awk '{ d = $1 + ($2 + $3 + $4) / 3; if (!(d * d <= 1e-20 * $1 * $1)) exit failed = 1; sum += $1 } END { exit failed || NR != 50 || !(sum > 0) }'
    # A linear field: J is that of the map, 1.05 * 0.96 + 0.02 * 0.03, and the pressure kappa (1 - J).
    { sed '/^\[displacement/,/^$/d' block.scene; printf '[displacement all]\nfacets = xmin, xmax, ymin, ymax\ntable = map.tsv\nunit = m\n'; } > linear.scene
    printf '%s\n' '0 0' '0.1 0' '0 0.1' '0.1 0.1' | awk '{ print $1, $2, 0.05 * $1 + 0.02 * $2, -0.03 * $1 - 0.04 * $2 }' > map.tsv
    mtled linear.scene table.mts > linear.dat
    rows volume_ratio linear.dat | awk '!(($1 - 1.0086) ^ 2 < 1e-10) { print; exit 1 }'
    rows pressure linear.dat | awk '!(($1 + 86) ^ 2 < 0.1) { print; exit 1 }'
    # On Gauss points J is det F: that of the strain.
    printf 'strain = yes\n' >> block.scene
    ipoints -g 4 square.mts | shapefn 2> note | mtled block.scene > gauss.dat
    paste -d ' ' <(rows volume_ratio gauss.dat) <(rows strain gauss.dat) |
        awk '{ J = sqrt((1 + 2 * $2) * (1 + 2 * $3) - 4 * $5 * $5); if (!(($1 - J) ^ 2 < 1e-24)) exit failed = 1 } END { exit failed || NR != 200 }'
}

@test "a dynamic scene: energies, frames by time, reactions" {
    swinging_block > block.scene
    printf '[output]\ninterval = 0.02\nenergy = yes\nreactions = yes\n' >> block.scene
    mtled -v block.scene square.mts > u.dat 2> report
    grep -q '^# energy f8 [0-9]* 7 .*cols=time,kinetic,internal,contact,work,dissipated,error' u.dat
    grep -q '^# u.frame.1 .*time=0.02$' u.dat
    grep -q '^# u.frame.2 .*time=0.04$' u.dat
    run -1 grep -q '^# u.frame.3 ' u.dat
    rows energy u.dat | awk '{ error = $7 < 0 ? -$7 : $7; if (error > 1e-3) bad = 1; time = $1; work = $5 }
        END { exit !(time == 0.05 && work > 0 && !bad) }'
    grep -q '^critical step' report
    grep -q '^largest energy error' report
    grep -q '^steps' report
    sed -i 's/interval = 0.02/frames = 5/' block.scene
    mtled block.scene square.mts 2> note > u.dat
    diff <(rows u.frame.5 u.dat) <(rows u u.dat)
    tovtk -o u.pvd u.dat
    [ "$(grep -c '<DataSet' u.pvd)" -eq 6 ]
    rows u.frame.0 u.dat | awk '$1 != 0 || $2 != 0 { exit 1 } END { exit NR != 36 }'
}

@test "a body that is moved at constant speed: the begin is a blow, whose work counts, and there is no jerk at the end" {
    cloud -d 2 -k regular -n 5 --box 0,0.1,0,0.1 > even.mts
    { block dynamic | sed 's/^nu = .*/nu = 0.49/'; printf '[displacement all]\nfacets = *\ncomponents = 0.01, free\ncurve = linear\n'
        printf '[output]\nenergy = yes\n[solver]\nend_time = 0.25\n'; } > moved.scene
    mtled moved.scene even.mts > u.dat 2> note
    rows energy u.dat | awk 'NR == 1 { blow = $5 } { bad += !($7 ^ 2 < 1e-6); work = $5 } END { exit bad || !(blow > 0 && work > blow) }'
    paste -d ' ' <(rows nodes.x u.dat) <(rows u u.dat) | awk '$1 == 0 { bad += !(($3 - 0.01) ^ 2 < 0.0005 ^ 2); n++ } END { exit bad || n != 5 }'
}

@test "an initial state: thrown, a body moves on as it was; rows that are not the nodes are refused" {
    { swinging_block | sed '/gravity/d; /^\[displacement/,/^$/d'; printf '[initial]\ntable = begin.tsv\nunit = mm\n'; } > thrown.scene
    rows nodes.x <(mts text square.mts) | awk '{ print 1e3 * $1, 1e3 * $2, 2, 3, 40, -20 }' > begin.tsv
    mtled thrown.scene square.mts 2> note | rows u | awk '
        { d = ($1 - 0.004)^2 + ($2 - 0.002)^2; if (!(d < 1e-24)) exit 1 }
        END { if (NR != 36) exit 1 }'
    sed -i '$d' begin.tsv
    refused 2 "begin.tsv: 35 rows for 36 nodes" mtled thrown.scene square.mts
    tac begin.tsv > reversed.tsv
    { cat reversed.tsv; head -n 1 begin.tsv; } > begin.tsv
    refused 2 "begin.tsv:1: not the place of node 0" mtled thrown.scene square.mts
    # Of a body of a micrometre: what is near is relative to it.
    cloud -d 2 -k regular -n 6 --box 0,1e-6,0,1e-6 > small.mts
    sed -i 's/^unit = mm/unit = um/; s/^end_time = .*/end_time = 1e-6/' thrown.scene
    rows nodes.x <(mts text small.mts) | awk '{ print 1e6 * $1, 1e6 * $2, 0, 0, 0, 0 }' > begin.tsv
    mtled thrown.scene small.mts > u.dat 2> note
    tac begin.tsv > reversed.tsv
    mv reversed.tsv begin.tsv
    refused 2 "begin.tsv:1: not the place of node 0" mtled thrown.scene small.mts
    { pressed_block; printf '[initial]\ntable = begin.tsv\nunit = mm\n'; } > edited.scene
    refused 2 "a quasi-static scene has no time" mtled edited.scene square.mts
}

@test "a quasi-static scene whose body is only held ends at rest, without a word" {
    pressed_block | sed 's/^components = .*/components = 0, 0/' > held.scene
    mtled held.scene square.mts 2> said | rows u > u
    [ "$(cat said)" = "mtled: no sections of ipoints, support, shapefn in the input: ran with defaults" ]
    awk '$1 > 1e-15 || $1 < -1e-15 || $2 > 1e-15 || $2 < -1e-15 { exit 1 } END { exit NR != 36 }' u
}

@test "a table of displacements far from the boundary, in the wrong unit, or missing" {
    with 's/^components = 0, -0.005$/table = load.tsv\nunit = mm/'
    printf '%s\n' "0 100 0 -5" "50 100 0 -5" "100 100 0 -5" > load.tsv
    mtled edited.scene square.mts 2> note | rows u > table.u
    mtled block.scene square.mts 2> note | rows u > plain.u
    paste -d ' ' table.u plain.u | awk '{ d = ($1 - $3)^2 + ($2 - $4)^2; if (d > 1e-16) exit 1 }'
    sed -i 's/unit = mm/unit = m/' edited.scene
    refused 2 "wrong unit or wrong place" mtled edited.scene square.mts
    sed -i 's/unit = m/unit = mm/' edited.scene
    printf '%s\n' "0 9100 0 -5" "50 9100 0 -5" "100 9100 0 -5" > load.tsv
    refused 2 "load.tsv" mtled edited.scene square.mts
    rm load.tsv
    refused 2 "load.tsv" mtled edited.scene square.mts
}

@test "a table of displacements of other facets, of a part of them, or that contradicts itself" {
    with 's/^components = 0, -0.005$/table = load.tsv\nunit = mm/'
    seq 0 10 100 | awk '{ print $1, 0, 0, -5 }' > load.tsv
    refused 2 'edited.scene:15: [displacement top]: table load.tsv: its nearest point is 0.1 m from the boundary at (' mtled edited.scene square.mts
    [[ "$stderr" == *'wrong unit or wrong place, else give rows there or leave these facets out' ]]
    seq 0 2 20 | awk '{ print $1, 100, 0, -5 }' > load.tsv
    refused 2 'its nearest point is 0.0' mtled edited.scene square.mts
    printf '%s\n' "0 100 0 -5" "100 100 0 -5" "100 100 0 -4" > load.tsv
    refused 2 'table load.tsv: rows 2 and 3, both at (0.1, 0.1), differ by 0.001 m: leave one out' mtled edited.scene square.mts
    # The same again is no contradiction, and two rows tell of all that is between them.
    printf '%s\n' "0 100 0 -5" "100 100 0 -5" "100 100 0 -5.000000000001" > load.tsv
    mtled edited.scene square.mts 2> note > u.dat
}

@test "streams whose tables are missing or do not fit, are refused" {
    shapefn square.mts > table.mts 2> note
    for section in edge.phi boundary.phi; do
        mts drop $section table.mts > none.mts
        refused 2 "no section $section: run shapefn" mtled block.scene none.mts
    done
    refused 2 "" mtled block.scene /dev/null
    for section in cells.region points.weight points.cell faces.cell facets.set edge.phi edge.idx boundary.phi boundary.ptr node.phi node.ptr; do
        shortened $section table.mts > short.mts
        refused 2 "fit" mtled block.scene short.mts
    done
    ipoints -g 3 square.mts | support | shapefn > gauss.mts
    mts drop shape.dphi gauss.mts > none.mts
    refused 2 "no section shape.dphi: run shapefn" mtled block.scene none.mts
    for section in points.weight shape.dphi shape.phi nbr.ptr boundary.idx; do
        shortened $section gauss.mts > short.mts
        refused 2 "fit" mtled block.scene short.mts
    done
    ipoints --lattice 5,5 square.mts | shapefn > lattice.mts 2> note
    refused 2 "an evaluation lattice cannot be integrated over" mtled block.scene lattice.mts
    mts text table.mts | sed '/^# faces i4/{n;s/^[0-9]*/36/}' > bad.mts
    refused 2 "faces: row 0: no row 36 of nodes.x" mtled block.scene bad.mts
    mts text table.mts | sed '/^# facets.set/,/^$/s/^3$/2/' > empty.mts
    refused 2 "its facet groups are empty" mtled block.scene empty.mts
}

@test "small stacks of threads: the same bytes" {
    cloud -d 3 -k jittered -n 7 --box 0,0.1,0,0.1,0,0.1 --jitter 0.1 | shapefn > cube.mts 2> note
    printf '[scene]\ndim = 3\nanalysis = quasi-static\n[material body]\nregion = body\nE = 3000\nnu = 0.49\nrho = 1000\n%s%s' \
        $'[displacement low]\nfacets = zmin\ncomponents = 0, 0, 0\n' \
        $'[displacement high]\nfacets = zmax\ncomponents = 0, 0, 0.005\n' > pull.scene
    OMP_NUM_THREADS=1 mtled -q pull.scene cube.mts > one.dat
    OMP_NUM_THREADS=2 OMP_STACKSIZE=256k mtled -q pull.scene cube.mts > two.dat
    cmp one.dat two.dat
}

@test "a checkpoint that is the result is refused before the first step" {
    shapefn -o t.mts square.mts 2> note
    pressed_block > s.scene
    refused 2 '-o run.mts: is the checkpoint of -c run.mts, which is removed at the end: name another file' mtled -q -c run.mts -o run.mts s.scene t.mts
    refused 2 '-o run.frames: is the checkpoint of -c run' mtled -q -c run -o run.frames s.scene t.mts
    [ ! -e run.mts ]
    mtled -q -c run.ckpt -o run.mts s.scene t.mts
    [ -s run.mts ]
}

@test "messages: what is missing, its section, and the remedy" {
    cloud -d 3 -k regular -n 3 --box 0,1,0,1,0,1 > cube.mts
    refused 2 "dim = 2, but the nodes have 3 coordinates" mtled block.scene cube.mts
    mts drop 'facets*' square.mts | shapefn > bare.mts 2> note
    refused 2 'block.scene:11: [displacement bottom]: no named facets: give the mesh physical groups, or run tag' mtled block.scene bare.mts
    with 's/^components = 0, -0.005$/&\ncurve = ramp/'
    refused 2 'edited.scene:15: [displacement top]: curve: not smooth, linear or step, and as a file: ' mtled edited.scene square.mts
    refused 2 'a stream, not a scene? mtled SCENE [FILE]' mtled square.mts block.scene
    with 's/^analysis.*/&\ngravity = 0 -9.81/'
    refused 2 'separate components by commas' mtled edited.scene square.mts
    with 's/^components = 0, -0.005$/components = 0, -10/'
    printf '[solver]\nmax_steps = 1\n' >> edited.scene
    run --separate-stderr mtled edited.scene square.mts
    [ "$status" -eq 1 ]
    [[ "$stderr" == *'edited.scene: a displacement of 10 m is prescribed, '*' times the size of the body: lengths without a unit are in m'* ]]
    tag -r 'left=half:0.05,0,1,0' square.mts 2> note | shapefn > two.mts 2> note
    refused 2 "region 'left' has no material: add it to a [material], or leave it out (nodes -r; voxels -l)" mtled block.scene two.mts
    printf '[output]\nstress = yes\n' | cat block.scene - > edited.scene
    mtled edited.scene square.mts > u.dat 2> note
    refused 2 "-f: no field 'stress' of type f8 with one row per node (see mts list); one row per integration point or cell: see tovtk" interp -f stress u.dat
}
