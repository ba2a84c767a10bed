/* A sparse inverse in factors, K^-1 ~ L^T D^-1 L, with a lower triangular L of dim x dim blocks (Kolotilina
 * and Yeremin 1993); inverse_stiffness.h builds it. */
#pragma once

#include "base/ranks.h"

#include <stdbool.h>
#include <stdint.h>

/* Rows of blocks, by nodes. */
struct block_rows {
    int64_t *ptr; /* node_count + 1 */
    int32_t *idx;
    float *block; /* dim * dim for each, by columns */
};

struct inverse_factor {
    int dim;
    int64_t node_count;                 /* 0: no factor */
    struct block_rows rows, transposed; /* L, diagonal last in each row, and L^T */
    /* Several processes each hold all of L, and apply the rows of their own nodes. */
    const struct ranks *ranks; /* NULL: one process */
    int64_t *first;            /* ranks + 1: first row of each process */
    struct halo halo;          /* values at other nodes that own rows of L^T need */
};

void inverse_factor_free(struct inverse_factor *factor);

/* Set what follows from the rows. */
MUST_CHECK enum status inverse_factor_finish(struct inverse_factor *factor, struct error *error);

/* y = L x and y = L^T x for vectors of node_count * dim; x and y are different arrays. With several
 * processes, L x is known at own nodes and where own rows of L^T need it. */
void inverse_factor_apply(const struct inverse_factor *factor, const double *x, double *y);
void inverse_factor_apply_transposed(const struct inverse_factor *factor, const double *x, double *y);
