/* Cholesky factorization of a sparse symmetric positive definite matrix within its envelope (skyline), rows
 * reordered by reverse Cuthill-McKee; long rows and those that depend on others most come last. For
 * constraint systems: factored once, solved every step. */
#ifndef BASE_ENVELOPE_H
#define BASE_ENVELOPE_H

#include "base/status.h"

#include <stdint.h>

struct envelope {
    int64_t n;
    int64_t *order;  /* order[i]: the caller's row at place i */
    int64_t *first;  /* first column of row i within the envelope */
    int64_t *start;  /* n + 1: row i is value[start[i] .. start[i+1]), columns first[i] .. i */
    double *value;   /* the factor L */
    double *scratch; /* n */
    int64_t dropped; /* rows that depend on others: their diagonal entry of L is infinite */
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

/* Solve in place: x[n] holds the right-hand side, then the solution. */
void envelope_solve(const struct envelope *factor, double *x);

#endif
