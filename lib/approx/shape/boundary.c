#include "approx/shape/boundary_private.h"

#include "approx/cells/quadrature.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static enum status allocate(int dim, int64_t parts, int64_t samples, struct boundary_averages *averages,
                            struct error *error)
{
    averages->count = parts;
    RETURN_IF_ERROR(NEW_ARRAY(&averages->node, parts, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->area, parts, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->normal, parts * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->position, parts * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->ptr, parts + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->sample_ptr, parts + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->sample_x, samples * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->sample_share, samples, error));
    return NEW_ARRAY(&averages->sample_point, samples, error);
}

/* A dense row over the nodes with a list of its nonzeros, to accumulate one average at a time. */
struct dense_row {
    double *value;
    int32_t *touched;
    int64_t count, capacity;
    bool *is_touched;
};

static void row_free(struct dense_row *row)
{
    FREE_ALL(row->value, row->touched, row->is_touched);
}

static enum status row_add(struct dense_row *row, int32_t node, double value, struct error *error)
{
    if (!row->is_touched[node]) {
        RETURN_IF_ERROR(GROW_ARRAY(&row->touched, row->count + 1, &row->capacity, error));
        row->is_touched[node] = true;
        row->touched[row->count++] = node;
    }
    row->value[node] += value;
    return STATUS_OK;
}

/* Append the row, divided by `whole`, to the CSR lists of the averages, and clear it. */
static enum status row_finish(struct dense_row *row, double whole, int64_t part, int64_t *capacity,
                              struct boundary_averages *averages, struct error *error)
{
    int64_t at = averages->ptr[part], room = *capacity;
    RETURN_IF_ERROR(GROW_ARRAY(&averages->idx, at + row->count, &room, error));
    RETURN_IF_ERROR(GROW_ARRAY(&averages->phi, at + row->count, capacity, error));
    qsort(row->touched, (size_t)row->count, sizeof *row->touched, compare_int32);
    for (int64_t i = 0; i < row->count; i++) {
        int32_t node = row->touched[i];
        averages->idx[at + i] = node;
        averages->phi[at + i] = row->value[node] / whole;
        row->value[node] = 0.0;
        row->is_touched[node] = false;
    }
    averages->ptr[part + 1] = at + row->count;
    row->count = 0;
    return STATUS_OK;
}

/* The weight of a quadrature point in the value at a vertex of the linear function through the points of a
 * facet; the point has the barycentric coordinate `near` of the vertex. */
static double extrapolated(int dim, double near)
{
    return (dim + 1) * near - 1.0;
}

/* Add one corner's facet to the part: its shape functions, area, normal, and samples. */
static enum status add_corner(const struct face_table *table, const struct facet_set *set,
                              const int64_t *face_of, const struct corner *corner, int64_t part,
                              bool at_corner, struct dense_row *row, struct boundary_averages *averages,
                              struct error *error)
{
    int dim = table->dim;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    const int32_t *face = table->faces->node + face_of[corner->facet] * dim;
    double normal[3], size, x[9];
    int vertex = 0; /* the face may start at a different node than the facet */
    while (vertex + 1 < dim && face[vertex] != corner->node) {
        vertex++;
    }
    boundary_unit_normal(table, set->facet + (int64_t)corner->facet * dim, normal, &size);
    quadrature_positions(&rule, dim, table->x, face, x);
    for (int g = 0; g < rule.points; g++) {
        double near = rule.barycentric[g * dim + vertex], weight = rule.weight[g] * size * near;
        double in_row = at_corner ? size / dim * extrapolated(dim, near) : weight;
        int64_t point = face_of[corner->facet] * table->per_face + g;
        for (int64_t i = table->lists->ptr[point]; row != NULL && i < table->lists->ptr[point + 1]; i++) {
            RETURN_IF_ERROR(row_add(row, table->lists->idx[i], in_row * table->phi[i], error));
        }
        if (!(weight > 0.0)) {
            continue;
        }
        averages->area[part] += weight;
        int64_t sample = averages->sample_ptr[part + 1]++;
        averages->sample_share[sample] = weight;
        averages->sample_point[sample] = (int64_t)corner->facet * table->per_face + g;
        for (int a = 0; a < dim; a++) {
            averages->normal[part * dim + a] += weight * normal[a];
            averages->position[part * dim + a] += weight * x[g * dim + a];
            averages->sample_x[sample * dim + a] = x[g * dim + a];
        }
    }
    return STATUS_OK;
}

