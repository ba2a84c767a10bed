#include "base/envelope.h"

#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/processor.h"

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

/* The rows of a group: a register of processors with AVX-512. */
typedef double eight __attribute__((vector_size(64), aligned(8), may_alias));
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

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
 * entry before it. first[]: of each row. */
static void find_blocks(struct envelope *factor, const int64_t *first)
{
    int64_t n = factor->n, least = n, *block = factor->block, blocks = 0;
    block[n] = n;
    for (int64_t i = n - 1; i >= 0; i--) {
        least = first[i] < least ? first[i] : least;
        if (least == i) {
            blocks++;
            block[n - blocks] = i;
        }
    }
    memmove(block, block + n - blocks, (size_t)(blocks + 1) * sizeof *block);
    factor->block_count = blocks;
}

/* Divide each block into groups; the first column of a group is that of a group. */
static void find_groups(struct envelope *factor, const int64_t *first)
{
    int64_t count = 0, size = 0;
    for (int64_t b = 0; b < factor->block_count; b++) {
        int64_t begin = factor->block[b], end = factor->block[b + 1];
        factor->block[b] = count;
        for (int64_t i = begin; i < end; i += ENVELOPE_GROUP, count++) {
            int64_t last = i + ENVELOPE_GROUP < end ? i + ENVELOPE_GROUP : end, least = i;
            for (int64_t k = i; k < last; k++) {
                least = first[k] < least ? first[k] : least;
            }
            least -= (least - begin) % ENVELOPE_GROUP;
            factor->groups[count] = (struct envelope_group){i, last - i, least, size};
            size += (i + ENVELOPE_GROUP - least) * ENVELOPE_GROUP;
        }
    }
    factor->block[factor->block_count] = factor->group_count = count;
    factor->size = size;
}

static double *column_of(const struct envelope *factor, const struct envelope_group *group, int64_t column)
{
    return factor->value + group->start + (column - group->first) * ENVELOPE_GROUP;
}

static inline int threads_for(const struct envelope *factor)
{
    return factor->block_count > 1 ? chunks_of(factor->size, ENTRIES_FOR_THREAD).threads : 1;
}

static enum status lay_out(const int64_t *ptr, const int64_t *column, struct envelope *factor,
                           struct error *error)
{
    NEW_SCRATCH(int64_t, first, factor->n, error);
    for (int64_t i = 0; i < factor->n; i++) {
        factor->place[factor->order[i]] = i;
    }
    for (int64_t i = 0; i < factor->n; i++) {
        int64_t row = factor->order[i];
        first[i] = i;
        for (int64_t k = ptr[row]; k < ptr[row + 1]; k++) {
            int64_t other = factor->place[column[k]];
            first[i] = other < first[i] ? other : first[i];
        }
    }
    find_blocks(factor, first);
    find_groups(factor, first);
    for (int64_t g = 0; g < factor->group_count; g++) {
        const struct envelope_group *group = &factor->groups[g];
        for (int64_t i = 0; i < group->count; i++) {
            factor->at[factor->order[group->row + i]] = group->start - group->first * ENVELOPE_GROUP + i;
        }
    }
    return STATUS_OK;
}

static enum status fill(const int64_t *ptr, const int64_t *column, const double *value,
                        struct envelope *factor, struct error *error)
{
    free(factor->value);
    factor->value = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&factor->value, factor->size, error));
    for (int64_t i = 0; i < factor->n; i++) {
        for (int64_t k = ptr[i]; k < ptr[i + 1]; k++) {
            if (factor->place[column[k]] <= factor->place[i]) { /* in the lower triangle */
                factor->value[factor->at[i] + factor->place[column[k]] * ENVELOPE_GROUP] += value[k];
            }
        }
    }
    return STATUS_OK;
}

/* rest[columns of `right`] -= left right^T, over `count` columns of both groups. */
KERNEL_INLINE void subtract(int64_t count, const double *left, const double *right, double *rest)
{
    enum { AT_ONCE = 4 }; /* columns */
    for (int from = 0; from < ENVELOPE_GROUP; from += AT_ONCE) {
        eight sum[AT_ONCE];
        for (int k = 0; k < AT_ONCE; k++) {
            sum[k] = *(const eight *)(rest + (from + k) * ENVELOPE_GROUP);
        }
        for (int64_t m = 0; m < count; m++) {
            eight rows = *(const eight *)(left + m * ENVELOPE_GROUP);
            for (int k = 0; k < AT_ONCE; k++) {
                sum[k] -= right[m * ENVELOPE_GROUP + from + k] * rows;
            }
        }
        for (int k = 0; k < AT_ONCE; k++) {
            *(eight *)(rest + (from + k) * ENVELOPE_GROUP) = sum[k];
        }
    }
}

