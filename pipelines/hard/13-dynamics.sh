#!/bin/bash
# Rows 13 to 16: free vibrations, the frequency of central differences, rotation and free spin, energy of a release. Each scene
# begins with the displacements and velocities of its [initial].
. "$(dirname "$0")/common.sh"

# initial TABLE_STREAM EXPRESSIONS > FILE: a row for each node, coordinates, displacement and velocity, the latter an awk
# expression list in $1.. the coordinates.
initial() {
    mts print nodes.x "$1" | awk -v OFMT=%.17g -v CONVFMT=%.17g 'BEGIN { pi = atan2(0, -1) } { print $0, '"$2"' }'
}

# frames FILE: the frames one behind the other, each row led by the frame's time.
frames() {
    [ -s "$1" ] || return 0
    awk '/^# / { inside = $2 ~ /^u\.frame\.[1-9]/; sub(/.*time=/, ""); time = $1; next } inside && NF > 0 { print time, $0 }' "$1"
}

# ---- 13: a column of .1 m, fixed at its bottom, that may move along one axis only, swings in its first mode ----
cloud -d 2 -k jittered -n 4,49 --jitter 0.2 --seed 4 --box 0,0.00625,0,0.1 | shapefn -o "$work/column.mts" 2> /dev/null

# swing NAME ALONG ACROSS EXPECTED: axes 1 and 2; the frequency from the zero crossings of the top's mean displacement.
swing() {
    initial "$work/column.mts" "$([ "$2" -eq 1 ] || echo '0,') 1e-6 * sin(pi / 2 * \$2 / 0.1), $([ "$2" -eq 2 ] || echo '0,') 0, 0" > "$work/begin.tsv"
    local held='free, 0' foot='0, free'
    [ "$2" -eq 1 ] || { held='0, free' foot='free, 0'; }
    dim=2 analysis=dynamic scene "$work/a.scene" <<END
[initial]
table = begin.tsv
unit = m
[displacement across]
facets = xmin, xmax, ymin, ymax
components = $held
[displacement foot]
facets = ymin
components = $foot
[output]
frames = 400
[solver]
end_time = $(calc "2.3 / $3")
END
    relax "$work/a.scene" "$work/column.mts" "$work/a.dat"
    frames "$work/a.dat" > "$work/swing"
    row 13 "$1 of a column: frequency, Hz" "$(awk -v axis="$2" '
        NR == FNR { if ($2 > 0.1 - 1e-9) is_top[FNR] = 1; nodes = FNR; next }
        {
            if (!((FNR - 1) % nodes)) sum = 0
            if (((FNR - 1) % nodes + 1) in is_top) sum += $(1 + axis)
            if (FNR % nodes) next
            if (frame++ && (sum > 0) != (before > 0)) {
                last = time + before / (before - sum) * ($1 - time)
                if (!crossings++) first = last
            }
            before = sum
            time = $1
        }
        END { print (crossings >= 3 ? 0.5 * (crossings - 1) / (last - first) : "nan") }' \
        <(mts print nodes.x "$work/column.mts") "$work/swing")" "$3" vibration
}
swing 'pressure wave' 2 17.91338
swing 'shear mode' 1 2.50838

# ---- 14 and 15: bodies of one cell, which reduce to a few oscillators and masses ----

# one_cell DIM: an equilateral triangle, or a regular tetrahedron, about the origin; corners 1 m away from it.
one_cell() {
    if [ "$1" -eq 2 ]; then
        printf '# mts 1\n# nodes.x f8 3 2 enc=text unit=m cols=x,y\n1 0\n-0.5 0.86602540378443865\n-0.5 -0.86602540378443865\n\n\n'
        printf '# cells i4 1 3 enc=text\n0 1 2\n\n\n# cells.region i4 1 1 enc=text names=body\n0\n\n\n# end 3\n'
    else
        printf '# mts 1\n# nodes.x f8 4 3 enc=text unit=m cols=x,y,z\n'
        for corner in '1 1 1' '1 -1 -1' '-1 1 -1' '-1 -1 1'; do
            awk '{ print $1 / sqrt(3), $2 / sqrt(3), $3 / sqrt(3) }' OFMT=%.17g <<< "$corner"
        done
        printf '\n\n# cells i4 1 4 enc=text\n0 2 1 3\n\n\n# cells.region i4 1 1 enc=text names=body\n0\n\n\n# end 3\n'
    fi | ipoints | support -b mls1 | shapefn -o "$work/cell$1.mts"
}
one_cell 2
one_cell 3

