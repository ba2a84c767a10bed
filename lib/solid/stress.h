/* Stresses of points and conforming cells of any law, one at a time; private to lib/solid. */
#ifndef SOLID_STRESS_H
#define SOLID_STRESS_H

#include "solid/kernel.h"

/* A matrix of a point, 3 x 3 with 1 at the end in plane strain, from rows laid out as body->F. */
void stress_matrix(const struct body *body, const double *rows, int64_t point, double F[9]);

/* Weighted stresses P of a block of points. */
void stress_points(const struct body *body, const struct block *block, block_stress P);

/* Weighted stresses of a block of cells, P on F and T on F_h: see conforming.h. */
void stress_cells(const struct body *body, const struct block *block, block_stress P, block_stress T);

/* What ties F_h of a cell to F, that is given. */
struct tie {
    double stiffness; /* k, Pa */
    double slope;     /* dk/dW */
    double squares;   /* |F_h - F|^2 */
};
struct tie stress_tie(const struct body *body, int64_t point, const double F[9]);

#endif