/* rest[column k] -= what the columns of `rest` before take; `other`: the rows of these columns. */
KERNEL_INLINE void reduce(int64_t k, const double *other, double *rest)
{
    eight column = *(const eight *)(rest + k * ENVELOPE_GROUP);
    for (int64_t c = 0; c < k; c++) {
        column -= other[c * ENVELOPE_GROUP + k] * *(const eight *)(rest + c * ENVELOPE_GROUP);
    }
    *(eight *)(rest + k * ENVELOPE_GROUP) = column;
}

/* Compute row k of a group and the column below. The row is dropped if its pivot is below `least` times its
 * diagonal entry. */
KERNEL_INLINE void finish_row(const struct envelope_group *group, int64_t k, double diagonal, double least,
                              double shift, double *rows, double *rest)
{
    double *column = rest + k * ENVELOPE_GROUP;
    reduce(k, rest, rest);
    double pivot = column[k];
    if (!(pivot > least * diagonal) && !(shift > 0.0)) {
        for (double *entry = rows + k; entry < column; entry += ENVELOPE_GROUP) {
            *entry = 0.0;
        }
        pivot = INFINITY;
    } else {
        pivot = sqrt(fmax(pivot, 0.0) + shift * diagonal);
    }
    for (int64_t i = 0; i < ENVELOPE_GROUP; i++) {
        column[i] = i < k || i >= group->count ? 0.0 : column[i] / pivot;
    }
    column[k] = pivot;
}

/* Compute the rows of group g of L, with `shift` times the diagonal entries added to these. */
ALL_SETS static void factor_group(const struct envelope *factor, int64_t g, double least, double shift)
{
    const struct envelope_group *group = &factor->groups[g];
    double *rows = column_of(factor, group, group->first), *rest = column_of(factor, group, group->row);
    double diagonal[ENVELOPE_GROUP];
    for (int64_t i = 0; i < group->count; i++) {
        diagonal[i] = rest[i * (ENVELOPE_GROUP + 1)];
    }
    for (int64_t h = g - (group->row - group->first) / ENVELOPE_GROUP; h < g; h++) {
        const struct envelope_group *before = &factor->groups[h];
        int64_t from = group->first > before->first ? group->first : before->first;
        double *there = column_of(factor, group, before->row);
        const double *other = column_of(factor, before, before->row);
        subtract(before->row - from, column_of(factor, group, from), column_of(factor, before, from), there);
        for (int64_t k = 0; k < ENVELOPE_GROUP; k++) {
            reduce(k, other, there);
            *(eight *)(there + k * ENVELOPE_GROUP) /= other[k * (ENVELOPE_GROUP + 1)];
        }
    }
    subtract(group->row - group->first, rows, rows, rest);
    for (int64_t k = 0; k < group->count; k++) {
        finish_row(group, k, diagonal[k], least, shift, rows, rest);
    }
}

bool envelope_is_dropped(const struct envelope *factor, int64_t i)
{
    return isinf(factor->value[factor->at[factor->order[i]] + i * ENVELOPE_GROUP]);
}

