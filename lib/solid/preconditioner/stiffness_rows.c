#include "solid/preconditioner/stiffness_rows.h"

#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/body/nodal_volume.h"
#include "solid/contact/friction.h"
#include "solid/system/system.h"

#include <math.h>
#include <string.h>

/* Four numbers, which fit into one register of processors with AVX2. */
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

/* What rows need of a cell again and again. */
struct stiffness_cell {
    int32_t first, end;                                  /* its group (merged_cells.h) */
    int32_t count, field[SMOOTHED_MOST_ROWS], vertex[4]; /* fields: edges first; those at the vertices */
    double share, shear, first_lame;         /* of the group: its part; moduli times volume, N m (2D: N) */
    double variance;                         /* modulus of the variance, likewise */
    double gradient[SMOOTHED_MOST_ROWS * 3]; /* by the fields, */
    double linear_gradient[12];              /* and of the linear shape functions, 1/m */
};

/* The lists of rows by nodes. */
static enum status transpose_lists(const struct constraint_rows *rows, int64_t nodes, struct sparse *lists,
                                   struct error *error)
{
    static int64_t none[1]; /* of no rows */
    const struct sparse by_list = {.row_count = rows->list_count,
                                   .column_count = nodes,
                                   .ptr = rows->list_count > 0 ? rows->ptr : none,
                                   .idx = rows->idx,
                                   .value = rows->phi};
    return sparse_transpose(&by_list, lists, error);
}

static void set_cell(const struct body *body, int64_t q, struct stiffness_cell *cell)
{
    const struct material *material = &body->materials[body->material[q]];
    double shear = material->shear_modulus;
    double bulk = material->bulk_modulus - (body->averaged ? nodal_pressure_modulus(material) : 0.0);
    cell->first = (int32_t)smoothed_cells_group(body, q);
    cell->end = (int32_t)smoothed_cells_group_end(body, q);
    cell->share = smoothed_cells_share(body, q);
    cell->shear = body->weight[q] * shear;
    cell->first_lame = body->weight[q] * (bulk - 2.0 / 3.0 * shear);
    cell->variance = EDGE_OFFSET * VARIANCE_FACTOR(body->dim) * body->cells.variance_weight[q] * shear;
    cell->count = smoothed_cells_rows(body, q, cell->field, cell->gradient);
    smoothed_cells_linear_gradients(body, q, cell->linear_gradient);
    for (int k = 0; k <= body->dim; k++) {
        cell->vertex[k] =
            (int32_t)(body->cells.averages.row_count - body->node_count) + smoothed_cells_node(body, q, k);
    }
}

/* Of the penalties of points, as most of them do not press. */
static const double counted = 0.3;

static enum status take_point(struct stiffness_rows *rows, const struct contact *contact, int64_t p,
                              const double *direction, double stiffness, struct error *error)
{
    struct average average = average_of_boundary(contact->points, p);
    RETURN_IF_ERROR(constraint_rows_add(&rows->touching, average.length, average.idx, average.phi, direction,
                                        0.0, 0, 0, 0, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&rows->touching_stiffness, rows->touching.count, error));
    rows->touching_stiffness[rows->touching.count - 1] = stiffness;
    return STATUS_OK;
}

/* The points of contacts with rigid surfaces, and with friction across their normals, too. Those between
 * facets of the body are left out: most of them never do. */
static enum status take_contacts(struct stiffness_rows *rows, struct error *error)
{
    const struct solid_system *system = rows->system;
    constraint_rows_init(&rows->touching, system->dim);
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t p = 0; contact->between == NULL && p < contact->count; p++) {
            const double *normal = contact->points->normal + p * system->dim;
            double factor = counted * contact->points->area[p];
            RETURN_IF_ERROR(take_point(rows, contact, p, normal, factor * contact->stiffness[p], error));
            for (int i = 0; contact->friction != NULL && i < system->dim; i++) {
                double across[3] = {0.0}; /* T^T T = T for the projection T = 1 - n (x) n */
                across[i] = 1.0;
                add_scaled(system->dim, -normal[i], normal, across);
                RETURN_IF_ERROR(
                    take_point(rows, contact, p, across, factor * contact->friction->stiffness[p], error));
            }
        }
    }
    return transpose_lists(&rows->touching, system->node_count, &rows->touched, error);
}

