#include "approx/cells/quality.h"

#include "base/vector.h"

#include <math.h>

/* q = 2 r / R with r = A / s, R = a b c / (4 A), s half the perimeter. */
static double triangle_quality(double area, const double *const x[3])
{
    double a = vector_distance(2, x[1], x[2]);
    double b = vector_distance(2, x[2], x[0]);
    double c = vector_distance(2, x[0], x[1]);
    return area * fabs(area) * 16 / ((a + b + c) * a * b * c);
}

/* q = 3 r / R with r = 3 V / S, R = sqrt(p (p - a)(p - b)(p - c)) / (6 V); a, b, c are the products of
 * opposite edges, and p is half their sum. */
static double tetrahedron_quality(double volume, const double *const x[4])
{
    double a = vector_distance(3, x[0], x[1]) * vector_distance(3, x[2], x[3]);
    double b = vector_distance(3, x[0], x[2]) * vector_distance(3, x[1], x[3]);
    double c = vector_distance(3, x[0], x[3]) * vector_distance(3, x[1], x[2]);
    double p = (a + b + c) / 2;
    double surface = 0;
    for (int i = 0; i < 4; i++) {
        const double *u = x[(i + 1) % 4];
        const double *v = x[(i + 2) % 4];
        const double *w = x[(i + 3) % 4];
        double s[3], t[3], normal[3];
        vector_subtract(3, v, u, s);
        vector_subtract(3, w, u, t);
        vector_cross(s, t, normal);
        surface += vector_length(3, normal) / 2;
    }
    double product = p * (p - a) * (p - b) * (p - c);
    return 54 * volume * fabs(volume) / (surface * sqrt(fmax(product, 0)));
}

double cell_quality(const struct cells *cells, int64_t cell)
{
    int dim = cells->dim;
    const double *x[4];
    cell_corners(cells, cell, x);
    double volume = cell_volume(cells, cell);
    double quality = dim == 2 ? triangle_quality(volume, x) : tetrahedron_quality(volume, x);
    return isfinite(quality) ? quality : 0;
}
