#include "solid/preconditioner/inverse_stiffness.h"

#include "base/chunks.h"
#include "base/dense.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/preconditioner/stiffness_rows.h"
#include "solid/system/system.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

/* Entries of a row of L. Conjugate gradients on the brain at rest, to 1e-6: 67, 59, 53, 49 with 8, 12, 16, 32
 * neighbours. */
enum { MOST_ENTRIES = 17, MOST_SIZE = 3 * MOST_ENTRIES };
enum { ROWS_AT_ONCE = 16, NODES_FOR_THREAD = 100 };
static const double ridge = 1e-9; /* on the diagonal of K_pp, by itself */
/* Weights up to this are left out of the fields: three times as fast as all; the same iterations to .02, some
 * 20 % more at .04. */
static const double least_weight = 0.02;
static const double least_share = 1e-6; /* least diagonal entry by a typical one */

/* Rows of L of all nodes, by their places in the body's order: MOST_ENTRIES of each. */
struct padded {
    int32_t *idx; /* places of lower nodes, and last, the node's own; then -1 */
    float *block; /* dim * dim of each, by columns */
};
static void padded_free(struct padded *rows)
{
    FREE_ALL(rows->idx, rows->block);
}

static int64_t entries_of(const int32_t *pattern)
{
    int64_t count = 0;
    while (count < MOST_ENTRIES && pattern[count] >= 0) {
        count++;
    }
    return count;
}

/* Nodes whose rows of L are computed, in succession in the body's order. All numbers are places in that
 * order.
 */
struct batch {
    const struct solid_system *system;
    int64_t count;
    const int32_t *pattern; /* of each: its entries in L */
    int32_t *row;           /* row_count: the nodes in the patterns, ascending, whose rows of K are needed, */
    int64_t row_count;
    int64_t *ptr;    /* row_count + 1: and which columns of each, */
    int32_t *column; /* of lower place */
    double *block;   /* dim * dim of each column */
    int32_t *number; /* of places: in row[], or -1 */
    double least;    /* least diagonal entry */
};
static void batch_free(struct batch *batch)
{
    FREE_ALL(batch->row, batch->ptr, batch->column, batch->block, batch->number);
}

/* Nodes near node i of lower number. */
struct near {
    int64_t count, capacity;
    struct placed *list;
    int64_t *seen; /* of each node: 1 + the last i that has it */
};
static void near_free(struct near *near)
{
    FREE_ALL(near->list, near->seen);
}

/* Add those around a node. */
static enum status add_around(const struct solid_system *system, int64_t i, int64_t node, struct near *near,
                              struct error *error)
{
    const struct neighbours *around = system->node_lists;
    int64_t begin = around->ptr[node], end = around->ptr[node + 1];
    RETURN_IF_ERROR(GROW_ARRAY(&near->list, near->count + end - begin, &near->capacity, error));
    for (int64_t k = begin; k < end; k++) {
        int64_t other = around->idx[k];
        if (other < i && near->seen[other] != i + 1) {
            const double *x = system->X + other * system->dim;
            double distance2 = vector_distance2(system->dim, x, system->X + i * system->dim);
            near->seen[other] = i + 1;
            near->list[near->count++] = (struct placed){distance2, other};
        }
    }
    return STATUS_OK;
}

/* The pattern of the row of place p, by distance: of the nodes around it and, in the plane, where supports
 * are narrow, of those around them. */
static enum status choose(const struct solid_system *system, int64_t p, struct near *near, int32_t *pattern,
                          struct error *error)
{
    const struct neighbours *around = system->node_lists;
    int64_t i = system->body.order.nodes[p], kept = 0;
    near->count = 0;
    RETURN_IF_ERROR(add_around(system, i, i, near, error));
    bool few = system->dim == 2 && near->count < MOST_ENTRIES - 1;
    for (int64_t k = around->ptr[i]; few && k < around->ptr[i + 1]; k++) {
        RETURN_IF_ERROR(add_around(system, i, around->idx[k], near, error));
    }
    qsort(near->list, (size_t)near->count, sizeof *near->list, compare_placed);
    for (; kept < near->count && kept < MOST_ENTRIES - 1; kept++) {
        pattern[kept] = system->body.order.places[near->list[kept].item];
    }
    pattern[kept++] = (int32_t)p;
    memset(pattern + kept, -1, (size_t)(MOST_ENTRIES - kept) * sizeof *pattern);
    return STATUS_OK;
}

