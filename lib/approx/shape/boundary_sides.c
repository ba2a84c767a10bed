/* The facets of a set: their faces in the table, their normals, and the sides that they form. */
#include "approx/cells/parts.h"
#include "approx/shape/boundary_private.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/sets.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

/* Facets that turn by 45 degrees or more at a node belong to different sides; slightly less, so that
 * round-off does not decide at chamfers of 45 degrees. */
static const double side_cosine = 0.7072;
/* Angle in radians below which the two sides of an edge are the faces of a closed slit, not those of a spike.
 */
static const double least_angle = 1e-6;

enum status boundary_find_faces(const struct face_table *table, const struct facet_set *set, int64_t *face_of,
                                struct error *error)
{
    for (int64_t i = 0; i < set->count * table->dim; i++) {
        if (set->facet[i] < 0 || set->facet[i] >= table->node_count) {
            return fail(error, STATUS_INPUT, "facets: no node %d", set->facet[i]);
        }
    }
    RETURN_IF_ERROR(faces_find(table->faces, set->count, set->facet, face_of, error));
    for (int64_t i = 0; i < set->count; i++) {
        if (face_of[i] < 0) {
            return fail(error, STATUS_INPUT, "facets: row %lld of the set is no boundary face of the cells",
                        (long long)i);
        }
    }
    return STATUS_OK;
}

void boundary_unit_normal(const struct face_table *table, const int32_t *facet, double *normal, double *size)
{
    normal[2] = 0.0;
    face_area_vector(table->dim, table->x, facet, normal);
    *size = vector_length(table->dim, normal);
    for (int a = 0; a < table->dim; a++) {
        normal[a] /= *size;
    }
}

/* By parts, nodes and facets. */
static int compare_corners(const void *left, const void *right)
{
    int parts = compare_int64(left, right);
    return parts != 0 ? parts
                      : compare_numbers(2, &((const struct corner *)left)->node,
                                        &((const struct corner *)right)->node);
}

/* Whether two facets, given by their dim nodes, have an edge (2D: a node) in common. */
static bool share_edge(int dim, const int32_t *a, const int32_t *b)
{
    int shared = 0;
    for (int i = 0; i < dim; i++) {
        for (int k = 0; k < dim; k++) {
            shared += a[i] == b[k];
        }
    }
    return shared >= dim - 1;
}

/* Whether two facets that meet at a node, given by their nodes, are on one side; in 3D they must share an
 * edge. */
static bool of_one_side(const struct face_table *table, const int32_t *a, const int32_t *b)
{
    double na[3], nb[3], size;
    if (!share_edge(table->dim, a, b)) {
        return false;
    }
    boundary_unit_normal(table, a, na, &size);
    boundary_unit_normal(table, b, nb, &size);
    return vector_dot(3, na, nb) >= side_cosine;
}

static bool same_side(const struct face_table *table, const struct facet_set *set, const struct corner *a,
                      const struct corner *b)
{
    return a->side == b->side && of_one_side(table, set->facet + (int64_t)a->facet * table->dim,
                                             set->facet + (int64_t)b->facet * table->dim);
}

