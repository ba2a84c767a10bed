#include "solid/scalar_stiffness.h"

#include "base/memory.h"
#include "solid/system.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The bonds: penalties of the conditions, one for each list of rows, then the contacts' averages, of points
 * and all. */
static int64_t count_bonds(const struct solid_system *system)
{
    int64_t count = system->penalties.list_count;
    for (int64_t c = 0; c < system->contact_count; c++) {
        count += system->contacts[c].averages->count;
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
    for (; b >= system->contacts[c].averages->count; c++) {
        b -= system->contacts[c].averages->count;
    }
    *stiffness = system->contacts[c].stiffness * system->contacts[c].averages->area[b];
    return average_of_boundary(system->contacts[c].averages, b);
}

static struct average field_at(const struct scalar_stiffness *stiffness, int64_t f)
{
    const struct solid_system *system = stiffness->system;
    const struct smoothed_cells *cells = &system->body.cells;
    double unused;
    if (f < stiffness->face_count) {
        int64_t at = cells->face_ptr[f];
        return (struct average){cells->face_ptr[f + 1] - at, cells->face_idx + at, cells->face_phi + at};
    }
    f -= stiffness->face_count;
    if (f < system->node_count) {
        int64_t at = system->node_lists->ptr[f];
        return (struct average){system->node_lists->ptr[f + 1] - at, system->node_lists->idx + at,
                                system->node_phi + at};
    }
    return bond_at(system, f - system->node_count, &unused);
}

/* The field that corner k of cell q looks at: its face, or with `vertex` its node. */
static int64_t field_of_corner(const struct scalar_stiffness *stiffness, int64_t q, int k, bool vertex)
{
    const struct body *body = &stiffness->system->body;
    int corners = body->dim + 1;
    return vertex ? stiffness->face_count + body->cells.cell_node[body->order[q] * corners + k]
                  : body->cells.face_of_corner[q * corners + k];
}

static enum status list_corners(struct scalar_stiffness *stiffness, struct error *error)
{
    enum status status;
    const struct body *body = &stiffness->system->body;
    int corners = body->dim + 1;
    int64_t count = 2 * body->point_count * corners;
    TRY(NEW_ARRAY(&stiffness->corner_ptr, stiffness->field_count + 2, error));
    TRY(NEW_ARRAY(&stiffness->corner, count, error));
    int64_t *start = stiffness->corner_ptr;
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t i = 0; i < count; i++) {
            int64_t q = i / 2 / corners, f = field_of_corner(stiffness, q, (int)(i / 2 % corners), i % 2 > 0);
            if (pass == 0) {
                start[f + 2]++;
            } else {
                stiffness->corner[start[f + 1]++] = q;
            }
        }
        for (int64_t f = 0; f < stiffness->field_count && pass == 0; f++) {
            start[f + 2] += start[f + 1];
        }
    }
done:
    return status;
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
            start[field.idx[i] + 2]++;
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
            int64_t at = start[field.idx[i] + 1]++;
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
    for (int64_t i = 0; i < body->point_count * (body->dim + 1); i++) {
        int64_t face = body->cells.face_of_corner[i];
        stiffness->face_count = face >= stiffness->face_count ? face + 1 : stiffness->face_count;
    }
    stiffness->field_count = stiffness->face_count + system->node_count;
    if (stiffness->field_count + stiffness->bond_count > INT32_MAX) {
        status = fail(error, STATUS_SYSTEM, "preconditioner: more than 2^31 faces, nodes and conditions");
        goto done;
    }
    TRY(NEW_ARRAY(&stiffness->bond_stiffness, stiffness->bond_count, error));
    for (int64_t b = 0; b < stiffness->bond_count; b++) {
        (void)bond_at(system, b, &stiffness->bond_stiffness[b]);
    }
    TRY(list_corners(stiffness, error));
    TRY(list_nodes(stiffness, error));
done:
    if (status != STATUS_OK) {
        scalar_stiffness_free(stiffness);
    }
    return status;
}

void scalar_stiffness_free(struct scalar_stiffness *stiffness)
{
    free(stiffness->corner_ptr);
    free(stiffness->corner);
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
    double hat[12], smooth[3] = {0.0, 0.0, 0.0}, off[3] = {0.0, 0.0, 0.0};
    double modulus = modulus_of(body, q), k_off = SMOOTHING_STIFFNESS(dim);
    smoothed_cells_hat_gradients(body, q, hat);
    for (int k = 0; k <= dim; k++) {
        double mean = row->at_field[field_of_corner(stiffness, q, k, false)];
        double value = row->at_field[field_of_corner(stiffness, q, k, true)];
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
        put(on_mean, field_of_corner(stiffness, q, k, false), i, row, touched);
        put(on_value, field_of_corner(stiffness, q, k, true), i, row, touched);
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
        for (int64_t k = 0; k < field.length && field.idx[k] <= i; k++) {
            int32_t node = field.idx[k];
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
        for (int64_t c = stiffness->corner_ptr[f]; c < stiffness->corner_ptr[f + 1]; c++) {
            int64_t q = stiffness->corner[c];
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
