/* Weight functions of moving least squares, on the relative distance r = |x - x_j| / R_j within [0, 1):
 * equation (1) of lib/README.md. */
#pragma once

#include <math.h>

enum weight_function {
    WEIGHT_QUARTIC,     /* 1 - 6 r^2 + 8 r^3 - 3 r^4 */
    WEIGHT_REGULARISED, /* Most and Bucher 2005, e = 1e-5: almost interpolates */
    WEIGHT_COUNT
};

/* Names for command lines and headers, indexed by weight_function. */
extern const char *const weight_names[WEIGHT_COUNT];

/* The formulas: w(r) and w'(r) / r (finite at r = 0) from the squared relative distance r2 = r^2 < 1. They
 * have no branches, so that loops over them become vector code. */

#define WEIGHT_FORMULA static inline __attribute__((always_inline)) void

/* In factors, so that rounding near r = 1 leaves nothing negative: (1 - r)^3 (1 + 3 r). */
WEIGHT_FORMULA weight_quartic(double r2, double *value, double *slope_over_r)
{
    double r = sqrt(r2);
    double s = 1.0 - r;
    *value = s * s * s * (1.0 + 3.0 * r);
    *slope_over_r = -12.0 * s * s;
}

WEIGHT_FORMULA weight_regularised(double r2, double *value, double *slope_over_r)
{
    const double e = 1e-5;
    const double at_end = 1.0 / ((1.0 + e) * (1.0 + e));
    const double scale = 1.0 / (1.0 / (e * e) - at_end);
    double q = 1.0 / (r2 + e);
    double above = q * q - at_end;
    *value = (above > 0.0 ? above : 0.0) * scale;
    *slope_over_r = -4.0 * q * q * q * scale;
}

WEIGHT_FORMULA weight_evaluate(enum weight_function function, double r2, double *value, double *slope_over_r)
{
    if (function == WEIGHT_REGULARISED) {
        weight_regularised(r2, value, slope_over_r);
    } else {
        weight_quartic(r2, value, slope_over_r);
    }
}
