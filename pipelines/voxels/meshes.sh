#!/bin/bash
# One body meshed by gmsh and from a label image with about as many nodes, of several sizes: bash meshes.sh BODY PHANTOM FILLED > BODY.tsv, with
# the programs that make images. `off_mm` is the mean distance of a solution from a reference, `apart_mm` its mean distance from
# the solutions on the meshes of gmsh, other than itself.
#
# ball: held at one opening and pressed in at the other; the reference is that of a fine mesh of gmsh.
# brain: the whole brain without its skull, of examples/brain3d; the reference is of mixed elements. The image is filled from the surfaces
# that gmsh meshes anew; the craniotomy are the facets along its surface.
#
# The brain's sizes are 4 to 6 % apart: gmsh meshes a surface anew, with the rims on it, only where the number of nodes on these changes.
set -euo pipefail
export LC_ALL=C
here=$(cd "$(dirname "$0")" && pwd)
body=$1
phantom=$(realpath "$2") filled=$(realpath "$3")
brain3d=$here/../../examples/brain3d
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# told COMMAND...: what it says is shown where it fails.
told() { "$@" 2> said || { cat said >&2; exit 1; }; }

prepare_ball() {
    length=h
    of_image=()
    sizes=(4.6 4.7 4.8 4.9 5 5.1 5.2 5.3 5.4)
    spacings=(6.2 6.35 6.5 6.65 6.8 6.95 7.1 7.25 7.4)
    cp "$here/ball.geo" body.geo
    cp "$here/ball.scene" body.scene
    "$phantom" sphere 1 0.75 > body.nii.gz
    printf '1 ball\n' > names
    groups=(-f 'top=ball:0,0,28,14' -f 'bottom=ball:0,0,-28,16')
    of_gmsh fine 1.8
    mv fine.dat reference.dat
}

prepare_brain() {
    length=lc
    sizes=(12.4 13.1 13.8 14.6 15.4)
    spacings=(16 16.7 17.4 18.1 18.8)
    gzip -dc "$brain3d/brain3d_surfaces.msh.gz" > brain3d_surfaces.msh
    gzip -dc "$brain3d/brain3d_free.tsv.gz" | awk -f "$here/../reference.awk" > reference.dat
    cp "$brain3d/brain3d.geo" body.geo
    cp "$brain3d/free.scene" body.scene
    cp "$brain3d/load.tsv" .
    triangles brain 1 100
    triangles ventricles 201 218
    triangles tumour 301 306
    triangles craniotomy 100 100
    "$filled" 1 1 brain.tsv 3 ventricles.tsv 2 tumour.tsv > body.nii.gz
    printf '1 brain\n2 tumour\n3 ventricles -\n' > names
    # gmsh's meshes are finer there, too.
    of_image=(--fine "9.5mm:ventricles,tumour")
    groups=(-f 'craniotomy=along:2,craniotomy.tsv')
}

# triangles NAME FIRST LAST: of the brain's surfaces of these numbers
triangles() { awk -f "$here/surface.awk" -v first="$2" -v last="$3" brain3d_surfaces.msh > "$1.tsv"; }

# of_gmsh NAME SIZE and of_image NAME SPACING: NAME.dat
of_gmsh() {
    gmsh -3 -v 1 -nt 1 -setnumber "$length" "$2" body.geo -o "$1.msh" > /dev/null
    told nodes -u mm "$1.msh" > "$1.mts"
    told mtled -q body.scene "$1.mts" > "$1.dat"
}
of_image() {
    told voxels -h "$2mm" -l names "${of_image[@]}" body.nii.gz > "$1.voxels"
    told tag -u mm "${groups[@]}" "$1.voxels" > "$1.mts"
    told mtled -q body.scene "$1.mts" > "$1.dat"
}
mean() { told fieldcmp --skip-outside "$1.dat" "$2.dat" | awk -F '\t' '$1 == "avg" { print 1e3 * $2; found = 1 } END { exit !found }'; }

"prepare_$body"
for size in "${sizes[@]}"; do of_gmsh "gmsh-$size" "$size"; done
for spacing in "${spacings[@]}"; do of_image "image-$spacing" "$spacing"; done
printf 'body\tmesh\tsize_mm\tnodes\toff_mm\tapart_mm\n'
for name in "${sizes[@]/#/gmsh-}" "${spacings[@]/#/image-}"; do
    apart=()
    for other in "${sizes[@]/#/gmsh-}"; do
        [ "$name" = "$other" ] || { one=$(mean "$name" "$other"); apart+=("$one"); }
    done
    off=$(mean "$name" reference)
    nodes=$(mts list "$name.dat" | awk -F '\t' '$1 == "nodes.x" { print $3 }')
    printf '%s\n' "${apart[@]}" | awk -v OFS='\t' -v body="$body" -v name="$name" -v nodes="$nodes" -v off="$off" '
        { sum += $1 } END { sub(/-/, OFS, name); print body, name, nodes, sprintf("%.4f", off), sprintf("%.4f", sum / NR) }'
done
