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

/* S up to its diagonal, by rows. */
struct lower {
    int64_t *ptr;
    int32_t *idx;
    double *value;
    int64_t capacity;
    double least; /* on the diagonal */
};

static enum status keep_row(const struct scalar_row *row, int64_t i, struct lower *lower, struct error *error)
{
    int64_t at = lower->ptr[i];
    if (at + row->count > lower->capacity) {
        int64_t capacity = (at + row->count) / 4 * 5 + 4096;
        int32_t *idx = array_grow(lower->idx, capacity, sizeof *idx);
        lower->idx = idx != NULL ? idx : lower->idx;
        double *value = array_grow(lower->value, capacity, sizeof *value);
        lower->value = value != NULL ? value : lower->value;
        if (idx == NULL || value == NULL) {
            return fail_memory(error, "preconditioner");
        }
        lower->capacity = capacity;
    }
    if (row->count > 0) {
        memcpy(lower->idx + at, row->node, (size_t)row->count * sizeof *row->node);
        memcpy(lower->value + at, row->value, (size_t)row->count * sizeof *row->value);
    }
    lower->ptr[i + 1] = at + row->count;
    return STATUS_OK;
}

static enum status make_lower(const struct solid_system *system, struct lower *lower, struct error *error)
{
    enum status status;
    struct scalar_stiffness stiffness = {0};
    struct scalar_row row = {0};
    double sum = 0.0;
    TRY(scalar_stiffness_make(system, &stiffness, error));
    TRY(scalar_row_make(&stiffness, &row, error));
    TRY(NEW_ARRAY(&lower->ptr, system->node_count + 1, error));
    for (int64_t i = 0; i < system->node_count; i++) {
        scalar_stiffness_row(&stiffness, i, &row);
        sum += row.count > 0 ? row.value[row.count - 1] : 0.0;
        TRY(keep_row(&row, i, lower, error));
    }
    lower->least = least_share * sum / (double)system->node_count;
done:
    scalar_row_free(&row);
    scalar_stiffness_free(&stiffness);
    return status;
}

/* S_ij, j <= i; 0 where there is no such entry. */
static double entry(const struct lower *lower, int32_t i, int32_t j)
{
    int64_t low = lower->ptr[i], high = lower->ptr[i + 1];
    while (low < high) {
        int64_t middle = (low + high) / 2;
        if (lower->idx[middle] < j) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    double value = low < lower->ptr[i + 1] && lower->idx[low] == j ? lower->value[low] : 0.0;
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
    for (int64_t k = lower->ptr[i]; k < lower->ptr[i + 1]; k++) {
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

static enum status make_rows(const struct solid_system *system, const struct lower *lower,
                             struct sparse *factor, struct error *error)
{
    enum status status;
    struct near *near = NULL;
    int64_t most = 0;
    for (int64_t i = 0; i < system->node_count; i++) {
        int64_t length = lower->ptr[i + 1] - lower->ptr[i];
        most = length > most ? length : most;
        factor->ptr[i + 1] = factor->ptr[i] + (length < MOST_ENTRIES ? length : MOST_ENTRIES);
    }
    TRY(NEW_ARRAY(&near, most, error));
    int64_t at = 0;
    for (int64_t i = 0; i < system->node_count; i++) {
        int32_t list[MOST_ENTRIES];
        int64_t count = choose(system, lower, (int32_t)i, near, list);
        memcpy(factor->idx + at, list, (size_t)count * sizeof *list);
        solve_row(lower, count, list, factor->value + at);
        at += count;
        factor->ptr[i + 1] = at;
    }
done:
    free(near);
    return status;
}

enum status inverse_factor_build(const struct solid_system *system, struct inverse_factor *factor,
                                 struct error *error)
{
    enum status status;
    struct lower lower = {0};
    int64_t nodes = system->node_count;
    *factor = (struct inverse_factor){0};
    TRY(make_lower(system, &lower, error));
    TRY(sparse_new(nodes, nodes, nodes * MOST_ENTRIES, &factor->rows, error));
    TRY(make_rows(system, &lower, &factor->rows, error));
    TRY(sparse_transpose(&factor->rows, &factor->transposed, error));
done:
    free(lower.ptr);
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
}

void inverse_factor_apply(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    sparse_apply(&factor->rows, dim, x, y);
}

void inverse_factor_apply_transposed(const struct inverse_factor *factor, int dim, const double *x, double *y)
{
    sparse_apply(&factor->transposed, dim, x, y);
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
