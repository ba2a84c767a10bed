/* The rows H of the preconditioner: the conditions G, which hold exactly, and the pressures K C of nodal
 * volumes, which have a compliance. S = H D^-1 H^T + diag(0, K) is factored once for many steps. */
#include "solid/inertia_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Added to the diagonal of K in S, by itself: patterns of volumes that no point sees have no stiffness. Far
 * below mu / kappa, so that what it leaves out is far below mu. */
static const double ridge = 1e-8;

int64_t inertia_row_count(const struct inertia *inertia)
{
    const struct constraint_rows *rows = inertia->constraint.rows;
    return (rows != NULL ? rows->count : 0) + inertia->volumes.count;
}

void inertia_rows_see(struct inertia *inertia, const double *x, double *seen)
{
    constraint_rows_values(inertia->constraint.rows, x, seen);
    if (inertia->volumes.count > 0) {
        volume_rows_force(&inertia->volumes, x, seen + inertia->constraint.rows->count);
    }
}

void inertia_rows_spread(const struct inertia *inertia, const double *amount, double *x)
{
    constraint_rows_spread(inertia->constraint.rows, amount, inertia->mass, x);
    if (inertia->volumes.count > 0) {
        volume_rows_spread(&inertia->volumes, amount + inertia->constraint.rows->count, inertia->mass, x);
    }
}

void inertia_rows_solve(const struct inertia *inertia, double *amount)
{
    if (inertia->volumes.count > 0) {
        sparse_solve(&inertia->coupled, amount);
    } else if (inertia->constraint.rows->count > 0) {
        envelope_solve(&inertia->constraint.factor, amount);
    }
}

enum status inertia_rows_solve_many(const struct inertia *inertia, int64_t count, double *amount,
                                    struct error *error)
{
    if (inertia->volumes.count > 0) {
        return sparse_solve_many(&inertia->coupled, count, amount, error);
    }
    for (int64_t i = 0; i < count; i++) {
        inertia_rows_solve(inertia, amount + i * inertia_row_count(inertia));
    }
    return STATUS_OK;
}

void inertia_project(struct inertia *inertia, const double *factor, double *move)
{
    const struct constraint_rows *rows = inertia->constraint.rows;
    if (inertia->volumes.count == 0 || rows == NULL || rows->count == 0) {
        constraint_project(&inertia->constraint, factor, move);
        return;
    }
    double *amount = inertia->seen;
    constraint_rows_missing(rows, factor, move, amount);
    memset(amount + rows->count, 0, (size_t)inertia->volumes.count * sizeof *amount);
    inertia_rows_solve(inertia, amount);
    inertia_rows_spread(inertia, amount, move);
}

/* Nodes of K C's row a that `seen` does not have yet, listed in idx from `count` on. */
static int64_t pressure_columns(const struct volume_rows *volumes, int64_t a, int64_t *seen, int64_t row,
                                int64_t count, int32_t *idx)
{
    const struct volume_matrix *K = &volumes->stiffness;
    for (int64_t i = K->ptr[a]; i < K->ptr[a + 1]; i++) {
        count = volume_matrix_note_columns(&volumes->change, K->idx[i], row, seen, count, idx);
    }
    return count;
}

/* Lengths of the rows, and where there is room for them the nodes. Rows of conditions that were dropped are
 * empty. */
static void list_nodes(const struct inertia *inertia, const bool *dropped, int64_t *seen,
                       struct volume_matrix *list)
{
    const struct constraint_rows *rows = inertia->constraint.rows;
    memset(seen, -1, (size_t)inertia->node_count * sizeof *seen);
    for (int64_t r = 0; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        int64_t length = dropped[r] ? 0 : average.length;
        if (list->idx != NULL) {
            memcpy(list->idx + list->ptr[r], average.idx, (size_t)length * sizeof *average.idx);
        }
        list->ptr[r + 1] = list->ptr[r] + length;
    }
    for (int64_t a = 0; a < inertia->volumes.count; a++) {
        int64_t r = rows->count + a;
        list->ptr[r + 1] = pressure_columns(&inertia->volumes, a, seen, r, list->ptr[r], list->idx);
    }
}

