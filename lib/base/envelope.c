#include "base/envelope.h"

#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Rows with a pivot below this share of their diagonal entry are put last, where dependent ones are
 * identified: a small pivot in an early row would make all following rows inaccurate. */
static const double weak_pivot = 1e-3;

/* Rows with more than this multiple of the mean number of entries are put last, too: elsewhere they would
 * widen the envelope of all following rows. */
static const int64_t most_entries = 8;

enum { ENTRIES_FOR_THREAD = 50000 }; /* see chunks_of */

/* Reverse Cuthill-McKee: breadth first from a node of least degree in each component. order[i] is the old
 * row; the last *longs are the long rows. */
static enum status order_rows(int64_t n, const int64_t *ptr, const int64_t *column, int64_t *order,
                              int64_t *longs, struct error *error)
{
    int64_t count = 0, last = n;
    NEW_SCRATCH(bool, placed, n, error);
    for (int64_t i = 0; i < n; i++) {
        placed[i] = (ptr[i + 1] - ptr[i]) * n > most_entries * ptr[n];
        if (placed[i]) {
            order[--last] = i;
        }
    }
    *longs = n - last;
    while (count < last) {
        int64_t seed = -1;
        for (int64_t i = 0; i < n; i++) {
            if (!placed[i] && (seed < 0 || ptr[i + 1] - ptr[i] < ptr[seed + 1] - ptr[seed])) {
                seed = i;
            }
        }
        int64_t next = count;
        order[count++] = seed;
        placed[seed] = true;
        for (; next < count; next++) {
            int64_t row = order[next];
            for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
                if (!placed[column[k]]) {
                    placed[column[k]] = true;
                    order[count++] = column[k];
                }
            }
        }
    }
    for (int64_t i = 0; i < last / 2; i++) {
        int64_t swap = order[i];
        order[i] = order[last - 1 - i];
        order[last - 1 - i] = swap;
    }
    return STATUS_OK;
}

/* Find the first rows of the diagonal blocks, from the end: a block begins at a row if no later row has an
 * entry before it. */
static void find_blocks(struct envelope *factor)
{
    int64_t n = factor->n, least = n, *block = factor->block, blocks = 0;
    block[n] = n;
    for (int64_t i = n - 1; i >= 0; i--) {
        least = factor->first[i] < least ? factor->first[i] : least;
        if (least == i) {
            blocks++;
            block[n - blocks] = i;
        }
    }
    memmove(block, block + n - blocks, (size_t)(blocks + 1) * sizeof *block);
    factor->block_count = blocks;
}

/* The threads that are worth using for the rows from `begin` to before `end`. */
static inline int threads_for(const struct envelope *factor, int64_t begin, int64_t end)
{
    return begin < end ? chunks_of(factor->start[end] - factor->start[begin], ENTRIES_FOR_THREAD).threads : 1;
}

/* The envelope of the reordered matrix, filled with its lower triangle. */
static enum status fill(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                        struct envelope *factor, struct error *error)
{
    free(factor->value);
    factor->value = NULL;
    NEW_SCRATCH(int64_t, place, n, error);
    for (int64_t i = 0; i < n; i++) {
        place[factor->order[i]] = i;
    }
    for (int64_t i = 0; i < n; i++) {
        int64_t row = factor->order[i];
        factor->first[i] = i;
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = place[column[k]];
            factor->first[i] = other < factor->first[i] ? other : factor->first[i];
        }
        factor->start[i + 1] = factor->start[i] + i - factor->first[i] + 1;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&factor->value, factor->start[n], error));
    for (int64_t i = 0; i < n; i++) {
        int64_t row = factor->order[i];
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = place[column[k]];
            if (other <= i) {
                factor->value[factor->start[i] + other - factor->first[i]] += value[k];
            }
        }
    }
    find_blocks(factor);
    return STATUS_OK;
}

