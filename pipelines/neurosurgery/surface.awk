# Distance of a surface from where it truly is, mm, without and with prediction:
# awk -f surface.awk -v triangles=FILE TRUE PREDICTED...
#
# The triangles are those of voxels --surface, m; TRUE and PREDICTED... the displacements of their corners, m, in the order of the file, three
# for a triangle. From each corner the distance to the nearest triangle of the other surface is taken, both ways; the Hausdorff distance is
# the larger of the two 95th percentiles, and the share is that of all corners that are no farther than two voxels of 1 mm.

BEGIN {
    n = singles = 0
    while ((getline line < triangles) > 0) {
        if (line ~ /^#/ || split(line, field) < 9) continue
        for (corner = 0; corner < 3; corner++) {
            for (i = 1; i <= 3; i++) x[n, i] = 1e3 * field[3 * corner + i]
            key = x[n, 1] " " x[n, 2] " " x[n, 3]
            if (!(key in seen)) {
                seen[key] = 1
                single[singles++] = n
            }
            n++
        }
    }
}

FNR == 1 { file++ }
{ for (i = 1; i <= 3; i++) u[file, FNR - 1, i] = 1e3 * $i; got[file] = FNR }

END {
    for (f = 1; f <= file; f++) if (got[f] != n) wrong = 1
    if (n == 0 || file < 2 || wrong) {
        print "surface.awk: files are missing, or not of " n " corners" > "/dev/stderr"
        exit 1
    }
    # Place 0: before; place f: after the displacement of file f, the first of which is the true one.
    for (i = 0; i < n; i++) for (k = 1; k <= 3; k++) for (f = 0; f <= file; f++) place[f, i, k] = x[i, k] + (f ? u[f, i, k] : 0)
    for (f = 0; f <= file; f++) {
        if (f == 1) continue
        near = 0
        there = percentile_of_distances(f, 1)
        back = percentile_of_distances(1, f)
        distances = distances sprintf("\t%.2f", there > back ? there : back)
        shares = shares sprintf("\t%.1f", 100 * near / (2 * singles))
    }
    print "surface of the ventricles, 95 % Hausdorff distance, mm" distances
    print "surface of the ventricles within two voxels, %" shares
}

function percentile_of_distances(from, to,    i, j, k, t, d, least, radius, c, distance, sorted) {
    # Each triangle's middle and the radius of the ball about it that holds its corners: those too far need no look.
    for (t = 0; t < n; t += 3) {
        radius[t] = 0
        for (k = 1; k <= 3; k++) c[t, k] = (place[to, t, k] + place[to, t + 1, k] + place[to, t + 2, k]) / 3
        for (j = 0; j < 3; j++) {
            d = sqrt((place[to, t + j, 1] - c[t, 1]) ^ 2 + (place[to, t + j, 2] - c[t, 2]) ^ 2 + (place[to, t + j, 3] - c[t, 3]) ^ 2)
            if (d > radius[t]) radius[t] = d
        }
    }
    for (i = 0; i < singles; i++) {
        for (k = 1; k <= 3; k++) p[k] = place[from, single[i], k]
        least = 1e9
        for (t = 0; t < n; t += 3) {
            d = (p[1] - c[t, 1]) ^ 2 + (p[2] - c[t, 2]) ^ 2 + (p[3] - c[t, 3]) ^ 2
            if (d >= (least + radius[t]) ^ 2) continue
            d = to_triangle(to, t)
            if (d < least) least = d
        }
        if (least <= 2) near++
        for (j = i - 1; j >= 0 && sorted[j] > least; j--) sorted[j + 1] = sorted[j]
        sorted[j + 1] = least
    }
    i = singles * 0.95
    return sorted[(i > int(i) ? int(i) + 1 : int(i)) - 1]
}

# Distance of p from a triangle (Ericson 2005, Real-Time Collision Detection, 5.1.5).
function to_triangle(s, t,    k, d1, d2, d3, d4, d5, d6, va, vb, vc, v, w) {
    for (k = 1; k <= 3; k++) {
        A[k] = place[s, t, k]
        AB[k] = place[s, t + 1, k] - A[k]
        AC[k] = place[s, t + 2, k] - A[k]
        AP[k] = p[k] - A[k]
        BP[k] = AP[k] - AB[k]
        CP[k] = AP[k] - AC[k]
    }
    d1 = dot(AB, AP); d2 = dot(AC, AP)
    if (d1 <= 0 && d2 <= 0) return away(0, 0)
    d3 = dot(AB, BP); d4 = dot(AC, BP)
    if (d3 >= 0 && d4 <= d3) return away(1, 0)
    vc = d1 * d4 - d3 * d2
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return away(d1 / (d1 - d3), 0)
    d5 = dot(AB, CP); d6 = dot(AC, CP)
    if (d6 >= 0 && d5 <= d6) return away(0, 1)
    vb = d5 * d2 - d1 * d6
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return away(0, d2 / (d2 - d6))
    va = d3 * d6 - d5 * d4
    if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
        w = (d4 - d3) / (d4 - d3 + d5 - d6)
        return away(1 - w, w)
    }
    return away(vb / (va + vb + vc), vc / (va + vb + vc))
}

function dot(a, b) { return a[1] * b[1] + a[2] * b[2] + a[3] * b[3] }

function away(v, w,    k, sum) {
    for (k = 1; k <= 3; k++) sum += (AP[k] - v * AB[k] - w * AC[k]) ^ 2
    return sqrt(sum)
}
