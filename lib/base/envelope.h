/* Cholesky factorization of a sparse symmetric positive definite matrix within its envelope (skyline), rows
 * reordered by reverse Cuthill-McKee; long rows and those that depend on others most come last. For
 * constraint systems: factored once, solved every step. */
#pragma once

#include "base/ranks.h"

#include <stdint.h>

struct envelope {
    int64_t n;
    int64_t *order;  /* order[i]: the caller's row at place i */
    int64_t *first;  /* first column of row i within the envelope */
    int64_t *start;  /* n + 1: row i is value[start[i] .. start[i+1]), columns first[i] .. i */
    double *value;   /* the factor L */
    double *scratch; /* n */
    int64_t dropped; /* rows that depend on others: their diagonal entry of L is infinite */
    int64_t *block;  /* block_count + 1: where rows begin that no others couple to, nor they to others */
    int64_t block_count;
};

/* Factorise the matrix given in CSR, both triangles: column[ptr[n]], value[ptr[n]]. A row whose pivot is
 * below `least` times its diagonal entry depends on others and is dropped: its unknown is 0 in every
 * solution. */
MUST_CHECK enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column,
                                          const double *value, double least, struct envelope *factor,
                                          struct error *error);
void envelope_free(struct envelope *factor);

/* row[factor->dropped]: the caller's rows that were dropped. */
void envelope_dropped(const struct envelope *factor, int64_t *row);

/* Cut the rows into stretches that are solved apart, of about the same work for each process, as far as there
 * are such: (*first)[count + 1], places, to be freed. */
MUST_CHECK enum status envelope_share(const struct envelope *factor, const struct ranks *ranks,
                                      int64_t **first, struct error *error);

/* envelope_solve by several processes, each its stretch, to the same bits. All call this together. */
void envelope_solve_shared(const struct envelope *factor, const struct ranks *ranks, const int64_t *first,
                           double *x);

/* Solve in place, blocks by several threads: x[n] holds the right-hand side, then the solution. */
void envelope_solve(const struct envelope *factor, double *x);