# An oscillator: the triangle swells and shrinks, the fastest of its three modes, at w^2 = 4 (lambda + mu) / rho. The step is a
# share of the critical one, 2 / w, and there is a frame for each step: u(n + 1) + u(n - 1) = 2 cos(w_h dt) u(n).
steps=40
omega=$(calc 'sqrt(4 * 3000 / (2 * 1.49 * 0.02) / 1000)')
initial "$work/cell2.mts" '1e-7 * $1, 1e-7 * $2, 0, 0' > "$work/begin.tsv"
for case in '0.1 1.001674' '0.5 1.047198' '0.9 1.244188'; do
    read -r share reference <<< "$case"
    # A little less than `steps` of them, so that it is not one more.
    end=$(calc "(1 - 1e-6) * $steps * $share * 2 / $omega")
    dim=2 analysis=dynamic scene "$work/a.scene" <<END
[initial]
table = begin.tsv
unit = m
[output]
frames = $steps
[solver]
end_time = $end
time_step_margin = $share
END
    relax "$work/a.scene" "$work/cell2.mts" "$work/a.dat"
    [ "$share" != 0.1 ] || row 14 'critical step / that of the closed form' "$(calc "$(reported "$work/a.dat" 'critical step, s') * $omega / 2")" 1 critical-step
    row 14 "central differences, $share of the critical step: w_h / w" "$(frames "$work/a.dat" | awk -v angle="$(calc "$omega * $end / $steps")" '
        BEGIN { u[0] = 1e-7 }
        NR % 3 == 1 { u[++n] = $2 } # of the corner at (1, 0)
        END {
            for (i = 1; i < n; i++) { sum += (u[i + 1] + u[i - 1]) * u[i]; square += u[i] ^ 2 }
            if (n < 3) print "nan"
            else { cosine = sum / (2 * square); print atan2(sqrt(1 - cosine ^ 2), cosine) / angle }
        }' CONVFMT=%.12g OFMT=%.12g)" "$reference" central-differences
done

# Free spin: thrown and turning, for more than a turn; momenta of the corners, half a step on, over all steps. Beside it how far
# it swings meanwhile.
for dim in 2 3; do
    initial "$work/cell$dim.mts" "$([ $dim -eq 2 ] && echo '0, 0, -3 * $2 + 0.1, 3 * $1' ||
        echo '0, 0, 0, 0.5 * $3 - 2 * $2 + 0.1, 2 * $1 - $3, $2 - 0.5 * $1')" > "$work/begin.tsv"
    for frames in 1 steps; do # one run counts the steps, the next one gives a frame for each
        [ $frames = 1 ] || frames=$(reported "$work/a.dat" steps)
        dim=$dim analysis=dynamic scene "$work/a.scene" <<END
