#include "solid/preconditioner/inverse_stiffness.h"

#include "base/dense.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/preconditioner/lower_stiffness.h"
#include "solid/system/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Entries of a row of L: with 12, 24 and 40 the ratio of the frequencies of a bar is 26, 22, 22; of a ball of
 * flat cells 119, 79, 52. In two dimensions a row of S has half as many. */
enum { MOST_ENTRIES = 24, MOST_ENTRIES_2D = 12 };
/* Rows that are worth the while of a thread. */
static const int64_t worthwhile = 500;
static const double ridge = 1e-9; /* on the diagonal of S_pp, by itself */

/* The list p of row i, ascending, so that i is the last; `near` is scratch. */
static int64_t choose(const struct solid_system *system, const struct lower *lower, int32_t i,
                      struct placed *near, int32_t list[MOST_ENTRIES])
{
    int dim = system->dim, most = dim == 2 ? MOST_ENTRIES_2D : MOST_ENTRIES;
    int64_t count = 0, kept = 0;
    struct lower_row row = lower_row(lower, i);
    for (int64_t k = 0; k < row.count; k++) {
        int64_t node = row.idx[k];
        if (node < i && fpclassify(row.value[k]) != FP_ZERO) {
            near[count++] = (struct placed){
                vector_distance2(dim, system->X + node * dim, system->X + (int64_t)i * dim), node};
        }
    }
    qsort(near, (size_t)count, sizeof *near, compare_placed);
    for (; kept < count && kept < most - 1; kept++) {
        list[kept] = (int32_t)near[kept].item;
    }
    qsort(list, (size_t)kept, sizeof *list, compare_int32);
    list[kept] = i;
    return kept + 1;
}

/* Row i of L into value[count] over the list. */
static void solve_row(const struct lower *lower, int64_t count, const int32_t *list, double *value)
{
    double matrix[MOST_ENTRIES * MOST_ENTRIES];
    for (int64_t a = 0; a < count; a++) {
        for (int64_t b = 0; b <= a; b++) {
            matrix[a * count + b] = lower_entry(lower, list[a], list[b]) * (a == b ? 1.0 + ridge : 1.0);
        }
    }
    memset(value, 0, (size_t)count * sizeof *value);
    value[count - 1] = 1.0;
    if (dense_factorise(count, matrix)) {
        dense_solve(count, matrix, value);
    } else {
        value[count - 1] = 1.0 / lower_entry(lower, list[count - 1], list[count - 1]);
    }
    double scale = 1.0 / sqrt(value[count - 1]);
    for (int64_t k = 0; k < count; k++) {
        value[k] *= scale;
    }
}

/* Make the rows of S that a batch of rows of L needs and that do not exist yet; rows->idx has their numbers.
 */
static enum status add_rows(const struct solid_system *system, int64_t first, int64_t last,
                            const struct sparse *rows, const int64_t *length, struct lower *lower,
                            struct error *error)
{
    NEW_SCRATCH(bool, wanted, system->node_count, error);
    for (int64_t p = first; p < last; p++) {
        for (int64_t k = 0; k < length[p]; k++) {
            wanted[rows->idx[p * MOST_ENTRIES + k]] = true;
        }
    }
    return system->body.share.ranks != NULL ? lower_fetch(wanted, lower, error)
                                            : lower_add(wanted, lower, error);
}

/* Rows of the nodes from `first` to before `last` in the body's order, the one at place p at
 * p * MOST_ENTRIES; length[]: how long each is. */
static enum status make_rows(const struct solid_system *system, int64_t first, int64_t last,
                             struct lower *lower, struct sparse *rows, int64_t *length, struct error *error)
{
    const int64_t *node = system->body.node_order;
    const struct chunks chunks = chunks_of(last - first, worthwhile);
    int64_t most = 0;
    for (int64_t p = first; p < last; p++) {
        int64_t entries = lower_row(lower, node[p]).count;
        most = entries > most ? entries : most;
    }
    NEW_SCRATCH(struct placed, near, most * chunks.count, error);
#pragma omp parallel for schedule(static, 1) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        for (int64_t p = first + chunks_begin(&chunks, c); p < first + chunks_begin(&chunks, c + 1); p++) {
            length[p] =
                choose(system, lower, (int32_t)node[p], near + c * most, rows->idx + p * MOST_ENTRIES);
        }
    }
    RETURN_IF_ERROR(add_rows(system, first, last, rows, length, lower, error));
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t p = first; p < last; p++) {
        int64_t at = p * MOST_ENTRIES;
        solve_row(lower, length[p], rows->idx + at, rows->value + at);
    }
    return STATUS_OK;
}

/* Make all own rows, in batches of nodes, holding S for one batch at a time. The diagonal entry of nodes
 * without stiffness is known only when all of S has been computed; then the rows are made again. */
static enum status make_own_rows(const struct solid_system *system, int64_t batch, struct lower *lower,
                                 struct sparse *rows, int64_t *length, struct error *error)
{
    const struct body_share *share = &system->body.share;
    int64_t begin = share->begin_node, end = share->end_node;
    bool good = false;
    if (share->ranks != NULL || end - begin <= batch) {
        RETURN_IF_ERROR(lower_make(begin, end, lower, error));
        (void)lower_set_least(lower);
        RETURN_IF_ERROR(make_rows(system, begin, end, lower, rows, length, error));
        return STATUS_OK;
    }
    for (int time = 0; time < 2 && !good; time++) {
        for (int64_t p = begin; p < end; p += batch) {
            int64_t last = end - p < batch ? end : p + batch;
            RETURN_IF_ERROR(lower_make(p, last, lower, error));
            RETURN_IF_ERROR(make_rows(system, p, last, lower, rows, length, error));
        }
        good = lower_set_least(lower);
    }
    return STATUS_OK;
}

