# Of a ventricle: awk -f ventricle.awk prints points of the wall in mm, 41 inside and 41 outside, from apex to base in the plane y = 0;
# with rows of these and their displacements in m, as interp gives them, awk -v rows=deformed -f ventricle.awk FILE prints radius and height
# of each, mm, a blank line between inside and outside; and -v rows=chamber: the volume of the chamber, ml, the height of the apex inside
# and outside, mm.
BEGIN {
    n = 41; pi = atan2(0, -1)
    if (rows == "") for (side = 0; side < 2; side++) {
        short = 7 + 3 * side; long = 17 + 3 * side; most = pi - atan2(sqrt(1 - (5 / long) ^ 2), 5 / long)
        for (i = 0; i < n; i++) printf "%.6g 0 %.6g\n", short * sin(i / (n - 1) * most), -long * cos(i / (n - 1) * most)
    }
    if (rows == "") exit
}
{ r[NR] = 1e3 * sqrt(($1 + $4) ^ 2 + ($2 + $5) ^ 2); z[NR] = 1e3 * ($3 + $6) }
END {
    if (rows == "deformed") for (i = 1; i <= NR; i++) printf "%s%.6g %.6g\n", (i == n + 1 ? "\n" : ""), r[i], z[i]
    if (rows != "chamber") exit
    # Frusta of cones between the points.
    for (i = 2; i <= n; i++) volume += pi / 3 * (z[i] - z[i - 1]) * (r[i] ^ 2 + r[i] * r[i - 1] + r[i - 1] ^ 2)
    printf "%.4f\t%.3f\t%.3f\n", volume / 1e3, z[1], z[n + 1]
}