/* Sum of a[k] b[k], in four partial sums, as a single one would wait for each addition. */
static double product(int64_t count, const double *a, const double *b)
{
    double sum[4] = {0.0, 0.0, 0.0, 0.0};
    int64_t k = 0;
    for (; k + 4 <= count; k += 4) {
        for (int i = 0; i < 4; i++) {
            sum[i] += a[k + i] * b[k + i];
        }
    }
    for (; k < count; k++) {
        sum[0] += a[k] * b[k];
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* Row i of the factor, to be indexed by column. */
static double *row_at(const struct envelope *factor, int64_t i)
{
    return factor->value + factor->start[i] - factor->first[i];
}

/* Compute the entries of row i of L in the columns before `columns`, whose rows are complete. */
static void eliminate(struct envelope *factor, int64_t i, int64_t columns)
{
    double *row = row_at(factor, i);
    for (int64_t k = factor->first[i]; k < columns; k++) {
        const double *other = row_at(factor, k);
        int64_t from = factor->first[i] > factor->first[k] ? factor->first[i] : factor->first[k];
        row[k] = (row[k] - product(k - from, row + from, other + from)) / other[k];
    }
}

/* Entry (i, j), j <= i, of the Schur complement after the first `columns` columns. */
static double reduced(const struct envelope *factor, int64_t i, int64_t j, int64_t columns)
{
    const double *row = row_at(factor, i), *other = row_at(factor, j);
    double entry = j >= factor->first[i] ? row[j] : 0.0;
    int64_t from = factor->first[i] > factor->first[j] ? factor->first[i] : factor->first[j];
    return entry - product(columns - from, row + from, other + from);
}

static void drop_row(struct envelope *factor, int64_t i)
{
    double *row = row_at(factor, i);
    for (int64_t l = factor->first[i]; l < i; l++) {
        row[l] = 0.0;
    }
    row[i] = INFINITY;
}

/* Compute row i of L; it is dropped if its pivot is below `least` times its diagonal entry. */
static void factor_row(struct envelope *factor, int64_t i, double least)
{
    double diagonal = row_at(factor, i)[i];
    eliminate(factor, i, i);
    double pivot = reduced(factor, i, i, i);
    if (!(pivot > least * diagonal) || !(pivot > 0.0)) {
        drop_row(factor, i);
        return;
    }
    row_at(factor, i)[i] = sqrt(pivot);
}

/* Compute the rows of L before `kept`; the others are dropped. */
static void factor_rows(struct envelope *factor, int64_t kept, double least)
{
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor, 0, factor->n))
    for (int64_t b = 0; b < factor->block_count; b++) {
        for (int64_t i = factor->block[b]; i < factor->block[b + 1]; i++) {
            if (i < kept) {
                factor_row(factor, i, least);
            } else {
                drop_row(factor, i);
            }
        }
    }
    factor->dropped = 0;
    for (int64_t i = 0; i < factor->n; i++) {
        factor->dropped += isinf(row_at(factor, i)[i]) != 0;
    }
}

/* Order `count` rows by the largest remaining pivot, relative to the diagonal entries; matrix[count * count]
 * is overwritten. Returns the number of pivots above `least`; their rows come first in order[count]. */
static int64_t order_by_pivot(int64_t count, double *matrix, const double *diagonal, double least,
                              int64_t *order)
{
    for (int64_t i = 0; i < count; i++) {
        order[i] = i;
    }
    for (int64_t k = 0; k < count; k++) {
        int64_t best = k;
        for (int64_t i = k; i < count; i++) {
            double pivot = matrix[order[i] * (count + 1)] / diagonal[order[i]];
            best = pivot > matrix[order[best] * (count + 1)] / diagonal[order[best]] ? i : best;
        }
        int64_t row = order[best];
        if (!(matrix[row * (count + 1)] > least * diagonal[row])) {
            return k;
        }
        order[best] = order[k];
        order[k] = row;
        for (int64_t i = k + 1; i < count; i++) {
            double scale = matrix[order[i] * count + row] / matrix[row * (count + 1)];
            for (int64_t j = k + 1; j < count; j++) {
                matrix[order[i] * count + order[j]] -= scale * matrix[row * count + order[j]];
            }
        }
    }
    return count;
}

/* Put the rows that the first pass left out behind the others, the most independent first; *kept: number of
 * independent rows. */
static enum status order_weak(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                              double least, struct envelope *factor, int64_t *kept, struct error *error)
{
    int64_t count = factor->dropped, strong = 0, weak = 0;
    NEW_SCRATCH(int64_t, behind, count, error);
    NEW_SCRATCH(int64_t, by_pivot, count, error);
    NEW_SCRATCH(double, matrix, count * count, error);
    NEW_SCRATCH(double, diagonal, count, error);
    for (int64_t i = 0; i < n; i++) {
        if (isinf(row_at(factor, i)[i])) {
            behind[weak++] = factor->order[i];
        } else {
            factor->order[strong++] = factor->order[i];
        }
    }
    memcpy(factor->order + strong, behind, (size_t)count * sizeof *behind);
    RETURN_IF_ERROR(fill(n, ptr, column, value, factor, error));
    for (int64_t i = 0; i < n; i++) {
        if (i >= strong) {
            diagonal[i - strong] = row_at(factor, i)[i];
            eliminate(factor, i, strong);
        } else {
            factor_row(factor, i, 0.0);
        }
    }
    for (int64_t i = 0; i < count; i++) {
        for (int64_t j = 0; j <= i; j++) {
            matrix[i * count + j] = matrix[j * count + i] = reduced(factor, strong + i, strong + j, strong);
        }
    }
    *kept = strong + order_by_pivot(count, matrix, diagonal, least, by_pivot);
    for (int64_t i = 0; i < count; i++) {
        factor->order[strong + i] = behind[by_pivot[i]];
    }
    return STATUS_OK;
}

enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                               double least, struct envelope *factor, struct error *error)
{
    int64_t kept = n, longs;
    *factor = (struct envelope){.n = n};
    RETURN_IF_ERROR(NEW_ARRAY(&factor->order, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->first, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->start, n + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->scratch, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->block, n + 1, error));
    RETURN_IF_ERROR(order_rows(n, ptr, column, factor->order, &longs, error));
    RETURN_IF_ERROR(fill(n, ptr, column, value, factor, error));
    factor_rows(factor, n - longs, fmax(weak_pivot, least));
    if (factor->dropped > 0) {
        RETURN_IF_ERROR(order_weak(n, ptr, column, value, least, factor, &kept, error));
        RETURN_IF_ERROR(fill(n, ptr, column, value, factor, error));
        /* A pivot that was above `least` can now be below it only by round-off. */
        factor_rows(factor, kept, 0.1 * least);
    }
    return STATUS_OK;
}

void envelope_dropped(const struct envelope *factor, int64_t *row)
{
    for (int64_t i = 0; i < factor->n; i++) {
        if (isinf(row_at(factor, i)[i])) {
            *row++ = factor->order[i];
        }
    }
}

void envelope_free(struct envelope *factor)
{
    FREE_ALL(factor->order, factor->first, factor->start, factor->value, factor->scratch, factor->block);
    *factor = (struct envelope){0};
}

/* Solve for one block, y[begin .. end). */
static void solve_rows(const struct envelope *factor, int64_t begin, int64_t end, const double *x, double *y)
{
    int64_t some = begin; /* the first row with a right-hand side */
    while (some < end && x[factor->order[some]] == 0.0) {
        y[some++] = 0.0;
    }
    if (some == end) {
        return;
    }
    for (int64_t i = some; i < end; i++) {
        const double *row = factor->value + factor->start[i];
        int64_t first = factor->first[i];
        y[i] = (x[factor->order[i]] - product(i - first, row, y + first)) / row[i - first];
    }
    for (int64_t i = end - 1; i >= begin; i--) {
        const double *row = factor->value + factor->start[i];
        int64_t first = factor->first[i];
        double *restrict before = y + first, last = y[i] / row[i - first];
        y[i] = last;
        for (int64_t k = 0; k < i - first; k++) {
            before[k] -= row[k] * last;
        }
    }
}

void envelope_solve(const struct envelope *factor, double *x)
{
    envelope_solve_shared(factor, NULL, NULL, x);
}

void envelope_solve_shared(const struct envelope *factor, const struct ranks *ranks, const int64_t *first,
                           double *x)
{
    double *y = factor->scratch;
    int rank = ranks_rank(ranks);
    int64_t begin = ranks != NULL ? first[rank] : 0, end = ranks != NULL ? first[rank + 1] : factor->n;
    int64_t last = first_from(factor->block, 0, factor->block_count, end);
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor, begin, end))
    for (int64_t b = first_from(factor->block, 0, last, begin); b < last; b++) {
        solve_rows(factor, factor->block[b], factor->block[b + 1], x, y);
    }
    ranks_gather(ranks, y, sizeof *y, first);
    for (int64_t i = 0; i < factor->n; i++) {
        x[factor->order[i]] = y[i];
    }
}

enum status envelope_share(const struct envelope *factor, const struct ranks *ranks, int64_t **first,
                           struct error *error)
{
    const int64_t *begin = factor->block, blocks = factor->block_count;
    NEW_SCRATCH(double, work, blocks, error);
    for (int64_t b = 0; b < blocks; b++) {
        work[b] = (double)(factor->start[begin[b + 1]] - factor->start[begin[b]]);
    }
    RETURN_IF_ERROR(ranks_share(ranks, blocks, work, first, error));
    for (int r = 0; r <= ranks_count(ranks); r++) {
        (*first)[r] = begin[(*first)[r]];
    }
    return STATUS_OK;
}
