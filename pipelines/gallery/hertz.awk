# indentation.tsv: mts print reactions.frames u.dat | awk -f hertz.awk
#
# Depth, mm; force on the ball, N; that of Hertz, 4/3 E/(1 - nu^2) sqrt(R) d^1.5, the limit of small loads on a half space, and the ratio to
# it; the ratio to Hertz where the body is held at 120 mm: that takes F (1 + nu)(3 - 2 nu)/(2 pi E 120 mm), what the half space sinks there.

BEGIN { OFS = "\t"; E = 3000; nu = 0.45; R = 0.01; held = 0.12; pi = atan2(0, -1); print "depth_mm", "force_N", "hertz_N", "ratio", "ratio_held" }
$1 > 0 {
    d = 0.0006 * $1
    force = 4 * sqrt($NF^2)
    whole = hertz(d)
    bounded = whole
    for (i = 0; i < 20; i++) bounded = hertz(d + bounded * (1 + nu) * (3 - 2 * nu) / (2 * pi * E * held))
    printf "%.3f\t%.6f\t%.6f\t%.4f\t%.4f\n", 1e3 * d, force, whole, force / whole, force / bounded
}
function hertz(d) { return 4 / 3 * E / (1 - nu^2) * sqrt(R) * d^1.5 }
