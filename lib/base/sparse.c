#include "base/sparse.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <suitesparse/cholmod.h>

struct sparse_workspace {
    cholmod_common common;
    cholmod_factor *L;
    cholmod_dense *x, *y, *e; /* of the solves, kept by CHOLMOD */
    int64_t entries;          /* of the matrix that L was ordered for */
};

static enum status make_workspace(struct sparse_factor *factor, struct error *error)
{
    struct sparse_workspace *work = calloc(1, sizeof *work);
    if (work == NULL) {
        return fail_memory(error, "sparse factor");
    }
    cholmod_l_start(&work->common);
    work->common.print = 0;
    work->common.quick_return_if_not_posdef = 1;
    factor->workspace = work;
    return STATUS_OK;
}

static void free_parts(struct sparse_workspace *work)
{
    cholmod_l_free_factor(&work->L, &work->common);
    cholmod_l_free_dense(&work->x, &work->common);
    cholmod_l_free_dense(&work->y, &work->common);
    cholmod_l_free_dense(&work->e, &work->common);
}

void sparse_free(struct sparse_factor *factor)
{
    if (factor->workspace != NULL) {
        free_parts(factor->workspace);
        cholmod_l_finish(&factor->workspace->common);
        free(factor->workspace);
    }
    *factor = (struct sparse_factor){0};
}

/* The upper triangle by columns, which is the lower by rows. */
static cholmod_sparse *upper_triangle(int64_t n, const int64_t *ptr, const int64_t *column,
                                      const double *value, cholmod_common *common)
{
    cholmod_sparse *A =
        cholmod_l_allocate_sparse((size_t)n, (size_t)n, (size_t)ptr[n], false, true, 1, CHOLMOD_REAL, common);
    if (A == NULL) {
        return NULL;
    }
    SuiteSparse_long *first = A->p, *row = A->i;
    double *entry = A->x;
    int64_t at = 0;
    for (int64_t r = 0; r < n; r++) {
        for (int64_t k = ptr[r]; k < ptr[r + 1]; k++) {
            if (column[k] <= r) {
                row[at] = column[k];
                entry[at++] = value[k];
            }
        }
        first[r + 1] = at;
    }
    return A;
}

/* Let CHOLMOD allocate what sparse_solve works with, by a solve. */
static enum status prepare_solves(const struct sparse_factor *factor, struct error *error)
{
    struct sparse_workspace *work = factor->workspace;
    cholmod_dense *zero = cholmod_l_zeros((size_t)factor->n, 1, CHOLMOD_REAL, &work->common);
    bool good = zero != NULL && cholmod_l_solve2(CHOLMOD_A, work->L, zero, NULL, &work->x, NULL, &work->y,
                                                 &work->e, &work->common);
    cholmod_l_free_dense(&zero, &work->common);
    return good ? STATUS_OK : fail_memory(error, "sparse factor");
}

enum status sparse_factorise(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                             struct sparse_factor *factor, struct error *error)
{
    enum status status = STATUS_OK;
    cholmod_sparse *A = NULL;
    struct sparse_workspace *work;
    if (factor->workspace == NULL && (status = make_workspace(factor, error)) != STATUS_OK) {
        return status;
    }
    work = factor->workspace;
    if (work->L != NULL && (factor->n != n || work->entries != ptr[n])) {
        free_parts(work);
    }
    A = upper_triangle(n, ptr, column, value, &work->common);
    if (A != NULL && work->L == NULL) {
        work->L = cholmod_l_analyze(A, &work->common);
    }
    if (A == NULL || work->L == NULL) {
        status = fail_memory(error, "sparse factor");
    } else if (!cholmod_l_factorize(A, work->L, &work->common) || work->L->minor < (size_t)n) {
        status = work->common.status == CHOLMOD_OUT_OF_MEMORY
                     ? fail_memory(error, "sparse factor")
                     : fail(error, STATUS_VERDICT, "a matrix is not positive definite at row %lld",
                            (long long)work->L->minor);
    }
    factor->n = n;
    work->entries = ptr[n];
    cholmod_l_free_sparse(&A, &work->common);
    return status == STATUS_OK ? prepare_solves(factor, error) : status;
}

/* A dense matrix around the caller's numbers. */
static cholmod_dense dense_around(const struct sparse_factor *factor, int64_t count, double *x)
{
    return (cholmod_dense){.nrow = (size_t)factor->n,
                           .ncol = (size_t)count,
                           .nzmax = (size_t)(factor->n * count),
                           .d = (size_t)factor->n,
                           .x = x,
                           .xtype = CHOLMOD_REAL,
                           .dtype = CHOLMOD_DOUBLE};
}

void sparse_solve(const struct sparse_factor *factor, double *x)
{
    struct sparse_workspace *work = factor->workspace;
    cholmod_dense side = dense_around(factor, 1, x);
    (void)cholmod_l_solve2(CHOLMOD_A, work->L, &side, NULL, &work->x, NULL, &work->y, &work->e,
                           &work->common);
    memcpy(x, work->x->x, (size_t)factor->n * sizeof *x);
}

enum status sparse_solve_many(const struct sparse_factor *factor, int64_t count, double *x,
                              struct error *error)
{
    struct sparse_workspace *work = factor->workspace;
    cholmod_dense side = dense_around(factor, count, x);
    cholmod_dense *solution = cholmod_l_solve(CHOLMOD_A, work->L, &side, &work->common);
    if (solution == NULL) {
        return fail_memory(error, "sparse solution");
    }
    memcpy(x, solution->x, (size_t)(factor->n * count) * sizeof *x);
    cholmod_l_free_dense(&solution, &work->common);
    return STATUS_OK;
}
