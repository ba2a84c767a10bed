#include "approx/quality.h"

#include <math.h>
#include <string.h>

static double distance(const double *a, const double *b, int dim)
{
    double sum = 0;
    for (int k = 0; k < dim; k++) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sqrt(sum);
}

/* q = 2 r / R with r = A / s, R = a b c / (4 A), s half the perimeter. */
static double triangle_quality(double area, const double *const x[3])
{
    double a = distance(x[1], x[2], 2);
    double b = distance(x[2], x[0], 2);
    double c = distance(x[0], x[1], 2);
    return area * fabs(area) * 16 / ((a + b + c) * a * b * c);
}

/* q = 3 r / R with r = 3 V / S, R = sqrt(p (p - a)(p - b)(p - c)) / (6 V), a, b, c the products of opposite
 * edges and p half their sum. */
static double tetrahedron_quality(double volume, const double *const x[4])
{
    double a = distance(x[0], x[1], 3) * distance(x[2], x[3], 3);
    double b = distance(x[0], x[2], 3) * distance(x[1], x[3], 3);
    double c = distance(x[0], x[3], 3) * distance(x[1], x[2], 3);
    double p = (a + b + c) / 2;
    double surface = 0;
    for (int i = 0; i < 4; i++) {
        const double *u = x[(i + 1) % 4];
        const double *v = x[(i + 2) % 4];
        const double *w = x[(i + 3) % 4];
        double s[3], t[3];
        for (int k = 0; k < 3; k++) {
            s[k] = v[k] - u[k];
            t[k] = w[k] - u[k];
        }
        surface +=
            hypot(hypot(s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2]), s[0] * t[1] - s[1] * t[0]) / 2;
    }
    double product = p * (p - a) * (p - b) * (p - c);
    return 54 * volume * fabs(volume) / (surface * sqrt(fmax(product, 0)));
}

double cell_quality(const struct cells *cells, int64_t cell)
{
    int dim = cells->dim;
    const double *x[4];
    for (int k = 0; k <= dim; k++) {
        x[k] = cells->x + (int64_t)cells->node[cell * (dim + 1) + k] * dim;
    }
    double volume = cell_volume(cells, cell);
    double quality = dim == 2 ? triangle_quality(volume, x) : tetrahedron_quality(volume, x);
    return isfinite(quality) ? quality : 0;
}

int64_t cells_poorest(const struct cells *cells, double bound, int most, struct poor_cell poorest[])
{
    int64_t below = 0;
    int kept = 0;
    for (int64_t c = 0; c < cells->count; c++) {
        double quality = cell_quality(cells, c);
        if (!(quality < bound)) {
            continue;
        }
        below++;
        int at = kept;
        while (at > 0 && poorest[at - 1].quality > quality) {
            at--;
        }
        if (at < most) {
            kept += kept < most;
            memmove(&poorest[at + 1], &poorest[at], (size_t)(kept - 1 - at) * sizeof *poorest);
            poorest[at] = (struct poor_cell){c, quality};
        }
    }
    return below;
}
