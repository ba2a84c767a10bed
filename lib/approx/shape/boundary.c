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
    if (row->count > 0) { /* else there is nothing to sort, which qsort does not take */
        qsort(row->touched, (size_t)row->count, sizeof *row->touched, compare_int32);
    }
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
        /* At a corner: as of the linear function through the points. */
        double in_row = at_corner ? size / dim * ((dim + 1) * near - 1.0) : weight;
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

/* Build averages of any kind; without `valued`, the lists of neighbours are empty. */
static enum status build(const struct face_table *table, const struct facet_set *set, bool split,
                         bool at_corner, bool valued, struct boundary_sides *sides,
                         struct boundary_averages *averages, struct error *error)
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
    RETURN_IF_ERROR(boundary_parts(table, set, face_of, split, sides, corners, &parts, error));
    RETURN_IF_ERROR(allocate(dim, parts, corner_count * table->per_face, averages, error));
    for (int64_t part = 0, next = 0; part < parts; part++) {
        averages->node[part] = corners[next].node;
        averages->sample_ptr[part + 1] = averages->sample_ptr[part];
        for (; next < corner_count && corners[next].part == part; next++) {
            RETURN_IF_ERROR(add_corner(table, set, face_of, &corners[next], part, at_corner,
                                       valued ? &row : NULL, averages, error));
        }
        double mean = normalise(dim, part, averages);
        if (sides != NULL) {
            sides->flat[part] = mean > 1.0 - 0.5e-6;
        }
        RETURN_IF_ERROR(row_finish(&row, averages->area[part], part, &capacity, averages, error));
    }
    return STATUS_OK;
}

enum status boundary_averages_build(const struct face_table *table, const struct facet_set *set,
                                    struct boundary_averages *averages, struct error *error)
{
    return build(table, set, true, false, true, NULL, averages, error);
}

enum status boundary_corners_build(const struct face_table *table, const struct facet_set *set,
                                   struct boundary_averages *averages, struct error *error)
{
    return build(table, set, false, true, true, NULL, averages, error);
}

enum status boundary_sides_build(const struct face_table *table, const struct facet_set *set, bool split,
                                 struct boundary_averages *averages, struct boundary_sides *sides,
                                 struct error *error)
{
    *sides = (struct boundary_sides){0};
    return build(table, set, split, false, true, sides, averages, error);
}

void boundary_sides_free(struct boundary_sides *sides)
{
    FREE_ALL(sides->group, sides->facet_group, sides->flat);
    *sides = (struct boundary_sides){0};
}

/* Let average `a` be the value at the place x, its one sample: a row of a table. room: of idx and phi. */
static enum status put_value(int dim, int64_t a, const struct neighbours *lists, const double *phi,
                             int64_t row, const double *x, int64_t room[2],
                             struct boundary_averages *averages, struct error *error)
{
    int64_t from = lists->ptr[row], length = lists->ptr[row + 1] - from, at = averages->ptr[a];
    RETURN_IF_ERROR(GROW_ARRAY(&averages->idx, at + length, &room[0], error));
    RETURN_IF_ERROR(GROW_ARRAY(&averages->phi, at + length, &room[1], error));
    memcpy(averages->idx + at, lists->idx + from, (size_t)length * sizeof *averages->idx);
    memcpy(averages->phi + at, phi + from, (size_t)length * sizeof *phi);
    averages->ptr[a + 1] = at + length;
    averages->sample_ptr[a + 1] = a + 1;
    averages->sample_share[a] = 1.0;
    memcpy(averages->position + a * dim, x, (size_t)dim * sizeof *x);
    memcpy(averages->sample_x + a * dim, x, (size_t)dim * sizeof *x);
    return STATUS_OK;
}

enum status boundary_nodes_build(const struct face_table *table, const struct facet_set *set,
                                 const struct neighbours *node_lists, const double *node_phi,
                                 struct boundary_averages *averages, struct error *error)
{
    int64_t room[2] = {0};
    RETURN_IF_ERROR(build(table, set, false, false, false, NULL, averages, error));
    for (int64_t a = 0; a < averages->count; a++) {
        int64_t node = averages->node[a];
        RETURN_IF_ERROR(put_value(table->dim, a, node_lists, node_phi, node, table->x + node * table->dim,
                                  room, averages, error));
    }
    return STATUS_OK;
}

enum status boundary_list_build(int dim, const double *x, const int32_t *nodes, int64_t count,
                                const struct neighbours *lists, const double *phi,
                                struct boundary_averages *averages, struct error *error)
{
    int64_t room[2] = {0};
    *averages = (struct boundary_averages){0};
    RETURN_IF_ERROR(allocate(dim, count, count, averages, error));
    for (int64_t i = 0; i < count; i++) {
        averages->node[i] = nodes[i];
        RETURN_IF_ERROR(
            put_value(dim, i, lists, phi, nodes[i], x + (int64_t)nodes[i] * dim, room, averages, error));
    }
    return STATUS_OK;
}

enum status boundary_points_build(const struct face_table *table, const struct facet_set *set,
                                  struct boundary_averages *averages, struct error *error)
{
    int dim = table->dim;
    int64_t count = set->count * table->per_face, room[2] = {0};
    struct quadrature_rule rule = quadrature_face_rule(dim);
    *averages = (struct boundary_averages){0};
    NEW_SCRATCH(int64_t, face_of, set->count, error);
    RETURN_IF_ERROR(boundary_find_faces(table, set, face_of, error));
    RETURN_IF_ERROR(allocate(dim, count, count, averages, error));
    for (int64_t p = 0; p < count; p++) {
        int64_t facet = p / table->per_face, g = p % table->per_face;
        double normal[3], size, x[9];
        boundary_unit_normal(table, set->facet + facet * dim, normal, &size);
        quadrature_positions(&rule, dim, table->x, table->faces->node + face_of[facet] * dim, x);
        averages->node[p] = set->facet[facet * dim];
        averages->area[p] = rule.weight[g] * size;
        memcpy(averages->normal + p * dim, normal, (size_t)dim * sizeof *normal);
        RETURN_IF_ERROR(put_value(dim, p, table->lists, table->phi, face_of[facet] * table->per_face + g,
                                  x + g * dim, room, averages, error));
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
