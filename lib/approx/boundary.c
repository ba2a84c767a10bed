#include "approx/boundary.h"

#include "approx/quadrature.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Facets that turn by 45 degrees or more at a node belong to different sides; a little less than that, so
 * that round-off does not decide on chamfers. */
static const double side_cosine = 0.7072;

/* A face by its sorted nodes, for look-up. */
struct keyed_face {
    int32_t key[3];
    int64_t face;
};

static void sorted_key(int dim, const int32_t *node, int32_t key[3])
{
    key[2] = -1;
    for (int i = 0; i < dim; i++) {
        int at = i;
        for (; at > 0 && key[at - 1] > node[i]; at--) {
            key[at] = key[at - 1];
        }
        key[at] = node[i];
    }
}

static int compare_faces(const void *left, const void *right)
{
    const struct keyed_face *a = left, *b = right;
    for (int i = 0; i < 3; i++) {
        if (a->key[i] != b->key[i]) {
            return a->key[i] < b->key[i] ? -1 : 1;
        }
    }
    return 0;
}

/* face_of[i]: the face of the table that facet i of the set is. */
static enum status find_faces(const struct face_table *table, const struct facet_set *set, int64_t *face_of,
                              struct error *error)
{
    enum status status;
    struct keyed_face *keyed = NULL;
    int dim = table->dim;
    int64_t count = 0;
    TRY(NEW_ARRAY(&keyed, table->faces->count, error));
    for (int64_t f = 0; f < table->faces->count; f++) {
        if (table->faces->cell[2 * f + 1] < 0) {
            sorted_key(dim, table->faces->node + f * dim, keyed[count].key);
            keyed[count++].face = f;
        }
    }
    qsort(keyed, (size_t)count, sizeof *keyed, compare_faces);
    for (int64_t i = 0; i < set->count; i++) {
        struct keyed_face wanted;
        sorted_key(dim, set->facet + i * dim, wanted.key);
        const struct keyed_face *found = bsearch(&wanted, keyed, (size_t)count, sizeof *keyed, compare_faces);
        if (found == NULL) {
            status = fail(error, STATUS_INPUT, "facets: row %lld of the set is no boundary face of the cells",
                          (long long)i);
            goto done;
        }
        face_of[i] = found->face;
    }
done:
    free(keyed);
    return status;
}

/* One corner of a facet: which hat part it belongs to. */
struct corner {
    int32_t node;
    int32_t vertex; /* of the facet */
    int64_t facet;  /* of the set */
    int64_t part;
};

static int compare_corners(const void *left, const void *right)
{
    const struct corner *a = left, *b = right;
    if (a->node != b->node) {
        return a->node < b->node ? -1 : 1;
    }
    if (a->facet != b->facet) {
        return a->facet < b->facet ? -1 : 1;
    }
    return a->vertex - b->vertex;
}

static void unit_normal(const struct face_table *table, const int32_t *facet, double *normal, double *size)
{
    double sum = 0.0;
    normal[2] = 0.0;
    face_area_vector(table->dim, table->x, facet, normal);
    for (int a = 0; a < table->dim; a++) {
        sum += normal[a] * normal[a];
    }
    *size = sqrt(sum);
    for (int a = 0; a < table->dim; a++) {
        normal[a] /= *size;
    }
}

/* Whether two facets at a node are of one side: in 3D they must share an edge there, in 2D they meet anyway.
 */
static bool same_side(const struct face_table *table, const struct facet_set *set, const struct corner *a,
                      const struct corner *b)
{
    double na[3], nb[3], size;
    const int32_t *fa = set->facet + a->facet * table->dim, *fb = set->facet + b->facet * table->dim;
    int shared = 0;
    for (int i = 0; i < table->dim; i++) {
        for (int k = 0; k < table->dim; k++) {
            shared += fa[i] == fb[k];
        }
    }
    if (shared < table->dim - 1) {
        return false;
    }
    unit_normal(table, fa, na, &size);
    unit_normal(table, fb, nb, &size);
    return na[0] * nb[0] + na[1] * nb[1] + na[2] * nb[2] >= side_cosine;
}

