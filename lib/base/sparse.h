/* Cholesky factorization of a large sparse symmetric positive definite matrix, by CHOLMOD (Chen, Davis, Hager
 * and Rajamanickam 2008): ordered for little fill, by blocks. Serial; the same matrix gives the same bits. */
#ifndef BASE_SPARSE_H
#define BASE_SPARSE_H

#include "base/status.h"

#include <stdint.h>

struct sparse_workspace;

struct sparse_factor {
    int64_t n; /* 0: nothing is factored */
    struct sparse_workspace *workspace;
};

/* Factorise the matrix given in CSR, of which only the lower triangle is read: column[ptr[n]], value[ptr[n]].
 * A factor that holds one already is replaced; the order of elimination is kept where n and ptr[n] are the
 * same. STATUS_VERDICT when the matrix is not positive definite, STATUS_SYSTEM for memory. */
MUST_CHECK enum status sparse_factorise(int64_t n, const int64_t *ptr, const int64_t *column,
                                        const double *value, struct sparse_factor *factor,
                                        struct error *error);
void sparse_free(struct sparse_factor *factor);

/* Solve in place: x[n]. */
void sparse_solve(const struct sparse_factor *factor, double *x);

/* The same for `count` right-hand sides, one after the other: x[count * n]. */
MUST_CHECK enum status sparse_solve_many(const struct sparse_factor *factor, int64_t count, double *x,
                                         struct error *error);

#endif
