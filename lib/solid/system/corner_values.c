#include "solid/system/corner_values.h"

#include "base/eigen.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

/* Rows that together prescribe a corner. */
struct hold {
    int count;
    int64_t row[3];
    double along[9]; /* count * dim: vector b_k of each, with b_k . a_j = (j == k) for directions a */
};

/* A row of the section and direction of another one. */
struct near_row {
    int64_t row;
    double away[3]; /* the place of its average from that of the other one, m */
    double share;   /* in the value at the node of that */
};

struct building {
    const struct face_table *table;
    const struct constraint_rows *rows;
    int64_t *row_of, *face_of; /* node_count + 1: of each node */
    int32_t *row, *face;       /* its rows, its faces on the boundary */
    int64_t *term;             /* node_count: its term, if it belongs to the corner in work */
    int64_t near_count, near_capacity;
    struct near_row *near;
};

static void building_free(struct building *building)
{
    FREE_ALL(building->row_of, building->face_of, building->row, building->face, building->term,
             building->near);
}

/* Add row r, with the direction a, to those that prescribe a corner, unless it depends on them. The vectors b
 * lie in the span of the directions: each loses its part along a, b_j -= (b_j . a) b. */
static void hold_add(const struct constraint_rows *rows, int64_t r, struct hold *hold)
{
    int dim = rows->dim, count = hold->count;
    double *along = hold->along, rest[3], part[3] = {0.0};
    const double *a = rows->direction + r * dim;
    for (int k = 0; k < count; k++) {
        add_scaled(dim, vector_dot(dim, rows->direction + hold->row[k] * dim, a), along + k * dim, part);
    }
    vector_subtract(dim, a, part, rest);
    double length2 = vector_dot(dim, rest, rest);
    if (count == dim || length2 < 0.01) {
        return;
    }
    hold->row[hold->count++] = r;
    for (int i = 0; i < dim; i++) {
        along[count * dim + i] = rest[i] / length2;
    }
    for (int k = 0; k < count; k++) {
        add_scaled(dim, -vector_dot(dim, along + k * dim, a), along + count * dim, along + k * dim);
    }
}

/* place[dim]: where the average of row r is at rest, m. */
static void place_of(const struct building *building, int64_t r, double *place)
{
    struct average average = constraint_rows_average(building->rows, r);
    average_take(&average, building->rows->dim, building->table->x, place);
}

static bool are_alike(const struct constraint_rows *rows, int64_t r, int64_t s)
{
    size_t size = (size_t)rows->dim * sizeof *rows->direction;
    return rows->section[r] == rows->section[s] &&
           memcmp(rows->direction + r * rows->dim, rows->direction + s * rows->dim, size) == 0;
}

/* List row r, and the rows like it at the nodes of faces at its node: repeated if they share several. */
static enum status list_near(struct building *building, int64_t r, struct error *error)
{
    const struct constraint_rows *rows = building->rows;
    int dim = rows->dim;
    int32_t node = rows->node[r];
    double origin[3];
    place_of(building, r, origin);
    building->near_count = 0;
    for (int64_t i = building->face_of[node] * dim; i < building->face_of[node + 1] * dim; i++) {
        int32_t other = building->table->faces->node[(int64_t)building->face[i / dim] * dim + i % dim];
        for (int64_t j = building->row_of[other]; j < building->row_of[other + 1]; j++) {
            int64_t s = building->row[j];
            if (s != r && are_alike(rows, r, s)) {
                RETURN_IF_ERROR(
                    GROW_ARRAY(&building->near, building->near_count + 1, &building->near_capacity, error));
                struct near_row *added = &building->near[building->near_count++];
                *added = (struct near_row){.row = s};
                place_of(building, s, added->away);
                vector_subtract(dim, added->away, origin, added->away);
            }
        }
    }
    return STATUS_OK;
}

/* Set the shares of the rows near row r such that linear fields are exact at its node as far as the rows
 * tell, by least squares with weights |away|^-4. Returns the share of row r. */
static double share_out(struct building *building, int64_t r)
{
    int dim = building->rows->dim;
    double offset[3], G[9] = {0.0}, values[3], V[9], slope[3] = {0.0}, most = 0.0, left = 1.0;
    place_of(building, r, offset);
    vector_subtract(dim, building->table->x + (int64_t)building->rows->node[r] * dim, offset, offset);
    for (int64_t i = 0; i < building->near_count; i++) {
        struct near_row *near = &building->near[i];
        double length2 = vector_dot(dim, near->away, near->away);
        near->share = length2 > 0.0 ? 1.0 / (length2 * length2) : 0.0;
        for (int a = 0; a < dim; a++) {
            add_scaled(dim, near->share * near->away[a], near->away, G + a * dim);
        }
    }
    eigen_symmetric(dim, G, values, V);
    for (int k = 0; k < dim; k++) {
        most = values[k] > most ? values[k] : most;
    }
    for (int k = 0; k < dim; k++) {
        const double axis[3] = {V[k], V[dim + k], V[(dim - 1) * dim + k]};
        if (values[k] > 1e-3 * most) {
            add_scaled(dim, vector_dot(dim, axis, offset) / values[k], axis, slope);
        }
    }
    for (int64_t i = 0; i < building->near_count; i++) {
        building->near[i].share *= vector_dot(dim, building->near[i].away, slope);
        left -= building->near[i].share;
    }
    return left;
}

