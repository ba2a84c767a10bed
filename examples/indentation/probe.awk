# The lower cap of a ball of radius R that rests on the origin, triangles a b c in a row, mm, normals outward:
# awk -v R=10 -v rim=4 -v rings=24 -v sectors=32 -f probe.awk > probe.tsv
BEGIN {
    pi = atan2(0, -1)
    for (i = 0; i < rings; i++)
        for (k = 0; k < sectors; k++) {
            triangle(i, k, i + 1, k + 1, i + 1, k)
            if (i > 0) triangle(i, k, i, k + 1, i + 1, k + 1)
        }
}
function triangle(i, a, j, b, k, c) { print vertex(i, a), vertex(j, b), vertex(k, c) }
function vertex(i, k,    r, angle) {
    r = rim * i / rings
    angle = 2 * pi * (k % sectors) / sectors
    return sprintf("%.9g %.9g %.9g", r * cos(angle), r * sin(angle), R - sqrt(R^2 - r^2))
}
