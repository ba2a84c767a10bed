/* The kernels of the force loop, one set for each instruction set and dimension; private to lib/solid. */
#ifndef SOLID_KERNEL_H
#define SOLID_KERNEL_H

#include "solid/body.h"

/* Matrices of the points of a block: row k of component k, points along it. A stress that is scattered has
 * zeros behind the last point, up to a whole group. */
typedef double block_rows[9][OPERATOR_MAX_ROWS];

/* What an evaluation finds at the points of a block; */
struct block_state {
    block_rows F;
    double J[OPERATOR_MAX_ROWS];
};

/* that, or what the body keeps of it: components of F so far apart. */
struct block_view {
    const double *F, *J;
    int64_t apart;
};

/* Each works on the block of that number. scratch: sparse_operator_scratch(). */
struct force_kernels {
    const char *name;
    /* For nodes first .. last - 1: displacements into the body's order; and force, in the caller's, as the
     * sum of what the blocks put on them. */
    void (*place)(struct body *body, int64_t first, int64_t last, const double *u);
    void (*sum)(const struct body *body, int64_t first, int64_t last, double *force);
    /* F and J of points from the table of gradients and body->u; and the forces of weighted stresses P, added
     * to those of the block's accumulation block. */
    void (*apply)(struct body *body, int64_t block, struct block_state *state, double *scratch);
    void (*apply_transposed)(struct body *body, int64_t block, const block_rows P, double *scratch);
    /* Averages from the field u; and the forces of what the corners put on them. */
    void (*apply_averages)(struct field_averages *averages, int64_t block, const double *u, double *scratch);
    void (*apply_averages_transposed)(struct field_averages *averages, int64_t block, double *scratch);
    /* Weighted stresses of a block of neo-Hookean points. */
    void (*neo_hookean)(const struct body *body, int64_t block, struct block_view state, block_rows P);
    /* What gradients g[count * dim] add to bounds of the stiffness: g A g, if positive, and smoothing |g|^2.
     */
    void (*bounds)(const double *g, int64_t count, const double A[9], double smoothing, double *sum);
    /* F, F_h and J of smoothed cells from the averages; weighted stresses P on F and T on F_h of a block of
     * neo-Hookean cells; and what the corners then put on the averages. */
    void (*cell_gradients)(struct body *body, int64_t block);
    void (*cell_neo_hookean)(const struct body *body, int64_t block, block_rows P, block_rows T);
    void (*cell_forces)(struct body *body, int64_t block, const block_rows P, const block_rows T);
};

/* Sets by name, plain, avx2, avx512: NULL where the processor lacks it; the best one for NULL. */
const struct force_kernels *force_kernels_select(const char *name, int dim);

/* Work arrays for so many threads; body_build() makes those for the threads it chooses. */
MUST_CHECK enum status body_make_scratch(struct body *body, int threads, struct error *error);

/* What body_diagonal needs. */
MUST_CHECK enum status body_make_bounds(struct body *body, struct error *error);
void body_free_bounds(struct body *body);

#endif
