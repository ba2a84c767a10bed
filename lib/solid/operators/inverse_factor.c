#include "solid/operators/inverse_factor.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"

#include <stdlib.h>

enum { ROWS_FOR_THREAD = 1000 }; /* see chunks_for_threads */

static void block_rows_free(struct block_rows *rows)
{
    FREE_ALL(rows->ptr, rows->idx, rows->block);
    *rows = (struct block_rows){0};
}

void inverse_factor_free(struct inverse_factor *factor)
{
    block_rows_free(&factor->rows);
    block_rows_free(&factor->transposed);
    halo_free(&factor->halo);
    free(factor->first);
    factor->first = NULL;
    factor->node_count = 0;
}

static enum status transpose(struct inverse_factor *factor, struct error *error)
{
    const struct block_rows *rows = &factor->rows;
    struct block_rows *to = &factor->transposed;
    int64_t nodes = factor->node_count, entries = rows->ptr[nodes];
    int dim = factor->dim;
    NEW_SCRATCH(int64_t, next, nodes + 1, error);
    RETURN_IF_ERROR(NEW_ARRAY(&to->ptr, nodes + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&to->idx, entries, error));
    RETURN_IF_ERROR(NEW_ARRAY(&to->block, entries * dim * dim, error));
    for (int64_t i = 0; i < entries; i++) {
        to->ptr[rows->idx[i] + 1]++;
    }
    for (int64_t n = 0; n < nodes; n++) {
        next[n + 1] = to->ptr[n + 1] += to->ptr[n];
    }
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t i = rows->ptr[n]; i < rows->ptr[n + 1]; i++) {
            int64_t at = next[rows->idx[i]]++;
            to->idx[at] = (int32_t)n;
            for (int k = 0; k < dim * dim; k++) {
                to->block[at * dim * dim + k] = rows->block[i * dim * dim + k % dim * dim + k / dim];
            }
        }
    }
    return STATUS_OK;
}

static int owner(const void *factor, int64_t node)
{
    const struct inverse_factor *of = factor;
    return ranks_owner(of->ranks, of->first, node);
}

enum status inverse_factor_finish(struct inverse_factor *factor, struct error *error)
{
    const struct block_rows *matrix = &factor->transposed;
    NEW_SCRATCH(bool, wanted, factor->node_count, error);
    RETURN_IF_ERROR(transpose(factor, error));
    RETURN_IF_ERROR(ranks_share(factor->ranks, factor->node_count, NULL, &factor->first, error));
    const int64_t *first = factor->first + ranks_rank(factor->ranks);
    for (int64_t i = matrix->ptr[first[0]]; i < matrix->ptr[first[1]]; i++) {
        wanted[matrix->idx[i]] = true;
    }
    return halo_build(factor->ranks, factor->node_count, wanted, factor->dim, owner, factor, &factor->halo,
                      error);
}

/* Rows from `begin` to before `end`. The dimension is known when compiling. */
KERNEL_INLINE void apply_some(const struct block_rows *rows, int dim, int64_t begin, int64_t end,
                              const double *x, double *y)
{
    for (int64_t n = begin; n < end; n++) {
        double sum[3] = {0.0, 0.0, 0.0};
        for (int64_t i = rows->ptr[n]; i < rows->ptr[n + 1]; i++) {
            const float *block = rows->block + i * dim * dim;
            const double *at = x + (int64_t)rows->idx[i] * dim;
            for (int b = 0; b < dim; b++) {
                for (int a = 0; a < dim; a++) {
                    sum[a] += (double)block[b * dim + a] * at[b];
                }
            }
        }
        for (int a = 0; a < dim; a++) {
            y[n * dim + a] = sum[a];
        }
    }
}

ALL_SETS static void apply(const struct block_rows *rows, int dim, int64_t begin, int64_t end,
                           const double *x, double *y)
{
    if (dim == 2) {
        apply_some(rows, 2, begin, end, x, y);
    } else {
        apply_some(rows, 3, begin, end, x, y);
    }
}

static void apply_own(const struct inverse_factor *factor, const struct block_rows *rows, const double *x,
                      double *y)
{
    const int64_t *first = factor->first + ranks_rank(factor->ranks);
    struct chunks chunks = chunks_for_threads(first[1] - first[0], first[1] - first[0], ROWS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        apply(rows, factor->dim, first[0] + chunks_begin(&chunks, c), first[0] + chunks_begin(&chunks, c + 1),
              x, y);
    }
}

void inverse_factor_apply(const struct inverse_factor *factor, const double *x, double *y)
{
    apply_own(factor, &factor->rows, x, y);
    halo_exchange(&factor->halo, factor->dim, y);
}

void inverse_factor_apply_transposed(const struct inverse_factor *factor, const double *x, double *y)
{
    apply_own(factor, &factor->transposed, x, y);
    ranks_gather(factor->ranks, y, (size_t)factor->dim * sizeof *y, factor->first);
}
