/* Stresses of points and conforming cells of any law, one at a time; private to lib/solid. */
#ifndef SOLID_STRESS_H
#define SOLID_STRESS_H

#include "solid/kernel.h"

/* F and J of a block at the last evaluation, kept or gathered anew into `state`. scratch: PAIRS_SCRATCH. */
struct block_view body_state(struct body *body, int64_t block, struct block_state *state, double *scratch);

/* A matrix of a point, 3 x 3 with 1 at the end in plane strain, from rows that lie so far apart. */
void stress_matrix(int dim, const double *row, int64_t apart, double F[9]);

/* Weighted stresses P of a block of points. */
void stress_points(const struct body *body, const struct block *block, struct block_view state, block_rows P);

/* Weighted stresses of a block of cells, P on F and T on F_h: see conforming.h. */
void stress_cells(const struct body *body, const struct block *block, block_rows P, block_rows T);

/* What ties F_h of a cell to F, that is given. */
struct tie {
    double stiffness; /* k, Pa */
    double slope;     /* dk/dW */
    double squares;   /* |F_h - F|^2 */
};
struct tie stress_tie(const struct body *body, int64_t point, const double F[9]);

#endif
