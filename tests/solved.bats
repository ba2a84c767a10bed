# Results carry the parameters of the field that mtled solved for: interp and fieldcmp evaluate that field.

load common.bash

setup() { enter_alone; }

# scene DIM LOW HIGH COMPONENTS: held at LOW, moved at HIGH.
scene() {
    printf '[scene]\ndim = %d\nanalysis = quasi-static\n[material all]\nregion = body\nE = 3000\nnu = 0.45\nrho = 1000\n' "$1"
    printf '[displacement low]\nfacets = %s\ncomponents = 0, 0%s\n' "$2" "$([ "$1" -eq 2 ] || echo ', 0')"
    printf '[displacement high]\nfacets = %s\ncomponents = %s\n' "$3" "$4"
}

# largest A B: the largest difference of two lists of numbers, relative to the largest of A.
largest() {
    paste "$1" "$2" | awk '
        NF % 2 || NF == 0 { bad = 1 }
        { for (i = 1; i <= NF / 2; i++) {
            d = $i - $(i + NF / 2); d = d < 0 ? -d : d; if (!(d <= worst)) worst = d
            a = $i < 0 ? -$i : $i; if (a > size) size = a } }
        END { print (bad || !(size > 0) ? "none" : worst / size) }'
}

# below LIMIT VALUE
below() {
    echo "$2"
    awk -v limit="$1" -v value="$2" 'BEGIN { exit !(value ~ /^[0-9]/ && value + 0 <= limit + 0) }'
}

# at_nodes U [FIELD]: interp at the very nodes of a result gives the field there.
at_nodes() {
    local field=${2:-u}
    interp -f "$field" -p "$1" "$1" | mts print "$field" > at
    mts print "$field" "$1" > given
    below 1e-12 "$(largest given at)"
    # Without the parameters the values are smoothed again.
    mts drop 'parameters*' "$1" | interp -f "$field" -p "$1" | mts print "$field" > smoothed
    run ! below 1e-6 "$(largest given smoothed)"
}

@test "at the nodes a result is what it says: 2D with frames, supports of the user's, 3D, a slit" {
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.3 --seed 4 > square.mts
    { scene 2 ymin ymax "0.02, 0.01"; printf '[output]\nframes = 2\n'; } > square.scene
    shapefn square.mts 2> note | mtled -q square.scene > u.dat
    mts check u.dat
    for field in u u.frame.1 u.frame.2; do at_nodes u.dat $field; done
    # Also with another basis than the default, lists cut short, and a bound.
    for options in "-b mls1 -k 1.5" "-b mls2 -k 2.4 --bound 5" "-n 9 -m 7" "-R 30mm --mu 1e-3" "--no-widen -k 2"; do
        # shellcheck disable=SC2086
        ipoints square.mts | support $options | shapefn | mtled -q square.scene > u.dat
        at_nodes u.dat
    done
    ipoints -g 3 square.mts | support -w quartic | shapefn -b mls1 | mtled -q square.scene > u.dat
    at_nodes u.dat
    cloud -d 3 -k jittered -n 5 --box 0,0.1,0,0.1,0,0.1 --jitter 0.2 > cube.mts
    scene 3 zmin zmax "0.01, 0, -0.01" > cube.scene
    shapefn cube.mts 2> note | mtled -q cube.scene > u.dat
    at_nodes u.dat
    gmsh -2 -v 0 -setnumber h 2 "$top/examples/hard/slit.geo" -o slit.msh > /dev/null
    scene 2 held lifted "0, 3e-3" > slit.scene
    nodes -u mm slit.msh | shapefn 2> note | mtled -q slit.scene > u.dat
    at_nodes u.dat
}

@test "between the nodes: the field of the parameters, in the middle of cells, of a stream, of a table, by fieldcmp" {
    cloud -d 2 -k jittered -n 9 --box 0,0.1,0,0.1 --jitter 0.3 --seed 4 > square.mts
    cloud -d 2 -k halton -n 50 --box 0,0.1,0,0.1 > points.mts
    scene 2 ymin ymax "0.02, 0.01" > square.scene
    shapefn square.mts 2> note | mtled -q square.scene > u.dat
    # The parameters as a field of their own, through the same supports.
    mts text u.dat | sed '/^# u /s/ u / given /;/^# parameters /s/ parameters / u /' > parameters.dat
    interp -f u -p points.mts parameters.dat | mts print u > expected
    interp -f u -p points.mts u.dat | mts print u | cmp - expected
    mts print nodes.x points.mts > points.tsv
    interp -f u -p points.tsv -u m --deformed u.dat > at.mts
    mts print u at.mts | cmp - expected
    paste points.tsv expected | awk '{ printf "%.17g %.17g\n", $1 + $3, $2 + $4 }' > moved
    mts print x.deformed at.mts > x
    below 1e-15 "$(largest moved x)"
    # The solver has 1.8 spacings: other supports are another field, as are those of a table.
    interp -f u -p points.mts -k 1.8 u.dat | mts print u > other
    run ! below 1e-6 "$(largest expected other)"
    ipoints --lattice 5,5 u.dat | support | shapefn > lattice.mts
    mts print points.x lattice.mts > lattice.tsv
    interp -f u -p lattice.tsv -u m u.dat | mts print u > expected
    interp -f u lattice.mts | mts print u | cmp - expected
    ipoints square.mts | mts print points.x > middles.tsv
    interp -f u -p middles.tsv -u m u.dat | mts print u > expected
    interp -f u u.dat 2> note | mts print u > middles
    below 1e-12 "$(largest expected middles)"
    # fieldcmp takes the same field of B at the nodes of A.
    interp -f u -p points.mts u.dat > there.mts
    below 1e-15 "$(fieldcmp there.mts u.dat | awk '$1 == "max" { print $2 }')"
    run ! below 1e-6 "$(fieldcmp there.mts <(mts drop 'parameters*' u.dat) | awk '$1 == "max" { print $2 }')"
    interp -t -p points.mts u.dat > all.dat
    run -1 grep -q '^# parameters' all.dat
    tovtk -t u.dat > u.vtk
    run -1 grep -q '^parameters' u.vtk
}

@test "parameters that do not fit are refused or reported" {
    cloud -d 2 -k jittered -n 6 --box 0,0.1,0,0.1 --jitter 0.2 > square.mts
    scene 2 ymin ymax "0.02, 0.01" > square.scene
    shapefn square.mts 2> note | mtled -q square.scene > u.dat
    awk '{ print } /^# parameters.radius/ { getline; print "nan" }' u.dat > bad.dat
    refused 2 "parameters.radius: row 0: nan is not finite and positive" interp -p square.mts bad.dat
    refused 2 "" fieldcmp square.mts bad.dat
    run -1 mts check bad.dat
    sed 's/^\(# parameters.radius.*basis=\)[^ ]*/\1cubic/' u.dat > bad.dat
    refused 2 "parameters.radius: -b: " interp -p square.mts bad.dat
    awk '/^# parameters.radius/ { $4--; print; getline; next } { print }' u.dat > bad.dat
    refused 2 "parameters.radius: does not fit nodes.x: 35 rows instead of 36: run mtled again" interp -p square.mts bad.dat
    run -1 mts check bad.dat
}
