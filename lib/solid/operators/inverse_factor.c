#include "solid/operators/inverse_factor.h"

#include "base/memory.h"
#include "base/processor.h"

#include <stdlib.h>

void inverse_factor_free(struct inverse_factor *factor)
{
    sparse_free(&factor->rows);
    sparse_free(&factor->transposed);
    halo_free(&factor->halo);
    free(factor->first);
    factor->first = NULL;
}

enum status inverse_factor_wanted(const struct inverse_factor *factor, bool **wanted, struct error *error)
{
    const struct sparse *matrix = &factor->transposed;
    const int64_t *first = factor->first + ranks_rank(factor->ranks);
    enum status status = NEW_ARRAY(wanted, matrix->row_count, error);
    for (int64_t i = matrix->ptr[first[0]]; status == STATUS_OK && i < matrix->ptr[first[1]]; i++) {
        (*wanted)[matrix->idx[i]] = true;
    }
    return status;
}

void inverse_factor_apply(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    const int64_t *first = factor->first + ranks_rank(factor->ranks);
    sparse_apply_rows(&factor->rows, first[0], first[1], dim, x, y);
    halo_exchange(&factor->halo, dim, y);
}

void inverse_factor_apply_transposed(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    const int64_t *first = factor->first + ranks_rank(factor->ranks);
    sparse_apply_rows(&factor->transposed, first[0], first[1], dim, x, y);
    ranks_gather(factor->ranks, y, (size_t)dim * sizeof *y, factor->first);
}

/* Node n of x, from the entries of its row from `first` to before `last`, and that on the diagonal. The width
 * is known when compiling, here and below; sums stay in registers. */
static inline __attribute__((always_inline)) void solve_node(const struct sparse *matrix, int width,
                                                             int64_t n, int64_t first, int64_t last,
                                                             int64_t diagonal, double *x)
{
    double sum[8] = {0.0};
    for (int a = 0; a < width; a++) {
        sum[a] = x[n * width + a];
    }
    for (int64_t i = first; i < last; i++) {
        const double *at = x + (int64_t)matrix->idx[i] * width;
        for (int a = 0; a < width; a++) {
            sum[a] -= matrix->value[i] * at[a];
        }
    }
    for (int a = 0; a < width; a++) {
        x[n * width + a] = sum[a] / matrix->value[diagonal];
    }
}

static inline __attribute__((always_inline)) void solve(const struct sparse *matrix, int width, double *x)
{
    for (int64_t n = 0; n < matrix->row_count; n++) {
        int64_t last = matrix->ptr[n + 1] - 1;
        solve_node(matrix, width, n, matrix->ptr[n], last, last, x);
    }
}

static inline __attribute__((always_inline)) void solve_transposed(const struct sparse *matrix, int width,
                                                                   double *x)
{
    for (int64_t n = matrix->row_count; n-- > 0;) {
        int64_t first = matrix->ptr[n];
        solve_node(matrix, width, n, first + 1, matrix->ptr[n + 1], first, x);
    }
}

ALL_SETS void inverse_factor_solve(const struct inverse_factor *factor, int width, double *x)
{
    if (width == 2) {
        solve(&factor->rows, 2, x);
    } else if (width == 3) {
        solve(&factor->rows, 3, x);
    } else {
        solve(&factor->rows, 8, x);
    }
}

ALL_SETS void inverse_factor_solve_transposed(const struct inverse_factor *factor, int width, double *x)
{
    if (width == 2) {
        solve_transposed(&factor->transposed, 2, x);
    } else if (width == 3) {
        solve_transposed(&factor->transposed, 3, x);
    } else {
        solve_transposed(&factor->transposed, 8, x);
    }
}