/* Divide the integrals of an average by its area; returns the length of the mean normal. */
static double normalise(int dim, int64_t part, struct boundary_averages *averages)
{
    double length2 = 0.0;
    for (int a = 0; a < dim; a++) {
        averages->position[part * dim + a] /= averages->area[part];
        length2 += averages->normal[part * dim + a] * averages->normal[part * dim + a];
    }
    for (int a = 0; a < dim; a++) {
        averages->normal[part * dim + a] /= sqrt(length2);
    }
    for (int64_t s = averages->sample_ptr[part]; s < averages->sample_ptr[part + 1]; s++) {
        averages->sample_share[s] /= averages->area[part];
    }
    return sqrt(length2) / averages->area[part];
}

/* Average `a` is the value at one place, its one sample. */
static void put_place(int dim, int64_t a, const double *x, struct boundary_averages *averages)
{
    int64_t sample = averages->sample_ptr[a];
    averages->sample_ptr[a + 1] = sample + 1;
    averages->sample_share[sample] = 1.0;
    memcpy(averages->position + a * dim, x, (size_t)dim * sizeof *x);
    memcpy(averages->sample_x + sample * dim, x, (size_t)dim * sizeof *x);
}

/* The parts over which averages are taken: one for each node, or each node and side; with `sides` followed by
 * the whole sides. */
static enum status collect_parts(const struct face_table *table, const struct facet_set *set,
                                 const int64_t *face_of, bool split, struct boundary_sides *sides,
                                 struct corner *corners, int64_t *parts, struct error *error)
{
    int64_t count = 2 * set->count * table->dim;
    boundary_collect_corners(table, set, face_of, split, corners, parts);
    if (sides != NULL) {
        sides->node_average_count = *parts;
        RETURN_IF_ERROR(NEW_ARRAY(&sides->facet_group, set->count, error));
        RETURN_IF_ERROR(boundary_add_sides(table, set, split, corners, parts, sides->facet_group,
                                           &sides->group_count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&sides->group, *parts, error));
        RETURN_IF_ERROR(NEW_ARRAY(&sides->flat, *parts, error));
        for (int64_t i = 0; i < count; i++) {
            sides->group[corners[i].part] = sides->facet_group[corners[i].facet];
        }
    }
    return STATUS_OK;
}

/* Build averages of any kind; without node_lists boundary averages, else node values. */
static enum status build(const struct face_table *table, const struct facet_set *set, bool split,
                         bool at_corner, struct boundary_sides *sides, const struct neighbours *node_lists,
                         const double *node_phi, struct boundary_averages *averages, struct error *error)
{
    int dim = table->dim;
    int64_t corner_count = (sides != NULL ? 2 : 1) * set->count * dim, parts = 0, capacity = 0;
    FREED_BY(row_free) struct dense_row row = {0};
    *averages = (struct boundary_averages){0};
    NEW_SCRATCH(struct corner, corners, corner_count, error);
    NEW_SCRATCH(int64_t, face_of, set->count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&row.value, table->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&row.is_touched, table->node_count, error));
    RETURN_IF_ERROR(boundary_find_faces(table, set, face_of, error));
    RETURN_IF_ERROR(collect_parts(table, set, face_of, split, sides, corners, &parts, error));
    RETURN_IF_ERROR(allocate(dim, parts, corner_count * table->per_face, averages, error));
    for (int64_t part = 0, next = 0; part < parts; part++) {
        int32_t node = corners[next].node;
        averages->sample_ptr[part + 1] = averages->sample_ptr[part];
        for (; next < corner_count && corners[next].part == part; next++) {
            RETURN_IF_ERROR(add_corner(table, set, face_of, &corners[next], part, at_corner,
                                       node_lists == NULL ? &row : NULL, averages, error));
        }
        averages->node[part] = node;
        double whole = averages->area[part];
        double mean = normalise(dim, part, averages);
        if (sides != NULL) {
            sides->flat[part] = mean > 1.0 - 0.5e-6;
        }
        if (node_lists != NULL) {
            whole = 1.0;
            put_place(dim, part, table->x + (int64_t)node * dim, averages);
            for (int64_t i = node_lists->ptr[node]; i < node_lists->ptr[node + 1]; i++) {
                RETURN_IF_ERROR(row_add(&row, node_lists->idx[i], node_phi[i], error));
            }
        }
        RETURN_IF_ERROR(row_finish(&row, whole, part, &capacity, averages, error));
    }
    return STATUS_OK;
}

enum status boundary_averages_build(const struct face_table *table, const struct facet_set *set,
                                    struct boundary_averages *averages, struct error *error)
{
    return build(table, set, true, false, NULL, NULL, NULL, averages, error);
}

enum status boundary_corners_build(const struct face_table *table, const struct facet_set *set,
                                   struct boundary_averages *averages, struct error *error)
{
    return build(table, set, false, true, NULL, NULL, NULL, averages, error);
}

