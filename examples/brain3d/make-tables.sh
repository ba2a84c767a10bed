#!/bin/bash
# Make load.tsv and skull.tsv, the two tables of brain3d.scene, from the geometry. Run by hand: its output is
# kept beside it, so that a run of the scene needs neither gmsh nor this script.
set -euo pipefail
cd "$(dirname "$0")"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp brain3d.geo brain3d_skull.geo "$work"
for surfaces in brain3d_surfaces brain3d_skull_surfaces; do
    gzip -dc $surfaces.msh.gz > "$work/$surfaces.msh"
done

# mesh GEOMETRY SIZE: its surfaces as triangles. The .geo asks for version 4.1 of the mesh file; version 2.2 says of each
# element which group it is in.
mesh() {
    printf 'Include "%s";\nMesh.MshFileVersion = 2.2;\n' "$work/$1" > "$work/surfaces.geo"
    gmsh -2 "$work/surfaces.geo" -setnumber lc "$2" -o "$work/surfaces.msh" > "$work/log" ||
        { cat "$work/log" >&2; return 1; }
}

# of_group GROUP: the program given as second argument, with the nodes x[], y[], z[], called for the triangles a b c.
of_group() {
    awk -v group="$1" '
        /^\$/                { part = $1; next }
        part == "$Nodes"     { x[$1] = $2; y[$1] = $3; z[$1] = $4 }
        part != "$Elements" || $2 != 2 || $4 != group { next }
        { a = $(NF - 2); b = $(NF - 1); c = $NF }
        '"$2" "$work/surfaces.msh"
}

# The craniotomy: its points are pressed in along the inward normal of the opening, by half a cosine over its radius.
mesh brain3d.geo 3
of_group 12 '
    BEGIN {
        print "# Displacement prescribed at the craniotomy: u = -10 mm (1 + cos(pi r/R))/2 n, r the distance from the axis."
        print "# x_mm\ty_mm\tz_mm\tux_mm\tuy_mm\tuz_mm"
        pi = atan2(0, -1)
        cx = 63.472; cy = 16.069; cz = 19.997   # centre of the opening, mm
        nx = 0.9798; ny = 0.1591; nz = 0.1212   # its outward normal
        R = 33; depth = 10                      # mm
    }
    function point(i,    dx, dy, dz, along, r, u) {
        if (i in seen) return
        seen[i] = 1
        dx = x[i] - cx; dy = y[i] - cy; dz = z[i] - cz
        along = dx * nx + dy * ny + dz * nz
        r = sqrt(dx^2 + dy^2 + dz^2 - along^2)
        u = r < R ? -depth * (1 + cos(pi * r / R)) / 2 : 0
        printf "%.4f\t%.4f\t%.4f\t%.6f\t%.6f\t%.6f\n", x[i], y[i], z[i], u * nx, u * ny, u * nz
    }
    { point(a); point(b); point(c) }' > load.tsv

# The inner skull, the flap taken out: triangles whose right-hand normals point away from the brain.
mesh brain3d_skull.geo 6
of_group 14 '
    BEGIN {
        print "# Inner skull without the bone flap: triangles, the brain behind them (right-hand normals point outward)."
        print "# ax_mm\tay\taz\tbx\tby\tbz\tcx\tcy\tcz"
    }
    function corner(i) { return sprintf("%.3f\t%.3f\t%.3f", x[i], y[i], z[i]) }
    { print corner(a) "\t" corner(b) "\t" corner(c) }' > skull.tsv
