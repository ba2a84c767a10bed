/* What all rows of the stiffness need: cells, lists by nodes, prepared columns; see stiffness_rows.h. */
#include "solid/preconditioner/stiffness_rows.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/nodal_volume.h"
#include "solid/contact/friction.h"
#include "solid/system/system.h"

#include <math.h>
#include <string.h>

/* The lists of rows by nodes. */
static enum status transpose_lists(const struct constraint_rows *rows, int64_t nodes, struct sparse *lists,
                                   struct error *error)
{
    const struct sparse by_list = constraint_rows_lists(rows, nodes);
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
    cell->variance_shear = EDGE_OFFSET * body->cells.variance_shear[q];
    cell->variance_lame =
        EDGE_OFFSET * (body->cells.variance_bulk[q] - 2.0 / 3.0 * body->cells.variance_shear[q]);
    cell->count = smoothed_cells_rows(body, q, cell->field, cell->gradient);
    smoothed_cells_linear_gradients(body, q, cell->linear_gradient);
    for (int k = 0; k <= body->dim; k++) {
        cell->vertex[k] = (int32_t)body_node_row(body, smoothed_cells_node(body, q, k));
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
    RETURN_IF_ERROR(NEW_ARRAY(&rows->cells, body->point_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows->slot, body->node_count, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        set_cell(body, q, &rows->cells[q]);
    }
    RETURN_IF_ERROR(transpose_lists(&system->springs.rows, system->node_count, &rows->springs, error));
    RETURN_IF_ERROR(take_contacts(rows, error));
    return transpose_lists(&system->rows, system->node_count, &rows->held, error);
}

void stiffness_rows_free(struct stiffness_rows *rows)
{
    sparse_free(&rows->columns);
    sparse_free(&rows->springs);
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
    int64_t length = matrix->ptr[f + 1] - matrix->ptr[f];
    *place = NULL;
    if (length > 0 || body->share.ranks == NULL) {
        return (struct average){length, matrix->idx + matrix->ptr[f], matrix->value + matrix->ptr[f]};
    }
    int64_t edges = averages->given[0].lists->count;
    const struct row_table *table = &averages->given[f < edges ? 0 : 1];
    const struct neighbours *lists = table->lists;
    int64_t row = table->order[f < edges ? f : f - edges], at = lists->ptr[row];
    *place = body->order.places;
    return (struct average){lists->ptr[row + 1] - at, lists->idx + at, table->phi + at};
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