enum status stiffness_rows_begin(const struct solid_system *system, struct stiffness_rows *rows,
                                 struct error *error)
{
    const struct body *body = &system->body;
    *rows = (struct stiffness_rows){.system = system};
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&rows->cells, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&rows->slot, body->node_count, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        set_cell(body, q, &rows->cells[q]);
    }
    RETURN_IF_ERROR(transpose_lists(&system->penalties, system->node_count, &rows->penalised, error));
    RETURN_IF_ERROR(take_contacts(rows, error));
    return transpose_lists(&system->rows, system->node_count, &rows->held, error);
}

void stiffness_rows_free(struct stiffness_rows *rows)
{
    sparse_free(&rows->columns);
    sparse_free(&rows->penalised);
    sparse_free(&rows->held);
    sparse_free(&rows->touched);
    constraint_rows_free(&rows->touching);
    FREE_ALL(rows->cells, rows->slot, rows->touching_stiffness);
    *rows = (struct stiffness_rows){0};
}

/* Field f; (*place)[]: the body's index of each of its nodes; NULL: they are the body's already. With several
 * processes the body lacks rows that its cells do not use; these are taken from the tables. */
static struct average field_at(const struct body *body, int64_t f, const int32_t **place)
{
    const struct field_averages *averages = &body->cells.averages;
    const struct sparse *matrix = &body->rows.matrix;
    int64_t length = matrix->ptr[f + 1] - matrix->ptr[f], edges = averages->given[0].row_count;
    *place = NULL;
    if (length > 0 || body->share.ranks == NULL) {
        return (struct average){length, matrix->idx + matrix->ptr[f], matrix->value + matrix->ptr[f]};
    }
    const struct average_table *table = &averages->given[f < edges ? 0 : 1];
    int64_t row = table->order[f < edges ? f : f - edges], at = table->ptr[row];
    *place = body->node_place;
    return (struct average){table->ptr[row + 1] - at, table->idx + at, table->phi + at};
}

/* Count the entries of prepared columns in next[]; once they have room, store them from next[] on. */
static void visit_fields(struct stiffness_rows *rows, int64_t *next)
{
    const struct body *body = &rows->system->body;
    const int32_t *place;
    for (int64_t f = 0; f < body->cells.averages.row_count; f++) {
        struct average field = field_at(body, f, &place);
        for (int64_t i = 0; i < field.length; i++) {
            int32_t slot = rows->slot[place != NULL ? place[field.idx[i]] : field.idx[i]];
            slot = fabs(field.phi[i]) > rows->least_weight ? slot : -1;
            if (slot >= 0 && rows->columns.ptr != NULL) {
                rows->columns.idx[next[slot]] = (int32_t)f;
                rows->columns.value[next[slot]] = field.phi[i];
            }
            next[slot < 0 ? 0 : slot] += slot >= 0;
        }
    }
}

enum status stiffness_rows_prepare(struct stiffness_rows *rows, const int32_t *place, int64_t count,
                                   struct error *error)
{
    const struct body *body = &rows->system->body;
    int64_t entries = 0;
    NEW_SCRATCH(int64_t, next, count, error);
    sparse_free(&rows->columns);
    memset(rows->slot, -1, (size_t)body->node_count * sizeof *rows->slot);
    for (int64_t c = 0; c < count; c++) {
        rows->slot[place[c]] = (int32_t)c;
    }
    visit_fields(rows, next);
    for (int64_t c = 0; c < count; c++) {
        entries += next[c];
    }
    RETURN_IF_ERROR(sparse_new(count, body->cells.averages.row_count, entries, &rows->columns, error));
    for (int64_t c = 0; c < count; c++) {
        rows->columns.ptr[c + 1] = rows->columns.ptr[c] + next[c];
        next[c] = rows->columns.ptr[c];
    }
    visit_fields(rows, next);
    return STATUS_OK;
}

