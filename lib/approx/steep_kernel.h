/* The arithmetic of steep_bounds(): vector code written once and compiled for several instruction sets;
 * private to lib/approx. The same bits on every processor. */
#ifndef APPROX_STEEP_KERNEL_H
#define APPROX_STEEP_KERNEL_H

#include "approx/mls.h"

/* Points that go together. */
#define STEEP_LANES 8

/* The candidates of a group of points, in the scale of their largest radius and around an origin near them.
 */
struct steep_group {
    int64_t count, stride;            /* stride at least count */
    double scale;                     /* in units of x */
    const float *place;               /* [dim][stride] */
    const float *ratio;               /* [count]: (scale / radius)^2 */
    float *weight;                    /* [count][STEEP_LANES], scratch: w_j */
    float *share;                     /* [count][STEEP_LANES], scratch: k_j^2 |xi_j|^2 / w_j */
    float least_pivot[MLS_MAX_BASIS]; /* none may be smaller */
};

/* Bounds bound[STEEP_LANES] on |grad phi| at x[dim][STEEP_LANES], in the scale of the group, for the quartic
 * spline without H, but for round-off; INFINITY where the moment matrix is not very well conditioned. */
typedef void steep_kernel(struct steep_group *group, const float *x, float *bound);

/* One set of compiled kernels. */
struct steep_kernels {
    const char *name;
    steep_kernel *linear[2], *quadratic[2]; /* in 2D, 3D */
};

/* The best set for this processor; or, for tests, the set of that name ("plain", "avx2", "avx512"), NULL when
 * the processor has it not. */
const struct steep_kernels *steep_kernels_select(void);
const struct steep_kernels *steep_kernels_named(const char *name);

#endif
