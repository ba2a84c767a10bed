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

/* Rows with more than this multiple of the mean number of entries are put last: elsewhere they would
 * widen the envelope of all following rows. */
static const int64_t most_entries = 8;

enum { ENTRIES_FOR_THREAD = 50000 }; /* see chunks_of */

/* Reverse Cuthill-McKee: breadth first from a node of least degree in each component. order[i] is the old
 * row; the long rows are last. */
static enum status order_rows(int64_t n, const int64_t *ptr, const int64_t *column, int64_t *order,
                              struct error *error)
{
    int64_t count = 0, last = n;
    NEW_SCRATCH(bool, placed, n, error);
    for (int64_t i = 0; i < n; i++) {
        placed[i] = (ptr[i + 1] - ptr[i]) * n > most_entries * ptr[n];
        if (placed[i]) {
            order[--last] = i;
        }
    }
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

/* The threads that are worth using for all rows. */
static inline int threads_for(const struct envelope *factor)
{
    return factor->n > 0 ? chunks_of(factor->start[factor->n], ENTRIES_FOR_THREAD).threads : 1;
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

/* Compute row i of L, with `shift` times the diagonal entry added to that. It is dropped if its pivot is
 * below `least` times the diagonal entry. */
static void factor_row(struct envelope *factor, int64_t i, double least, double shift)
{
    double *row = row_at(factor, i), diagonal = row[i];
    for (int64_t k = factor->first[i]; k < i; k++) {
        const double *other = row_at(factor, k);
        int64_t from = factor->first[i] > factor->first[k] ? factor->first[i] : factor->first[k];
        row[k] = (row[k] - product(k - from, row + from, other + from)) / other[k];
    }
    double pivot = diagonal - product(i - factor->first[i], row + factor->first[i], row + factor->first[i]);
    bool dropped = !(pivot > least * diagonal) && !(shift > 0.0);
    if (dropped) {
        memset(row + factor->first[i], 0, (size_t)(i - factor->first[i]) * sizeof *row);
    }
    row[i] = dropped ? INFINITY : sqrt(fmax(pivot, 0.0) + shift * diagonal);
}

bool envelope_is_dropped(const struct envelope *factor, int64_t i)
{
    return isinf(row_at(factor, i)[i]);
}

static void factor_rows(struct envelope *factor, double least, double shift)
{
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor))
    for (int64_t b = 0; b < factor->block_count; b++) {
        for (int64_t i = factor->block[b]; i < factor->block[b + 1]; i++) {
            factor_row(factor, i, least, shift);
        }
    }
    factor->dropped = 0;
    for (int64_t i = 0; i < factor->n; i++) {
        factor->dropped += envelope_is_dropped(factor, i);
    }
}

/* Put the rows that were dropped behind the others. */
static enum status put_last(struct envelope *factor, struct error *error)
{
    int64_t kept = 0, dropped = 0;
    NEW_SCRATCH(int64_t, behind, factor->dropped, error);
    for (int64_t i = 0; i < factor->n; i++) {
        *(envelope_is_dropped(factor, i) ? &behind[dropped++] : &factor->order[kept++]) = factor->order[i];
    }
    memcpy(factor->order + kept, behind, (size_t)dropped * sizeof *behind);
    return STATUS_OK;
}

enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                               double least, double shift, struct envelope *factor, struct error *error)
{
    *factor = (struct envelope){.n = n};
    RETURN_IF_ERROR(NEW_ARRAY(&factor->order, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->first, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->start, n + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->scratch, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->block, n + 1, error));
    RETURN_IF_ERROR(order_rows(n, ptr, column, factor->order, error));
    RETURN_IF_ERROR(fill(n, ptr, column, value, factor, error));
    factor_rows(factor, fmax(weak_pivot, least), shift);
    if (factor->dropped > 0) {
        RETURN_IF_ERROR(put_last(factor, error));
        RETURN_IF_ERROR(fill(n, ptr, column, value, factor, error));
        factor_rows(factor, least, shift);
    }
    return STATUS_OK;
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
    double *y = factor->scratch;
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor))
    for (int64_t b = 0; b < factor->block_count; b++) {
        solve_rows(factor, factor->block[b], factor->block[b + 1], x, y);
    }
    for (int64_t i = 0; i < factor->n; i++) {
        x[factor->order[i]] = y[i];
    }
}
