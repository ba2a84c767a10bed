/* The kernels of the force loop; private to lib/solid. Each is compiled for several instruction sets
 * (ALL_SETS), between which results differ by round-off only (fused multiplications), and for 2 and 3
 * dimensions. */
#pragma once

#include "solid/body/body.h"

/* Matrices of the points of a block: row k of component k, points along it. */
typedef double block_rows[9][BLOCK_MOST_POINTS];

/* y = A x for rows begin .. end - 1, of vectors VECTOR_STRIDE(dim) apart. */
void force_apply(int dim, const struct sparse *matrix, int64_t begin, int64_t end, const double *x,
                 double *y);

/* y = A^T x for the columns of the stripe of that number. */
void force_apply_transposed(int dim, const struct row_operator *rows, int64_t stripe, const double *x,
                            double *y);

/* The forces of cells on averages begin .. end - 1. */
void force_sum_parts(int dim, struct field_averages *averages, int64_t begin, int64_t end);

/* Of the block of that number: F and J of points from the derivatives of the field; weighted stresses of
 * neo-Hookean points; and weighted stresses P in the place of the derivatives. */
void force_point_gradients(struct body *body, int64_t block);
void force_point_neo_hookean(const struct body *body, int64_t block, block_rows P);
void force_point_forces(struct body *body, int64_t block, const block_rows P);

/* F, F_h and J of smoothed cells from the averages; weighted stresses P on F and T on F_h of neo-Hookean
 * cells; and what the corners then put on the averages. */
void force_cell_gradients(struct body *body, int64_t block);
void force_cell_neo_hookean(const struct body *body, int64_t block, block_rows P, block_rows T);
void force_cell_forces(struct body *body, int64_t block, block_rows P, block_rows T);

/* X and the strains of a viscoelastic block at the last evaluation: see prony.h. */
typedef double prony_rows[PRONY_MOST][BLOCK_MOST_POINTS];
void force_prony_state(const struct body *body, int64_t block, prony_rows X, prony_rows x);
