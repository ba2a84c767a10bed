# Triangles of a mesh of gmsh (MSH 2), rows of nine numbers: awk -f surface.awk -v first=TAG -v last=TAG MESH, those of surfaces with such tags.
# -v along=X,Y,Z: the prism instead that the surface sweeps out from X,Y,Z inward to twice that outward.

BEGIN { swept = split(along, way, ",") }

/^\$/ { part = $1; next }
part == "$Nodes" { x[$1] = $2; y[$1] = $3; z[$1] = $4 }
part != "$Elements" || $2 != 2 || $5 < first || $5 > last { next }

function corner(node, times) {
    return sprintf("%.9g\t%.9g\t%.9g", x[node] + times * way[1], y[node] + times * way[2], z[node] + times * way[3])
}

# A triangle whose corners are moved by so many times the way.
function triangle(a, times_a, b, times_b, c, times_c) {
    print corner(a, times_a) "\t" corner(b, times_b) "\t" corner(c, times_c)
}

{
    for (i = 1; i <= 3; i++) node[i] = $(NF - 3 + i)
    if (!swept) {
        triangle(node[1], 0, node[2], 0, node[3], 0)
        next
    }
    triangle(node[1], 2, node[2], 2, node[3], 2)
    triangle(node[3], -1, node[2], -1, node[1], -1)
    for (i = 1; i <= 3; i++) edge[node[i], node[i % 3 + 1]] = 1
}

END {
    for (e in edge) {
        split(e, end, SUBSEP)
        if ((end[2], end[1]) in edge) continue
        triangle(end[1], 2, end[1], -1, end[2], -1)
        triangle(end[1], 2, end[2], -1, end[2], 2)
    }
}