/* The columns that row `number` of K needs: of the patterns users[count] that its node is in. Returns how
 * many; column: NULL, or these. */
static int64_t list_columns(const struct batch *batch, const int32_t *users, int64_t count, int64_t number,
                            int32_t *seen, int32_t *column)
{
    int64_t columns = 0;
    for (int64_t u = 0; u < count; u++) {
        const int32_t *pattern = batch->pattern + users[u] * MOST_ENTRIES;
        for (int e = 0; e < MOST_ENTRIES && pattern[e] >= 0; e++) {
            if (pattern[e] <= batch->row[number] && seen[pattern[e]] != number + 1) {
                seen[pattern[e]] = (int32_t)number + 1;
                if (column != NULL) {
                    column[columns] = pattern[e];
                }
                columns++;
            }
        }
    }
    return columns;
}

/* List the rows of K and their columns. */
static enum status list_rows(struct batch *batch, struct error *error)
{
    int64_t nodes = batch->system->node_count;
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *users = NULL;
    NEW_SCRATCH(int32_t, seen, nodes, error);
    RETURN_IF_ERROR(NEW_ARRAY(&batch->number, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&batch->row, nodes, error));
    RETURN_IF_ERROR(lists_by_row(batch->count, MOST_ENTRIES, batch->pattern, nodes, &ptr, &users, error));
    for (int64_t p = 0; p < nodes; p++) {
        batch->number[p] = ptr[p + 1] > ptr[p] ? (int32_t)batch->row_count : -1;
        if (ptr[p + 1] > ptr[p]) {
            batch->row[batch->row_count++] = (int32_t)p;
        }
    }
    RETURN_IF_ERROR(NEW_ARRAY(&batch->ptr, batch->row_count + 1, error));
    for (int pass = 0; pass < 2; pass++) {
        memset(seen, 0, (size_t)nodes * sizeof *seen);
        for (int64_t r = 0; r < batch->row_count; r++) {
            const int64_t *of = ptr + batch->row[r];
            int32_t *column = pass == 0 ? NULL : batch->column + batch->ptr[r];
            batch->ptr[r + 1] =
                batch->ptr[r] + list_columns(batch, users + of[0], of[1] - of[0], r, seen, column);
        }
        if (pass == 0) {
            RETURN_IF_ERROR(NEW_ARRAY(&batch->column, batch->ptr[batch->row_count], error));
        }
    }
    return STATUS_OK;
}

/* Compute these rows of K. */
static enum status make_rows(struct batch *batch, struct stiffness_rows *rows, struct error *error)
{
    int64_t values = batch->system->dim * batch->system->dim;
    struct first_failure failure = {STATUS_OK};
    RETURN_IF_ERROR(stiffness_rows_prepare(rows, batch->row, batch->row_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&batch->block, batch->ptr[batch->row_count] * values, error));
#pragma omp parallel num_threads(chunks_of(batch->row_count, NODES_FOR_THREAD).threads)
    {
        struct stiffness_row row;
        struct error own;
        enum status made = stiffness_row_begin(rows, &row, &own);
#pragma omp for schedule(dynamic, ROWS_AT_ONCE)
        for (int64_t r = 0; r < batch->row_count; r++) {
            if (made == STATUS_OK) {
                int64_t at = batch->ptr[r];
                stiffness_row_make(rows, batch->row[r], batch->ptr[r + 1] - at, batch->column + at, &row,
                                   batch->block + at * values);
            }
        }
        stiffness_row_free(&row);
        note_failure(&failure, 0, made, &own, error);
    }
    return failure.status;
}

