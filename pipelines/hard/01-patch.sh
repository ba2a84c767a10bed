#!/bin/bash
# Row 1: the linear patch test with every integration scheme, and the consistency of the shape functions in m, in mm and
# 1 m away from the origin.
. "$(dirname "$0")/common.sh"

# ---- patch test: u = A x prescribed on the whole boundary of a scattered cloud ----

# Strains of some percent, in terms of awk.
linear_2d='0.011 * $1 + 0.021 * $2, 0.032 * $1 - 0.019 * $2'
linear_3d='0.011 * $1 + 0.021 * $2 - 0.014 * $3, 0.032 * $1 - 0.019 * $2 + 0.007 * $3, 0.005 * $1 - 0.027 * $2 + 0.013 * $3'

# patch DIM ARGUMENTS_OF_IPOINTS QUANTITY LIMIT VOLUME
patch() {
    local dim=$1 sides=xmin,xmax,ymin,ymax linear=$linear_2d
    [ "$dim" -eq 2 ] || { sides+=,zmin,zmax linear=$linear_3d; }
    # shellcheck disable=SC2086 # several arguments
    ipoints $2 "$work/cloud$dim.mts" | shapefn -o "$work/table.mts" 2> /dev/null
    mts print nodes.x "$work/cloud$dim.mts" | awk -v OFMT=%.17g -v dim="$dim" '{
        outer = 0
        for (i = 1; i <= dim; i++) if ($i < 1e-9 || $i > 0.1 - 1e-9) outer = 1
        if (outer) print $0, '"$linear"'
    }' > "$work/linear.tsv"
    dim=$dim scene "$work/patch.scene" <<END
[displacement sides]
facets = $sides
table = linear.tsv
unit = m
[solver]
tolerance = 1e-11
volume = $5
END
    relax "$work/patch.scene" "$work/table.mts" "$work/u.dat"
    row 1 "$3" "$(paste <(mts print nodes.x "$work/u.dat") <(mts print u "$work/u.dat") | awk -v dim="$dim" '
        {
            split(sprintf(dim == 2 ? "%.17g %.17g" : "%.17g %.17g %.17g", '"$linear"'), exact, " ")
            size = error = 0
            for (i = 1; i <= dim; i++) { size += exact[i]^2; error += ($(dim + i) - exact[i])^2 }
            if (size > largest) largest = size
            if (!(error <= worst)) worst = error
        }
        END { print (NR > 0 ? sqrt(worst / largest) : "nan") }')" 0 "$4"
}

cloud -d 2 -k jittered -n 13 --jitter 0.25 --seed 3 --box 0,0.1,0,0.1 -o "$work/cloud2.mts"
cloud -d 3 -k jittered -n 9 --jitter 0.15 --seed 3 --box 0,0.1,0,0.1,0,0.1 -o "$work/cloud3.mts"
for dim in 2 3; do
    patch $dim -c "patch test ${dim}D, smoothed cells" patch-cells nodal
    # The others are not exact, here or elsewhere: this records by how much.
    for points in $([ $dim -eq 2 ] && echo 1 3 4 6 7 12 || echo 1 4); do
        patch $dim "-g $points" "patch test ${dim}D, $points point$([ "$points" -eq 1 ] || echo s) per cell" patch-points pointwise
    done
done

# ---- consistency ----