/* Number the parts of one node's hat: corners first..last-1 joined through neighbours of one side. */
static void split_hat(const struct face_table *table, const struct facet_set *set, struct corner *corners,
                      int64_t first, int64_t last, bool split, int64_t *part_count)
{
    for (int64_t i = first; i < last; i++) {
        corners[i].part = -1;
    }
    for (int64_t seed = first; seed < last; seed++) {
        if (corners[seed].part >= 0) {
            continue;
        }
        corners[seed].part = *part_count;
        for (bool grew = true; grew;) {
            grew = false;
            for (int64_t i = first; i < last; i++) {
                for (int64_t k = first; corners[i].part < 0 && k < last; k++) {
                    if (corners[k].part == *part_count &&
                        (!split || same_side(table, set, &corners[i], &corners[k]))) {
                        corners[i].part = *part_count;
                        grew = true;
                    }
                }
            }
        }
        ++*part_count;
    }
}

static int compare_parts(const void *left, const void *right)
{
    const struct corner *a = left, *b = right;
    if (a->part != b->part) {
        return a->part < b->part ? -1 : 1;
    }
    return compare_corners(left, right);
}

/* The corners of the set, sorted by hat part. */
static enum status collect_corners(const struct face_table *table, const struct facet_set *set, bool split,
                                   struct corner *corners, int64_t *part_count, struct error *error)
{
    int dim = table->dim;
    int64_t count = set->count * dim;
    for (int64_t i = 0; i < count; i++) {
        if (set->facet[i] < 0 || set->facet[i] >= table->node_count) {
            return fail(error, STATUS_INPUT, "facets: no node %d", set->facet[i]);
        }
        corners[i] = (struct corner){.node = set->facet[i], .vertex = (int32_t)(i % dim), .facet = i / dim};
    }
    qsort(corners, (size_t)count, sizeof *corners, compare_corners);
    *part_count = 0;
    for (int64_t first = 0; first < count;) {
        int64_t last = first;
        while (last < count && corners[last].node == corners[first].node) {
            last++;
        }
        split_hat(table, set, corners, first, last, split, part_count);
        first = last;
    }
    qsort(corners, (size_t)count, sizeof *corners, compare_parts);
    return STATUS_OK;
}

static enum status allocate(int dim, int64_t parts, int64_t samples, struct boundary_averages *averages,
                            struct error *error)
{
    enum status status;
    averages->count = parts;
    TRY(NEW_ARRAY(&averages->node, parts, error));
    TRY(NEW_ARRAY(&averages->area, parts, error));
    TRY(NEW_ARRAY(&averages->normal, parts * dim, error));
    TRY(NEW_ARRAY(&averages->position, parts * dim, error));
    TRY(NEW_ARRAY(&averages->ptr, parts + 1, error));
    TRY(NEW_ARRAY(&averages->sample_ptr, parts + 1, error));
    TRY(NEW_ARRAY(&averages->sample_x, samples * dim, error));
    TRY(NEW_ARRAY(&averages->sample_share, samples, error));
done:
    return status;
}

/* A dense row over the nodes, with the list of those touched: one average at a time is summed in it. */
struct dense_row {
    double *value;
    int32_t *touched;
    int64_t count, capacity;
    bool *is_touched;
};

static enum status row_add(struct dense_row *row, int32_t node, double value, struct error *error)
{
    if (!row->is_touched[node]) {
        if (row->count == row->capacity) {
            int64_t capacity = row->capacity * 2 + 64;
            int32_t *grown = array_grow(row->touched, capacity, sizeof *grown);
            if (grown == NULL) {
                return fail_memory(error, "boundary averages");
            }
            row->touched = grown;
            row->capacity = capacity;
        }
        row->is_touched[node] = true;
        row->touched[row->count++] = node;
    }
    row->value[node] += value;
    return STATUS_OK;
}

static int compare_indices(const void *left, const void *right)
{
    int32_t a = *(const int32_t *)left, b = *(const int32_t *)right;
    return (a > b) - (a < b);
}

