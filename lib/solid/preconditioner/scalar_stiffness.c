#include "solid/preconditioner/scalar_stiffness.h"

#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/merged_cells.h"
#include "solid/system/system.h"

#include <math.h>
#include <stdlib.h>

static const int64_t worthwhile = 1000; /* fields for a thread */

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
    RETURN_IF_ERROR(NEW_ARRAY(&stiffness->field_slot, stiffness->field_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffness->bond_stiffness, stiffness->bond_count, error));
    return list_bonds(stiffness, error);
}

void scalar_stiffness_free(struct scalar_stiffness *stiffness)
{
    sparse_free(&stiffness->bonds);
    sparse_free(&stiffness->fields);
    sparse_free(&stiffness->cells);
    FREE_ALL(stiffness->bond_stiffness, stiffness->range, stiffness->slot, stiffness->cells_end,
             stiffness->field_slot);
    *stiffness = (struct scalar_stiffness){0};
}

enum status scalar_row_make(const struct scalar_stiffness *stiffness, struct scalar_row *row,
                            struct error *error)
{
    const struct body *body = &stiffness->system->body;
    int64_t nodes = body->node_count, fields = stiffness->field_count + stiffness->bond_count;
    *row = (struct scalar_row){0};
    RETURN_IF_ERROR(NEW_ARRAY(&row->node, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->value, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->at_field, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->on_field, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->sum, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->touched, fields, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->cell_seen, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row->field_seen, fields, error));
    for (int64_t p = 0; p < nodes; p++) {
        row->sum[p].node = (int32_t)body->node_order[p];
    }
    return STATUS_OK;
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

static void put(double amount, int64_t f, struct scalar_row *row)
{
    if (row->field_seen[f] != row->turn) {
        row->field_seen[f] = row->turn;
        row->touched[row->touched_count++] = (int32_t)f;
        row->on_field[f] = 0.0;
    }
    row->on_field[f] += amount;
}

/* The forces of the mean gradient of a group of cells, the first of which is q. */
static void add_mean(const struct scalar_stiffness *stiffness, int64_t q, struct scalar_row *row)
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
            put(share * modulus * vector_dot(dim, mean, gradient[c - q] + r * dim), field[c - q][r], row);
        }
    }
}

/* The forces of the variance of the gradient in cell q. */
static void add_variance(const struct scalar_stiffness *stiffness, int64_t q, struct scalar_row *row)
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
        put(force, smoothed_cells_edge(body, q, e), row);
        put(-0.5 * force, nodes + smoothed_cells_node(body, q, k), row);
        put(-0.5 * force, nodes + smoothed_cells_node(body, q, l), row);
    }
}

static void begin_row(struct scalar_row *row)
{
    row->turn++;
    row->touched_count = row->count = 0;
}

/* The first cell of the group that has use u of the averages' lists. */
static int64_t group_of_use(const struct body *body, int64_t u)
{
    const struct field_averages *averages = &body->cells.averages;
    return smoothed_cells_group(body, field_averages_cell(averages, body->dim, averages->use[u]));
}

/* The forces of the cells on fields if field f is 1 and all others are 0. */
static void field_row(const struct scalar_stiffness *stiffness, int64_t f, struct scalar_row *row)
{
    const struct body *body = &stiffness->system->body;
    const struct field_averages *averages = &body->cells.averages;
    begin_row(row);
    row->at_field[f] = 1.0;
    for (int64_t u = averages->use_ptr[f]; u < averages->use_ptr[f + 1]; u++) {
        int64_t q = group_of_use(body, u);
        if (row->cell_seen[q] != row->turn) {
            row->cell_seen[q] = row->turn;
            add_mean(stiffness, q, row);
            add_variance(stiffness, q, row);
        }
    }
    row->at_field[f] = 0.0;
}

/* At most how many fields the cells at field f have: edges, vertices and boundary faces. */
static int64_t most_fields(const struct body *body, int64_t f)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t most = 0;
    for (int64_t u = averages->use_ptr[f]; u < averages->use_ptr[f + 1]; u++) {
        int64_t q = group_of_use(body, u);
        int64_t end = smoothed_cells_group_end(body, q);
        most += (end - q) * (CELL_EDGES(body->dim) + body->dim + 1) + field_averages_face(averages, end) -
                field_averages_face(averages, q);
    }
    return most;
}

