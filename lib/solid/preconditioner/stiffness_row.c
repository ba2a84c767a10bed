/* One row of the stiffness; see stiffness_rows.h. */
#include "solid/preconditioner/stiffness_rows.h"

#include "base/memory.h"
#include "base/processor.h"
#include "base/vector.h"
#include "solid/system/system.h"

/* Four numbers, which fit into one register of processors with AVX2. */
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));

static enum status numbered_begin(int64_t items, struct numbered *list, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&list->number, items, error));
    return NEW_ARRAY(&list->item, items, error);
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
    RETURN_IF_ERROR(NEW_ARRAY(&row->on_cell, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->on_volume, volumes, error));
    return NEW_ARRAY(&row->on_field, fields, error);
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

/* Of moves in each direction, whose gradient at a vertex varies by v: the stress along g. */
KERNEL_INLINE void add_stresses(int dim, const struct stiffness_cell *cell, const double *v, const double *g,
                                four force[3])
{
    four along_v = {v[0], v[1], dim == 3 ? v[2] : 0.0, 0.0},
         along_g = {g[0], g[1], dim == 3 ? g[2] : 0.0, 0.0};
    double common = cell->variance_shear * vector_dot(dim, v, g);
    for (int a = 0; a < dim; a++) {
        force[a] += cell->variance_shear * g[a] * along_v + cell->variance_lame * v[a] * along_g;
        force[a][a] += common;
    }
}

/* Forces of the variance of the gradient in a cell. */
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
        four force[3] = {{0.0}};
        add_stresses(dim, cell, variation + k * dim, grad_N + l * dim, force);
        add_stresses(dim, cell, variation + l * dim, grad_N + k * dim, force);
        double *at[3] = {on_field(row, cell->field[e]), on_field(row, cell->vertex[k]),
                         on_field(row, cell->vertex[l])};
        for (int a = 0; a < dim; a++) {
            *(four *)(at[0] + 4 * a) += force[a];
            *(four *)(at[1] + 4 * a) -= 0.5 * force[a];
            *(four *)(at[2] + 4 * a) -= 0.5 * force[a];
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
    int64_t node = body->order.nodes[p], dim = body->dim;
    for (int64_t i = lists->ptr[node]; i < lists->ptr[node + 1]; i++) {
        int64_t list = lists->idx[i];
        for (int64_t e = squares->ptr[list]; e < squares->ptr[list + 1]; e++) {
            int32_t to = number_of(columns, body->order.places[squares->idx[e]]);
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
    add_squares(rows, &system->springs.rows, &rows->springs, system->springs.stiffness, 0.0, p, &row->columns,
                block);
    add_squares(rows, &rows->touching, &rows->touched, rows->touching_stiffness, 0.0, p, &row->columns,
                block);
    add_squares(rows, &system->rows, &rows->held, NULL, rows->hold, p, &row->columns, block);
}