/* value[], which is A, becomes L. */
static void factorise(struct envelope *factor, double least, double shift)
{
#pragma omp parallel for schedule(static, 1) num_threads(threads_for(factor))
    for (int64_t b = 0; b < factor->block_count; b++) {
        for (int64_t g = factor->block[b]; g < factor->block[b + 1]; g++) {
            factor_group(factor, g, least, shift);
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

/* Order the rows, and set all but value[]. */
static enum status begin(int64_t n, const int64_t *ptr, const int64_t *column, struct envelope *factor,
                         struct error *error)
{
    *factor = (struct envelope){.n = n};
    RETURN_IF_ERROR(NEW_ARRAY(&factor->order, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->place, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->at, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->groups, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->scratch, n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&factor->block, n + 1, error));
    RETURN_IF_ERROR(order_rows(n, ptr, column, factor->order, error));
    return lay_out(ptr, column, factor, error);
}

enum status envelope_factorise(int64_t n, const int64_t *ptr, const int64_t *column, const double *value,
                               double least, double shift, struct envelope *factor, struct error *error)
{
    RETURN_IF_ERROR(begin(n, ptr, column, factor, error));
    RETURN_IF_ERROR(fill(ptr, column, value, factor, error));
    factorise(factor, fmax(weak_pivot, least), shift);
    if (factor->dropped > 0) {
        RETURN_IF_ERROR(put_last(factor, error));
        RETURN_IF_ERROR(lay_out(ptr, column, factor, error));
        RETURN_IF_ERROR(fill(ptr, column, value, factor, error));
        factorise(factor, least, shift);
    }
    return STATUS_OK;
}

void envelope_free(struct envelope *factor)
{
    FREE_ALL(factor->order, factor->place, factor->at, factor->groups, factor->value, factor->scratch,
             factor->block);
    *factor = (struct envelope){0};
}

#define PAIRS(a, b, i, k) ((four){(a)[i], (b)[i], (a)[k], (b)[k]})

/* y[count] -= the columns[count] of a group, each times x. */
KERNEL_INLINE void subtract_columns(int64_t count, const double *columns, const eight *x, double *y)
{
    for (int64_t m = 0; m < count; m += 4) {
        four half[4];
        for (int k = 0; k < 4; k++) {
            eight product = *(const eight *)(columns + (m + k) * ENVELOPE_GROUP) * *x;
            half[k] = (four){product[0], product[1], product[2], product[3]} +
                      (four){product[4], product[5], product[6], product[7]};
        }
        four left = PAIRS(half[0], half[1], 0, 2) + PAIRS(half[0], half[1], 1, 3);
        four right = PAIRS(half[2], half[3], 0, 2) + PAIRS(half[2], half[3], 1, 3);
        *(four *)(y + m) -=
            (four){left[0], left[1], right[0], right[1]} + (four){left[2], left[3], right[2], right[3]};
    }
}

/* y = L^-1 x in the rows of a group, after those before. */
KERNEL_INLINE void solve_group(const struct envelope *factor, const struct envelope_group *group,
                               const double *x, double *y)
{
    const double *columns = factor->value + group->start;
    int64_t count = group->row - group->first;
    eight sum[4] = {{0.0}};
    for (int64_t m = 0; m < count; m += 4) {
        for (int k = 0; k < 4; k++) {
            sum[k] += y[group->first + m + k] * *(const eight *)(columns + (m + k) * ENVELOPE_GROUP);
        }
    }
    eight rest = -((sum[0] + sum[1]) + (sum[2] + sum[3]));
    for (int64_t k = 0; k < group->count; k++) {
        rest[k] += x[factor->order[group->row + k]];
    }
    for (int64_t k = 0; k < group->count; k++) {
        const double *column = columns + (count + k) * ENVELOPE_GROUP;
        y[group->row + k] = rest[k] / column[k];
        rest -= y[group->row + k] * *(const eight *)column;
    }
}

/* y = L^-T y in the rows of a group, after those behind, and y less what these take before. */
KERNEL_INLINE void solve_group_back(const struct envelope *factor, const struct envelope_group *group,
                                    double *y)
{
    const double *columns = factor->value + group->start;
    int64_t count = group->row - group->first;
    eight last = {0.0};
    for (int64_t k = group->count - 1; k >= 0; k--) {
        const double *column = columns + (count + k) * ENVELOPE_GROUP;
        double sum = y[group->row + k];
        for (int64_t i = k + 1; i < group->count; i++) {
            sum -= column[i] * last[i];
        }
        y[group->row + k] = last[k] = sum / column[k];
    }
    subtract_columns(count, columns, &last, y + group->first);
}

/* Solve for block b. */
ALL_SETS static void solve_block(const struct envelope *factor, int64_t b, const double *x, double *y)
{
    bool some = false; /* a right-hand side, in the groups so far */
    for (int64_t g = factor->block[b]; g < factor->block[b + 1]; g++) {
        const struct envelope_group *group = &factor->groups[g];
        for (int64_t i = group->row; i < group->row + group->count; i++) {
            some = some || x[factor->order[i]] != 0.0;
            y[i] = 0.0;
        }
        if (some) {
            solve_group(factor, group, x, y);
        }
    }
    for (int64_t g = factor->block[b + 1] - 1; g >= factor->block[b] && some; g--) {
        solve_group_back(factor, &factor->groups[g], y);
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
