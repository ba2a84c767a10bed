# Displacements of measured points, anywhere in a body or on it: exact ones and those known to a standard deviation.

load common.bash

setup() { enter_alone; }

# cloud_of DIM: a block of 0.1 m as block.mts
cloud_of() {
    local box=0,0.1,0,0.1 nodes=11
    [ "$1" = 2 ] || { box=$box,0,0.1; nodes=6; }
    cloud -d "$1" -k jittered -n $nodes --box $box --jitter 0.2 --seed 3 | shapefn > block.mts 2> note
}

# head_of DIM [LINES OF scene]
head_of() {
    printf '[scene]\ndim = %s\nanalysis = quasi-static\n%b' "$1" "$2"
    printf '[material body]\nregion = body\nE = 3000\nnu = 0.45\nrho = 1000\n[output]\nreactions = yes\nenergy = yes\n[solver]\ntolerance = 1e-7\n'
}

# random COUNT DIM FORMULA [SEED]: rows of places within the block and what awk makes of x, y, z
random() {
    awk -v n="$1" -v dim="$2" -v seed="${4:-1}" '
        function uniform() { seed = (16807 * seed) % 2147483647; return seed / 2147483647 }
        function normal() { return sqrt(-2 * log(uniform())) * cos(6.283185307179586 * uniform()) }
        BEGIN {
            OFMT = "%.12g"
            for (i = 0; i < 10; i++) uniform()
            for (i = 0; i < n; i++) {
                x = 0.1 * uniform(); y = 0.1 * uniform(); z = dim == 3 ? 0.1 * uniform() : 0
                printf "%.9g %.9g ", x, y
                if (dim == 3) printf "%.9g ", z
                print '"$3"'
            }
        }'
}

# off FORMULA...: the largest distance of u at the nodes of u.dat from what awk makes of x, y, z, one formula for each component
off() {
    paste -d ' ' <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '{
        n = NF / 2; x = $1; y = $2; z = n == 3 ? $3 : 0
        w[1] = '"$1"'; w[2] = '"$2"'; w[3] = '"${3:-0}"'
        for (i = 1; i <= n; i++) { d = $(n + i) - w[i]; if (d < 0) d = -d; if (!(d <= most)) most = d }
    } END { print most }'
}

below() { awk -v a="$1" -v b="$2" 'BEGIN { print a " is to be below " b; exit !(a <= b) }'; }

# A turn by .3 about z, and a way.
turned=('.955336489 * x - .295520207 * y - x + .01' '.295520207 * x + .955336489 * y - y - .02' '.005')

@test "a rigid motion given at scattered points is found, without a force: 2D, 3D, exact and with standard deviations" {
    for dim in 2 3; do
        cloud_of $dim
        text="${turned[0]}, ${turned[1]}"
        [ $dim = 2 ] || text="$text, ${turned[2]}"
        random 8 $dim "$text" > exact.tsv
        sed 's/$/ 0.0005/' exact.tsv > springs.tsv; sed 's/$/ 1e-12/' exact.tsv > stiff.tsv
        for kind in exact springs stiff; do
            { head_of $dim; printf '[displacement measured]\npoints = %s.tsv\nunit = m\n' $kind; } > run.scene
            mtled run.scene block.mts > u.dat
            below "$(off "${turned[@]}")" 2e-8
            [ $kind = stiff ] || rows reactions u.dat | awk '{ for (i = 1; i <= NF; i++) if (!($i^2 < 1e-10)) exit 1 }'
            # What interp finds at the points is what was measured.
            interp -f u -p <(cut -d ' ' -f "1-$dim" exact.tsv) -u m u.dat | mts print u - | paste -d ' ' - <(cut -d ' ' -f "$((dim + 1))-" exact.tsv) |
                awk '{ for (i = 1; i <= NF / 2; i++) { d = $i - $(i + NF / 2); if (!(d^2 < 1e-15)) exit 1 } }'
        done
    done
}