static void fill_condition(const struct inertia *inertia, int64_t r, struct volume_matrix *list)
{
    const struct constraint_rows *rows = inertia->constraint.rows;
    struct average average = constraint_rows_average(rows, r);
    for (int64_t i = list->ptr[r]; i < list->ptr[r + 1]; i++) {
        for (int k = 0; k < inertia->dim; k++) {
            list->value[i * inertia->dim + k] =
                average.phi[i - list->ptr[r]] * rows->direction[r * inertia->dim + k];
        }
    }
}

static void fill_pressure(const struct inertia *inertia, int64_t a, int64_t *place,
                          struct volume_matrix *list)
{
    const struct volume_matrix *K = &inertia->volumes.stiffness, *C = &inertia->volumes.change;
    int64_t r = inertia->constraint.rows->count + a;
    int dim = inertia->dim;
    for (int64_t i = list->ptr[r]; i < list->ptr[r + 1]; i++) {
        place[list->idx[i]] = i;
    }
    for (int64_t i = K->ptr[a]; i < K->ptr[a + 1]; i++) {
        for (int64_t k = C->ptr[K->idx[i]]; k < C->ptr[K->idx[i] + 1]; k++) {
            for (int b = 0; b < dim; b++) {
                list->value[place[C->idx[k]] * dim + b] += K->value[i] * C->value[k * dim + b];
            }
        }
    }
}

static enum status list_rows(const struct inertia *inertia, struct volume_matrix *list, struct error *error)
{
    enum status status;
    const struct constraint_rows *rows = inertia->constraint.rows;
    int64_t count = inertia_row_count(inertia), *seen = NULL, *which = NULL;
    bool *dropped = NULL;
    TRY(NEW_ARRAY(&seen, inertia->node_count, error));
    TRY(NEW_ARRAY(&dropped, rows->count, error));
    TRY(NEW_ARRAY(&which, inertia->constraint.factor.dropped, error));
    TRY(NEW_ARRAY(&list->ptr, count + 1, error));
    envelope_dropped(&inertia->constraint.factor, which);
    for (int64_t d = 0; d < inertia->constraint.factor.dropped; d++) {
        dropped[which[d]] = true;
    }
    list_nodes(inertia, dropped, seen, list);
    TRY(NEW_ARRAY(&list->idx, list->ptr[count], error));
    TRY(NEW_ARRAY(&list->value, list->ptr[count] * inertia->dim, error));
    list_nodes(inertia, dropped, seen, list);
    for (int64_t r = 0; r < rows->count; r++) {
        fill_condition(inertia, r, list);
    }
    for (int64_t a = 0; a < inertia->volumes.count; a++) {
        fill_pressure(inertia, a, seen, list);
    }
done:
    free(seen);
    free(dropped);
    free(which);
    return status;
}

/* For each node the places in the list that name it. */
static enum status list_by_node(const struct inertia *inertia, const struct volume_matrix *list,
                                int64_t **ptr, int64_t **row, int64_t **place, struct error *error)
{
    enum status status;
    int64_t count = inertia_row_count(inertia), entries = list->ptr[count];
    TRY(NEW_ARRAY(ptr, inertia->node_count + 2, error));
    TRY(NEW_ARRAY(row, entries, error));
    TRY(NEW_ARRAY(place, entries, error));
    for (int64_t i = 0; i < entries; i++) {
        (*ptr)[list->idx[i] + 2]++;
    }
    for (int64_t n = 0; n < inertia->node_count; n++) {
        (*ptr)[n + 2] += (*ptr)[n + 1];
    }
    for (int64_t r = 0; r < count; r++) {
        for (int64_t i = list->ptr[r]; i < list->ptr[r + 1]; i++) {
            int64_t at = (*ptr)[list->idx[i] + 1]++;
            (*row)[at] = r;
            (*place)[at] = i;
        }
    }
done:
    return status;
}

/* The lower triangle of S in CSR. */
struct square {
    int64_t *ptr, *column;
    double *value;
};

static void free_square(struct square *square)
{
    free(square->ptr);
    free(square->column);
    free(square->value);
}