static enum status numbered_begin(int64_t items, struct numbered *list, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&list->number, items, error));
    return NEW_ARRAY_UNTOUCHED(&list->item, items, error);
}

enum status stiffness_row_begin(const struct stiffness_rows *rows, struct stiffness_row *row,
                                struct error *error)
{
    const struct body *body = &rows->system->body;
    int64_t fields = body->cells.averages.row_count, volumes = body->averaged ? body->volumes.count : 0;
    *row = (struct stiffness_row){0};
    RETURN_IF_ERROR(NEW_ARRAY(&row->at_field, fields, error));
    RETURN_IF_ERROR(numbered_begin(body->point_count, &row->cells, error));
    RETURN_IF_ERROR(numbered_begin(fields, &row->fields, error));
    RETURN_IF_ERROR(numbered_begin(volumes, &row->volumes, error));
    RETURN_IF_ERROR(numbered_begin(body->node_count, &row->columns, error));
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&row->on_cell, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY_UNTOUCHED(&row->on_volume, volumes, error));
    return NEW_ARRAY_UNTOUCHED(&row->on_field, fields, error);
}

void stiffness_row_free(struct stiffness_row *row)
{
    struct numbered *lists[] = {&row->cells, &row->fields, &row->volumes, &row->columns};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
        FREE_ALL(lists[i]->number, lists[i]->item);
    }
    FREE_ALL(row->at_field, row->on_cell, row->on_volume, row->on_field);
    *row = (struct stiffness_row){0};
}

/* The number of an item, or -1. */
KERNEL_INLINE int32_t number_of(const struct numbered *list, int32_t item)
{
    int32_t number = list->number[item];
    return number < list->count && list->item[number] == item ? number : -1;
}

/* The values of an item in values[][fours * 4], which are zero at first. */
KERNEL_INLINE double *values_of(struct numbered *list, int32_t item, int fours, double *values)
{
    int32_t number = number_of(list, item);
    if (number < 0) {
        number = list->number[item] = (int32_t)list->count++;
        list->item[number] = item;
        for (int k = 0; k < fours; k++) {
            *(four *)(values + (number * fours + k) * 4) = (four){0.0, 0.0, 0.0, 0.0};
        }
    }
    return values + number * fours * 4;
}

KERNEL_INLINE double *on_cell(struct stiffness_row *row, int32_t q)
{
    return values_of(&row->cells, q, 2, row->on_cell[0]);
}

KERNEL_INLINE double *on_field(struct stiffness_row *row, int32_t f)
{
    return values_of(&row->fields, f, 3, row->on_field[0]);
}

/* The cells at a field. */
static void add_cells(const struct stiffness_rows *rows, int32_t f, struct stiffness_row *row)
{
    const struct body *body = &rows->system->body;
    const struct field_averages *averages = &body->cells.averages;
    for (int64_t u = averages->use_ptr[f]; u < averages->use_ptr[f + 1]; u++) {
        (void)on_cell(row, rows->cells[field_averages_cell(averages, body->dim, averages->use[u])].first);
    }
}

/* Forces of the variance of the gradient in a cell, the same in each direction. */
KERNEL_INLINE void add_variance(int dim, const struct stiffness_cell *cell, struct stiffness_row *row)
{
    double edge[6], vertex[4], variation[12];
    const double *grad_N = cell->linear_gradient;
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        edge[e] = row->at_field[cell->field[e]];
    }
    for (int k = 0; k <= dim; k++) {
        vertex[k] = row->at_field[cell->vertex[k]];
    }
    smoothed_cells_variation(dim, grad_N, edge, vertex, variation);
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int k = cell_edge_ends[e][0], l = cell_edge_ends[e][1];
        double force = cell->variance * (vector_dot(dim, variation + k * dim, grad_N + l * dim) +
                                         vector_dot(dim, variation + l * dim, grad_N + k * dim));
        double *at[3] = {on_field(row, cell->field[e]), on_field(row, cell->vertex[k]),
                         on_field(row, cell->vertex[l])};
        for (int i = 0; i < dim; i++) {
            at[0][i * 5] += force;
            at[1][i * 5] -= 0.5 * force;
            at[2][i * 5] -= 0.5 * force;
        }
    }
}