/* Append the row, divided by `whole`, to the averages' CSR lists, and clear it. */
static enum status row_finish(struct dense_row *row, double whole, int64_t part, int64_t *capacity,
                              struct boundary_averages *averages, struct error *error)
{
    int64_t at = averages->ptr[part];
    if (at + row->count > *capacity) {
        *capacity = (at + row->count) * 2 + 1024;
        int32_t *idx = array_grow(averages->idx, *capacity, sizeof *idx);
        averages->idx = idx != NULL ? idx : averages->idx;
        double *phi = array_grow(averages->phi, *capacity, sizeof *phi);
        averages->phi = phi != NULL ? phi : averages->phi;
        if (idx == NULL || phi == NULL) {
            return fail_memory(error, "boundary averages");
        }
    }
    qsort(row->touched, (size_t)row->count, sizeof *row->touched, compare_indices);
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
                              struct dense_row *row, struct boundary_averages *averages, struct error *error)
{
    int dim = table->dim;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    const int32_t *face = table->faces->node + face_of[corner->facet] * dim;
    double normal[3], size, x[9];
    int vertex = 0; /* the face may start at another node than the facet */
    while (vertex + 1 < dim && face[vertex] != corner->node) {
        vertex++;
    }
    unit_normal(table, set->facet + corner->facet * dim, normal, &size);
    quadrature_positions(&rule, dim, table->x, face, x);
    for (int g = 0; g < rule.points; g++) {
        double hat = rule.weight[g] * size * rule.barycentric[g * dim + vertex];
        int64_t point = face_of[corner->facet] * table->per_face + g;
        for (int64_t i = table->lists->ptr[point]; row != NULL && i < table->lists->ptr[point + 1]; i++) {
            enum status status = row_add(row, table->lists->idx[i], hat * table->phi[i], error);
            if (status != STATUS_OK) {
                return status;
            }
        }
        averages->area[part] += hat;
        int64_t sample = averages->sample_ptr[part + 1]++;
        averages->sample_share[sample] = hat;
        for (int a = 0; a < dim; a++) {
            averages->normal[part * dim + a] += hat * normal[a];
            averages->position[part * dim + a] += hat * x[g * dim + a];
            averages->sample_x[sample * dim + a] = x[g * dim + a];
        }
    }
    return STATUS_OK;
}

/* From integrals to averages. */
static void normalise(int dim, int64_t part, struct boundary_averages *averages)
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
}

/* Both kinds of averages; node_lists == NULL: hat averages. */
static enum status build(const struct face_table *table, const struct facet_set *set,
                         const struct neighbours *node_lists, const double *node_phi,
                         struct boundary_averages *averages, struct error *error)
{
    enum status status;
    int dim = table->dim;
    int64_t corner_count = set->count * dim, parts = 0, capacity = 0;
    struct corner *corners = NULL;
    int64_t *face_of = NULL;
    struct dense_row row = {0};
    *averages = (struct boundary_averages){0};
    TRY(NEW_ARRAY(&corners, corner_count, error));
    TRY(NEW_ARRAY(&face_of, set->count, error));
    TRY(NEW_ARRAY(&row.value, table->node_count, error));
    TRY(NEW_ARRAY(&row.is_touched, table->node_count, error));
    TRY(collect_corners(table, set, node_lists == NULL, corners, &parts, error));
    TRY(find_faces(table, set, face_of, error));
    TRY(allocate(dim, parts, corner_count * table->per_face, averages, error));
    for (int64_t part = 0, next = 0; part < parts; part++) {
        int32_t node = corners[next].node;
        averages->sample_ptr[part + 1] = averages->sample_ptr[part];
        for (; next < corner_count && corners[next].part == part; next++) {
            TRY(add_corner(table, set, face_of, &corners[next], part, node_lists == NULL ? &row : NULL,
                           averages, error));
        }
        averages->node[part] = node;
        double whole = averages->area[part];
        normalise(dim, part, averages);
        if (node_lists != NULL) {
            for (int64_t i = node_lists->ptr[node]; i < node_lists->ptr[node + 1]; i++) {
                TRY(row_add(&row, node_lists->idx[i], node_phi[i], error));
            }
            whole = 1.0;
            averages->sample_ptr[part + 1] = averages->sample_ptr[part] + 1;
            averages->sample_share[averages->sample_ptr[part]] = 1.0;
            for (int a = 0; a < dim; a++) {
                double x = table->x[(int64_t)node * dim + a];
                averages->position[part * dim + a] = x;
                averages->sample_x[averages->sample_ptr[part] * dim + a] = x;
            }
        }
        TRY(row_finish(&row, whole, part, &capacity, averages, error));
    }
done:
    free(corners);
    free(face_of);
    free(row.value);
    free(row.touched);
    free(row.is_touched);
    if (status != STATUS_OK) {
        boundary_averages_free(averages);
    }
    return status;
}

