#!/bin/bash
# Row 21: clouds that trap supports. Each ends in a table that reproduces linear fields, or in one clear error.
. "$(dirname "$0")/common.sh"

# cloud_stream DIM FILE: a text stream of nodes.x from lines `node X Y [Z]` and points.x from lines `point X Y [Z]`.
cloud_stream() {
    awk -v dim="$1" '
        { text = ""; for (i = 2; i <= dim + 1; i++) text = text " " sprintf("%.17g", $i) }
        $1 == "node" { nodes[n++] = text }
        $1 == "point" { points[p++] = text }
        function section(name, lines, count,    i) {
            printf "# %s f8 %d %d enc=text unit=m\n", name, count, dim
            for (i = 0; i < count; i++) print substr(lines[i], 2)
            print "\n"
        }
        BEGIN { print "# mts 1" }
        END {
            section("nodes.x", nodes, n)
            section("points.x", points, p)
            print "# end 2"
        }' > "$2"
}

# reproduction TABLE: largest error of sum phi = 1 and of sum phi x = x relative to the largest support radius; of the
# gradient's as well.
reproduction() {
    local section
    for section in nodes.x points.x support.radius nbr.ptr nbr.idx shape.phi shape.dphi; do
        mts print $section "$1" > "$work/$section"
    done
    awk -v work="$work" '
        function load(name, array,    i, k) {
            for (i = 0; (getline < (work "/" name)) > 0; i++) {
                columns = NF
                for (k = 1; k <= NF; k++) array[i, k] = $k
            }
            return i
        }
        function worse(old, new) { return new < 0 ? worse(old, -new) : new <= old ? old : new }
        BEGIN {
            rows = load("support.radius", s)
            for (i = 0; i < rows; i++) radius = worse(radius, s[i, 1])
            load("nodes.x", x)
            load("nbr.ptr", ptr)
            load("nbr.idx", idx)
            load("shape.phi", phi)
            load("shape.dphi", dphi)
            points = load("points.x", at)
            dim = columns
            worst = 0
            for (q = 0; q < points; q++) {
                sum = -1
                for (k = ptr[q, 1]; k < ptr[q + 1, 1]; k++) sum += phi[k, 1]
                worst = worse(worst, sum)
                for (a = 1; a <= dim; a++) {
                    sum = 0
                    for (k = ptr[q, 1]; k < ptr[q + 1, 1]; k++) sum += phi[k, 1] * (x[idx[k, 1], a] - at[q, a])
                    worst = worse(worst, sum / radius)
                    for (b = 1; b <= dim; b++) {
                        sum = a == b ? -1 : 0
                        for (k = ptr[q, 1]; k < ptr[q + 1, 1]; k++) sum += dphi[k, a] * (x[idx[k, 1], b] - at[q, b])
                        worst = worse(worst, sum)
                    }
                }
            }
            print worst
        }'
}

# caught QUANTITY WANTED STREAM ARGUMENTS_OF_SUPPORT: WANTED is `table`, `error` or `either`; an error is a verdict in one
# line that names a point or node and where it is.
caught() {
    local status=0
    # shellcheck disable=SC2086
    support $4 "$3" 2> "$work/message" > "$work/support.mts" || status=$?
    if [ $status -eq 0 ]; then
        shapefn -o "$work/table.mts" "$work/support.mts" 2> "$work/message" || status=$?
    fi
    if [ $status -eq 0 ] && [ "$2" != error ]; then
        row 21 "$1: linear reproduction" "$(reproduction "$work/table.mts")" 0 reproduction
    elif [ $status -eq 1 ] && [ "$2" != table ] && [ "$(wc -l < "$work/message")" -eq 1 ] &&
        grep -qE '(row|node|point) [0-9]+.* at \(' "$work/message"; then
        printf '21\t%s: clear error\t1\t1\t0\t0\tpass\n' "$1"
    else
        printf '21\t%s: %s\tstatus %d\t-\t-\t0\tFAIL\n' "$1" "$2" $status
        head -n 3 "$work/message" >&2
    fi
}