enum status boundary_sides_build(const struct face_table *table, const struct facet_set *set, bool split,
                                 struct boundary_averages *averages, struct boundary_sides *sides,
                                 struct error *error)
{
    *sides = (struct boundary_sides){0};
    return build(table, set, split, false, sides, NULL, NULL, averages, error);
}

void boundary_sides_free(struct boundary_sides *sides)
{
    FREE_ALL(sides->group, sides->facet_group, sides->flat);
    *sides = (struct boundary_sides){0};
}

enum status boundary_nodes_build(const struct face_table *table, const struct facet_set *set,
                                 const struct neighbours *node_lists, const double *node_phi,
                                 struct boundary_averages *averages, struct error *error)
{
    return build(table, set, false, false, NULL, node_lists, node_phi, averages, error);
}

/* Set average `a` to the values of one point. */
static void put_values(struct boundary_averages *averages, int64_t a, const int32_t *idx, const double *phi,
                       int64_t length)
{
    int64_t at = averages->ptr[a];
    memcpy(averages->idx + at, idx, (size_t)length * sizeof *idx);
    memcpy(averages->phi + at, phi, (size_t)length * sizeof *phi);
    averages->ptr[a + 1] = at + length;
}

enum status boundary_list_build(int dim, const double *x, const int32_t *nodes, int64_t count,
                                const struct neighbours *lists, const double *phi,
                                struct boundary_averages *averages, struct error *error)
{
    int64_t entries = 0;
    *averages = (struct boundary_averages){0};
    for (int64_t i = 0; i < count; i++) {
        entries += lists->ptr[nodes[i] + 1] - lists->ptr[nodes[i]];
    }
    RETURN_IF_ERROR(allocate(dim, count, count, averages, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->idx, entries, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->phi, entries, error));
    for (int64_t i = 0; i < count; i++) {
        int64_t from = lists->ptr[nodes[i]], length = lists->ptr[nodes[i] + 1] - from;
        averages->node[i] = nodes[i];
        put_values(averages, i, lists->idx + from, phi + from, length);
        put_place(dim, i, x + (int64_t)nodes[i] * dim, averages);
    }
    return STATUS_OK;
}

enum status boundary_points_build(const struct face_table *table, const struct facet_set *set,
                                  struct boundary_averages *averages, struct error *error)
{
    int dim = table->dim;
    int64_t entries = 0, count = set->count * table->per_face;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    *averages = (struct boundary_averages){0};
    NEW_SCRATCH(int64_t, face_of, set->count, error);
    RETURN_IF_ERROR(boundary_find_faces(table, set, face_of, error));
    RETURN_IF_ERROR(allocate(dim, count, count, averages, error));
    for (int64_t f = 0; f < set->count; f++) {
        int64_t first = face_of[f] * table->per_face;
        entries += table->lists->ptr[first + table->per_face] - table->lists->ptr[first];
    }
    RETURN_IF_ERROR(NEW_ARRAY(&averages->idx, entries, error));
    RETURN_IF_ERROR(NEW_ARRAY(&averages->phi, entries, error));
    for (int64_t p = 0; p < count; p++) {
        int64_t facet = p / table->per_face, point = face_of[facet] * table->per_face + p % table->per_face;
        int64_t from = table->lists->ptr[point], length = table->lists->ptr[point + 1] - from;
        double normal[3], size, x[9];
        boundary_unit_normal(table, set->facet + facet * dim, normal, &size);
        quadrature_positions(&rule, dim, table->x, table->faces->node + face_of[facet] * dim, x);
        averages->node[p] = set->facet[facet * dim];
        averages->area[p] = rule.weight[p % table->per_face] * size;
        memcpy(averages->normal + p * dim, normal, (size_t)dim * sizeof *normal);
        put_place(dim, p, x + p % table->per_face * dim, averages);
        put_values(averages, p, table->lists->idx + from, table->phi + from, length);
    }
    return STATUS_OK;
}

double boundary_stretch(const struct boundary_averages *averages, const struct face_table *table,
                        const struct facet_set *set, int64_t a, const double *x)
{
    int dim = table->dim;
    double stretch = 0.0, now[3], at_rest[3];
    for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
        const int32_t *facet = set->facet + averages->sample_point[s] / table->per_face * dim;
        face_area_vector(dim, x, facet, now);
        face_area_vector(dim, table->x, facet, at_rest);
        stretch += averages->sample_share[s] * vector_length(dim, now) / vector_length(dim, at_rest);
    }
    return stretch;
}

void boundary_averages_free(struct boundary_averages *averages)
{
    FREE_ALL(averages->node, averages->area, averages->normal, averages->position, averages->ptr,
             averages->idx, averages->phi, averages->sample_ptr, averages->sample_x, averages->sample_share,
             averages->sample_point);
    *averages = (struct boundary_averages){0};
}