/* matrix[size * size], its lower triangle: K between the nodes of a list; at[places] = -1, scratch. */
static void take_matrix(const struct batch *batch, int64_t count, const int32_t *list, int32_t *at,
                        double *matrix)
{
    int64_t dim = batch->system->dim, size = count * dim;
    for (int64_t k = 0; k < count; k++) {
        at[list[k]] = (int32_t)k;
    }
    for (int64_t k = 0; k < count; k++) {
        int32_t r = batch->number[list[k]];
        for (int64_t e = batch->ptr[r]; e < batch->ptr[r + 1]; e++) {
            int64_t other = at[batch->column[e]];
            const double *block = batch->block + e * dim * dim;
            for (int64_t v = 0; v < dim * dim && other >= 0; v++) {
                int64_t i = k * dim + v / dim, j = other * dim + v % dim;
                matrix[i > j ? i * size + j : j * size + i] = block[v];
            }
        }
    }
    for (int64_t k = 0; k < count; k++) {
        at[list[k]] = -1;
    }
    for (int64_t i = 0; i < size; i++) {
        matrix[i * (size + 1)] = fmax(matrix[i * (size + 1)] * (1.0 + ridge), batch->least);
    }
}

/* x[dim][size]: the last rows of the inverse of the Cholesky factor R of the matrix: R^T x_a = e_a. */
static void solve_rows(int64_t dim, int64_t size, const double *matrix, double *x)
{
    memset(x, 0, (size_t)(dim * size) * sizeof *x);
    for (int64_t a = 0; a < dim; a++) {
        double *to = x + a * size;
        int64_t last = size - dim + a;
        to[last] = 1.0;
        for (int64_t i = last; i >= 0; i--) {
            to[i] /= matrix[i * (size + 1)];
            dense_add_row(i, -to[i], matrix + i * size, to);
        }
    }
}

/* Row k of L into block[count][dim * dim] over its list. */
static void solve_row(const struct batch *batch, int64_t k, int32_t *at, float *block)
{
    double matrix[MOST_SIZE * MOST_SIZE], x[3 * MOST_SIZE];
    const int32_t *list = batch->pattern + k * MOST_ENTRIES;
    int64_t count = entries_of(list), dim = batch->system->dim;
    int64_t size = count * dim;
    memset(matrix, 0, (size_t)(size * size) * sizeof *matrix);
    take_matrix(batch, count, list, at, matrix);
    if (!dense_factorise(size, matrix)) {
        memset(matrix, 0, (size_t)(size * size) * sizeof *matrix);
        take_matrix(batch, count, list, at, matrix);
        for (int64_t i = 0; i < size; i++) {
            double root = sqrt(matrix[i * (size + 1)]);
            memset(matrix + i * size, 0, (size_t)i * sizeof *matrix);
            matrix[i * (size + 1)] = root;
        }
    }
    solve_rows(dim, size, matrix, x);
    for (int64_t i = 0; i < size * dim; i++) { /* by columns */
        block[i] = (float)x[i % dim * size + i / dim];
    }
}

/* Compute the rows of L of a batch, into their blocks. */
static enum status solve_all(const struct batch *batch, float *block, struct error *error)
{
    int64_t nodes = batch->system->node_count, values = batch->system->dim * batch->system->dim;
    int threads = chunks_of(batch->count, NODES_FOR_THREAD).threads;
    NEW_SCRATCH(int32_t, at, nodes * threads, error);
    memset(at, -1, (size_t)(nodes * threads) * sizeof *at);
#pragma omp parallel for schedule(dynamic, ROWS_AT_ONCE) num_threads(threads)
    for (int64_t k = 0; k < batch->count; k++) {
        solve_row(batch, k, at + omp_get_thread_num() * nodes, block + k * MOST_ENTRIES * values);
    }
    return STATUS_OK;
}