/* The displacement of the last corner += amount along (direction . average). */
static enum status add_average(struct building *building, struct corner_values *values,
                               struct average average, const double *along, const double *direction,
                               double amount, struct error *error)
{
    int64_t begin = values->first[values->count - 1], *end = &values->first[values->count];
    for (int64_t i = 0; i < average.length; i++) {
        int32_t node = average.idx[i];
        int64_t *at = &building->term[node];
        if (*at < begin || *at >= *end || values->terms[*at].node != node) {
            RETURN_IF_ERROR(GROW_ARRAY(&values->terms, *end + 1, &values->capacity, error));
            *at = (*end)++;
            values->terms[*at] = (struct corner_term){.node = node};
        }
        for (int a = 0; a < values->dim; a++) {
            add_scaled(values->dim, amount * average.phi[i] * along[a], direction,
                       values->terms[*at].weight[a]);
        }
    }
    return STATUS_OK;
}

/* What the rows prescribe in place of the displacement of the boundary at corner c. */
static enum status add_rows(struct building *building, const struct hold *hold,
                            const struct boundary_averages *corners, int64_t c, struct corner_values *values,
                            struct error *error)
{
    const struct constraint_rows *rows = building->rows;
    for (int k = 0; k < hold->count; k++) {
        int64_t r = hold->row[k];
        const double *along = hold->along + k * rows->dim, *direction = rows->direction + r * rows->dim;
        RETURN_IF_ERROR(list_near(building, r, error));
        double left = share_out(building, r);
        RETURN_IF_ERROR(
            add_average(building, values, average_of_boundary(corners, c), along, direction, -1.0, error));
        RETURN_IF_ERROR(
            add_average(building, values, constraint_rows_average(rows, r), along, direction, left, error));
        for (int64_t i = 0; i < building->near_count; i++) {
            RETURN_IF_ERROR(add_average(building, values,
                                        constraint_rows_average(rows, building->near[i].row), along,
                                        direction, building->near[i].share, error));
        }
    }
    return STATUS_OK;
}

enum status corner_values_build(const struct face_table *table, const struct boundary_averages *corners,
                                const struct constraint_rows *rows, struct corner_values *values,
                                struct error *error)
{
    static const double unit[3][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}};
    FREED_BY(building_free) struct building building = {.table = table, .rows = rows};
    *values = (struct corner_values){.dim = table->dim};
    RETURN_IF_ERROR(NEW_ARRAY(&values->first, corners->count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&building.term, table->node_count, error));
    RETURN_IF_ERROR(
        lists_by_row(rows->count, 1, rows->node, table->node_count, &building.row_of, &building.row, error));
    RETURN_IF_ERROR(lists_by_row(table->faces->boundary_count, table->dim, table->faces->node,
                                 table->node_count, &building.face_of, &building.face, error));
    for (int64_t c = 0; c < corners->count; c++) {
        int32_t node = corners->node[c];
        struct hold hold = {0};
        values->first[++values->count] = values->first[c];
        for (int i = 0; i < table->dim; i++) {
            RETURN_IF_ERROR(add_average(&building, values, average_of_boundary(corners, c), unit[i], unit[i],
                                        1.0, error));
        }
        for (int64_t i = building.row_of[node]; i < building.row_of[node + 1]; i++) {
            hold_add(rows, building.row[i], &hold);
        }
        RETURN_IF_ERROR(add_rows(&building, &hold, corners, c, values, error));
    }
    return STATUS_OK;
}

void corner_values_free(struct corner_values *values)
{
    FREE_ALL(values->first, values->terms);
    *values = (struct corner_values){0};
}

void corner_values_take(const struct corner_values *values, int64_t c, const double *field, double *u)
{
    int dim = values->dim;
    memset(u, 0, (size_t)dim * sizeof *u);
    for (int64_t i = values->first[c]; i < values->first[c + 1]; i++) {
        const struct corner_term *term = &values->terms[i];
        for (int a = 0; a < dim; a++) {
            u[a] += vector_dot(dim, term->weight[a], field + (int64_t)term->node * dim);
        }
    }
}

void corner_values_spread(const struct corner_values *values, int64_t c, const double *on, double *force)
{
    int dim = values->dim;
    for (int64_t i = values->first[c]; i < values->first[c + 1]; i++) {
        const struct corner_term *term = &values->terms[i];
        for (int a = 0; a < dim; a++) {
            add_scaled(dim, on[a], term->weight[a], force + (int64_t)term->node * dim);
        }
    }
}
