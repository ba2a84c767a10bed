/* Cholesky factorization of a sparse symmetric positive definite matrix within its envelope (skyline), rows
 * reordered by reverse Cuthill-McKee; long rows come last. Used for constraint systems, which are factored
 * once and solved in every step. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct envelope {
    int64_t n;
    int64_t *order, *place; /* order[i]: the caller's row at place i; place[order[i]] = i */
    int64_t *first;         /* of the row at each place: its first column within the envelope, */
    int64_t *at;            /* and where column 0 would be in value[] */
    int64_t size;
    double *value;   /* size: the factor L, row by row */
    double *scratch; /* n */
    int64_t dropped; /* linearly dependent rows: their diagonal entry of L is infinite */
    int64_t *block;  /* block_count + 1: first row of each diagonal block; rows of different blocks are not
                        coupled */
    int64_t block_count;
};

/* Factorise the matrix A given in CSR, both triangles: column[ptr[n]], value[ptr[n]], as A + shift diag(A).
 * Without a shift a row whose pivot is below `least` times its diagonal entry counts as linearly dependent on
 * those before it and is dropped: its unknown is 0 in every solution. With one, of the solutions of a
 * singular system that of the least sum_i A_ii x_i^2 is found, up to the shift. */
MUST_CHECK enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column,
                                          const double *value, double least, double shift,
                                          struct envelope *factor, struct error *error);

void envelope_free(struct envelope *factor);

/* Whether the row at place i, order[i] of the caller, was dropped. */
bool envelope_is_dropped(const struct envelope *factor, int64_t i);

/* Solve in place, blocks by several threads: x[n] holds the right-hand side, then the solution. */
void envelope_solve(const struct envelope *factor, double *x);