@test "landmarks of 3D Slicer before and after: what a table of the same says, and moved landmarks are those after" {
    cloud_of 3
    random 8 3 "${turned[0]}, ${turned[1]}, ${turned[2]}" > exact.tsv
    awk '{ printf "%s{\"label\": \"p%d\", \"position\": [%.15g, %.15g, %.15g]}", (NR > 1 ? ",\n" : "{\"markups\": [{\"controlPoints\": [\n"), NR,
        -1e3 * $1, -1e3 * $2, 1e3 * $3 } END { printf "]}]}" }' exact.tsv > before.mrk.json
    awk 'BEGIN { print "# CoordinateSystem = 0" } { printf "%d,%.15g,%.15g,%.15g,0,0,0,1,1,1,0,p%d,,\n", NR, 1e3 * ($1 + $4), 1e3 * ($2 + $5),
        1e3 * ($3 + $6), NR }' exact.tsv > after.fcsv
    { head_of 3; printf '[displacement seen]\npoints = before.mrk.json\n'; } > alone.scene
    { cat alone.scene; printf 'moved = after.fcsv\n'; } > seen.scene
    mtled seen.scene block.mts > u.dat
    below "$(off "${turned[@]}")" 1e-6
    interp -p before.mrk.json --deformed -o moved.mrk.json u.dat
    interp -p before.mrk.json -u mm --deformed -o moved.fcsv u.dat
    /usr/bin/python3 -c 'import json
for p in json.load(open("moved.mrk.json"))["markups"][0]["controlPoints"]: print(p["label"], -p["position"][0], -p["position"][1], p["position"][2])' > moved
    awk -F, '!/^#/ { gsub(/"/, ""); print $12, $2, $3, $4 }' moved.fcsv >> moved
    awk -F, '!/^#/ { print $12, $2, $3, $4 }' after.fcsv after.fcsv | paste -d ' ' - moved | awk '
        { for (k = 2; k < 5; k++) if (($k - $(k + 4))^2 > 1e-6) exit 1; n += $1 == $5 } END { exit n != 16 }'
    # Names are kept whole, in both formats and from one to the other.
    sed 's/"p1"/"'"$(printf '%62s' '')"'é\\ud83d\\ude00, \\"a\\\\"/' before.mrk.json > named.mrk.json
    interp -p named.mrk.json --deformed -o named.fcsv u.dat
    interp -p named.fcsv --deformed -o again.mrk.json u.dat
    /usr/bin/python3 -c 'import json
a, b = ([p["label"] for p in json.load(open(f))["markups"][0]["controlPoints"]] for f in ("named.mrk.json", "again.mrk.json"))
assert a == b and a[0].strip() == "\u00e9\U0001f600, \"a\\" and len(a[0]) == 69, (a, b)'
    refused 2 "landmarks are places: give those that they move to, as moved" mtled alone.scene block.mts
    sed 's/moved = after.fcsv/&\nunit = cm/' seen.scene > unit.scene
    refused 2 "landmarks are in mm" mtled unit.scene block.mts
    sort -r after.fcsv > moved.fcsv
    sed 's/after/moved/' seen.scene > moved.scene
    refused 2 "its points have another order than those of points" mtled moved.scene block.mts
    sed '$ d' after.fcsv > moved.fcsv
    refused 2 "another number of points" mtled moved.scene block.mts
    refused 2 "-u cm: landmarks are in mm" interp -p before.mrk.json -u cm u.dat
    refused 2 "landmarks are moved points: give --deformed" interp -p before.mrk.json -o moved.fcsv u.dat
}

@test "components that are not known: - and nan; each row says what it says" {
    cloud_of 3
    printf '10 20 30 1 - nan\n80 10 20 1 2 -\n20 90 50 - 2 3\n70 60 90 - - 3\n10 80 10 1 - 3\n' > some.tsv
    { head_of 3; printf '[displacement measured]\npoints = some.tsv\nunit = mm\n'; } > run.scene
    mtled run.scene block.mts > u.dat
    below "$(off .001 .002 .003)" 1e-9
    printf '10 20 30 1 - nan .1\n80 10 20 1 2 - .1\n20 90 50 - 2 3 .2\n70 60 90 - - 3 .1\n10 80 10 1 - 3 .3\n' > some.tsv
    mtled run.scene block.mts > u.dat
    below "$(off .001 .002 .003)" 1e-8
}

