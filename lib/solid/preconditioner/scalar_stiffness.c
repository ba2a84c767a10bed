#include "solid/preconditioner/scalar_stiffness.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/merged_cells.h"
#include "solid/system/system.h"

#include <math.h>
#include <stdlib.h>

/* The number of points of a contact with a rigid surface. Contacts between facets of the body do not count:
 * it is not known where they will touch, and the time step takes account of their stiffness. */
static int64_t points_of(const struct contact *contact)
{
    return contact->between == NULL ? contact->points->count : 0;
}

/* The number of bonds: penalties of the conditions, one for each list of rows, then the points of the
 * contacts. */
static int64_t count_bonds(const struct solid_system *system)
{
    int64_t count = system->penalties.list_count;
    for (int64_t c = 0; c < system->contact_count; c++) {
        count += points_of(&system->contacts[c]);
    }
    return count;
}

/* Bond b, and its stiffness. */
static struct average bond_at(const struct solid_system *system, int64_t b, double *stiffness)
{
    if (b < system->penalties.list_count) {
        int64_t row = system->penalties.first[b];
        *stiffness = system->penalty_stiffness[row];
        return constraint_rows_average(&system->penalties, row);
    }
    b -= system->penalties.list_count;
    int64_t c = 0;
    for (; b >= points_of(&system->contacts[c]); c++) {
        b -= points_of(&system->contacts[c]);
    }
    *stiffness = system->contacts[c].stiffness[b] * system->contacts[c].points->area[b];
    return average_of_boundary(system->contacts[c].points, b);
}

/* The average of field or bond f; (*place)[]: the body's index of each of its nodes; NULL: they are the
 * body's already. With several processes the body lacks rows that its cells do not use; these are taken from
 * the tables. */
static struct average field_at(const struct scalar_stiffness *stiffness, int64_t f, const int32_t **place)
{
    const struct body *body = &stiffness->system->body;
    const struct field_averages *averages = &body->cells.averages;
    double unused;
    *place = body->node_place;
    if (f >= stiffness->field_count) {
        return bond_at(stiffness->system, f - stiffness->field_count, &unused);
    }
    const struct sparse *matrix = &body->rows.matrix;
    int64_t length = matrix->ptr[f + 1] - matrix->ptr[f];
    if (length > 0 || body->share.ranks == NULL) {
        *place = NULL;
        return (struct average){length, matrix->idx + matrix->ptr[f], matrix->value + matrix->ptr[f]};
    }
    int64_t edges = averages->given[0].row_count;
    const struct average_table *table = &averages->given[f < edges ? 0 : 1];
    int64_t row = table->order[f < edges ? f : f - edges], at = table->ptr[row];
    return (struct average){table->ptr[row + 1] - at, table->idx + at, table->phi + at};
}

/* The fields that contain node i, and its weights there. */
static struct average fields_of(const struct scalar_stiffness *stiffness, int64_t i)
{
    const struct sparse *fields = &stiffness->fields;
    int64_t r = stiffness->slot[stiffness->system->body.node_place[i]], at = fields->ptr[r];
    return (struct average){fields->ptr[r + 1] - at, fields->idx + at, fields->value + at};
}

static enum status list_bonds(struct scalar_stiffness *stiffness, struct error *error)
{
    const struct solid_system *system = stiffness->system;
    FREED_BY(sparse_free) struct sparse by_bond = {0};
    double unused;
    int64_t entries = 0, at = 0;
    for (int64_t b = 0; b < stiffness->bond_count; b++) {
        entries += bond_at(system, b, &unused).length;
    }
    RETURN_IF_ERROR(sparse_new(stiffness->bond_count, system->node_count, entries, &by_bond, error));
    for (int64_t b = 0; b < stiffness->bond_count; b++) {
        struct average bond = bond_at(system, b, &stiffness->bond_stiffness[b]);
        for (int64_t i = 0; i < bond.length; i++, at++) {
            by_bond.idx[at] = bond.idx[i];
            by_bond.value[at] = bond.phi[i];
        }
        by_bond.ptr[b + 1] = at;
    }
    return sparse_transpose(&by_bond, &stiffness->bonds, error);
}