/* Number the parts of one node: corners first..last-1 joined through neighbours of one side. */
static void split_node(const struct face_table *table, const struct facet_set *set, struct corner *corners,
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

void boundary_collect_corners(const struct face_table *table, const struct facet_set *set,
                              const int64_t *face_of, bool split, struct corner *corners, int64_t *part_count)
{
    int dim = table->dim;
    int64_t count = set->count * dim;
    for (int64_t i = 0; i < count; i++) {
        corners[i] =
            (struct corner){.node = set->facet[i], .vertex = (int32_t)(i % dim), .facet = (int32_t)(i / dim)};
        if (table->cell_side != NULL) {
            corners[i].side = table->cell_side[table->faces->cell[2 * face_of[i / dim]]];
        }
    }
    qsort(corners, (size_t)count, sizeof *corners, compare_corners);
    *part_count = 0;
    for (int64_t first = 0; first < count;) {
        int64_t last = first;
        while (last < count && corners[last].node == corners[first].node) {
            last++;
        }
        split_node(table, set, corners, first, last, split, part_count);
        first = last;
    }
    qsort(corners, (size_t)count, sizeof *corners, compare_corners);
}

/* side, piece[set->count]: the first facet of the side and of the piece of each. */
static void join_facets(const struct face_table *table, const struct facet_set *set,
                        const struct corner *corners, int32_t *side, int32_t *piece)
{
    int64_t count = set->count * table->dim;
    for (int64_t f = 0; f < set->count; f++) {
        side[f] = piece[f] = (int32_t)f;
    }
    for (int64_t begin = 0, i = 0; i < count; i++) {
        begin = corners[i].node == corners[begin].node ? begin : i;
        set_join(piece, corners[begin].facet, corners[i].facet);
        for (int64_t k = begin; k < i; k++) {
            if (same_side(table, set, &corners[i], &corners[k])) {
                set_join(side, corners[i].facet, corners[k].facet);
            }
        }
    }
}

enum status boundary_add_sides(const struct face_table *table, const struct facet_set *set, bool split,
                               struct corner *corners, int64_t *part_count, int64_t *group,
                               int64_t *group_count, struct error *error)
{
    int dim = table->dim;
    int64_t count = set->count * dim;
    NEW_SCRATCH(int32_t, side, set->count, error);
    NEW_SCRATCH(int32_t, piece, set->count, error);
    NEW_SCRATCH(int64_t, part, set->count, error);
    join_facets(table, set, corners, side, piece);
    *group_count = 0;
    for (int64_t f = 0; f < set->count; f++) {
        int32_t of_side = set_first(side, (int32_t)f);
        int32_t first = split ? of_side : set_first(piece, (int32_t)f);
        group[f] = first == f ? (*group_count)++ : group[first];
        part[f] = of_side == f ? (*part_count)++ : part[of_side];
        for (int k = 0; k < dim; k++) {
            corners[count + f * dim + k] =
                (struct corner){part[f], set->facet[f * dim + k], (int32_t)f, k, 0};
        }
    }
    qsort(corners, (size_t)(2 * count), sizeof *corners, compare_corners);
    return STATUS_OK;
}

/* Whether facets a and b that meet on a ridge, not of one side, do so at a re-entrant edge: b does not lie
 * behind a. */
static bool turns_inwards(const struct face_table *table, const struct ridge *a, const struct ridge *b)
{
    int dim = table->dim;
    double normal[3], size, into_b[3];
    boundary_unit_normal(table, table->faces->node + (int64_t)a->facet * dim, normal, &size);
    vector_subtract(dim, table->x + (int64_t)b->opposite * dim, table->x + (int64_t)b->node[0] * dim, into_b);
    return vector_dot(dim, normal, into_b) > -least_angle * vector_length(dim, into_b);
}

static bool is_junction(const struct face_table *table, int kinds, const bool *held, const bool *constrained,
                        const struct ridge *a, const struct ridge *b)
{
    const int32_t *node = table->faces->node;
    int32_t f = a->facet, g = b->facet;
    bool meets = (held[f] && !constrained[g]) || (held[g] && !constrained[f]);
    if (!meets && !(kinds & BOUNDARY_REENTRANT)) {
        return false;
    }
    if (of_one_side(table, node + (int64_t)f * table->dim, node + (int64_t)g * table->dim)) {
        return meets && (kinds & BOUNDARY_JUNCTION_SMOOTH);
    }
    return (meets && (kinds & BOUNDARY_JUNCTION_SHARP)) ||
           ((kinds & BOUNDARY_REENTRANT) && turns_inwards(table, a, b));
}

enum status boundary_find_junctions(const struct face_table *table, int kinds, const bool *held,
                                    const bool *constrained, bool *junction, struct error *error)
{
    int dim = table->dim;
    int64_t facets = table->faces->boundary_count, count = facets * dim;
    NEW_SCRATCH(struct ridge, ridge, count, error);
    ridges_list(dim, facets, table->faces->node, ridge);
    for (int64_t begin = 0, i = 0; i < count; i++) {
        begin = memcmp(ridge[i].node, ridge[begin].node, sizeof ridge->node) == 0 ? begin : i;
        for (int64_t k = begin; k < i; k++) {
            if (is_junction(table, kinds, held, constrained, &ridge[i], &ridge[k])) {
                for (int j = 0; j < dim - 1; j++) {
                    junction[ridge[i].node[j]] = true;
                }
            }
        }
    }
    return STATUS_OK;
}