@test "two measurements of each place: their mean weighted by the squares of the deviations; noise of many is averaged" {
    cloud_of 3
    for place in '10 20 30' '80 10 20' '20 90 50' '70 60 90'; do echo "$place 1 0 0 .1"; echo "$place 2 0 3 .2"; done > twice.tsv
    { head_of 3; printf '[displacement measured]\npoints = twice.tsv\nunit = mm\n'; } > run.scene
    mtled run.scene block.mts > u.dat 2> said
    below "$(off .0012 0 .0006)" 1e-8 # 4/5 and 1/5
    cloud_of 2
    random 400 2 '.001 + .0005 * normal(), -.002 + .0005 * normal(), .0005' > noisy.tsv
    { head_of 2; printf '[displacement measured]\npoints = noisy.tsv\nunit = m\n'; } > run.scene
    mtled run.scene block.mts > u.dat
    mean=$(mts print u u.dat | awk '{ a += $1 - .001; b += $2 + .002 } END { print sqrt(a^2 + b^2) / NR }')
    below "$mean" 1e-4
    rms=$(mts print u u.dat | awk '{ s += ($1 - .001)^2 + ($2 + .002)^2 } END { print sqrt(s / NR / 2) }')
    below "$rms" 0.0002
}

@test "a spring yields by its force: k goes with the inverse square of the deviation and the square of model_error" {
    for dim in 2 3; do
        cloud_of $dim
        last=ymin
        [ $dim = 2 ] || last=zmin
        rest=0
        [ $dim = 2 ] || rest=0,0
        k=()
        for known in '1 .004' '2 .004' '1 .008'; do
            read -r deviation model <<< "$known"
            { head_of $dim; printf '[displacement held]\nfacets = %s\ncomponents = 0,%s\n[displacement point]\npoints = one.tsv\nunit = mm\nmodel_error = %s\n' $last $rest "$model"; } > run.scene
            if [ $dim = 2 ]; then echo "53 71 4 - $deviation" > one.tsv; else echo "53 47 71 4 - - $deviation" > one.tsv; fi
            mtled run.scene block.mts > u.dat
            u=$(interp -f u -p <(cut -d ' ' -f "1-$dim" one.tsv) -u mm u.dat | mts print u - | awk '{ print $1 }')
            k+=("$(rows reactions u.dat | awk -v u="$u" 'NR == 1 { f = $1 } NR == 2 { if (!((f + $1)^2 < 1e-8 * f^2)) exit 1; print $1 / (.004 - u) }')")
        done
        awk -v a="${k[0]}" -v b="${k[1]}" -v c="${k[2]}" 'BEGIN { print a, b, c; p = a / b / 4 - 1; q = c / a / 4 - 1; exit !(p^2 < 1e-8 && q^2 < 1e-8) }'
    done
    # 6 pi mu r (s / sigma)^2, r of the ball of a node's volume, which is the block's by its nodes at the mean
    awk -v k="${k[0]}" 'BEGIN { mu = 3000 / 2.9; r = (0.75 * 0.001 / 216 / 3.14159265)^(1/3); f = k / (6 * 3.14159265 * mu * r * 16); print f; exit !(f > 0.8 && f < 1.5) }'
}

# The block stands on a floor that is nowhere held, under its weight, and a few points inside are known.
resting() {
    cloud_of 3
    printf -- '-1 -1 0 2 -1 0 2 2 0\n-1 -1 0 2 2 0 -1 2 0\n' > floor.tsv
    printf '20 20 60 0 0 -.4 .05\n80 20 60 0 0 -.4 .05\n50 80 60 0 0 - .05\n50 50 90 1 0 - 0\n20 50 90 - 0 - 0\n' > some.tsv
    { head_of 3 'gravity = 0, 0, -9.81\n'; printf '[displacement some]\npoints = some.tsv\nunit = mm\n'
        printf '[contact floor]\nfacets = zmin\nrigid = floor.tsv\nunit = m\nside = front\n'; } | sed 's/^energy/frames = 2\nenergy/; s/= 1e-7/= 1e-6/' > rest.scene
}