enum status boundary_averages_build(const struct face_table *table, const struct facet_set *set,
                                    struct boundary_averages *averages, struct error *error)
{
    return build(table, set, NULL, NULL, averages, error);
}

enum status boundary_nodes_build(const struct face_table *table, const struct facet_set *set,
                                 const struct neighbours *node_lists, const double *node_phi,
                                 struct boundary_averages *averages, struct error *error)
{
    return build(table, set, node_lists, node_phi, averages, error);
}

enum status boundary_points_build(const struct face_table *table, const struct facet_set *set,
                                  struct boundary_averages *averages, struct error *error)
{
    enum status status;
    int dim = table->dim;
    int64_t *face_of = NULL, pairs = 0, count = set->count * table->per_face;
    struct quadrature_rule rule = quadrature_face_rule(dim);
    *averages = (struct boundary_averages){0};
    TRY(NEW_ARRAY(&face_of, set->count, error));
    TRY(find_faces(table, set, face_of, error));
    TRY(allocate(dim, count, count, averages, error));
    for (int64_t f = 0; f < set->count; f++) {
        int64_t first = face_of[f] * table->per_face;
        pairs += table->lists->ptr[first + table->per_face] - table->lists->ptr[first];
    }
    TRY(NEW_ARRAY(&averages->idx, pairs, error));
    TRY(NEW_ARRAY(&averages->phi, pairs, error));
    for (int64_t p = 0; p < count; p++) {
        int64_t facet = p / table->per_face, point = face_of[facet] * table->per_face + p % table->per_face;
        int64_t from = table->lists->ptr[point], length = table->lists->ptr[point + 1] - from;
        double normal[3], size, x[9];
        unit_normal(table, set->facet + facet * dim, normal, &size);
        quadrature_positions(&rule, dim, table->x, table->faces->node + face_of[facet] * dim, x);
        averages->node[p] = set->facet[facet * dim];
        averages->area[p] = rule.weight[p % table->per_face] * size;
        averages->sample_ptr[p + 1] = p + 1;
        averages->sample_share[p] = 1.0;
        for (int a = 0; a < dim; a++) {
            double place = x[p % table->per_face * dim + a];
            averages->normal[p * dim + a] = normal[a];
            averages->position[p * dim + a] = averages->sample_x[p * dim + a] = place;
        }
        averages->ptr[p + 1] = averages->ptr[p] + length;
        memcpy(averages->idx + averages->ptr[p], table->lists->idx + from,
               (size_t)length * sizeof *averages->idx);
        memcpy(averages->phi + averages->ptr[p], table->phi + from, (size_t)length * sizeof *averages->phi);
    }
done:
    free(face_of);
    if (status != STATUS_OK) {
        boundary_averages_free(averages);
    }
    return status;
}

void boundary_averages_free(struct boundary_averages *averages)
{
    free(averages->node);
    free(averages->area);
    free(averages->normal);
    free(averages->position);
    free(averages->ptr);
    free(averages->idx);
    free(averages->phi);
    free(averages->sample_ptr);
    free(averages->sample_x);
    free(averages->sample_share);
    *averages = (struct boundary_averages){0};
}