/* List the fields of the prepared nodes, and make room for their rows. field[]: the field of each row. */
static enum status list_fields(struct scalar_stiffness *stiffness, int32_t **field, struct error *error)
{
    const struct sparse *fields = &stiffness->fields;
    int64_t count = 0, entries = 0;
    for (int64_t f = 0; f < stiffness->field_count; f++) {
        stiffness->field_slot[f] = -1;
    }
    for (int64_t k = 0; k < fields->ptr[fields->row_count]; k++) {
        int32_t f = fields->idx[k];
        if (stiffness->field_slot[f] < 0) {
            stiffness->field_slot[f] = (int32_t)count++;
            entries += most_fields(&stiffness->system->body, f);
        }
    }
    RETURN_IF_ERROR(NEW_ARRAY(field, count, error));
    RETURN_IF_ERROR(sparse_new(count, stiffness->field_count, entries, &stiffness->cells, error));
    RETURN_IF_ERROR(NEW_ARRAY(&stiffness->cells_end, count, error));
    for (int64_t f = 0; f < stiffness->field_count; f++) {
        if (stiffness->field_slot[f] >= 0) {
            (*field)[stiffness->field_slot[f]] = (int32_t)f;
        }
    }
    for (int64_t r = 0; r < count; r++) {
        stiffness->cells.ptr[r + 1] =
            stiffness->cells.ptr[r] + most_fields(&stiffness->system->body, (*field)[r]);
    }
    return STATUS_OK;
}

/* Compute the rows of the cells. */
static enum status make_field_rows(struct scalar_stiffness *stiffness, struct error *error)
{
    struct sparse *cells = &stiffness->cells;
    SCRATCH int32_t *field = NULL;
    struct first_failure failure = {STATUS_OK};
    RETURN_IF_ERROR(list_fields(stiffness, &field, error));
#pragma omp parallel num_threads(chunks_of(cells->row_count, worthwhile).threads)
    {
        struct scalar_row row;
        struct error own;
        enum status made = scalar_row_make(stiffness, &row, &own);
#pragma omp for schedule(static)
        for (int64_t r = 0; r < cells->row_count; r++) {
            if (made == STATUS_OK) {
                field_row(stiffness, field[r], &row);
                int64_t at = cells->ptr[r];
                for (int64_t k = 0; k < row.touched_count; k++, at++) {
                    cells->idx[at] = row.touched[k];
                    cells->value[at] = row.on_field[row.touched[k]];
                }
                stiffness->cells_end[r] = at;
            }
        }
        scalar_row_free(&row);
        note_failure(&failure, 0, made, &own, error);
    }
    return failure.status;
}

enum status scalar_stiffness_prepare(struct scalar_stiffness *stiffness, const int32_t *place, int64_t count,
                                     struct error *error)
{
    sparse_free(&stiffness->fields);
    sparse_free(&stiffness->cells);
    FREE_ALL(stiffness->cells_end);
    stiffness->cells_end = NULL;
    RETURN_IF_ERROR(row_operator_transpose(&stiffness->system->body.rows, stiffness->range, place, count,
                                           stiffness->slot, &stiffness->fields, error));
    return make_field_rows(stiffness, error);
}

/* Add the forces on nodes of the force on field f; list the nodes up to i. */
static void spread(const struct scalar_stiffness *stiffness, int64_t f, int64_t i, struct scalar_row *row)
{
    const int32_t *place;
    struct average field = field_at(stiffness, f, &place);
    double force = row->on_field[f];
    for (int64_t k = 0; k < field.length; k++) {
        struct scalar_sum *at = &row->sum[place != NULL ? place[field.idx[k]] : field.idx[k]];
        if (at->row != row->turn) {
            at->row = row->turn;
            at->sum = 0.0;
            row->node[row->count] = at->node; /* without a branch that is taken half of the time */
            row->count += at->node <= i;
        }
        at->sum += force * field.phi[k];
    }
}

void scalar_stiffness_row(const struct scalar_stiffness *stiffness, int64_t i, struct scalar_row *row)
{
    const struct sparse *bonds = &stiffness->bonds, *cells = &stiffness->cells;
    const int32_t *node_place = stiffness->system->body.node_place;
    struct average fields = fields_of(stiffness, i);
    begin_row(row);
    for (int64_t k = 0; k < fields.length; k++) {
        int32_t slot = stiffness->field_slot[fields.idx[k]];
        for (int64_t e = cells->ptr[slot]; e < stiffness->cells_end[slot]; e++) {
            put(fields.phi[k] * cells->value[e], cells->idx[e], row);
        }
    }
    for (int64_t k = bonds->ptr[i]; k < bonds->ptr[i + 1]; k++) {
        int64_t bond = bonds->idx[k];
        put(stiffness->bond_stiffness[bond] * bonds->value[k], stiffness->field_count + bond, row);
    }
    for (int64_t t = 0; t < row->touched_count; t++) {
        spread(stiffness, row->touched[t], i, row);
    }
    qsort(row->node, (size_t)row->count, sizeof *row->node, compare_int32);
    for (int64_t k = 0; k < row->count; k++) {
        row->value[k] = row->sum[node_place[row->node[k]]].sum;
    }
}