enum status scalar_stiffness_make(const struct solid_system *system, struct scalar_stiffness *stiffness,
                                  struct error *error)
{
    const struct body *body = &system->body;
    *stiffness = (struct scalar_stiffness){.system = system, .bond_count = count_bonds(system)};
    stiffness->field_count = body->cells.averages.row_count;
    if (stiffness->field_count + stiffness->bond_count > INT32_MAX) {
        return fail(error, STATUS_SYSTEM, "preconditioner: more than 2^31 edges, nodes and conditions");
    }
    RETURN_IF_ERROR(row_operator_ranges(&body->rows, &stiffness->range, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffness->slot, system->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffness->bond_stiffness, stiffness->bond_count, error));
    return list_bonds(stiffness, error);
}

void scalar_stiffness_free(struct scalar_stiffness *stiffness)
{
    sparse_free(&stiffness->bonds);
    sparse_free(&stiffness->fields);
    FREE_ALL(stiffness->bond_stiffness, stiffness->range, stiffness->slot);
    *stiffness = (struct scalar_stiffness){0};
}

enum status scalar_row_make(const struct scalar_stiffness *stiffness, struct scalar_row *row,
                            struct error *error)
{
    int64_t nodes = stiffness->system->node_count, fields = stiffness->field_count + stiffness->bond_count;
    *row = (struct scalar_row){0};
    RETURN_IF_ERROR(NEW_ARRAY(&row->node, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->value, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->at_field, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->on_field, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->sum, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->touched, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->cell_seen, stiffness->system->body.point_count, error));
    return NEW_ARRAY(&row->field_seen, fields, error);
}

enum status scalar_stiffness_prepare(struct scalar_stiffness *stiffness, const int32_t *place, int64_t count,
                                     struct error *error)
{
    sparse_free(&stiffness->fields);
    return row_operator_transpose(&stiffness->system->body.rows, stiffness->range, place, count,
                                  stiffness->slot, &stiffness->fields, error);
}

void scalar_row_free(struct scalar_row *row)
{
    FREE_ALL(row->node, row->value, row->at_field, row->on_field, row->sum, row->touched, row->cell_seen,
             row->field_seen);
    *row = (struct scalar_row){0};
}

/* Volume of a cell times the P-wave modulus. */
static double wave_modulus(const struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    double shear = material->shear_modulus, bulk = material->bulk_modulus;
    if (body->averaged) {
        bulk = fmin(bulk, body->volumes.pressures.most * shear);
    }
    return body->weight[q] * (bulk + 4.0 / 3.0 * shear);
}

static void put(const double amount, int64_t f, int64_t i, struct scalar_row *row, int64_t *touched)
{
    if (row->field_seen[f] != i + 1) {
        row->field_seen[f] = (int32_t)(i + 1);
        row->touched[(*touched)++] = (int32_t)f;
        row->on_field[f] = 0.0;
    }
    row->on_field[f] += amount;
}

/* The forces of the mean gradient of a group of cells, the first of which is q. */
static void add_mean(const struct scalar_stiffness *stiffness, int64_t q, int64_t i, struct scalar_row *row,
                     int64_t *touched)
{
    const struct body *body = &stiffness->system->body;
    int dim = body->dim, count[MERGED_MOST_CELLS];
    int64_t end = smoothed_cells_group_end(body, q);
    double mean[3] = {0.0, 0.0, 0.0}, modulus = 0.0, gradient[MERGED_MOST_CELLS][SMOOTHED_MOST_ROWS * 3];
    int32_t field[MERGED_MOST_CELLS][SMOOTHED_MOST_ROWS];
    for (int64_t c = q; c < end; c++) {
        double share = smoothed_cells_share(body, c);
        modulus += wave_modulus(body, c);
        count[c - q] = smoothed_cells_rows(body, c, field[c - q], gradient[c - q]);
        for (int r = 0; r < count[c - q]; r++) {
            add_scaled(dim, share * row->at_field[field[c - q][r]], gradient[c - q] + r * dim, mean);
        }
    }
    for (int64_t c = q; c < end; c++) {
        double share = smoothed_cells_share(body, c);
        for (int r = 0; r < count[c - q]; r++) {
            put(share * modulus * vector_dot(dim, mean, gradient[c - q] + r * dim), field[c - q][r], i, row,
                touched);
        }
    }
}

