# Displacements of an infinite plate with a slit of half length 10 mm along x, under sigma along x and y (Westergaard 1939), on the
# square of 80 mm around it: rows x y u v, mm. With Z = s z / w, w = sqrt(z^2 - a^2): 2 G u = (k - 1) / 2 Re s w - y Im Z and
# 2 G v = (k + 1) / 2 Im s w - y Re Z, k = 3 - 4 nu.
BEGIN {
    OFMT = "%.17g"; OFS = "\t"
    nu = 0.3; s = 1e-4 * 2 * (1 + nu) # sigma / G
    for (i = -200; i <= 200; i++) {
        put(i / 5, -40); put(i / 5, 40)
        if (i * i < 40000) { put(-40, i / 5); put(40, i / 5) }
    }
}

function put(x, y,    re, im, size, angle, wr, wi, zr, zi) {
    re = x * x - y * y - 100; im = 2 * x * y
    size = sqrt(sqrt(re * re + im * im)); angle = atan2(im, re) / 2
    wr = size * cos(angle); wi = size * sin(angle)
    if (wr * x + wi * y < 0) { wr = -wr; wi = -wi } # on the side of z
    zr = (x * wr + y * wi) / (size * size); zi = (y * wr - x * wi) / (size * size)
    print x, y, s / 2 * ((1 - 2 * nu) * wr - y * zi), s / 2 * ((2 - 2 * nu) * wi - y * zr)
}