/* Store the rows consecutively, rows->ptr[] in the body's order, and give the rows of all processes to all.
 */
static enum status gather_rows(const struct body_share *share, int64_t *length, struct sparse *rows,
                               struct error *error)
{
    int count = ranks_count(share->ranks);
    ranks_gather(share->ranks, length, sizeof *length, share->node_first);
    for (int64_t p = 0; p < rows->row_count; p++) {
        rows->ptr[p + 1] = rows->ptr[p] + length[p];
    }
    for (int64_t p = share->begin_node; p < share->end_node; p++) {
        int64_t from = p * MOST_ENTRIES, to = rows->ptr[p];
        memmove(rows->idx + to, rows->idx + from, (size_t)length[p] * sizeof *rows->idx);
        memmove(rows->value + to, rows->value + from, (size_t)length[p] * sizeof *rows->value);
    }
    NEW_SCRATCH(int64_t, first, count + 1, error);
    for (int r = 0; r <= count; r++) {
        first[r] = rows->ptr[share->node_first[r]];
    }
    ranks_gather(share->ranks, rows->idx, sizeof *rows->idx, first);
    ranks_gather(share->ranks, rows->value, sizeof *rows->value, first);
    return STATUS_OK;
}

/* The rows by the nodes' numbers. */
static enum status sort_rows(const struct body *body, const struct sparse *by_place, struct sparse *rows,
                             struct error *error)
{
    int64_t nodes = by_place->row_count;
    RETURN_IF_ERROR(sparse_new(nodes, nodes, by_place->ptr[nodes], rows, error));
    for (int64_t i = 0; i < nodes; i++) {
        int64_t from = by_place->ptr[body->node_place[i]], to = rows->ptr[i];
        int64_t length = by_place->ptr[body->node_place[i] + 1] - from;
        memcpy(rows->idx + to, by_place->idx + from, (size_t)length * sizeof *rows->idx);
        memcpy(rows->value + to, by_place->value + from, (size_t)length * sizeof *rows->value);
        rows->ptr[i + 1] = to + length;
    }
    return STATUS_OK;
}

enum status inverse_stiffness_factor(const struct solid_system *system, struct inverse_factor *factor,
                                     struct error *error)
{
    enum { STRETCH = 1 << 16 }; /* rows of S take about 5 kB each */
    return inverse_stiffness_factor_by(system, STRETCH, factor, error);
}

static int owner(const void *factor, int64_t node)
{
    const struct inverse_factor *of = factor;
    return ranks_owner(of->ranks, of->first, node);
}

enum status inverse_stiffness_factor_by(const struct solid_system *system, int64_t batch,
                                        struct inverse_factor *factor, struct error *error)
{
    FREED_BY(lower_free) struct lower lower = {0};
    FREED_BY(sparse_free) struct sparse by_place = {0};
    const struct body_share *share = &system->body.share;
    int64_t nodes = system->node_count;
    SCRATCH bool *wanted = NULL;
    *factor = (struct inverse_factor){.ranks = share->ranks};
    RETURN_IF_ERROR(ranks_share(factor->ranks, nodes, NULL, &factor->first, error));
    RETURN_IF_ERROR(lower_begin(system, &lower, error));
    RETURN_IF_ERROR(sparse_new(nodes, nodes, nodes * MOST_ENTRIES, &by_place, error));
    NEW_SCRATCH(int64_t, length, nodes, error);
    RETURN_IF_ERROR(make_own_rows(system, batch, &lower, &by_place, length, error));
    RETURN_IF_ERROR(gather_rows(share, length, &by_place, error));
    lower_free(&lower);
    RETURN_IF_ERROR(sort_rows(&system->body, &by_place, &factor->rows, error));
    RETURN_IF_ERROR(sparse_transpose(&factor->rows, &factor->transposed, error));
    RETURN_IF_ERROR(inverse_factor_wanted(factor, &wanted, error));
    return halo_build(factor->ranks, nodes, wanted, 3, owner, factor, &factor->halo, error);
}

enum status inverse_stiffness_rows(const struct inverse_factor *factor, const struct constraint_rows *rows,
                                   struct constraint_rows *transformed, struct error *error)
{
    const struct sparse *matrix = &factor->transposed;
    constraint_rows_init(transformed, rows->dim);
    NEW_SCRATCH(int64_t, at, matrix->row_count, error);
    NEW_SCRATCH(int32_t, idx, matrix->row_count, error);
    NEW_SCRATCH(double, phi, matrix->row_count, error);
    memset(at, -1, (size_t)matrix->row_count * sizeof *at);
    for (int64_t l = 0, r = 0; l < rows->list_count; l++) {
        struct average average = constraint_rows_average(rows, r);
        int64_t length = 0;
        for (int64_t i = 0; i < average.length; i++) {
            int32_t node = average.idx[i];
            for (int64_t k = matrix->ptr[node]; k < matrix->ptr[node + 1]; k++) {
                int32_t column = matrix->idx[k];
                if (at[column] < 0) {
                    at[column] = length;
                    idx[length] = column;
                    phi[length++] = 0.0;
                }
                phi[at[column]] += average.phi[i] * matrix->value[k];
            }
        }
        for (int64_t i = 0; i < length; i++) {
            at[idx[i]] = -1;
        }
        for (; r < rows->first[l + 1]; r++) {
            RETURN_IF_ERROR(constraint_rows_add(transformed, length, idx, phi,
                                                rows->direction + r * rows->dim, rows->target[r],
                                                rows->curve[r], rows->section[r], rows->node[r], error));
        }
    }
    return STATUS_OK;
}
