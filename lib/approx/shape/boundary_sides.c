/* The facets of a set: their faces in the table, their normals, and the sides that they form. */
#include "approx/shape/boundary_private.h"

#include "approx/cells/parts.h"
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

/* Whether two facets that meet on a ridge, given by their nodes, turn by less than 45 degrees. */
static bool turns_little(const struct face_table *table, const int32_t *a, const int32_t *b)
{
    double na[3], nb[3], size;
    boundary_unit_normal(table, a, na, &size);
    boundary_unit_normal(table, b, nb, &size);
    return vector_dot(3, na, nb) >= side_cosine;
}

/* By parts, nodes and facets. */
static int compare_corners(const void *left, const void *right)
{
    int parts = compare_int64(left, right);
    return parts != 0 ? parts
                      : compare_numbers(2, &((const struct corner *)left)->node,
                                        &((const struct corner *)right)->node);
}

/* The number of the corner, among all of the set, at node j of a ridge. */
static int32_t ridge_corner(int dim, const struct ridge *ridge, int j)
{
    return ridge->facet * dim + (ridge->corner + 1 + (dim == 2 || ridge->upward ? j : 1 - j)) % dim;
}

/* Join facets that are of one side in side[], and their corners at the nodes where they meet in around[]. */
static enum status join_sides(const struct face_table *table, const struct facet_set *set,
                              const int64_t *face_of, int32_t *side, int32_t *around, struct error *error)
{
    int dim = table->dim;
    int64_t count = set->count * dim;
    const int32_t *cell = table->faces->cell;
    NEW_SCRATCH(struct ridge, ridge, count, error);
    ridges_list(dim, set->count, set->facet, ridge);
    for (int64_t begin = 0, i = 0; i < count; i++) {
        begin = memcmp(ridge[i].node, ridge[begin].node, sizeof ridge->node) == 0 ? begin : i;
        for (int64_t k = begin; k < i; k++) {
            int64_t f = ridge[i].facet, g = ridge[k].facet;
            bool interface = table->cell_side != NULL &&
                             table->cell_side[cell[2 * face_of[f]]] != table->cell_side[cell[2 * face_of[g]]];
            if (!interface && turns_little(table, set->facet + f * dim, set->facet + g * dim)) {
                set_join(side, (int32_t)f, (int32_t)g);
                for (int j = 0; j < dim - 1; j++) {
                    set_join(around, ridge_corner(dim, &ridge[i], j), ridge_corner(dim, &ridge[k], j));
                }
            }
        }
    }
    return STATUS_OK;
}

/* Append the parts of whole sides, and number the groups. side, piece: the first facet of each. */
static enum status add_sides(const struct facet_set *set, int dim, bool split, int32_t *side, int32_t *piece,
                             struct corner *corners, int64_t *part_count, struct boundary_sides *sides,
                             struct error *error)
{
    int64_t count = set->count * dim;
    NEW_SCRATCH(int64_t, part, set->count, error);
    sides->node_average_count = *part_count;
    RETURN_IF_ERROR(NEW_ARRAY(&sides->facet_group, set->count, error));
    for (int64_t f = 0; f < set->count; f++) {
        int32_t of_side = set_first(side, (int32_t)f);
        int32_t first = split ? of_side : set_first(piece, (int32_t)f);
        sides->facet_group[f] = first == f ? sides->group_count++ : sides->facet_group[first];
        part[f] = of_side == f ? (*part_count)++ : part[of_side];
        for (int64_t i = f * dim; i < (f + 1) * dim; i++) {
            corners[count + i] = (struct corner){part[f], set->facet[i], (int32_t)f, (int32_t)i};
        }
    }
    qsort(corners, (size_t)(2 * count), sizeof *corners, compare_corners);
    RETURN_IF_ERROR(NEW_ARRAY(&sides->group, *part_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&sides->flat, *part_count, error));
    for (int64_t i = 0; i < 2 * count; i++) {
        sides->group[corners[i].part] = sides->facet_group[corners[i].facet];
    }
    return STATUS_OK;
}

enum status boundary_parts(const struct face_table *table, const struct facet_set *set,
                           const int64_t *face_of, bool split, struct boundary_sides *sides,
                           struct corner *corners, int64_t *part_count, struct error *error)
{
    int64_t count = set->count * table->dim;
    NEW_SCRATCH(int32_t, side, set->count, error);
    NEW_SCRATCH(int32_t, piece, set->count, error);
    NEW_SCRATCH(int32_t, around, count, error);
    NEW_SCRATCH(int64_t, part, count, error);
    for (int64_t i = 0; i < count; i++) {
        int32_t facet = (int32_t)(i / table->dim);
        side[facet] = piece[facet] = facet;
        around[i] = (int32_t)i;
        corners[i] = (struct corner){0, set->facet[i], facet, (int32_t)i};
    }
    RETURN_IF_ERROR(join_sides(table, set, face_of, side, around, error));
    qsort(corners, (size_t)count, sizeof *corners, compare_corners);
    *part_count = 0;
    for (int64_t i = 0; i < count; i++) {
        int32_t own = corners[i].number;
        if (i > 0 && corners[i].node == corners[i - 1].node) {
            set_join(piece, corners[i - 1].facet, corners[i].facet);
            set_join(around, split ? own : corners[i - 1].number, own);
        }
        int32_t first = set_first(around, own); /* its facet, and so the corner, comes first at the node */
        part[own] = first == own ? (*part_count)++ : part[first];
        corners[i].part = part[own];
    }
    qsort(corners, (size_t)count, sizeof *corners, compare_corners);
    return sides == NULL ? STATUS_OK
                         : add_sides(set, table->dim, split, side, piece, corners, part_count, sides, error);
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
    if (turns_little(table, node + (int64_t)f * table->dim, node + (int64_t)g * table->dim)) {
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
