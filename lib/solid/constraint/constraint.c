#include "solid/constraint/constraint.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Rows with a smaller relative pivot count as linearly dependent and are dropped: the part of such a row that
 * is independent of the others is at most 1e-5 of it. Their forces are shared with the shift. */
static const double least_pivot = 1e-10, share_shift = 1e-8;

void constraint_rows_init(struct constraint_rows *rows, int dim)
{
    *rows = (struct constraint_rows){.dim = dim};
}

void constraint_rows_free(struct constraint_rows *rows)
{
    FREE_ALL(rows->ptr, rows->first, rows->list, rows->idx, rows->phi, rows->direction, rows->target,
             rows->start, rows->curve, rows->section, rows->node);
    *rows = (struct constraint_rows){0};
}

static enum status reserve(struct constraint_rows *rows, int64_t length, struct error *error)
{
    int64_t pairs = rows->list_count > 0 ? rows->ptr[rows->list_count] : 0;
    if (rows->count == rows->capacity) {
        int64_t capacity = rows->capacity * 2 + 64;
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->ptr, capacity + 1, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->first, capacity + 1, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->list, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->direction, capacity * rows->dim, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->target, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->curve, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->section, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->node, capacity, error));
        rows->capacity = capacity;
        rows->ptr[0] = rows->first[0] = 0;
    }
    if (pairs + length > rows->pair_capacity) {
        int64_t capacity = (pairs + length) * 2 + 1024;
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->idx, capacity, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&rows->phi, capacity, error));
        rows->pair_capacity = capacity;
    }
    return STATUS_OK;
}

/* Whether this is the list of the last row. */
static bool is_last_list(const struct constraint_rows *rows, int64_t length, const int32_t *idx,
                         const double *phi)
{
    if (rows->count == 0) {
        return false;
    }
    struct average last = constraint_rows_average(rows, rows->count - 1);
    return last.length == length && memcmp(last.idx, idx, (size_t)length * sizeof *idx) == 0 &&
           memcmp(last.phi, phi, (size_t)length * sizeof *phi) == 0;
}

enum status constraint_rows_add(struct constraint_rows *rows, int64_t length, const int32_t *idx,
                                const double *phi, const double *direction, double target, int32_t curve,
                                int32_t section, int32_t node, struct error *error)
{
    if (length < 1) {
        return fail(error, STATUS_INPUT, "a condition at node %d over no nodes", node);
    }
    enum status status = reserve(rows, length, error);
    if (status != STATUS_OK) {
        return status;
    }
    if (!is_last_list(rows, length, idx, phi)) {
        int64_t at = rows->ptr[rows->list_count++];
        memcpy(rows->idx + at, idx, (size_t)length * sizeof *idx);
        memcpy(rows->phi + at, phi, (size_t)length * sizeof *phi);
        rows->ptr[rows->list_count] = at + length;
    }
    int64_t row = rows->count++;
    rows->list[row] = rows->list_count - 1;
    rows->first[rows->list_count] = rows->count;
    memcpy(rows->direction + row * rows->dim, direction, (size_t)rows->dim * sizeof *direction);
    rows->target[row] = target;
    rows->curve[row] = curve;
    rows->section[row] = section;
    rows->node[row] = node;
    return STATUS_OK;
}

/* List l as an average. */
static struct average average_of_list(const struct constraint_rows *rows, int64_t l)
{
    int64_t at = rows->ptr[l];
    return (struct average){rows->ptr[l + 1] - at, rows->idx + at, rows->phi + at};
}

struct average constraint_rows_average(const struct constraint_rows *rows, int64_t r)
{
    return average_of_list(rows, rows->list[r]);
}

struct sparse constraint_rows_lists(const struct constraint_rows *rows, int64_t node_count)
{
    static int64_t none[1]; /* of no rows */
    return (struct sparse){.row_count = rows->list_count,
                           .column_count = node_count,
                           .ptr = rows->list_count > 0 ? rows->ptr : none,
                           .idx = rows->idx,
                           .value = rows->phi};
}

/* The component of a vector along the direction of row r. */
static double along(const struct constraint_rows *rows, int64_t r, const double *vector)
{
    return vector_dot(rows->dim, rows->direction + r * rows->dim, vector);
}

void constraint_rows_take(const struct constraint_rows *rows, int64_t begin, int64_t end, const double *u,
                          double *value)
{
    for (int64_t l = begin; l < end; l++) {
        struct average average = average_of_list(rows, l);
        double mean[3];
        average_take(&average, rows->dim, u, mean);
        for (int64_t r = rows->first[l]; r < rows->first[l + 1]; r++) {
            value[r] = along(rows, r, mean);
        }
    }
}

double constraint_rows_value(const struct constraint_rows *rows, int64_t r, const double *u)
{
    struct average average = constraint_rows_average(rows, r);
    double mean[3];
    average_take(&average, rows->dim, u, mean);
    return along(rows, r, mean);
}

double constraint_rows_target(const struct constraint_rows *rows, int64_t r, const double *factor)
{
    double target = rows->target[r] * factor[rows->curve[r]];
    return rows->start != NULL ? target + rows->start[r] * factor[rows->start_curve] : target;
}

/* G M^-1 G^T in CSR. Rows of orthogonal directions do not couple, so that axis-aligned conditions decompose.
 */
