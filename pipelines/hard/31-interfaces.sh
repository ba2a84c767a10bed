#!/bin/bash
# Row 31: interfaces between materials of unequal stiffness, at which supports stop. Layers in series and side by side
# deform piecewise homogeneously: exact in every cell. A ball of three layers under pressure: Lame's solution.
. "$(dirname "$0")/common.sh"
geometries=$(dirname "$0")/../../examples/hard

# materials NAME YOUNGS NU ...: sections of a scene.
materials() {
    while [ $# -gt 0 ]; do
        printf '[material %s]\nregion = %s\nE = %s\nnu = %s\nrho = 1000\n' "$1" "$1" "$2" "$3"
        shift 3
    done
}

# layers DIM QUANTITY SLIDING PUSHED PUSH: the sides that slide, and that which is pushed. The largest deviation of a stress from the
# mean over its layer, relative to the largest stress of the layer.
layers() {
    {
        printf '[scene]\ndim = %s\nanalysis = quasi-static\n' "$1"
        materials left 3000 0.49 middle 30000 0.3 right 9000 0.45
        printf '[displacement sliding]\nfacets = %s\nnormal = 0\n[displacement pushed]\nfacets = %s\nnormal = %s\n' "$3" "$4" "$5"
        printf '[output]\nstress = yes\n[solver]\ntolerance = 1e-11\n'
    } > "$work/layers.scene"
    relax "$work/layers.scene" "$work/layers$1.mts" "$work/u.dat"
    row 31 "$2 of three materials, ${1}D: largest unevenness of the stress in a layer" \
        "$(paste <(mts print cells.region "$work/u.dat") <(mts print stress "$work/u.dat") | awk '
        NF < 5 { bad = 1 }
        {
            n[$1]++
            for (k = 2; k <= NF; k++) {
                sum[$1, k] += $k
                if (n[$1] == 1 || $k < least[$1, k]) least[$1, k] = $k
                if (n[$1] == 1 || $k > most[$1, k]) most[$1, k] = $k
            }
        }
        END {
            for (layer in n) {
                size = uneven = 0
                for (k = 2; k <= NF; k++) {
                    mean = sum[layer, k] / n[layer]
                    if (mean ^ 2 > size ^ 2) size = mean
                    if (most[layer, k] - mean > uneven) uneven = most[layer, k] - mean
                    if (mean - least[layer, k] > uneven) uneven = mean - least[layer, k]
                }
                uneven /= size < 0 ? -size : size
                if (uneven > worst) worst = uneven
            }
            print bad || NR == 0 ? "nan" : worst
        }')" 0 layers
}

gmsh -2 -v 1 "$geometries/layers.geo" -o "$work/layers2.msh" > /dev/null
gmsh -3 -v 1 -setnumber depth 40 -setnumber h 12 "$geometries/layers.geo" -o "$work/layers3.msh" > /dev/null
for dim in 2 3; do
    nodes -u mm "$work/layers$dim.msh" | ipoints | support | shapefn > "$work/layers$dim.mts"
done
layers 2 series xmin,ymin,ymax xmax -0.01
layers 3 series xmin,ymin,ymax,zmin,zmax xmax -0.01
layers 2 laminate xmin,ymin ymax -0.006
layers 3 laminate xmin,ymin,zmin,zmax ymax -0.006

# ---- a ball ----

gmsh -3 -v 1 -setnumber h 0.0071 "$geometries/ball.geo" -o "$work/ball.msh" > /dev/null
nodes -u m "$work/ball.msh" | ipoints | support | shapefn > "$work/ball.mts"
at_most 31 "ball of three layers: nodes" "$(count ball)" ball-nodes
for nu in 0.3 0.49; do
    {
        printf '[scene]\ndim = 3\nanalysis = quasi-static\n'
        materials core 30000 $nu shell 3000 $nu outer 10000 $nu
        printf '[displacement planes]\nfacets = planes\nnormal = 0\n[pressure all]\nfacets = surface\nvalue = 1\n'
        printf '[output]\nstress = yes\n[solver]\ntolerance = 1e-6\n'
    } > "$work/ball.scene"
    relax "$work/ball.scene" "$work/ball.mts" "$work/u.dat"
    while IFS=$'\t' read -r quantity error; do
        row 31 "ball of three layers, nu $nu: $quantity" "$error" 0 ball
    done < <(awk -f "$(dirname "$0")/../stream.awk" -f "$(dirname "$0")/ball.awk" -v field="$work/u.dat" \
        -v layers="core 0.04 30000 $nu, shell 0.07 3000 $nu, outer 0.1 10000 $nu" -v pressure=1)
done
