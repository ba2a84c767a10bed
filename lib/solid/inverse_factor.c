#include "solid/inverse_factor.h"

#include "base/dense.h"
#include "base/memory.h"
#include "solid/scalar_stiffness.h"
#include "solid/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Entries of a row of L: with 12, 24 and 40 the ratio of the frequencies of a bar is 26, 22, 22; of a ball of
 * flat cells 119, 79, 52. */
enum { MOST_ENTRIES = 24 };
static const double ridge = 1e-9;       /* on the diagonal of S_pp, by itself */
static const double least_share = 1e-6; /* of the mean diagonal entry, that nodes without stiffness have */

/* S up to its diagonal, by rows: those of own nodes, and such others as are needed. */
struct lower {
    int64_t *begin, *end; /* of each row */
    int32_t *idx;
    double *value;
    int64_t count, capacity;
    double least; /* on the diagonal */
};

static enum status make_room(struct lower *lower, int64_t more, struct error *error)
{
    if (lower->count + more > lower->capacity) {
        int64_t capacity = 2 * (lower->count + more) + 4096;
        int32_t *idx = array_grow(lower->idx, capacity, sizeof *idx);
        lower->idx = idx != NULL ? idx : lower->idx;
        double *value = array_grow(lower->value, capacity, sizeof *value);
        lower->value = value != NULL ? value : lower->value;
        if (idx == NULL || value == NULL) {
            return fail_memory(error, "preconditioner");
        }
        lower->capacity = capacity;
    }
    return STATUS_OK;
}

static enum status keep_row(const struct scalar_row *row, int64_t i, struct lower *lower, struct error *error)
{
    enum status status;
    int64_t at = lower->count;
    TRY(make_room(lower, row->count, error));
    if (row->count > 0) {
        memcpy(lower->idx + at, row->node, (size_t)row->count * sizeof *row->node);
        memcpy(lower->value + at, row->value, (size_t)row->count * sizeof *row->value);
    }
    lower->begin[i] = at;
    lower->end[i] = lower->count = at + row->count;
done:
    return status;
}

static enum status make_lower(const struct solid_system *system, const struct inverse_factor *factor,
                              struct lower *lower, struct error *error)
{
    enum status status;
    struct scalar_stiffness stiffness = {0};
    struct scalar_row row = {0};
    double sum = 0.0, *diagonal = NULL;
    int64_t nodes = system->node_count, begin = factor->first[ranks_rank(factor->ranks)],
            end = factor->first[ranks_rank(factor->ranks) + 1];
    TRY(scalar_stiffness_make(system, begin, end, &stiffness, error));
    TRY(scalar_row_make(&stiffness, &row, error));
    TRY(NEW_ARRAY(&lower->begin, nodes, error));
    TRY(NEW_ARRAY(&lower->end, nodes, error));
    TRY(NEW_ARRAY(&diagonal, nodes, error));
    for (int64_t i = begin; i < end; i++) {
        scalar_stiffness_row(&stiffness, i, &row);
        diagonal[i] = row.count > 0 ? row.value[row.count - 1] : 0.0;
        TRY(keep_row(&row, i, lower, error));
    }
    ranks_gather(factor->ranks, diagonal, sizeof *diagonal, factor->first);
    for (int64_t i = 0; i < nodes; i++) {
        sum += diagonal[i];
    }
    lower->least = least_share * sum / (double)nodes;
done:
    free(diagonal);
    scalar_row_free(&row);
    scalar_stiffness_free(&stiffness);
    return status;
}

/* S_ij, j <= i; 0 where there is no such entry. */
static double entry(const struct lower *lower, int32_t i, int32_t j)
{
    int64_t low = lower->begin[i], high = lower->end[i];
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (lower->idx[middle] < j) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    double value = low < lower->end[i] && lower->idx[low] == j ? lower->value[low] : 0.0;
    return i == j ? fmax(value, lower->least) : value;
}

struct near {
    double distance2;
    int32_t node;
};

