/* Moving nodes onto the blade; see incision.h. */
#include "solid/incision/incision_private.h"

#include "approx/cells/quality.h"
#include "base/lists.h"
#include "base/round_off.h"

#include <stdlib.h>
#include <string.h>

/* By level: a node is near a place on an edge within this share of it (isosurface stuffing: 0.25); and a node
 * that cannot move is taken to be on the blade within this share of its shortest edge. */
static const double near_share[] = {0.3, 0.4}, near_enough[] = {0.12, 0.24};

/* A cell stays good with this quality, or with this part of what it had. */
static const double good_quality = 0.2, good_part = 0.3;

/* A node may leave the boundaries on which it lies by this share of its shortest edge, where they are curved.
 */
static const double off_surface = 0.02;

/* The faces of the boundary, and those between regions, near the blade. A node stays where its faces have the
 * labels that they have: of groups, or of two regions. */
struct surfaces {
    int64_t count;
    int32_t *node;   /* count * dim */
    uint64_t *label; /* count */
    int64_t *ptr;    /* node_count + 1: the faces at each node */
    int32_t *idx;
};

struct snapping {
    struct cut *cut;
    enum level level;
    struct surfaces surfaces;
    int64_t *cell_ptr; /* node_count + 1: the cells at each node */
    int32_t *cell_idx;
};

static uint64_t mix(uint64_t number)
{
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9u; /* splitmix64 */
    number = (number ^ number >> 27) * 0x94d049bb133111ebu;
    return number ^ number >> 31;
}

/* The groups of the facets with the nodes key, as one number. */
static uint64_t label_of_groups(const struct division *body, int64_t count, const struct keyed *facets,
                                const int32_t key[3])
{
    uint64_t label = 0;
    int64_t first = keyed_find(count, facets, key);
    for (int64_t i = first, end = first < 0 ? first : keyed_end(count, facets, first); i < end; i++) {
        label += mix((uint64_t)body->group[facets[i].item] + 1);
    }
    return label;
}

static enum status surfaces_build(const struct cut *cut, struct surfaces *surfaces, struct error *error)
{
    const struct division *body = cut->body;
    int dim = body->dim;
    NEW_SCRATCH(struct keyed, facets, body->facet_count, error);
    for (int64_t f = 0; f < body->facet_count; f++) {
        face_key(dim, body->facet + f * dim, facets[f].key);
        facets[f].item = f;
    }
    keyed_sort(body->facet_count, facets);
    RETURN_IF_ERROR(NEW_ARRAY(&surfaces->node, cut->face_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surfaces->label, cut->face_count, error));
    for (int64_t i = 0, end; i < cut->face_count; i = end) {
        const struct keyed *face = &cut->face[i];
        int32_t one = body->of_cell[face->item / (dim + 1)], other = one;
        end = keyed_end(cut->face_count, cut->face, i);
        if (end - i == 2) {
            other = body->of_cell[face[1].item / (dim + 1)];
        }
        bool between = end - i == 2 && body->region != NULL && body->region[one] != body->region[other];
        if (end - i == 1 || between) {
            memcpy(surfaces->node + surfaces->count * dim, face->key, (size_t)dim * sizeof *face->key);
            surfaces->label[surfaces->count++] =
                between ? mix(mix((uint64_t)body->region[one]) + mix((uint64_t)body->region[other]))
                        : label_of_groups(body, body->facet_count, facets, face->key);
        }
    }
    return lists_by_row(surfaces->count, dim, surfaces->node, body->node_count, &surfaces->ptr,
                        &surfaces->idx, error);
}

static bool face_has(const struct snapping *snapping, int32_t face, int32_t node)
{
    int dim = snapping->cut->body->dim;
    for (int k = 0; k < dim; k++) {
        if (snapping->surfaces.node[(int64_t)face * dim + k] == node) {
            return true;
        }
    }
    return false;
}

/* Whether the edge from a node to another is on all surfaces, and in all sets, on which the node is. */
static bool stays_on_surfaces(const struct snapping *snapping, int32_t node, int32_t other)
{
    const struct surfaces *surfaces = &snapping->surfaces;
    const uint64_t *sets = snapping->cut->body->sets;
    for (int64_t i = surfaces->ptr[node]; i < surfaces->ptr[node + 1]; i++) {
        bool found = false;
        for (int64_t k = surfaces->ptr[node]; k < surfaces->ptr[node + 1]; k++) {
            found = found || (surfaces->label[surfaces->idx[i]] == surfaces->label[surfaces->idx[k]] &&
                              face_has(snapping, surfaces->idx[k], other));
        }
        if (!found) {
            return false;
        }
    }
    return (sets[node] & ~sets[other]) == 0;
}

/* Whether a move is along the planes of the surfaces on which the node is. */
static bool is_along_surfaces(const struct snapping *snapping, int32_t node, const double *x)
{
    const struct division *body = snapping->cut->body;
    const struct surfaces *surfaces = &snapping->surfaces;
    int dim = body->dim;
    double move[3] = {0.0};
    vector_subtract(dim, x, body->x + (int64_t)node * dim, move);
    for (int64_t i = surfaces->ptr[node]; i < surfaces->ptr[node + 1]; i++) {
        double normal[3];
        face_area_vector(dim, body->x, surfaces->node + (int64_t)surfaces->idx[i] * dim, normal);
        vector_normalise(dim, normal);
        if (!(fabs(vector_dot(dim, move, normal)) <= off_surface * snapping->cut->shortest[node])) {
            return false;
        }
    }
    return true;
}