# consistency SCHEME DIM BOX ARGUMENTS_OF_IPOINTS: the largest errors of sum phi = 1, sum grad phi = 0 (times the
# spacing), sum phi x = x (relative to the largest coordinate) and sum grad phi (x_j - x) = 1 over a scattered cloud.
consistency() {
    local dim=$2 section
    # shellcheck disable=SC2086
    cloud -d "$dim" -k jittered -n $((dim == 2 ? 13 : 7)) --jitter 0.15 --seed 5 --box "$3" | ipoints $4 | shapefn -o "$work/table.mts" 2> /dev/null
    for section in nodes.x points.x points.weight faces faces.cell faces.edge nbr.ptr nbr.idx shape.phi shape.dphi edge.ptr edge.idx edge.phi; do
        mts print $section "$work/table.mts" > "$work/$section" 2> /dev/null || : > "$work/$section"
    done
    row 1 "consistency, $1" "$(awk -v dim="$dim" -v work="$work" -v cells=$((dim == 2 ? 12 : 6)) '
        function load(name, array, columns,    i, k) {
            for (i = 0; (getline < (work "/" name)) > 0; i++) for (k = 1; k <= columns; k++) array[i, k] = $k
            return i
        }
        function worse(old, new) { return new < 0 ? worse(old, -new) : new <= old ? old : new }
        # The sums of phi, phi x, grad phi and grad phi (x - at), of point q.
        function at_point(q,    k, a, b) {
            for (k = ptr[q, 1]; k < ptr[q + 1, 1]; k++) {
                unity[q] += phi[k, 1]
                for (a = 1; a <= dim; a++) {
                    moment[q, a] += phi[k, 1] * x[idx[k, 1], a]
                    zero[q, a] += dphi[k, a]
                    for (b = 1; b <= dim; b++) gradient[q, a, b] += dphi[k, a] * (x[idx[k, 1], b] - at[q, b])
                }
            }
        }
        # The same of a cell from the averages over its faces, the means of rows, in 3D on the boundary one of its own: what face f adds
        # to a cell on one side of it.
        function from_face(f, q, side,    r, k, a, b, sum, first, normal, u, v, rows) {
            rows = dim == 2 || cell[f, 2] < 0 ? 1 : 3
            if (rows == 1) of_face[f, 1] = dim == 2 ? f : edges + f
            for (r = 1; r <= rows; r++) for (k = ptr[of_face[f, r], 1]; k < ptr[of_face[f, r] + 1, 1]; k++) {
                sum += phi[k, 1] / rows
                for (a = 1; a <= dim; a++) first[a] += phi[k, 1] * x[idx[k, 1], a] / rows
            }
            for (a = 1; a <= dim; a++) {
                u[a] = x[face[f, 2], a] - x[face[f, 1], a]
                v[a] = dim == 3 ? x[face[f, 3], a] - x[face[f, 1], a] : 0
            }
            if (dim == 2) {
                normal[1] = u[2]
                normal[2] = -u[1]
            } else for (a = 1; a <= 3; a++) normal[a] = (u[a % 3 + 1] * v[(a + 1) % 3 + 1] - u[(a + 1) % 3 + 1] * v[a % 3 + 1]) / 2
            unity[q] += sum / (dim + 1)
            for (a = 1; a <= dim; a++) {
                moment[q, a] += first[a] / (dim + 1)
                zero[q, a] += side * normal[a] * sum / volume[q, 1]
                for (b = 1; b <= dim; b++) gradient[q, a, b] += side * normal[a] * (first[b] - sum * at[q, b]) / volume[q, 1]
            }
        }
        BEGIN {
            n = load("nodes.x", x, dim)
            points = load("points.x", at, dim)
            if (load("edge.ptr", ptr, 1) > 0) {
                load("points.weight", volume, 1)
                load("edge.idx", idx, 1)
                load("edge.phi", phi, 1)
                faces = load("faces", face, dim)
                load("faces.cell", cell, 2)
                load("faces.edge", of_face, 3)
                for (f = 0; f < faces && dim == 3; f++) for (r = 1; r <= 3; r++) if (of_face[f, r] >= edges) edges = of_face[f, r] + 1
                for (f = 0; f < faces; f++) {
                    from_face(f, cell[f, 1], 1)
                    if (cell[f, 2] >= 0) from_face(f, cell[f, 2], -1)
                }
            } else {
                load("nbr.ptr", ptr, 1)
                load("nbr.idx", idx, 1)
                load("shape.phi", phi, 1)
                load("shape.dphi", dphi, dim)
                for (q = 0; q < points; q++) at_point(q)
            }
            for (i = 0; i < n; i++) for (a = 1; a <= dim; a++) {
                size = worse(size, x[i, a])
                if (i == 0 || x[i, 1] < low) low = x[i, 1]
                if (i == 0 || x[i, 1] > high) high = x[i, 1]
            }
            spacing = (high - low) / cells
            worst = 0
            for (q = 0; q < points; q++) {
                worst = worse(worst, unity[q] - 1)
                for (a = 1; a <= dim; a++) {
                    worst = worse(worse(worst, zero[q, a] * spacing), (moment[q, a] - at[q, a]) / size)
                    for (b = 1; b <= dim; b++) worst = worse(worst, gradient[q, a, b] - (a == b))
                }
            }
            print worst
        }')" 0 consistency
}

for scheme in 'smoothed cells:-c' '4 points per cell:-g 4'; do
    for dim in 2 3; do
        z=$([ $dim -eq 2 ] || echo z)
        consistency "${dim}D, ${scheme%:*}, in m" $dim "0,0.1,0,0.1${z:+,0,0.1}" "${scheme#*:}"
        consistency "${dim}D, ${scheme%:*}, in mm" $dim "0,100,0,100${z:+,0,100}" "${scheme#*:}"
        consistency "${dim}D, ${scheme%:*}, 1 m away" $dim "1,1.1,1,1.1${z:+,1,1.1}" "${scheme#*:}"
    done
done
