#!/bin/bash
# pipe.sh NODES FOLDER [BRAIN]: the whole pipe to a tolerance of 1e-4, one stage after the other through files, each removed when the next stage has
# read it: on a cube of about so many nodes, compressed by 1 % between plates, or, with BRAIN, the folder of the whole brain's geometry and scene,
# on that brain. A row of FOLDER/pipe.rows for each stage. Called again, it goes on behind the last stage that is there. What the stages say is in
# FOLDER/*.log.
set -eu -o pipefail
folder=$2
brain=${3-}
here=$(dirname "$0")
n=$(awk -v nodes="$1" 'BEGIN { printf "%.0f", nodes ^ (1 / 3) }')
nodes=$((n * n * n))
scene=$folder/cube.scene
rows=$folder/pipe.rows
mkdir -p "$folder"
touch "$rows"

free=$(df --output=avail -B 1000 "$folder" | tail -n 1)
if ! [ -s "$folder/shapefn.mts" ] && [ "$free" -lt $((12 * nodes)) ]; then
    echo "pipe.sh: $folder: $((free / 1000000)) GB are free: $nodes nodes need $((12 * nodes / 1000000 + 1)) GB: set OUT to a folder on another disk" >&2
    exit 3
fi

# stage NAME INPUT COMMAND...: as FOLDER/NAME.mts, unless its row is there.
stage() {
    local name=$1 input=$2 seconds wall peak anonymous bytes status
    shift 2
    ! grep -q "^$name	" "$rows" || return 0
    IFS=$'\t' read -r seconds wall peak anonymous bytes status < <(python3 "$here/measured.py" "$folder/$name.mts" "$input" "$@")
    [ "$status" -eq 0 ] || { cat "$folder/$name.mts.log" >&2; echo "pipe.sh: $name: status $status" >&2; exit 1; }
    awk -F '\t' -v OFS='\t' -v stage="$name" -v nodes=$nodes -v seconds="$seconds" -v wall="$wall" -v peak="$peak" -v anonymous="$anonymous" \
        -v bytes="$bytes" '$1 == "steps" { steps = $2 } END {
        printf "%s\t%d\t%.0f\t%.0f\t%.1f\t%.0f\t%.0f\t%.0f\t%.2f\t%s\n", stage, nodes, seconds, wall, 1e6 * seconds / nodes, bytes / nodes, \
            peak / nodes, anonymous / nodes, peak / 1e9, steps != "" ? steps : "-" }' "$folder/$name.mts.log" >> "$rows"
    [ "$input" = - ] || rm "$input"
}

if [ -z "$brain" ]; then
    printf '%s\n' '[scene]' 'dim = 3' 'analysis = quasi-static' '[material body]' 'region = body' 'E = 3000' 'nu = 0.49' 'rho = 1000' \
        '[displacement bottom]' 'facets = zmin' 'components = 0, 0, 0' '[displacement top]' 'facets = zmax' 'components = 0, 0, -0.001' \
        '[solver]' 'tolerance = 1e-4' > "$scene"
    stage cloud - cloud -d 3 -k jittered --jitter 0.15 -n "$n" --box 0,0.1,0,0.1,0,0.1
    cloud=$folder/cloud.mts
else
    scene=$brain/brain3d.scene
    if [ ! -s "$folder/brain.msh" ]; then
        cp "$brain/brain3d.geo" "$folder"
        gzip -dc "$brain/brain3d_surfaces.msh.gz" > "$folder/brain3d_surfaces.msh"
        # The size of the cells far inside: 139 mm over the cube root of the nodes, so that a million are asked for and come.
        gmsh -3 -nt 1 -v 2 -bin "$folder/brain3d.geo" -setnumber lc "$(awk -v n="$n" 'BEGIN { print 139 / n }')" -o "$folder/new.msh" >&2
        mv "$folder/new.msh" "$folder/brain.msh"
    fi
    nodes=$(nodes -v -u mm "$folder/brain.msh" 2>&1 > /dev/null | awk '$3 == "nodes," { print $2; exit }')
    stage nodes - nodes -u mm "$folder/brain.msh"
    cloud=$folder/nodes.mts
fi
stage ipoints "$cloud" ipoints
stage support "$folder/ipoints.mts" support
stage shapefn "$folder/support.mts" shapefn
stage mtled "$folder/shapefn.mts" mtled -v -q "$scene"