/* The forces of the variance of the gradient in cell q. */
static void add_variance(const struct scalar_stiffness *stiffness, int64_t q, int64_t i,
                         struct scalar_row *row, int64_t *touched)
{
    const struct body *body = &stiffness->system->body;
    int dim = body->dim;
    int64_t nodes = stiffness->field_count - body->node_count;
    double modulus = VARIANCE_FACTOR(dim) * body->cells.variance_weight[q] *
                     body->materials[body->material[q]].shear_modulus;
    double grad_N[12], edge[6], vertex[4], R[12];
    smoothed_cells_linear_gradients(body, q, grad_N);
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        edge[e] = row->at_field[smoothed_cells_edge(body, q, e)];
    }
    for (int k = 0; k <= dim; k++) {
        vertex[k] = row->at_field[nodes + smoothed_cells_node(body, q, k)];
    }
    smoothed_cells_variation(dim, grad_N, edge, vertex, R);
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int k = cell_edge_ends[e][0], l = cell_edge_ends[e][1];
        double force =
            EDGE_OFFSET * modulus *
            (vector_dot(dim, R + k * dim, grad_N + l * dim) + vector_dot(dim, R + l * dim, grad_N + k * dim));
        put(force, smoothed_cells_edge(body, q, e), i, row, touched);
        put(-0.5 * force, nodes + smoothed_cells_node(body, q, k), i, row, touched);
        put(-0.5 * force, nodes + smoothed_cells_node(body, q, l), i, row, touched);
    }
}

/* Force on a node of the body's order, listed in row->node. */
static inline void add_to_node(int32_t node, double amount, int64_t i, struct scalar_row *row)
{
    struct scalar_sum *at = &row->sum[node];
    if (at->row != i + 1) {
        *at = (struct scalar_sum){.row = i + 1};
        row->node[row->count++] = node;
    }
    at->sum += amount;
}

/* Sum the forces on the nodes up to i: the entries of the row. */
static void spread(const struct scalar_stiffness *stiffness, int64_t touched, int64_t i,
                   struct scalar_row *row)
{
    const struct body *body = &stiffness->system->body;
    const int32_t *place;
    int64_t kept = 0;
    row->count = 0;
    for (int64_t t = 0; t < touched; t++) {
        struct average field = field_at(stiffness, row->touched[t], &place);
        double force = row->on_field[row->touched[t]];
        for (int64_t k = 0; k < field.length; k++) {
            int32_t node = place != NULL ? place[field.idx[k]] : field.idx[k];
            add_to_node(node, force * field.phi[k], i, row);
        }
    }
    for (int64_t k = 0; k < row->count; k++) {
        int64_t node = body->node_order[row->node[k]];
        if (node <= i) {
            row->node[kept++] = (int32_t)node;
        }
    }
    row->count = kept;
    qsort(row->node, (size_t)row->count, sizeof *row->node, compare_int32);
    for (int64_t k = 0; k < row->count; k++) {
        row->value[k] = row->sum[body->node_place[row->node[k]]].sum;
    }
}

/* Add the cells that use field f. */
static void add_cells(const struct scalar_stiffness *stiffness, int64_t f, int64_t i, struct scalar_row *row,
                      int64_t *touched)
{
    const struct body *body = &stiffness->system->body;
    const struct field_averages *averages = &body->cells.averages;
    for (int64_t u = averages->use_ptr[f]; u < averages->use_ptr[f + 1]; u++) {
        int64_t q = smoothed_cells_group(body, field_averages_cell(averages, body->dim, averages->use[u]));
        if (row->cell_seen[q] != i + 1) {
            row->cell_seen[q] = (int32_t)(i + 1);
            add_mean(stiffness, q, i, row, touched);
            add_variance(stiffness, q, i, row, touched);
        }
    }
}

void scalar_stiffness_row(const struct scalar_stiffness *stiffness, int64_t i, struct scalar_row *row)
{
    const struct sparse *bonds = &stiffness->bonds;
    struct average fields = fields_of(stiffness, i);
    int64_t touched = 0;
    for (int64_t k = 0; k < fields.length; k++) {
        row->at_field[fields.idx[k]] = fields.phi[k];
    }
    for (int64_t k = 0; k < fields.length; k++) {
        add_cells(stiffness, fields.idx[k], i, row, &touched);
    }
    for (int64_t k = bonds->ptr[i]; k < bonds->ptr[i + 1]; k++) {
        int64_t bond = bonds->idx[k];
        put(stiffness->bond_stiffness[bond] * bonds->value[k], stiffness->field_count + bond, i, row,
            &touched);
    }
    for (int64_t k = 0; k < fields.length; k++) {
        row->at_field[fields.idx[k]] = 0.0;
    }
    spread(stiffness, touched, i, row);
}
