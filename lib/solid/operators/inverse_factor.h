/* A sparse inverse in factors, K^-1 ~ L^T D^-1 L, with a lower triangular L (Kolotilina and Yeremin 1993);
 * inverse_stiffness.h builds it. */
#pragma once

#include "base/ranks.h"
#include "base/sparse.h"

#include <stdbool.h>
#include <stdint.h>

struct inverse_factor {
    struct sparse rows,
        transposed; /* L, diagonal last in each row, and L^T, diagonal first; no rows: no factor */
    /* Several processes each hold all of L, and apply the rows of their own nodes. */
    const struct ranks *ranks; /* NULL: one process */
    int64_t *first;            /* ranks + 1: first row of each process */
    struct halo halo;          /* values at other nodes that own rows of L^T need */
};

void inverse_factor_free(struct inverse_factor *factor);

/* (*wanted)[node_count], to be freed: the nodes whose values this process needs to apply its rows of L^T. */
MUST_CHECK enum status inverse_factor_wanted(const struct inverse_factor *factor, bool **wanted,
                                             struct error *error);

/* y = L x and y = L^T x for vectors of node_count * dim, dim at most 3; x and y are different arrays. With
 * several processes, L x is known at own nodes and where own rows of L^T need it. */
void inverse_factor_apply(const struct inverse_factor *factor, int dim, const double *x, double *y);
void inverse_factor_apply_transposed(const struct inverse_factor *factor, int dim, const double *x,
                                     double *y);

/* x := L^-1 x, and L^-T x, by one thread, for vectors of node_count * width, width 2, 3 or 8. */
void inverse_factor_solve(const struct inverse_factor *factor, int width, double *x);
void inverse_factor_solve_transposed(const struct inverse_factor *factor, int width, double *x);