/* Move a node to x[dim], where `at` becomes at[dim], if its cells stay good. */
static bool move_node(const struct snapping *snapping, int32_t node, const double *x, const double *at)
{
    struct division *body = snapping->cut->body;
    struct cells cells = division_cells(body);
    int dim = body->dim;
    size_t size = (size_t)dim * sizeof(double);
    double *own = body->x + (int64_t)node * dim, before[3], to[3];
    bool good = is_along_surfaces(snapping, node, x);
    memcpy(before, own, size);
    memcpy(to, x, size);
    for (int64_t i = snapping->cell_ptr[node]; i < snapping->cell_ptr[node + 1] && good; i++) {
        double had = cell_quality(&cells, snapping->cell_idx[i], NULL);
        memcpy(own, to, size);
        double has = cell_quality(&cells, snapping->cell_idx[i], NULL);
        memcpy(own, before, size);
        good = has >= fmin(good_quality, good_part * had) && has > 0.0;
    }
    if (good) {
        memcpy(own, to, size);
        memcpy(body->at + (int64_t)node * dim, at, size);
    }
    return good;
}

static bool move_along(const struct snapping *snapping, int32_t node, const struct split *edge)
{
    const struct division *body = snapping->cut->body;
    const double *a = body->x + (int64_t)edge->node[0] * body->dim;
    const double *b = body->x + (int64_t)edge->node[1] * body->dim;
    const double *at_a = body->at + (int64_t)edge->node[0] * body->dim;
    const double *at_b = body->at + (int64_t)edge->node[1] * body->dim;
    double x[3], at[3];
    vector_between(body->dim, a, b, edge->share, x);
    vector_between(body->dim, at_a, at_b, edge->share, at);
    return stays_on_surfaces(snapping, node, edge->node[0] == node ? edge->node[1] : edge->node[0]) &&
           move_node(snapping, node, x, at);
}

/* Snap a node with these crossings, if one of them is near; the edges in the order of their length to go. */
static enum status snap_node(const struct snapping *snapping, int32_t node, int64_t count,
                             const struct crossing *items, const int32_t *which, struct error *error)
{
    struct cut *cut = snapping->cut;
    double *value = cut->value[snapping->level], had = value[node];
    int64_t near = 0;
    NEW_SCRATCH(struct split, edge, count, error);
    NEW_SCRATCH(struct placed, way, count, error);
    for (int64_t i = 0; i < count; i++) {
        struct sheet_place place;
        edge[near] = items[which[i]].split;
        const int32_t *end = edge[near].node;
        if (value[end[0]] * value[end[1]] < 0 &&
            cut_root(cut, snapping->level, end, &edge[near].share, &place)) {
            double share = end[0] == node ? edge[near].share : 1.0 - edge[near].share;
            double length = vector_distance(cut->body->dim, cut->body->at + (int64_t)end[0] * cut->body->dim,
                                            cut->body->at + (int64_t)end[1] * cut->body->dim);
            way[near] = (struct placed){share * length, near};
            near += share < near_share[snapping->level];
        }
    }
    qsort(way, (size_t)near, sizeof *way, compare_placed);
    bool moved = false;
    for (int64_t i = 0; i < near && !moved; i++) {
        moved = move_along(snapping, node, &edge[way[i].item]);
    }
    if (moved || (near > 0 && fabs(had) <= near_enough[snapping->level] * cut->shortest[node])) {
        cut_lay(cut, node);
        value[node] = 0.0;
    }
    return STATUS_OK;
}

static void snapping_free(struct snapping *snapping)
{
    struct surfaces *surfaces = &snapping->surfaces;
    FREE_ALL(surfaces->node, surfaces->label, surfaces->ptr, surfaces->idx, snapping->cell_ptr,
             snapping->cell_idx);
}

enum status cut_snap(struct cut *cut, enum level level, const struct crossings *crossings,
                     struct error *error)
{
    FREED_BY(snapping_free) struct snapping snapping = {.cut = cut, .level = level};
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *idx = NULL;
    const struct division *body = cut->body;
    NEW_SCRATCH(int32_t, end, crossings->count * 2, error);
    for (int64_t i = 0; i < crossings->count * 2; i++) {
        end[i] = crossings->item[i / 2].split.node[i % 2];
    }
    RETURN_IF_ERROR(surfaces_build(cut, &snapping.surfaces, error));
    RETURN_IF_ERROR(lists_by_row(body->cell_count, body->dim + 1, body->node, body->node_count,
                                 &snapping.cell_ptr, &snapping.cell_idx, error));
    RETURN_IF_ERROR(lists_by_row(crossings->count, 2, end, body->node_count, &ptr, &idx, error));
    for (int64_t n = 0; n < body->node_count; n++) {
        if (ptr[n + 1] > ptr[n] && cut->value[level][n] != 0.0) {
            RETURN_IF_ERROR(
                snap_node(&snapping, (int32_t)n, ptr[n + 1] - ptr[n], crossings->item, idx + ptr[n], error));
        }
    }
    return STATUS_OK;
}
