# Nominal stress of brain tissue (Ogden, mu = 842 Pa, alpha = -4.7) in uniaxial compression, incompressible, of a Prony series (g .45, .365; tau
# .5, 50 s): awk -v rate=R -f compression.awk; rows of stretch and stress, Pa. The second Piola-Kirchhoff stress of the isochoric law, along
# and across, is convolved in steps in which it is taken as linear; what is across is taken up by the pressure.
function along(l) { return 4 / 3 * mu / alpha * (l ^ alpha - l ^ (-alpha / 2)) / l ^ 2 }
function across(l) { return -2 / 3 * mu / alpha * (l ^ alpha - l ^ (-alpha / 2)) * l }
BEGIN {
    mu = 842; alpha = -4.7; terms = 2; g[1] = 0.45; tau[1] = 0.5; g[2] = 0.365; tau[2] = 50
    steps = 6000; dt = 0.3 / rate / steps
    for (n = 0; n <= steps; n++) {
        l = 1 - 0.3 * n / steps
        s[1] = along(l); s[2] = across(l)
        for (i = 1; i <= 2; i++) {
            q[i] = 0.185 * s[i]
            for (k = 1; k <= terms; k++) {
                keep = exp(-dt / tau[k])
                if (n > 0) h[i, k] = keep * h[i, k] + g[k] * (1 - keep) * tau[k] / dt * (s[i] - before[i])
                q[i] += h[i, k]
            }
            before[i] = s[i]
        }
        if (n % 100 == 0) printf "%.6g\t%.8g\n", l, l * (q[1] - q[2] / l ^ 3)
    }
}