/* Compute the rows of the nodes from `first` to before `last`. */
static enum status make_batch(struct stiffness_rows *rows, int64_t first, int64_t last, double least,
                              struct padded *to, struct error *error)
{
    const struct solid_system *system = rows->system;
    FREED_BY(near_free) struct near near = {0};
    FREED_BY(batch_free)
    struct batch batch = {
        .system = system, .count = last - first, .pattern = to->idx + first * MOST_ENTRIES, .least = least};
    RETURN_IF_ERROR(NEW_ARRAY(&near.seen, system->node_count, error));
    for (int64_t p = first; p < last; p++) {
        RETURN_IF_ERROR(choose(system, p, &near, to->idx + p * MOST_ENTRIES, error));
    }
    RETURN_IF_ERROR(list_rows(&batch, error));
    RETURN_IF_ERROR(make_rows(&batch, rows, error));
    return solve_all(&batch, to->block + first * MOST_ENTRIES * system->dim * system->dim, error);
}

/* The rows of all processes, by the nodes' numbers. */
static enum status gather_rows(const struct body *body, const struct padded *by_place,
                               struct block_rows *rows, struct error *error)
{
    const struct body_share *share = &body->share;
    int64_t nodes = body->node_count, values = body->dim * body->dim;
    ranks_gather(share->ranks, by_place->idx, MOST_ENTRIES * sizeof *by_place->idx, share->node_first);
    ranks_gather(share->ranks, by_place->block, (size_t)(MOST_ENTRIES * values) * sizeof *by_place->block,
                 share->node_first);
    RETURN_IF_ERROR(NEW_ARRAY(&rows->ptr, nodes + 1, error));
    for (int64_t n = 0; n < nodes; n++) {
        rows->ptr[n + 1] = rows->ptr[n] + entries_of(by_place->idx + body->order.places[n] * MOST_ENTRIES);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&rows->idx, rows->ptr[nodes], error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows->block, rows->ptr[nodes] * values, error));
    for (int64_t n = 0; n < nodes; n++) {
        int64_t from = body->order.places[n] * MOST_ENTRIES, to = rows->ptr[n], count = rows->ptr[n + 1] - to;
        for (int64_t e = 0; e < count; e++) {
            rows->idx[to + e] = (int32_t)body->order.nodes[by_place->idx[from + e]];
        }
        memcpy(rows->block + to * values, by_place->block + from * values,
               (size_t)(count * values) * sizeof *rows->block);
    }
    return STATUS_OK;
}

enum status inverse_stiffness_factor(const struct solid_system *system, struct inverse_factor *factor,
                                     struct error *error)
{
    enum { BATCH = 1 << 14 }; /* rows of K take some 7 kB each */
    return inverse_stiffness_factor_by(system, BATCH, factor, error);
}

enum status inverse_stiffness_factor_by(const struct solid_system *system, int64_t batch,
                                        struct inverse_factor *factor, struct error *error)
{
    const struct body_share *share = &system->body.share;
    FREED_BY(stiffness_rows_free) struct stiffness_rows rows = {0};
    FREED_BY(padded_free) struct padded by_place = {0};
    int64_t nodes = system->node_count, values = system->dim * system->dim;
    double least = 0.0;
    *factor = (struct inverse_factor){.ranks = share->ranks, .node_count = nodes, .dim = system->dim};
    RETURN_IF_ERROR(NEW_ARRAY(&by_place.idx, nodes * MOST_ENTRIES, error));
    RETURN_IF_ERROR(NEW_ARRAY(&by_place.block, nodes * MOST_ENTRIES * values, error));
    NEW_SCRATCH(double, diagonal, nodes, error);
    body_diagonal((struct body *)&system->body, true, diagonal);
    for (int64_t n = 0; n < nodes; n++) {
        least += least_share * diagonal[n] / (double)nodes;
    }
    RETURN_IF_ERROR(stiffness_rows_begin(system, &rows, error));
    rows.hold = least / least_share;
    rows.least_weight = least_weight;
    for (int64_t p = share->begin_node; p < share->end_node; p += batch) {
        int64_t last = share->end_node - p < batch ? share->end_node : p + batch;
        RETURN_IF_ERROR(make_batch(&rows, p, last, least, &by_place, error));
    }
    RETURN_IF_ERROR(gather_rows(&system->body, &by_place, &factor->rows, error));
    return inverse_factor_finish(factor, error);
}