static enum status assemble(const struct constraint_rows *rows, int64_t node_count, const double *mass,
                            int64_t **ptr, int64_t **column, double **value, struct error *error)
{
    const struct sparse lists = constraint_rows_lists(rows, node_count);
    FREED_BY(sparse_free) struct sparse of_node = {0};
    SCRATCH int64_t *touched = NULL, *last = NULL;
    int64_t capacity = 0, at = 0; /* last: the list that touched each last */
    RETURN_IF_ERROR(sparse_transpose(&lists, &of_node, error));
    RETURN_IF_ERROR(NEW_ARRAY(ptr, rows->count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&touched, rows->list_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&last, rows->list_count, error));
    NEW_SCRATCH(double, sum, rows->list_count, error);
    for (int64_t l = 0; l < rows->list_count; l++) {
        int64_t count = 0;
        for (int64_t i = rows->ptr[l]; i < rows->ptr[l + 1]; i++) {
            int32_t node = rows->idx[i];
            for (int64_t k = of_node.ptr[node]; k < of_node.ptr[node + 1]; k++) {
                int32_t m = of_node.idx[k];
                if (last[m] != l + 1) {
                    last[m] = l + 1;
                    sum[m] = 0.0;
                    touched[count++] = m;
                }
                sum[m] += rows->phi[i] * of_node.value[k] / (mass != NULL ? mass[node] : 1.0);
            }
        }
        for (int64_t r = rows->first[l]; r < rows->first[l + 1]; r++) {
            for (int64_t t = 0; t < count; t++) {
                for (int64_t s = rows->first[touched[t]]; s < rows->first[touched[t] + 1]; s++) {
                    double cosine = along(rows, r, rows->direction + s * rows->dim);
                    if (fabs(cosine) < 1e-14) {
                        continue;
                    }
                    if (at == capacity) {
                        capacity = at * 2 + 1024;
                        RETURN_IF_ERROR(RESIZE_ARRAY(column, capacity, error));
                        RETURN_IF_ERROR(RESIZE_ARRAY(value, capacity, error));
                    }
                    (*column)[at] = s;
                    (*value)[at++] = cosine * sum[touched[t]];
                }
            }
            (*ptr)[r + 1] = at;
        }
    }
    return STATUS_OK;
}

enum status constraint_factorise(const struct constraint_rows *rows, int64_t node_count, const double *mass,
                                 double least, struct envelope *factor, struct error *error)
{
    SCRATCH int64_t *ptr = NULL, *column = NULL;
    SCRATCH double *value = NULL;
    RETURN_IF_ERROR(assemble(rows, node_count, mass, &ptr, &column, &value, error));
    return envelope_factorise(rows->count, ptr, column, value, least, 0.0, factor, error);
}

enum status constraint_build(const struct constraint_rows *rows, int64_t node_count, const double *mass,
                             struct constraint *constraint, struct error *error)
{
    *constraint = (struct constraint){.node_count = node_count, .rows = rows, .mass = mass};
    if (rows->count == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&constraint->multiplier, rows->count, error));
    RETURN_IF_ERROR(constraint_factorise(rows, node_count, mass, least_pivot, &constraint->factor, error));
    return constraint_nodes_build(rows, node_count, mass, NULL, &constraint->nodes, error);
}

void constraint_free(struct constraint *constraint)
{
    FREE_ALL(constraint->multiplier);
    constraint_nodes_free(&constraint->nodes);
    envelope_free(&constraint->factor);
    *constraint = (struct constraint){0};
}

static void constraint_values(const struct constraint *constraint, const double *u, double *value)
{
    const struct constraint_rows *rows = constraint->rows;
    struct chunks lists = chunks_for_threads(rows->list_count, rows->list_count, LISTS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(lists.threads)
    for (int64_t c = 0; c < lists.count; c++) {
        constraint_rows_take(rows, chunks_begin(&lists, c), chunks_begin(&lists, c + 1), u, value);
    }
}

/* u += M^-1 G^T amount[rows->count]. */
static void constraint_spread(const struct constraint *constraint, const double *amount, double *u)
{
    constraint_nodes_spread(&constraint->nodes, amount, u);
}

void constraint_project(struct constraint *constraint, const double *factor, double *u)
{
    const struct constraint_rows *rows = constraint->rows;
    if (rows == NULL || rows->count == 0) {
        return;
    }
    double *multiplier = constraint->multiplier;
    constraint_values(constraint, u, multiplier);
    for (int64_t r = 0; r < rows->count; r++) {
        multiplier[r] = (factor != NULL ? constraint_rows_target(rows, r, factor) : 0.0) - multiplier[r];
    }
    envelope_solve(&constraint->factor, multiplier);
    constraint_spread(constraint, multiplier, u);
}

enum status constraint_share_out(const struct constraint *constraint, double *force, struct error *error)
{
    const struct constraint_rows *rows = constraint->rows;
    FREED_BY(envelope_free) struct envelope factor = {0};
    SCRATCH int64_t *ptr = NULL, *column = NULL;
    SCRATCH double *value = NULL;
    if (constraint->factor.dropped == 0) {
        return STATUS_OK;
    }
    NEW_SCRATCH(double, u, constraint->node_count * rows->dim, error);
    RETURN_IF_ERROR(assemble(rows, constraint->node_count, constraint->mass, &ptr, &column, &value, error));
    RETURN_IF_ERROR(envelope_factorise(rows->count, ptr, column, value, 0.0, share_shift, &factor, error));
    constraint_spread(constraint, force, u);
    constraint_values(constraint, u, force);
    envelope_solve(&factor, force);
    return STATUS_OK;
}

double constraint_violation(const struct constraint *constraint, const double *factor, const double *u,
                            int64_t *row)
{
    double worst = 0.0;
    for (int64_t r = 0; r < constraint->rows->count; r++) {
        const struct constraint_rows *rows = constraint->rows;
        double wanted = factor != NULL ? constraint_rows_target(rows, r, factor) : 0.0;
        double violation = fabs(wanted - constraint_rows_value(rows, r, u));
        if (!(violation <= worst)) {
            worst = violation;
            if (row != NULL) {
                *row = r;
            }
        }
    }
    return worst;
}
