/* The weight functions as formulas to be inlined: w(r) and w'(r) / r from r2 = r^2 < 1. Private to
 * lib/approx; see weight.h. Without branches, so that loops over them become vector code. */
#ifndef APPROX_WEIGHT_FORMULAS_H
#define APPROX_WEIGHT_FORMULAS_H

#include <math.h>

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

#endif