# 50 nodes on a sphere of 10 mm: the squares of the coordinates depend on each other.
awk 'BEGIN {
    turn = atan2(0, -1) * (3 - sqrt(5))
    for (i = 0; i < 50; i++) {
        z = 1 - (2 * i + 1) / 50
        r = sqrt(1 - z * z)
        printf "node %.17g %.17g %.17g\n", 0.01 * r * cos(turn * i), 0.01 * r * sin(turn * i), 0.01 * z
    }
    print "point 0 0 0\npoint 0.001 0.002 -0.001\npoint 0.006 0 0\npoint 0 0.0099 0"
}' | cloud_stream 3 "$work/sphere.dat"
caught '50 nodes on a sphere, MMLS' table "$work/sphere.dat" '-b mmls2'
caught '50 nodes on a sphere, MMLS, all in the support' table "$work/sphere.dat" '-b mmls2 --no-widen -R 0.03'
caught '50 nodes on a sphere, linear MLS' table "$work/sphere.dat" '-b mls1'
caught '50 nodes on a sphere, quadratic MLS' error "$work/sphere.dat" '-b mls2'
caught '50 nodes on a sphere, quadratic MLS, not widened' error "$work/sphere.dat" '-b mls2 --no-widen -R 0.03'

# A slab of 4 x 4 x 2 nodes: nothing tells z^2 from z.
cloud -d 3 -k regular -n 4,4,2 --box 0,0.03,0,0.03,0,0.01 | ipoints -g 4 > "$work/slab.mts"
caught 'slab of 4 x 4 x 2 nodes, MMLS' table "$work/slab.mts" '-b mmls2'
caught 'slab of 4 x 4 x 2 nodes, linear MLS' table "$work/slab.mts" '-b mls1'
caught 'slab of 4 x 4 x 2 nodes, quadratic MLS' error "$work/slab.mts" '-b mls2'

# 25 coplanar nodes in 3D, 12 collinear ones in 2D and in 3D, askew.
awk 'BEGIN {
    for (i = 0; i < 5; i++) for (j = 0; j < 5; j++) printf "node %.17g %.17g %.17g\n", i / 100, j / 100, 0.3 * i / 100 + 0.2 * j / 100
    print "point 0.021 0.018 0.0099"
}' | cloud_stream 3 "$work/plane.dat"
awk 'BEGIN {
    for (i = 0; i < 12; i++) printf "node %.17g %.17g %.17g\n", i / 100, 0.7 * i / 100, -0.3 * i / 100
    print "point 0.05 0.035 -0.015"
}' > "$work/line"
cloud_stream 2 "$work/line2.dat" < "$work/line"
cloud_stream 3 "$work/line3.dat" < "$work/line"
for basis in mls1 mls2 mmls2; do
    caught "25 coplanar nodes, $basis" error "$work/plane.dat" "-b $basis"
    caught "12 collinear nodes in 2D, $basis" error "$work/line2.dat" "-b $basis"
    caught "12 collinear nodes in 3D, $basis" error "$work/line3.dat" "-b $basis"
done

# A lattice with one node twice; with one node far from the others, looked at there and among the others.
cloud -d 2 -k regular -n 7 --box 0,0.06,0,0.06 -t | mts print nodes.x | sed 's/^/node /' > "$work/lattice"
awk '{ print } END { print "node 0.03 0.03\npoint 0.031 0.029\npoint 0.03 0.03\npoint 0.005 0.005" }' "$work/lattice" |
    cloud_stream 2 "$work/twice.dat"
caught 'two nodes at one place' either "$work/twice.dat" ''
awk '{ print } END { print "node 1 1\npoint 0.031 0.029\npoint 0.06 0.06" }' "$work/lattice" | cloud_stream 2 "$work/near.dat"
awk '{ print } END { print "node 1 1\npoint 1 1" }' "$work/lattice" | cloud_stream 2 "$work/away.dat"
caught 'a stray node, seen from the others' either "$work/near.dat" ''
caught 'a stray node, seen from itself' either "$work/away.dat" ''

# Spacings of 20:1, through the whole scheme.
for dim in 2 3; do
    cloud -d $dim -k graded --ratio 20 -n $((dim == 2 ? 13 : 6)) --box "0,0.1,0,0.1$([ $dim -eq 2 ] || echo ,0,0.1)" | ipoints -g 1 > "$work/graded.mts"
    caught "graded 20:1 in ${dim}D" table "$work/graded.mts" ''
done
