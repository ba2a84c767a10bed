/* The stiffness of a body of smoothed cells at its last evaluation, by rows of blocks K_nm; private to
 * lib/solid/preconditioner.
 *
 * The blocks are those of the linear interpolant in the cells around n, with the tangent of the neo-Hookean
 * law for all materials (as in body_diagonal) and its nodal pressures without projection: a bulk modulus k of
 * these adds sum_n E_n^T E_n / V_n, V_n the nodal volume and E_n the sum of sqrt(k) times the changes of
 * volume of its parts. */
#pragma once

#include "base/status.h"

#include <stdint.h>

struct body;

struct block_row {
    int64_t count;
    int32_t *node; /* neighbours, in the body's order */
    double *block; /* for each (dim + 1) * dim: K_nm, N/m (2D: N/m2), and below it what E_n is made of */
    double volume; /* V_n, m3 (2D: m2) */
};

/* The neighbours of a node at most, each as often as it is in a cell. */
int64_t block_row_most(const struct body *body);
MUST_CHECK enum status block_row_begin(const struct body *body, int64_t most, struct block_row *row,
                                       struct error *error);
void block_row_free(struct block_row *row);

/* The row of a node, in the body's order. */
void block_row_make(const struct body *body, int32_t node, struct block_row *row);
