#!/bin/bash
# One body, a ball held at one opening and pressed in at the other, meshed by gmsh and from a label image with as many nodes, three
# sizes each: bash meshes.sh IMAGE > meshes.tsv. `off` is the mean distance from a solution on a fine mesh of gmsh, `apart` the mean
# distance from the three of gmsh, other than itself, both in mm.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
image=$(realpath "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# solve NAME: NAME.mts to NAME.dat.
solve() {
    cat > "$1.scene" << END
[scene]
dim = 3
analysis = quasi-static
[material all]
region = $(mts list "$1.mts" | sed -nE 's/^cells\.region.*names=([^ ,]*).*/\1/p')
model = neo-hookean
E = 3000
nu = 0.49
rho = 1000
[displacement bottom]
facets = bottom
components = 0, 0, 0
[displacement top]
facets = top
components = 0.001, 0, -0.004
[solver]
tolerance = 1e-5
END
    mtled -q "$1.scene" "$1.mts" > "$1.dat" 2> "$1.log" || { cat "$1.log" >&2; exit 1; }
}

# of_gmsh NAME SIZE and of_image NAME SPACING
of_gmsh() {
    gmsh -3 -v 1 -nt 1 -setnumber h "$2" "$here/ball.geo" -o "$1.msh" > /dev/null
    nodes -u mm "$1.msh" > "$1.mts" 2> "$1.log" || { cat "$1.log" >&2; exit 1; }
    solve "$1"
}
of_image() {
    voxels -h "$2mm" --part top=ball:0,0,28mm,14mm --part bottom=ball:0,0,-28mm,16mm "$image" > "$1.mts"
    solve "$1"
}
mean() { fieldcmp --skip-outside "$1.dat" "$2.dat" | awk -F '\t' '$1 == "avg" { print 1e3 * $2; found = 1 } END { exit !found }'; }

of_gmsh fine 1.8
for size in 4.8 5 5.2; do of_gmsh "gmsh-$size" $size; done
for spacing in 6.2 6.4 6.6; do of_image "image-$spacing" $spacing; done
printf 'mesh\tnodes\toff_mm\tapart_mm\n'
for name in gmsh-{4.8,5,5.2} image-{6.2,6.4,6.6}; do
    apart=()
    for other in gmsh-{4.8,5,5.2}; do
        [ "$name" = "$other" ] || { one=$(mean "$name" "$other"); apart+=("$one"); }
    done
    off=$(mean "$name" fine)
    nodes=$(mts list "$name.dat" | awk -F '\t' '$1 == "nodes.x" { print $3 }')
    printf '%s\n' "${apart[@]}" | awk -v OFS='\t' -v name="$name" -v nodes="$nodes" -v off="$off" '
        { sum += $1 } END { print name, nodes, sprintf("%.4f", off), sprintf("%.4f", sum / NR) }'
done
