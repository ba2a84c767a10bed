#include "approx/weight.h"

#include <math.h>

const char *const weight_names[WEIGHT_COUNT] = {"quartic", "cubic", "wendland", "regularised"};

/* In factors, so that rounding near r = 1 leaves nothing negative: (1 - r)^3 (1 + 3 r). */
static void quartic(double r2, double *value, double *slope_over_r)
{
    double r = sqrt(r2);
    double s = 1.0 - r;
    *value = s * s * s * (1.0 + 3.0 * r);
    *slope_over_r = -12.0 * s * s;
}

static void cubic(double r2, double *value, double *slope_over_r)
{
    double r = sqrt(r2);
    if (r < 0.5) {
        *value = 1.0 - 6.0 * r2 * (1.0 - r);
        *slope_over_r = -12.0 + 18.0 * r;
    } else {
        double s = 1.0 - r;
        *value = 2.0 * s * s * s;
        *slope_over_r = -6.0 * s * s / r;
    }
}

static void wendland(double r2, double *value, double *slope_over_r)
{
    double r = sqrt(r2);
    double s = 1.0 - r;
    *value = s * s * s * s * (4.0 * r + 1.0);
    *slope_over_r = -20.0 * s * s * s;
}

static void regularised(double r2, double *value, double *slope_over_r)
{
    const double e = 1e-5;
    const double at_end = 1.0 / ((1.0 + e) * (1.0 + e));
    const double scale = 1.0 / (1.0 / (e * e) - at_end);
    double q = 1.0 / (r2 + e);
    *value = fmax(0.0, (q * q - at_end) * scale);
    *slope_over_r = -4.0 * q * q * q * scale;
}

void weight_evaluate(enum weight_function function, double r2, double *value, double *slope_over_r)
{
    switch (function) {
    case WEIGHT_CUBIC:
        cubic(r2, value, slope_over_r);
        return;
    case WEIGHT_WENDLAND:
        wendland(r2, value, slope_over_r);
        return;
    case WEIGHT_REGULARISED:
        regularised(r2, value, slope_over_r);
        return;
    case WEIGHT_QUARTIC:
    case WEIGHT_COUNT:
        break;
    }
    quartic(r2, value, slope_over_r);
}