@test "with contact, gravity, frames: forces balance the weight, energy holds what the springs do, threads change no byte" {
    resting
    mtled rest.scene block.mts > u.dat 2> said
    rows reactions u.dat | awk '{ for (i = 1; i <= 3; i++) s[i] += $i } END { print s[1], s[2], s[3]; exit !(NR == 2 && s[1]^2 < 1e-6 && s[2]^2 < 1e-6 && (s[3] - 9.81)^2 < 1e-4) }'
    rows reactions.frames u.dat | awk '{ print } END { exit !(NR == 3) }'
    interp -f u -p <(sed -n 4p some.tsv | cut -d ' ' -f 1-3) -u mm u.dat | mts print u - | awk '{ exit !(($1 - .001)^2 < 1e-16 && $2^2 < 1e-16) }'
    OMP_NUM_THREADS=2 mtled rest.scene block.mts 2> said | cmp - u.dat
}

@test "a run that is interrupted goes on from its checkpoint to the same bytes; other measurements are refused" {
    resting
    cp block.mts table.mts
    mtled rest.scene table.mts > whole.dat 2> said
    begin_and_end INT rest.scene
    [ "$status" -eq 130 ]
    sed -i.kept 's/-.4/-.5/' some.tsv
    run -2 --separate-stderr mtled -c run.ckpt rest.scene table.mts
    mv some.tsv.kept some.tsv
    mtled -c run.ckpt rest.scene table.mts 2> said | cmp - whole.dat
}

@test "in time: a point that is moved, exactly and by a spring, and the balance of energy" {
    cloud_of 2
    for deviation in 0 0.5; do
        echo "50 90 3 - $deviation" > one.tsv
        { head_of 2 | sed 's/quasi-static/dynamic/; s/^tolerance.*/end_time = 0.2/'; printf '[displacement held]\nfacets = ymin\ncomponents = 0, 0\n[displacement point]\npoints = one.tsv\nunit = mm\n'; } > run.scene
        mtled run.scene block.mts > u.dat
        rows energy u.dat | awk '{ if ($7 > 0.01 || $7 < -0.01) bad = 1; last = $3 } END { exit bad || !(last > 0) }'
        interp -f u -p <(echo 50 90) -u mm u.dat | mts print u - | awk -v deviation=$deviation '{ d = $1 - .003; print d; exit !(d^2 < (deviation > 0 ? 1e-6 : 1e-20)) }'
    done
}

