# Triangles of a blade through and in a body about a point: planes, ending inside, curved, crossing an interface, along a face of cells, nearly
# so, tangent to the top, a bowl tangent to it, branching, bent. -v n=0..19 -v seed= -v mid="X Y Z" -v size= (m)
function put(u, v, w,  i) { for (i = 0; i < 3; i++) printf "%.10g ", c[i] + u * e[i] + v * f[i] + w * g[i] }
function triangle(a, b, d, h, i, j, k, l, m) { put(a, b, d); put(h, i, j); put(k, l, m); print "" }
function square(w,  r) { triangle(-w, -w, 0, w, -w, 0, w, w, 0); triangle(-w, -w, 0, w, w, 0, -w, w, 0) }
function height(u, v) { return n < 17 ? bend * (u * u - .3 * v * v) / size : .9 * size - sqrt(.81 * size * size - u * u - v * v) }
function patch(w, s,  i, j, u, v, h) { h = 2 * w / s
    for (i = 0; i < s; i++) for (j = 0; j < s; j++) { u = -w + i * h; v = -w + j * h
        triangle(u, v, height(u, v), u + h, v, height(u + h, v), u + h, v + h, height(u + h, v + h))
        triangle(u, v, height(u, v), u + h, v + h, height(u + h, v + h), u, v + h, height(u, v + h)) } }
BEGIN { srand(seed); split(mid, m, " "); straight = n >= 13 && n < 18
    for (i = 0; i < 3; i++) { c[i] = m[i + 1] + (straight ? 0 : (rand() - .5) * .3 * size); e[i] = straight ? i == 0 : rand() - .5; f[i] = straight ? i == 1 : rand() - .5 }
    if (n == 14) { e[2] = .01; f[2] = .008 }
    s = sqrt(e[0]^2 + e[1]^2 + e[2]^2); for (i = 0; i < 3; i++) e[i] /= s
    s = e[0] * f[0] + e[1] * f[1] + e[2] * f[2]; for (i = 0; i < 3; i++) f[i] -= s * e[i]
    s = sqrt(f[0]^2 + f[1]^2 + f[2]^2); for (i = 0; i < 3; i++) f[i] /= s
    for (i = 0; i < 3; i++) g[i] = e[(i + 1) % 3] * f[(i + 2) % 3] - e[(i + 2) % 3] * f[(i + 1) % 3]
    if (n >= 15 && n < 18) c[2] += (n == 15 ? .96 : .92) * size / 2
    bend = .3 + .9 * rand()
    if (n < 4) square(2 * size); else if (n < 7) square(.3 * size); else if (n < 9) patch(size, 12); else if (n < 11) patch(.35 * size, 12)
    else if (n < 13) square(.5 * size); else if (n < 17) square(2 * size); else if (n == 17) patch(.5 * size, 12)
    else { w = .35 * size
        triangle(-w, -w, 0, 0, -w, 0, 0, w, 0); triangle(-w, -w, 0, 0, w, 0, -w, w, 0); triangle(0, -w, 0, 0, -w, w, 0, w, w); triangle(0, -w, 0, 0, w, w, 0, w, 0)
        if (n == 18) { triangle(0, -w, 0, w, -w, 0, w, w, 0); triangle(0, -w, 0, w, w, 0, 0, w, 0) } } }