static int compare_near(const void *left, const void *right)
{
    const struct near *a = left, *b = right;
    if (a->distance2 != b->distance2) {
        return a->distance2 < b->distance2 ? -1 : 1;
    }
    return (a->node > b->node) - (a->node < b->node);
}

static int compare_nodes(const void *left, const void *right)
{
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

/* The list p of row i, ascending, so that i is the last; `near` is scratch. */
static int64_t choose(const struct solid_system *system, const struct lower *lower, int32_t i,
                      struct near *near, int32_t list[MOST_ENTRIES])
{
    int dim = system->dim;
    int64_t count = 0, kept = 0;
    for (int64_t k = lower->begin[i]; k < lower->end[i]; k++) {
        int32_t node = lower->idx[k];
        double distance2 = 0.0;
        for (int a = 0; a < dim && node < i; a++) {
            double step = system->X[(int64_t)node * dim + a] - system->X[(int64_t)i * dim + a];
            distance2 += step * step;
        }
        if (node < i && fpclassify(lower->value[k]) != FP_ZERO) {
            near[count++] = (struct near){distance2, node};
        }
    }
    qsort(near, (size_t)count, sizeof *near, compare_near);
    for (; kept < count && kept < MOST_ENTRIES - 1; kept++) {
        list[kept] = near[kept].node;
    }
    qsort(list, (size_t)kept, sizeof *list, compare_nodes);
    list[kept] = i;
    return kept + 1;
}

/* Row i of L into value[count] over the list. */
static void solve_row(const struct lower *lower, int64_t count, const int32_t *list, double *value)
{
    double matrix[MOST_ENTRIES * MOST_ENTRIES];
    for (int64_t a = 0; a < count; a++) {
        for (int64_t b = 0; b <= a; b++) {
            matrix[a * count + b] = entry(lower, list[a], list[b]) * (a == b ? 1.0 + ridge : 1.0);
        }
    }
    memset(value, 0, (size_t)count * sizeof *value);
    value[count - 1] = 1.0;
    if (dense_factorise(count, matrix)) {
        dense_solve(count, matrix, value);
    } else {
        value[count - 1] = 1.0 / entry(lower, list[count - 1], list[count - 1]);
    }
    double scale = 1.0 / sqrt(value[count - 1]);
    for (int64_t k = 0; k < count; k++) {
        value[k] *= scale;
    }
}

static int owner_of_node(const void *factor, int64_t node)
{
    const struct inverse_factor *of = factor;
    return ranks_owner(of->ranks, of->first, node);
}

/* The rows of S that others have and that those of the own nodes look at. */
static enum status fetch_rows(const struct inverse_factor *factor, const bool *wanted, int64_t nodes,
                              struct lower *lower, struct error *error)
{
    enum status status;
    const struct ranks *ranks = factor->ranks;
    struct halo halo = {0};
    double *length = NULL, *value = NULL;
    int32_t *idx = NULL;
    int64_t *send_first = NULL, *receive_first = NULL, at = 0, first = lower->count;
    TRY(halo_build(ranks, nodes, wanted, 1, owner_of_node, factor, &halo, error));
    TRY(NEW_ARRAY(&length, nodes, error));
    TRY(NEW_ARRAY(&send_first, ranks->count + 1, error));
    TRY(NEW_ARRAY(&receive_first, ranks->count + 1, error));
    for (int64_t i = 0; i < nodes; i++) {
        length[i] = (double)(lower->end[i] - lower->begin[i]);
    }
    halo_exchange(&halo, 1, length);
    for (int r = 0; r < ranks->count; r++) {
        send_first[r + 1] = send_first[r];
        for (int64_t i = halo.send_first[r]; i < halo.send_first[r + 1]; i++) {
            send_first[r + 1] += lower->end[halo.send[i]] - lower->begin[halo.send[i]];
        }
        receive_first[r + 1] = receive_first[r];
        for (int64_t i = halo.receive_first[r]; i < halo.receive_first[r + 1]; i++) {
            int64_t node = halo.receive[i];
            lower->begin[node] = first + receive_first[r + 1];
            receive_first[r + 1] += (int64_t)length[node];
            lower->end[node] = first + receive_first[r + 1];
        }
    }
    TRY(make_room(lower, receive_first[ranks->count], error));
    TRY(NEW_ARRAY(&idx, send_first[ranks->count], error));
    TRY(NEW_ARRAY(&value, send_first[ranks->count], error));
    for (int64_t i = 0; i < halo.send_first[ranks->count]; i++) {
        int64_t from = lower->begin[halo.send[i]], count = lower->end[halo.send[i]] - from;
        memcpy(idx + at, lower->idx + from, (size_t)count * sizeof *idx);
        memcpy(value + at, lower->value + from, (size_t)count * sizeof *value);
        at += count;
    }
    ranks->exchange(ranks, sizeof *idx, idx, send_first, lower->idx + first, receive_first);
    ranks->exchange(ranks, sizeof *value, value, send_first, lower->value + first, receive_first);
    lower->count += receive_first[ranks->count];
done:
    halo_free(&halo);
    free(length);
    free(send_first);
    free(receive_first);
    free(idx);
    free(value);
    return status;
}

/* Rows of own nodes, one behind the other from the begin of the factor's arrays on; length[node]: how long each
 * is. */
static enum status make_rows(const struct solid_system *system, struct lower *lower,
                             struct inverse_factor *factor, int64_t *length, struct error *error)
{
    enum status status;
    struct near *near = NULL;
    bool *wanted = NULL;
    int64_t most = 0, at = 0, begin = factor->first[ranks_rank(factor->ranks)],
            end = factor->first[ranks_rank(factor->ranks) + 1];
    int32_t list[MOST_ENTRIES];
    for (int64_t i = begin; i < end; i++) {
        int64_t entries = lower->end[i] - lower->begin[i];
        most = entries > most ? entries : most;
    }
    TRY(NEW_ARRAY(&near, most, error));
    if (factor->ranks != NULL) {
        TRY(NEW_ARRAY(&wanted, system->node_count, error));
        for (int64_t i = begin; i < end; i++) {
            int64_t count = choose(system, lower, (int32_t)i, near, list);
            for (int64_t k = 0; k < count; k++) {
                wanted[list[k]] = true;
            }
        }
        TRY(fetch_rows(factor, wanted, system->node_count, lower, error));
    }
    for (int64_t i = begin; i < end; i++) {
        length[i] = choose(system, lower, (int32_t)i, near, list);
        memcpy(factor->rows.idx + at, list, (size_t)length[i] * sizeof *list);
        solve_row(lower, length[i], list, factor->rows.value + at);
        at += length[i];
    }
done:
    free(near);
    free(wanted);
    return status;
}

/* All rows to all: each process's go where they belong, and then to the others. */
static enum status gather_rows(struct inverse_factor *factor, int64_t *length, struct error *error)
{
    enum status status;
    const struct ranks *ranks = factor->ranks;
    struct sparse *rows = &factor->rows;
    int rank = ranks_rank(ranks), count = ranks_count(ranks);
    int64_t *first = NULL;
    ranks_gather(ranks, length, sizeof *length, factor->first);
    for (int64_t i = 0; i < rows->row_count; i++) {
        rows->ptr[i + 1] = rows->ptr[i] + length[i];
    }
    TRY(NEW_ARRAY(&first, count + 1, error));
    for (int r = 0; r <= count; r++) {
        first[r] = rows->ptr[factor->first[r]];
    }
    size_t own = (size_t)(first[rank + 1] - first[rank]);
    memmove(rows->idx + first[rank], rows->idx, own * sizeof *rows->idx);
    memmove(rows->value + first[rank], rows->value, own * sizeof *rows->value);
    ranks_gather(ranks, rows->idx, sizeof *rows->idx, first);
    ranks_gather(ranks, rows->value, sizeof *rows->value, first);
done:
    free(first);
    return status;
}

/* Stretches of nodes of about the same work, most of which is that of making S. */
static enum status share_nodes(const struct solid_system *system, struct inverse_factor *factor,
                               struct error *error)
{
    enum status status;
    double *work = NULL;
    TRY(NEW_ARRAY(&work, system->node_count, error));
    if (factor->ranks != NULL) {
        scalar_stiffness_work(system, work);
    }
    TRY(ranks_share(factor->ranks, system->node_count, work, &factor->first, error));
done:
    free(work);
    return status;
}

enum status inverse_factor_build(const struct solid_system *system, struct inverse_factor *factor,
                                 struct error *error)
{
    enum status status;
    struct lower lower = {0};
    int64_t nodes = system->node_count, *length = NULL;
    *factor = (struct inverse_factor){.ranks = system->body.share.ranks};
    TRY(share_nodes(system, factor, error));
    TRY(make_lower(system, factor, &lower, error));
    TRY(sparse_new(nodes, nodes, nodes * MOST_ENTRIES, &factor->rows, error));
    TRY(NEW_ARRAY(&length, nodes, error));
    TRY(make_rows(system, &lower, factor, length, error));
    TRY(gather_rows(factor, length, error));
    TRY(sparse_transpose(&factor->rows, &factor->transposed, error));
done:
    free(length);
    free(lower.begin);
    free(lower.end);
    free(lower.idx);
    free(lower.value);
    if (status != STATUS_OK) {
        inverse_factor_free(factor);
    }
    return status;
}

void inverse_factor_free(struct inverse_factor *factor)
{
    sparse_free(&factor->rows);
    sparse_free(&factor->transposed);
    free(factor->first);
    factor->first = NULL;
}

/* The rows of own nodes, and those of the others. */
static void apply(const struct inverse_factor *factor, const struct sparse *matrix, int dim, const double *x,
                  double *y)
{
    int rank = ranks_rank(factor->ranks);
    sparse_apply_rows(matrix, factor->first[rank], factor->first[rank + 1], dim, x, y);
    ranks_gather(factor->ranks, y, (size_t)dim * sizeof *y, factor->first);
}

void inverse_factor_apply(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    apply(factor, &factor->rows, dim, x, y);
}

void inverse_factor_apply_transposed(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    apply(factor, &factor->transposed, dim, x, y);
}

void inverse_factor_solve_transposed(const struct inverse_factor *factor, int dim, double *x)
{
    const struct sparse *matrix = &factor->transposed;
    for (int64_t n = matrix->row_count; n-- > 0;) {
        int64_t first = matrix->ptr[n];
        for (int64_t i = first + 1; i < matrix->ptr[n + 1]; i++) {
            const double *at = x + (int64_t)matrix->idx[i] * dim;
            for (int a = 0; a < dim; a++) {
                x[n * dim + a] -= matrix->value[i] * at[a];
            }
        }
        for (int a = 0; a < dim; a++) {
            x[n * dim + a] /= matrix->value[first];
        }
    }
}

enum status inverse_factor_transform_rows(const struct inverse_factor *factor,
                                          const struct constraint_rows *rows,
                                          struct constraint_rows *transformed, struct error *error)
{
    enum status status;
    const struct sparse *matrix = &factor->transposed;
    int64_t *at = NULL;
    int32_t *idx = NULL;
    double *phi = NULL;
    constraint_rows_init(transformed, rows->dim);
    TRY(NEW_ARRAY(&at, matrix->row_count, error));
    TRY(NEW_ARRAY(&idx, matrix->row_count, error));
    TRY(NEW_ARRAY(&phi, matrix->row_count, error));
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
            TRY(constraint_rows_add(transformed, length, idx, phi, rows->direction + r * rows->dim,
                                    rows->target[r], rows->curve[r], rows->section[r], rows->node[r], error));
        }
    }
done:
    free(at);
    free(idx);
    free(phi);
    if (status != STATUS_OK) {
        constraint_rows_free(transformed);
    }
    return status;
}
