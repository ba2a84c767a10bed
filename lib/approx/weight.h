/* Weight functions of moving least squares, on the relative distance r = |x - x_j| / R_j within [0, 1):
 * equation (1) of lib/README.md. */
#ifndef APPROX_WEIGHT_H
#define APPROX_WEIGHT_H

enum weight_function {
    WEIGHT_QUARTIC,     /* 1 - 6 r^2 + 8 r^3 - 3 r^4 */
    WEIGHT_REGULARISED, /* Most and Bucher 2005, e = 1e-5: almost interpolates */
    WEIGHT_COUNT
};

/* Names for command lines and headers, indexed by weight_function. */
extern const char *const weight_names[WEIGHT_COUNT];

/* w(r) and w'(r) / r (finite at r = 0) from the squared relative distance r2 < 1. */
void weight_evaluate(enum weight_function function, double r2, double *value, double *slope_over_r);

#endif