[initial]
table = begin.tsv
unit = m
[output]
frames = $frames
energy = yes
[solver]
end_time = 4
time_step_margin = 0.2
END
        relax "$work/a.scene" "$work/cell$dim.mts" "$work/a.dat"
    done
    row 15 "free spin in ${dim}D: changes of the step" "$(reported "$work/a.dat" 'step changes')" 0 none
    read -r linear angular swing < <(frames "$work/a.dat" | awk -v dim=$dim '
        function magnitude(x) { return x < 0 ? -x : x }
        NR == FNR { for (a = 1; a <= dim; a++) x[FNR, a] = $a; nodes = FNR; next }
        {
            node = (FNR - 1) % nodes + 1
            for (a = 1; a <= dim; a++) { v[node, a] = ($(1 + a) - u[node, a]) * (frame > 0); u[node, a] = $(1 + a) }
            if (node < nodes) next
            if (frame++ > 0) look()
        }
        function look(    i, a, b, p, L, square, size) {
            for (a = 1; a <= 3; a++) {
                p = L = 0
                b = a % 3 + 1
                for (i = 1; i <= nodes; i++) {
                    p += v[i, a]
                    L += (x[i, a] + u[i, a]) * v[i, b] - (x[i, b] + u[i, b]) * v[i, a]
                    speed += magnitude(v[i, a])
                }
                if (frame == 2) { p0[a] = p; L0[a] = L; size0 = speed }
                if (magnitude(p - p0[a]) > linear) linear = magnitude(p - p0[a])
                if (magnitude(L - L0[a]) > angular) angular = magnitude(L - L0[a])
            }
            for (a = 1; a <= dim; a++) square += (x[1, a] + u[1, a] - x[2, a] - u[2, a]) ^ 2
            size = sqrt(square)
            if (frame == 2 || size < least) least = size
            if (size > most) most = size
        }
        END { print (frame > 2 ? linear / size0 " " angular / size0 " " most / least - 1 : "nan nan nan") }' \
        <(mts print nodes.x "$work/cell$dim.mts") -)
    row 15 "free spin in ${dim}D: drift of the momentum" "$linear" 0 round-off
    row 15 "free spin in ${dim}D: drift of the angular momentum" "$angular" 0 round-off
    at_least 15 "free spin in ${dim}D: an edge swings by" "$swing" swing
done

# ---- 15: a body that begins a quarter turn from where it was: no stress in it, on no section of it a force ----
for dim in 2 3; do
    cloud -d $dim -k jittered -n $((dim == 2 ? 13 : 7)) --jitter 0.15 --seed 5 --box "0,0.1,0,0.1$([ $dim -eq 2 ] || echo ,0,0.1)" |
        shapefn -o "$work/body.mts" 2> /dev/null
    initial "$work/body.mts" "-\$2 - \$1, \$1 - \$2$([ $dim -eq 2 ] || echo ', 0, 0'), 0, 0" > "$work/begin.tsv"
    dim=$dim analysis=dynamic scene "$work/a.scene" <<END
[initial]
table = begin.tsv
unit = m
[output]
stress = yes
[solver]
end_time = 1e-3
END
    relax "$work/a.scene" "$work/body.mts" "$work/a.dat"
    row 15 "quarter turn in ${dim}D: largest stress / mu" "$({ [ ! -s "$work/a.dat" ] || mts print stress "$work/a.dat"; } | awk '
        { for (i = 1; i <= NF; i++) { s = $i < 0 ? -$i : $i; if (s > most) most = s } }
        END { print (NR > 0 ? most / 1006.711409 : "nan") }')" 0 round-off
done

# ---- 16: a block at rest in the state of row 2, stretch .8, let go between its sliding supports ----
# .65 of the critical step, a millisecond, as a penalty on the supports once had at .75.
cloud -d 3 -k jittered -n 5 --jitter 0.15 --seed 7 --box 0,0.1,0,0.1,0,0.1 | shapefn -o "$work/block.mts" 2> /dev/null
initial "$work/block.mts" '0.11574668 * $1, 0.11574668 * $2, -0.2 * $3, 0, 0, 0' > "$work/begin.tsv"
for margin in 0.65 0.2167; do
    analysis=dynamic scene "$work/a.scene" <<END
[initial]
table = begin.tsv
unit = m
[displacement planes]
facets = xmin, ymin, zmin
normal = 0
[output]
energy = yes
[solver]
end_time = 0.4
time_step_margin = $margin
END
    relax "$work/a.scene" "$work/block.mts" "$work/$margin.dat"
done
# energies MARGIN EXPRESSION: the largest magnitude over the run, relative to the energy at the start. Columns of the section:
# time, kinetic, internal, contact, work.
energies() {
    { [ ! -s "$work/$1.dat" ] || mts print energy "$work/$1.dat"; } | awk '
        function magnitude(x) { return x < 0 ? -x : x }
        NR == 1 { W = $3; start = $2 + $3 } # half a step before and after: the kinetic part is not quite 0
        { x = magnitude('"$2"') }
        x > most { most = x }
        END { print (NR > 100 ? most / W : "nan") }'
}
row 16 'release: W of the stretch 0.8, J/m3' \
    "$({ [ ! -s "$work/0.65.dat" ] || mts print energy "$work/0.65.dat"; } | awk 'NR == 1 { printf "%.9g\n", $3 / 1e-3 }')" 70.051447 homogeneous-energy
row 16 'release: largest drift of the balance / W' "$(energies 0.65 '$2 + $3 - $5 - start')" 0 energy-drift
at_most 16 'release: drift at a third of the step / drift' \
    "$(calc "$(energies 0.2167 '$2 + $3 - $5 - start') / $(energies 0.65 '$2 + $3 - $5 - start')")" drift-order
at_least 16 'release: largest kinetic energy / W' "$(energies 0.65 '$2')" released
