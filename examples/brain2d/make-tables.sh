#!/bin/bash
# Make load.tsv and skull.tsv, the two tables of brain2d.scene, from brain2d.geo. Run by hand: its output is
# kept beside it, so that a run of the scene needs neither gmsh nor this script.
#
# Both follow the curves of the .geo (splines) in steps of about 1 mm, walking counter-clockwise, the brain on the left.
set -euo pipefail
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The .geo asks for version 4.1 of the mesh file; version 2.2 says of each element which group it is in.
printf 'Include "%s";\nMesh.MshFileVersion = 2.2;\n' "$PWD/brain2d.geo" > "$work/curves.geo"

# curve GROUP ARGUMENT...: the points of a physical curve of brain2d.geo, one "x y" per line (mm), in order.
curve() {
    local group=$1
    shift
    gmsh -1 "$work/curves.geo" -setnumber lc 1.64 -setnumber kb 0.63 "$@" -o "$work/curves.msh" > "$work/log" ||
        { cat "$work/log" >&2; return 1; }
    awk -v group="$group" '
        /^\$/                { part = $1; next }
        part == "$Nodes"     { x[$1] = $2; y[$1] = $3 }
        part == "$Elements" && $2 == 1 && $4 == group {
            if (!started++) print x[$(NF - 1)], y[$(NF - 1)]
            else if ($(NF - 1) != end) { print "make-tables: the curve is not one piece" > "/dev/stderr"; exit 1 }
            end = $NF
            print x[end], y[end]
        }' "$work/curves.msh"
}

# The craniotomy: the cortex sinks by 8 mm along the inward normal of the opening's chord, as half a sine along the chord.
curve 12 | awk '
    BEGIN {
        pi = atan2(0, -1)
        ax = 69.1628; ay = -16.3320             # ends of the chord, mm
        bx = 49.0024; by = 45.5713
        length2 = (bx - ax)^2 + (by - ay)^2
        nx = 0.95085; ny = 0.30967              # outward normal of the chord
        depth = 8                               # mm
        print "# Displacement prescribed at the craniotomy: u = -8 mm sin(pi s) n, s the position along the chord, 0..1."
        print "# x_mm\ty_mm\tux_mm\tuy_mm"
    }
    {
        s = (($1 - ax) * (bx - ax) + ($2 - ay) * (by - ay)) / length2
        s = s < 0 ? 0 : s > 1 ? 1 : s
        u = depth * sin(pi * s)
        if (u < 1e-9) u = 0                     # sin(pi) is not quite zero
        printf "%.6f\t%.6f\t%.6f\t%.6f\n", $1, $2, u ? -u * nx : 0, u ? -u * ny : 0
    }' > load.tsv

curve 14 -setnumber part 1 | awk '
    BEGIN {
        print "# Inner skull without the bone flap: one open curve, counter-clockwise, the brain on its left."
        print "# x_mm\ty_mm"
    }
    { printf "%.6f\t%.6f\n", $1, $2 }' > skull.tsv