/* The mean gradient in a group of cells, and the contents of its nodal volumes. */
KERNEL_INLINE void strain_cell(const struct stiffness_rows *rows, int dim, int32_t q,
                               struct stiffness_row *row)
{
    const struct body *body = &rows->system->body;
    const struct nodal_volumes *volumes = &body->volumes;
    double *gradient = on_cell(row, q);
    for (int32_t c = q; c < rows->cells[q].end; c++) {
        const struct stiffness_cell *cell = &rows->cells[c];
        for (int r = 0; r < cell->count; r++) {
            add_scaled(dim, cell->share * row->at_field[cell->field[r]], cell->gradient + r * dim, gradient);
        }
    }
    for (int64_t s = (int64_t)q * (dim + 1); body->averaged && s < (int64_t)rows->cells[q].end * (dim + 1);
         s++) {
        if (volumes->share[s] > 0.0) {
            add_scaled(dim, volumes->share[s], gradient,
                       values_of(&row->volumes, volumes->of_point[s], 1, row->on_volume[0]));
        }
    }
}

/* The pressure of a nodal volume, on all its cells. */
static void press_volume(const struct stiffness_rows *rows, int64_t number, struct stiffness_row *row)
{
    const struct body *body = &rows->system->body;
    const struct nodal_volumes *volumes = &body->volumes;
    int32_t a = row->volumes.item[number];
    for (int64_t i = volumes->ptr[a]; i < volumes->ptr[a + 1]; i++) {
        int32_t s = volumes->slot[i];
        add_scaled(body->dim, volumes->share[s] * volumes->pressures.inverse[a], row->on_volume[number],
                   on_cell(row, rows->cells[s / (body->dim + 1)].first) + 4);
    }
}

/* The forces of a group of cells on fields. */
KERNEL_INLINE void push_fields(const struct stiffness_rows *rows, int dim, int32_t q,
                               struct stiffness_row *row)
{
    const double *strain = on_cell(row, q);
    double mu = 0.0, lambda = 0.0;
    for (int32_t c = q; c < rows->cells[q].end; c++) {
        mu += rows->cells[c].shear;
        lambda += rows->cells[c].first_lame;
    }
    four shear = mu * *(const four *)strain,
         along = lambda * *(const four *)strain + *(const four *)(strain + 4);
    for (int32_t c = q; c < rows->cells[q].end; c++) {
        const struct stiffness_cell *cell = &rows->cells[c];
        for (int r = 0; r < cell->count; r++) {
            const double *from = cell->gradient + r * dim;
            double *to = on_field(row, cell->field[r]);
            four g = {cell->share * from[0], cell->share * from[1], dim == 3 ? cell->share * from[2] : 0.0,
                      0.0};
            double common = shear[0] * g[0] + shear[1] * g[1] + shear[2] * g[2];
            for (int a = 0; a < dim; a++) {
                *(four *)(to + 4 * a) += along[a] * g + g[a] * shear;
                to[5 * a] += common;
            }
        }
    }
}

/* block = sum of the forces on fields by the weights of node q. */
KERNEL_INLINE void gather(const struct stiffness_rows *rows, int dim, int32_t q,
                          const struct stiffness_row *row, double *block)
{
    const struct sparse *columns = &rows->columns;
    int32_t slot = rows->slot[q];
    four sum[3] = {{0.0}};
    for (int64_t i = columns->ptr[slot]; i < columns->ptr[slot + 1]; i++) {
        int32_t number = number_of(&row->fields, columns->idx[i]);
        if (number >= 0) {
            const double *force = row->on_field[number];
            for (int a = 0; a < dim; a++) {
                sum[a] += columns->value[i] * *(const four *)(force + 4 * a);
            }
        }
    }
    for (int k = 0; k < dim * dim; k++) {
        block[k] = sum[k / dim][k % dim];
    }
}

