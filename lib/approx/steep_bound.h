/* Bounds on the gradients of the shape functions of several near points at once, in single precision: where
 * such a bound is small enough, mls_steepest() need not be asked. Private to lib/approx. */
#ifndef APPROX_STEEP_BOUND_H
#define APPROX_STEEP_BOUND_H

#include "approx/candidates.h"
#include "approx/mls.h"

/* Scratch space for one thread, all zero at first; grows on demand. */
struct steep_work {
    float *values;
    int64_t capacity;                    /* candidates that `values` serves */
    const struct steep_kernels *kernels; /* the code for this processor */
};
void steep_work_free(struct steep_work *work);

/* bound[count]: at each of the points x[count * dim], all of them in the box of the candidates and with all
 * nodes within reach as neighbours, the verdict is MLS_GOOD and no |grad phi| (per unit of x) is larger;
 * INFINITY where this cannot be told so simply. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status steep_bounds(const struct mls *mls, const struct candidates *candidates, int64_t count,
                                    const double *x, struct steep_work *work, double *bound,
                                    struct error *error);

#endif
