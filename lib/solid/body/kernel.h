/* The kernels of the force loop, one set for each instruction set and dimension; private to lib/solid. */
#pragma once

#include "solid/body/body.h"

/* Matrices of the points of a block: row k of component k, points along it. */
typedef double block_rows[9][BLOCK_MOST_POINTS];

/* Each function processes the rows, stripe or block of that number. */
struct force_kernels {
    const char *name;
    /* y = A x for rows begin .. end - 1, of vectors VECTOR_STRIDE(dim) apart. */
    void (*apply)(const struct sparse *matrix, int64_t begin, int64_t end, const double *x, double *y);
    /* y = A^T x for the columns of a stripe. */
    void (*apply_transposed)(const struct row_operator *rows, int64_t stripe, const double *x, double *y);
    /* The forces of the corners on averages begin .. end - 1. */
    void (*sum_corners)(struct field_averages *averages, int64_t begin, int64_t end);
    /* F and J of points from the derivatives of the field; and weighted stresses P in the place of these. */
    void (*point_gradients)(struct body *body, int64_t block);
    void (*point_forces)(struct body *body, int64_t block, const block_rows P);
    /* Weighted stresses of a block of neo-Hookean points. */
    void (*neo_hookean)(const struct body *body, int64_t block, block_rows P);
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

/* Scratch of body_diagonal. */
MUST_CHECK enum status body_make_bounds(struct body *body, struct error *error);
void body_free_bounds(struct body *body);