/* What row r has with each row up to itself that shares a node with it, in sum[row]; the rows in touched. */
static int64_t multiply_row(const struct inertia *inertia, const struct volume_matrix *list, int64_t r,
                            const int64_t *node_ptr, const int64_t *node_row, const int64_t *node_place,
                            bool *is_touched, int64_t *touched, double *sum)
{
    int64_t count = 0;
    int dim = inertia->dim;
    for (int64_t i = list->ptr[r]; i < list->ptr[r + 1]; i++) {
        int32_t node = list->idx[i];
        double inverse = 1.0 / inertia->mass[node];
        for (int64_t k = node_ptr[node]; k < node_ptr[node + 1] && node_row[k] <= r; k++) {
            int64_t s = node_row[k];
            double part = 0.0;
            for (int a = 0; a < dim; a++) {
                part += list->value[i * dim + a] * list->value[node_place[k] * dim + a];
            }
            if (!is_touched[s]) {
                is_touched[s] = true;
                touched[count++] = s;
            }
            sum[s] += inverse * part;
        }
    }
    return count;
}

/* K in row r of the volumes. */
static void add_stiffness(const struct inertia *inertia, int64_t r, double *sum)
{
    const struct volume_matrix *K = &inertia->volumes.stiffness;
    int64_t conditions = inertia->constraint.rows->count, a = r - conditions;
    for (int64_t i = a >= 0 ? K->ptr[a] : 0; a >= 0 && i < K->ptr[a + 1]; i++) {
        if (K->idx[i] > a) {
            continue;
        }
        sum[conditions + K->idx[i]] += K->value[i] * (K->idx[i] == a ? 1.0 + ridge : 1.0);
    }
}

static enum status multiply(const struct inertia *inertia, const struct volume_matrix *list, struct square *S,
                            struct error *error)
{
    enum status status;
    int64_t count = inertia_row_count(inertia), capacity = 0;
    int64_t *node_ptr = NULL, *node_row = NULL, *node_place = NULL, *touched = NULL;
    bool *is_touched = NULL;
    double *sum = NULL;
    TRY(list_by_node(inertia, list, &node_ptr, &node_row, &node_place, error));
    TRY(NEW_ARRAY(&touched, count, error));
    TRY(NEW_ARRAY(&is_touched, count, error));
    TRY(NEW_ARRAY(&sum, count, error));
    TRY(NEW_ARRAY(&S->ptr, count + 1, error));
    for (int64_t r = 0; r < count; r++) {
        int64_t at = S->ptr[r];
        int64_t length =
            multiply_row(inertia, list, r, node_ptr, node_row, node_place, is_touched, touched, sum);
        if (at + length + 1 > capacity) {
            capacity = 2 * (at + length + 1) + 1024;
            int64_t *columns = array_grow(S->column, capacity, sizeof *columns);
            S->column = columns != NULL ? columns : S->column;
            double *values = array_grow(S->value, capacity, sizeof *values);
            S->value = values != NULL ? values : S->value;
            if (columns == NULL || values == NULL) {
                status = fail_memory(error, "nodal volumes");
                goto done;
            }
        }
        add_stiffness(inertia, r, sum);
        for (int64_t i = 0; i < length; i++) {
            S->column[at + i] = touched[i];
            S->value[at + i] = sum[touched[i]];
            sum[touched[i]] = 0.0;
            is_touched[touched[i]] = false;
        }
        if (length == 0) { /* a condition that was dropped: it bears nothing */
            S->column[at] = r;
            S->value[at] = 1.0;
            length = 1;
        }
        S->ptr[r + 1] = at + length;
    }
done:
    free(node_ptr);
    free(node_row);
    free(node_place);
    free(touched);
    free(is_touched);
    free(sum);
    return status;
}

enum status inertia_couple(struct inertia *inertia, struct error *error)
{
    enum status status = STATUS_OK;
    struct volume_matrix list = {0};
    struct square S = {0};
    if (inertia->volumes.count == 0) {
        return STATUS_OK;
    }
    TRY(list_rows(inertia, &list, error));
    TRY(multiply(inertia, &list, &S, error));
    TRY(sparse_factorise(inertia_row_count(inertia), S.ptr, S.column, S.value, &inertia->coupled, error));
done:
    volume_matrix_free(&list);
    free_square(&S);
    return status;
}