/* Add squares of rows. stiffness[]: of each, N/m (2D: N/m2); NULL: `usual`. */
static void add_squares(const struct stiffness_rows *rows, const struct constraint_rows *squares,
                        const struct sparse *lists, const double *stiffness, double usual, int32_t p,
                        const struct numbered *columns, double *block)
{
    const struct body *body = &rows->system->body;
    int64_t node = body->node_order[p], dim = body->dim;
    for (int64_t i = lists->ptr[node]; i < lists->ptr[node + 1]; i++) {
        int64_t list = lists->idx[i];
        for (int64_t e = squares->ptr[list]; e < squares->ptr[list + 1]; e++) {
            int32_t to = number_of(columns, body->node_place[squares->idx[e]]);
            for (int64_t r = squares->first[list]; r < squares->first[list + 1] && to >= 0; r++) {
                const double *along = squares->direction + r * dim;
                double factor =
                    (stiffness != NULL ? stiffness[r] : usual) * lists->value[i] * squares->phi[e];
                for (int64_t v = 0; v < dim * dim; v++) {
                    block[to * dim * dim + v] += factor * along[v / dim] * along[v % dim];
                }
            }
        }
    }
}

ALL_SETS static void make(const struct stiffness_rows *rows, int32_t p, int64_t count, const int32_t *column,
                          struct stiffness_row *row, double *block)
{
    const struct body *body = &rows->system->body;
    const struct sparse *columns = &rows->columns;
    int64_t first = columns->ptr[rows->slot[p]], last = columns->ptr[rows->slot[p] + 1];
    int dim = body->dim;
    row->cells.count = row->fields.count = row->volumes.count = 0;
    for (int64_t i = first; i < last; i++) {
        row->at_field[columns->idx[i]] = columns->value[i];
        add_cells(rows, columns->idx[i], row);
    }
    for (int64_t i = 0; i < row->cells.count; i++) {
        int32_t q = row->cells.item[i];
        if (dim == 2) {
            strain_cell(rows, 2, q, row);
            add_variance(2, &rows->cells[q], row);
        } else {
            strain_cell(rows, 3, q, row);
            add_variance(3, &rows->cells[q], row);
        }
    }
    for (int64_t v = 0; v < row->volumes.count; v++) {
        press_volume(rows, v, row);
    }
    for (int64_t i = 0; i < row->cells.count; i++) {
        if (dim == 2) {
            push_fields(rows, 2, row->cells.item[i], row);
        } else {
            push_fields(rows, 3, row->cells.item[i], row);
        }
    }
    for (int64_t k = 0; k < count; k++) {
        gather(rows, dim, column[k], row, block + k * dim * dim);
    }
    for (int64_t i = first; i < last; i++) {
        row->at_field[columns->idx[i]] = 0.0;
    }
}

void stiffness_row_make(const struct stiffness_rows *rows, int32_t p, int64_t count, const int32_t *column,
                        struct stiffness_row *row, double *block)
{
    const struct solid_system *system = rows->system;
    make(rows, p, count, column, row, block);
    row->columns.count = 0;
    for (int64_t k = 0; k < count; k++) {
        row->columns.number[column[k]] = (int32_t)k;
        row->columns.item[row->columns.count++] = column[k];
    }
    add_squares(rows, &system->penalties, &rows->penalised, system->penalty_stiffness, 0.0, p, &row->columns,
                block);
    add_squares(rows, &rows->touching, &rows->touched, rows->touching_stiffness, 0.0, p, &row->columns,
                block);
    add_squares(rows, &system->rows, &rows->held, NULL, rows->hold, p, &row->columns, block);
}