@test "what is wrong is reported by row" {
    cloud_of 2
    { head_of 2; printf '[displacement m]\npoints = rows.tsv\nunit = mm\n'; } > run.scene
    while IFS='|' read -r rows message; do
        printf '%b\n' "$rows" > rows.tsv
        refused 2 "$message" mtled run.scene block.mts
    done << 'END'
10 20 1 1\n50 130 1 1|[displacement m]: points rows.tsv:2: at (0.05, 0.13): farther from the body than the spacing of its nodes: wrong unit or wrong place?
# x\n10 20 1 1\n50 50 - nan|points rows.tsv:3: at (0.05, 0.05): no component is given: leave the row out
10 20 1 1 .5\n50 50 1 1 -.5|points rows.tsv:2: at (0.05, 0.05): its standard deviation is negative: give a length, 0 for an exact point
10 20 1|rows.tsv:1: has 3 columns, not 4 to 5
10 - 1 1|rows.tsv:1: column 2: '-' is not a finite number
10 20 1 1 -|rows.tsv:1: column 5: '-' is not a finite number
10 20 1 1\n80 80 1 1\n10 20 1 1|at (0.01, 0.02): too many points for the nodes there, one twice, or one on what another section holds
10 20 1 1\n10 22 1 4|points rows.tsv:2: at (0.01, 0.022): contradicts line 1, 0.002 m away: their displacements differ by 0.003 m, which turns over what is between: give standard deviations, or leave one out
10 20 0 0 1\n80 80 0 - 1|[displacement m]: points rows.tsv: all that was measured is 0: say by model_error how far off the scene may be without them, m
END
    for i in $(seq 10); do for k in $(seq 10); do echo "$((i + 40)) $((k + 40)) 1 1"; done; done > rows.tsv
    refused 2 "too many points for the nodes there, one twice, or one on what another section holds: leave it out, give standard deviations, or refine the cloud" mtled run.scene block.mts
    sed -i 's/$/ .1/' rows.tsv
    mtled run.scene block.mts > u.dat
    { cat run.scene; printf '[displacement side]\nfacets = ymin\ncomponents = 0, 0\n'; } > side.scene
    echo "53 0 0 -" > rows.tsv
    refused 2 "too many points for the nodes there, one twice, or one on what another section holds" mtled side.scene block.mts
    echo "50 0 - 1 .1" > rows.tsv
    mtled -q side.scene block.mts > u.dat
    # A stated reach
    printf '10 20 1 1\n50 104 1 1\n' > rows.tsv
    mtled run.scene block.mts > u.dat
    { cat run.scene; echo 'reach = 0.003'; } > reach.scene
    refused 2 "points rows.tsv:2: at (0.05, 0.104): farther from the body than its reach: wrong unit or wrong place?" mtled reach.scene block.mts
    sed -i 's/0.003/0.005/' reach.scene
    mtled reach.scene block.mts > u.dat
}

@test "keys: points go alone, reach and model_error with them; one point leaves the body free" {
    cloud_of 2
    while IFS='|' read -r lines message; do
        { head_of 2; printf "[displacement m]\n$lines"; } > run.scene
        refused 2 "$message" mtled run.scene block.mts
    done << 'END'
points = a.tsv\n|points: needs unit = m, cm, mm or um of its lengths
points = a.tsv\nunit = m\nfacets = xmin\n|points
points = a.tsv\nunit = m\ntable = b.tsv\n|table: not allowed: it goes with facets or nodes
facets = xmin\ncomponents = 0, 0\nreach = 1\n|reach: not allowed: it goes with points
nodes = corner\ncomponents = 0, 0\nmodel_error = 1\n|model_error: not allowed: it goes with points
points = a.tsv\nunit = m\nreach = 0\n|reach
END
    echo '50 50 1 0 .1' > a.tsv
    { head_of 2; printf '[displacement m]\npoints = a.tsv\nunit = mm\n'; } > run.scene
    refused 1 "nothing holds the body: it may turn about (0.05, 0.05)" mtled run.scene block.mts
}

@test "a table is a fit: where it is off a row at a node that is told; points are exact" {
    cloud -d 2 -k regular -n 11 --box 0,0.1,0,0.1 | shapefn > square.mts 2> note
    awk 'BEGIN { for (i = 0; i <= 10; i++) print i / 100, 0.1, 0, (i < 5 ? 5 - i : i - 5) / 1000 }' > kink.tsv
    for how in 'facets = ymax\ntable' points; do
        { block quasi-static && held_below && printf "[displacement top]\n$how = kink.tsv\nunit = m\n"; } > kink.scene
        mtled kink.scene square.mts 2> said > u.dat
        if [ "$how" = points ]; then
            [ ! -s said ]
            paste <(mts print nodes.x u.dat) <(mts print u u.dat) | awk '$2 > 0.099 { d = $4 - ($1 < 0.05 ? 0.05 - $1 : $1 - 0.05) / 10; bad = bad || d > 1e-9 || d < -1e-9 } END { exit bad }'
        else
            grep 'kink.scene:[0-9]*: \[displacement top\]: table kink.tsv: at (0.05, 0.1) what is prescribed is off row 6 by 0.000[0-9]* m: the rows are fitted,' said
        fi
    done
}
