#include "base/envelope.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
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

static inline int threads_for(const struct envelope *factor)
{
    return factor->block_count > 1 ? chunks_of(factor->size, ENTRIES_FOR_THREAD).threads : 1;
}

static void lay_out(const int64_t *ptr, const int64_t *column, struct envelope *factor)
{
    factor->size = 0;
    for (int64_t i = 0; i < factor->n; i++) {
        factor->place[factor->order[i]] = i;
    }
    for (int64_t i = 0; i < factor->n; i++) {
        int64_t row = factor->order[i], first = i;
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = factor->place[column[k]];
            first = other < first ? other : first;
        }
        factor->first[i] = first;
        factor->at[i] = factor->size - first;
        factor->size += i + 1 - first;
    }
    find_blocks(factor);
}

static enum status fill(const int64_t *ptr, const int64_t *column, const double *value,
                        struct envelope *factor, struct error *error)
{
    free(factor->value);
    factor->value = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&factor->value, factor->size, error));
    for (int64_t i = 0; i < factor->n; i++) {
        int64_t row = factor->order[i];
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            if (factor->place[column[k]] <= i) { /* in the lower triangle */
                factor->value[factor->at[i] + factor->place[column[k]]] += value[k];
            }
        }
    }
    return STATUS_OK;
}

/* Compute row i of L, with `shift` times the diagonal entry added to that. The row is dropped if its pivot is
 * below `least` times its diagonal entry. */
static void factor_row(const struct envelope *factor, int64_t i, double least, double shift)
{
    int64_t first = factor->first[i];
    double *row = factor->value + factor->at[i], diagonal = row[i];
    for (int64_t k = first; k < i; k++) {
        int64_t from = first > factor->first[k] ? first : factor->first[k];
        const double *other = factor->value + factor->at[k];
        row[k] = (row[k] - dense_dot(k - from, row + from, other + from)) / other[k];
    }
    double pivot = diagonal - dense_dot(i - first, row + first, row + first);
    if (pivot > least * diagonal || shift > 0.0) {
        row[i] = sqrt(fmax(pivot, 0.0) + shift * diagonal);
    } else {
        memset(row + first, 0, (size_t)(i - first) * sizeof *row);
        row[i] = INFINITY;
    }
}

bool envelope_is_dropped(const struct envelope *factor, int64_t i)
{
    return isinf(factor->value[factor->at[i] + i]);
}

/* value[], which is A, becomes L. */
static void factorise(struct envelope *factor, double least, double shift)
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
    RETURN_IF_ERROR(NEW_ARRAY(&factor->place, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->first, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->at, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->scratch, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->block, n + 1, error));
    RETURN_IF_ERROR(order_rows(n, ptr, column, factor->order, error));
    lay_out(ptr, column, factor);
    RETURN_IF_ERROR(fill(ptr, column, value, factor, error));
    factorise(factor, fmax(weak_pivot, least), shift);
    if (factor->dropped > 0) {
        RETURN_IF_ERROR(put_last(factor, error));
        lay_out(ptr, column, factor);
        RETURN_IF_ERROR(fill(ptr, column, value, factor, error));
        factorise(factor, least, shift);
    }
    return STATUS_OK;
}

void envelope_free(struct envelope *factor)
{
    FREE_ALL(factor->order, factor->place, factor->first, factor->at, factor->value, factor->scratch,
             factor->block);
    *factor = (struct envelope){0};
}

/* Solve for block b. */
static void solve_block(const struct envelope *factor, int64_t b, const double *x, double *y)
{
    int64_t begin = factor->block[b], end = factor->block[b + 1];
    while (begin < end && x[factor->order[begin]] == 0.0) { /* zeros stay zeros */
        y[begin++] = 0.0;
    }
    for (int64_t i = begin; i < end; i++) {
        const double *row = factor->value + factor->at[i];
        int64_t from = factor->first[i] > begin ? factor->first[i] : begin;
        y[i] = (x[factor->order[i]] - dense_dot(i - from, row + from, y + from)) / row[i];
    }
    for (int64_t i = end - 1; i >= factor->block[b] && begin < end; i--) {
        const double *row = factor->value + factor->at[i];
        int64_t first = factor->first[i];
        y[i] /= row[i];
        dense_add_row(i - first, -y[i], row + first, y + first);
    }
}

void envelope_solve(const struct envelope *factor, double *x)
{
    double *y = factor->scratch;
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor))
    for (int64_t b = 0; b < factor->block_count; b++) {
        solve_block(factor, b, x, y);
    }
    for (int64_t i = 0; i < factor->n; i++) {
        x[factor->order[i]] = y[i];
    }
}
