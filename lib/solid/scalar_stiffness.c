#include "solid/scalar_stiffness.h"

#include "base/memory.h"
#include "solid/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The bonds: penalties of the conditions, one for each list of rows, then the points of the contacts. */
static int64_t count_bonds(const struct solid_system *system)
{
    int64_t count = system->penalties.list_count;
    for (int64_t c = 0; c < system->contact_count; c++) {
        count += system->contacts[c].points->count;
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
    for (; b >= system->contacts[c].points->count; c++) {
        b -= system->contacts[c].points->count;
    }
    *stiffness = system->contacts[c].stiffness[b] * system->contacts[c].points->area[b];
    return average_of_boundary(system->contacts[c].points, b);
}

/* Field or bond f, of nodes of the body's order or the system's. */
static struct average field_at(const struct scalar_stiffness *stiffness, int64_t f)
{
    const struct sparse *matrix = &stiffness->system->body.cells.averages.matrix;
    double unused;
    if (f < stiffness->field_count) {
        int64_t at = matrix->ptr[f];
        return (struct average){matrix->ptr[f + 1] - at, matrix->idx + at, matrix->value + at};
    }
    return bond_at(stiffness->system, f - stiffness->field_count, &unused);
}

/* Node k of field or bond f, as the system counts nodes. */
static int64_t node_of(const struct scalar_stiffness *stiffness, int64_t f, const struct average *field,
                       int64_t k)
{
    return f < stiffness->field_count ? stiffness->system->body.node_order[field->idx[k]] : field->idx[k];
}

static enum status list_nodes(struct scalar_stiffness *stiffness, struct error *error)
{
    enum status status;
    int64_t nodes = stiffness->system->node_count, all = stiffness->field_count + stiffness->bond_count;
    TRY(NEW_ARRAY(&stiffness->node_ptr, nodes + 2, error));
    int64_t *start = stiffness->node_ptr;
    for (int64_t f = 0; f < all; f++) {
        struct average field = field_at(stiffness, f);
        for (int64_t i = 0; i < field.length; i++) {
            start[node_of(stiffness, f, &field, i) + 2]++;
        }
    }
    for (int64_t n = 0; n < nodes; n++) {
        start[n + 2] += start[n + 1];
    }
    TRY(NEW_ARRAY(&stiffness->node_field, start[nodes + 1], error));
    TRY(NEW_ARRAY(&stiffness->node_phi, start[nodes + 1], error));
    for (int64_t f = 0; f < all; f++) {
        struct average field = field_at(stiffness, f);
        for (int64_t i = 0; i < field.length; i++) {
            int64_t at = start[node_of(stiffness, f, &field, i) + 1]++;
            stiffness->node_field[at] = (int32_t)f;
            stiffness->node_phi[at] = field.phi[i];
        }
    }
done:
    return status;
}

enum status scalar_stiffness_make(const struct solid_system *system, struct scalar_stiffness *stiffness,
                                  struct error *error)
{
    enum status status;
    const struct body *body = &system->body;
    *stiffness = (struct scalar_stiffness){.system = system, .bond_count = count_bonds(system)};
    stiffness->field_count = body->cells.averages.matrix.row_count;
    if (stiffness->field_count + stiffness->bond_count > INT32_MAX) {
        status = fail(error, STATUS_SYSTEM, "preconditioner: more than 2^31 faces, nodes and conditions");
        goto done;
    }
    TRY(NEW_ARRAY(&stiffness->bond_stiffness, stiffness->bond_count, error));
    for (int64_t b = 0; b < stiffness->bond_count; b++) {
        (void)bond_at(system, b, &stiffness->bond_stiffness[b]);
    }
    TRY(list_nodes(stiffness, error));
done:
    if (status != STATUS_OK) {
        scalar_stiffness_free(stiffness);
    }
    return status;
}

void scalar_stiffness_free(struct scalar_stiffness *stiffness)
{
    free(stiffness->node_ptr);
    free(stiffness->node_field);
    free(stiffness->node_phi);
    free(stiffness->bond_stiffness);
    *stiffness = (struct scalar_stiffness){0};
}

enum status scalar_row_make(const struct scalar_stiffness *stiffness, struct scalar_row *row,
                            struct error *error)
{
    enum status status;
    int64_t nodes = stiffness->system->node_count, fields = stiffness->field_count + stiffness->bond_count;
    *row = (struct scalar_row){0};
    TRY(NEW_ARRAY(&row->node, nodes, error));
    TRY(NEW_ARRAY(&row->value, nodes, error));
    TRY(NEW_ARRAY(&row->at_field, fields, error));
    TRY(NEW_ARRAY(&row->on_field, fields, error));
    TRY(NEW_ARRAY(&row->sum, nodes, error));
    TRY(NEW_ARRAY(&row->touched, fields, error));
    TRY(NEW_ARRAY(&row->cell_seen, stiffness->system->body.point_count, error));
    TRY(NEW_ARRAY(&row->field_seen, fields, error));
    TRY(NEW_ARRAY(&row->node_seen, nodes, error));
done:
    if (status != STATUS_OK) {
        scalar_row_free(row);
    }
    return status;
}

void scalar_row_free(struct scalar_row *row)
{
    void *arrays[] = {row->node,    row->value,     row->at_field,   row->on_field, row->sum,
                      row->touched, row->cell_seen, row->field_seen, row->node_seen};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *row = (struct scalar_row){0};
}

/* Volume times modulus of a cell. */
static double modulus_of(const struct body *body, int64_t q)
{
    const struct material *material = &body->materials[body->material[q]];
    double shear = material->shear_modulus, bulk = material->bulk_modulus;
    if (body->averaged) {
        bulk = fmin(bulk, body->volumes.pressures.most * shear);
    }
    return body->weight[q] * (bulk + (4.0 / 3.0 + 2.0 * SMOOTHING_STIFFNESS(body->dim)) * shear);
}

static void put(const double amount, int64_t f, int64_t i, struct scalar_row *row, int64_t *touched)
{
    if (row->field_seen[f] != i + 1) {
        row->field_seen[f] = i + 1;
        row->touched[(*touched)++] = (int32_t)f;
        row->on_field[f] = 0.0;
    }
    row->on_field[f] += amount;
}

/* The forces of cell q on the fields at its corners. */
static void add_cell(const struct scalar_stiffness *stiffness, int64_t q, int64_t i, struct scalar_row *row,
                     int64_t *touched)
{
    const struct body *body = &stiffness->system->body;
    int dim = body->dim;
    int rows = FACE_ROWS(dim);
    int64_t nodes = stiffness->field_count - body->node_count;
    double hat[12], smooth[3] = {0.0, 0.0, 0.0}, off[3] = {0.0, 0.0, 0.0};
    double modulus = modulus_of(body, q), k_off = SMOOTHING_STIFFNESS(dim);
    smoothed_cells_hat_gradients(body, q, hat);
    for (int k = 0; k <= dim; k++) {
        double mean = 0.0, value = row->at_field[nodes + smoothed_cells_node(body, q, k)];
        for (int r = 0; r < rows; r++) {
            mean += row->at_field[smoothed_cells_row(body, q, k, r)] / rows;
        }
        for (int a = 0; a < dim; a++) {
            smooth[a] -= dim * mean * hat[k * dim + a];
            off[a] += (value + dim * mean) * hat[k * dim + a];
        }
    }
    for (int k = 0; k <= dim; k++) {
        double on_mean = 0.0, on_value = 0.0;
        for (int a = 0; a < dim; a++) {
            on_mean -= dim * modulus * (smooth[a] - k_off * off[a]) * hat[k * dim + a];
            on_value += modulus * k_off * off[a] * hat[k * dim + a];
        }
        for (int r = 0; r < rows; r++) {
            put(on_mean / rows, smoothed_cells_row(body, q, k, r), i, row, touched);
        }
        put(on_value, nodes + smoothed_cells_node(body, q, k), i, row, touched);
    }
}

static int compare_nodes(const void *left, const void *right)
{
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

/* The forces on the nodes up to i. */
static void spread(const struct scalar_stiffness *stiffness, int64_t touched, int64_t i,
                   struct scalar_row *row)
{
    row->count = 0;
    for (int64_t t = 0; t < touched; t++) {
        struct average field = field_at(stiffness, row->touched[t]);
        double force = row->on_field[row->touched[t]];
        for (int64_t k = 0; k < field.length; k++) {
            int32_t node = (int32_t)node_of(stiffness, row->touched[t], &field, k);
            if (node > i) {
                continue;
            }
            if (row->node_seen[node] != i + 1) {
                row->node_seen[node] = i + 1;
                row->node[row->count++] = node;
                row->sum[node] = 0.0;
            }
            row->sum[node] += force * field.phi[k];
        }
    }
    qsort(row->node, (size_t)row->count, sizeof *row->node, compare_nodes);
    for (int64_t k = 0; k < row->count; k++) {
        row->value[k] = row->sum[row->node[k]];
    }
}

void scalar_stiffness_row(const struct scalar_stiffness *stiffness, int64_t i, struct scalar_row *row)
{
    const struct field_averages *averages = &stiffness->system->body.cells.averages;
    int dim = stiffness->system->body.dim;
    int64_t first = stiffness->node_ptr[i], last = stiffness->node_ptr[i + 1], touched = 0;
    for (int64_t n = first; n < last; n++) {
        row->at_field[stiffness->node_field[n]] = stiffness->node_phi[n];
    }
    for (int64_t n = first; n < last; n++) {
        int64_t f = stiffness->node_field[n], bond = f - stiffness->field_count;
        if (bond >= 0) {
            put(stiffness->bond_stiffness[bond] * stiffness->node_phi[n], f, i, row, &touched);
            continue;
        }
        for (int64_t c = averages->corner_ptr[f]; c < averages->corner_ptr[f + 1]; c++) {
            int64_t q = averages->corner[c] % averages->corner_count / (dim + 1);
            if (row->cell_seen[q] != i + 1) {
                row->cell_seen[q] = i + 1;
                add_cell(stiffness, q, i, row, &touched);
            }
        }
    }
    for (int64_t n = first; n < last; n++) {
        row->at_field[stiffness->node_field[n]] = 0.0;
    }
    spread(stiffness, touched, i, row);
}
