#include "solid/incision/division.h"

#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_EDGES = 6, MOST_PARTS = 1 << MOST_EDGES }; /* of a simplex */

/* Have room for so many nodes, cells and facets, and more, so that they may grow one by one. */
static enum status reserve(struct division *body, int64_t nodes, int64_t cells, int64_t facets,
                           struct error *error)
{
    int64_t dim = body->dim, room;
    if (nodes > INT32_MAX) {
        return fail(error, STATUS_INPUT, "the cut makes more than %d nodes", INT32_MAX);
    }
    if (nodes > body->node_room) {
        room = nodes + nodes / 4;
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->x, room * dim, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->at, room * dim, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->parent, room * 2, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->sets, room, error));
        body->node_room = room;
    }
    if (cells > body->cell_room) {
        room = cells + cells / 4;
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->node, room * (dim + 1), error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->of_cell, room, error));
        body->cell_room = room;
    }
    if (facets > body->facet_room) {
        room = facets + facets / 4;
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->facet, room * dim, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&body->group, room, error));
        body->facet_room = room;
    }
    return STATUS_OK;
}

enum status division_add_facet(struct division *body, const int32_t *facet, int32_t group,
                               struct error *error)
{
    RETURN_IF_ERROR(reserve(body, 0, 0, body->facet_count + 1, error));
    memcpy(body->facet + body->facet_count * body->dim, facet, (size_t)body->dim * sizeof *facet);
    body->group[body->facet_count++] = group;
    return STATUS_OK;
}

enum status division_begin(const struct cells *cells, const double *at, const int32_t *region,
                           int64_t facet_count, const int32_t *facet, const int32_t *group,
                           struct division *body, struct error *error)
{
    int dim = cells->dim;
    int64_t nodes = cells->node_count;
    *body = (struct division){.dim = dim,
                              .node_count = nodes,
                              .cell_count = cells->count,
                              .facet_count = facet_count,
                              .region = region};
    RETURN_IF_ERROR(reserve(body, nodes, cells->count, facet_count, error));
    memcpy(body->x, cells->x, (size_t)(nodes * dim) * sizeof *body->x);
    memcpy(body->at, at != NULL ? at : cells->x, (size_t)(nodes * dim) * sizeof *body->at);
    memcpy(body->node, cells->node, (size_t)(cells->count * (dim + 1)) * sizeof *body->node);
    if (facet_count > 0) {
        memcpy(body->facet, facet, (size_t)(facet_count * dim) * sizeof *facet);
        memcpy(body->group, group, (size_t)facet_count * sizeof *group);
    }
    memset(body->sets, 0, (size_t)nodes * sizeof *body->sets);
    for (int64_t c = 0; c < cells->count; c++) {
        body->of_cell[c] = (int32_t)c;
    }
    for (int64_t i = 0; i < 2 * nodes; i++) {
        body->parent[i] = (int32_t)(i / 2);
    }
    return STATUS_OK;
}

void division_free(struct division *body)
{
    FREE_ALL(body->x, body->at, body->parent, body->sets, body->node, body->of_cell, body->facet,
             body->group);
    *body = (struct division){0};
}

struct cells division_cells(const struct division *body)
{
    return (struct cells){body->dim, body->node_count, body->x, body->cell_count, body->node};
}

/* ---- growing ---- */

enum status division_add_node(struct division *body, int32_t a, int32_t b, double share, struct error *error)
{
    int dim = body->dim;
    int64_t n = body->node_count;
    RETURN_IF_ERROR(reserve(body, n + 1, 0, 0, error));
    vector_between(dim, body->x + (int64_t)a * dim, body->x + (int64_t)b * dim, share, body->x + n * dim);
    vector_between(dim, body->at + (int64_t)a * dim, body->at + (int64_t)b * dim, share, body->at + n * dim);
    body->parent[2 * n] = a;
    body->parent[2 * n + 1] = b;
    body->sets[n] = body->sets[a] & body->sets[b];
    body->node_count++;
    return STATUS_OK;
}

/* ---- splitting ---- */

int split_compare(const void *left, const void *right)
{
    const struct split *a = left, *b = right;
    return compare_numbers(2, a->node, b->node);
}

/* The edges that are split, in the order of their nodes. */
struct splits {
    int64_t count;
    const struct split *split;
    int32_t *rank;     /* count: the place of an edge in the order of splitting */
    int32_t *at_rank;  /* count: the edge at each place */
    bool *has;         /* node_count: the node is an end of a split edge */
    int64_t new_nodes; /* the number of the node on the first edge */
};

static enum status rank_splits(const struct division *body, struct splits *splits, struct error *error)
{
    int dim = body->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&splits->rank, splits->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&splits->at_rank, splits->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&splits->has, body->node_count, error));
    NEW_SCRATCH(struct placed, placed, splits->count, error);
    for (int64_t i = 0; i < splits->count; i++) {
        const int32_t *node = splits->split[i].node;
        placed[i].item = i;
        placed[i].place =
            -vector_distance2(dim, body->x + (int64_t)node[0] * dim, body->x + (int64_t)node[1] * dim);
        splits->has[node[0]] = splits->has[node[1]] = true;
    }
    qsort(placed, (size_t)splits->count, sizeof *placed, compare_placed);
    for (int64_t i = 0; i < splits->count; i++) {
        splits->rank[placed[i].item] = (int32_t)i;
        splits->at_rank[i] = (int32_t)placed[i].item;
    }
    return STATUS_OK;
}

/* rank[]: those of the split edges of a simplex, ascending; returns their number. */
static int find_splits(const struct splits *splits, int corners, const int32_t *node, int32_t rank[])
{
    int count = 0;
    for (int i = 0; i < corners; i++) {
        for (int k = i + 1; k < corners && splits->has[node[i]]; k++) {
            struct split key = {
                .node = {node[i] < node[k] ? node[i] : node[k], node[i] < node[k] ? node[k] : node[i]}};
            const struct split *found =
                splits->has[node[k]]
                    ? bsearch(&key, splits->split, (size_t)splits->count, sizeof key, split_compare)
                    : NULL;
            if (found != NULL) {
                rank[count++] = splits->rank[found - splits->split];
            }
        }
    }
    qsort(rank, (size_t)count, sizeof *rank, compare_int32);
    return count;
}

static int corner_of(int corners, const int32_t *simplex, int32_t node)
{
    int k = 0;
    while (k < corners && simplex[k] != node) {
        k++;
    }
    return k < corners ? k : -1;
}

/* part[]: the simplices that a simplex becomes; returns their number. */
static int divide(const struct splits *splits, int corners, const int32_t *node, int32_t part[MOST_PARTS][4])
{
    int32_t rank[MOST_EDGES];
    int parts = 1, edges = find_splits(splits, corners, node, rank);
    memcpy(part[0], node, (size_t)corners * sizeof *node);
    for (int e = 0; e < edges; e++) {
        int32_t i = splits->at_rank[rank[e]];
        const int32_t *end = splits->split[i].node;
        for (int p = 0, before = parts; p < before; p++) {
            int a = corner_of(corners, part[p], end[0]), b = corner_of(corners, part[p], end[1]);
            if (a >= 0 && b >= 0) {
                memcpy(part[parts], part[p], sizeof part[p]);
                part[p][b] = part[parts++][a] = (int32_t)(splits->new_nodes + i);
            }
        }
    }
    return parts;
}

static enum status split_cells(struct division *body, const struct splits *splits, struct error *error)
{
    int corners = body->dim + 1;
    int32_t part[MOST_PARTS][4];
    for (int64_t c = 0, before = body->cell_count; c < before; c++) {
        int parts = divide(splits, corners, body->node + c * corners, part);
        RETURN_IF_ERROR(reserve(body, 0, body->cell_count + parts, 0, error));
        for (int p = 0; p < parts; p++) {
            int64_t place = p == 0 ? c : body->cell_count++;
            memcpy(body->node + place * corners, part[p], (size_t)corners * sizeof(int32_t));
            body->of_cell[place] = body->of_cell[c];
        }
    }
    return STATUS_OK;
}

static enum status split_facets(struct division *body, const struct splits *splits, struct error *error)
{
    int32_t part[MOST_PARTS][4];
    for (int64_t f = 0, before = body->facet_count; f < before; f++) {
        int parts = divide(splits, body->dim, body->facet + f * body->dim, part);
        memcpy(body->facet + f * body->dim, part[0], (size_t)body->dim * sizeof(int32_t));
        for (int p = 1; p < parts; p++) {
            RETURN_IF_ERROR(division_add_facet(body, part[p], body->group[f], error));
        }
    }
    return STATUS_OK;
}

static void splits_free(struct splits *splits)
{
    FREE_ALL(splits->rank, splits->at_rank, splits->has);
}

enum status division_split(struct division *body, int64_t count, const struct split *split,
                           struct error *error)
{
    FREED_BY(splits_free)
    struct splits splits = {.count = count, .split = split, .new_nodes = body->node_count};
    RETURN_IF_ERROR(rank_splits(body, &splits, error));
    RETURN_IF_ERROR(split_cells(body, &splits, error));
    RETURN_IF_ERROR(split_facets(body, &splits, error));
    for (int64_t i = 0; i < count; i++) {
        RETURN_IF_ERROR(division_add_node(body, split[i].node[0], split[i].node[1], split[i].share, error));
    }
    return STATUS_OK;
}

/* ---- taking out ---- */

/* Facets of `group` where a cell that is kept meets one that is not; facets without a cell are removed. */
static enum status remake_facets(struct division *body, const bool *kept, int32_t group, struct error *error)
{
    struct cells cells = division_cells(body);
    FREED_BY(faces_free) struct faces faces = {0};
    int dim = body->dim;
    int64_t left = 0;
    RETURN_IF_ERROR(faces_build(&cells, false, &faces, error));
    NEW_SCRATCH(int64_t, face, body->facet_count, error);
    RETURN_IF_ERROR(faces_find(&faces, body->facet_count, body->facet, face, error));
    for (int64_t f = 0; f < body->facet_count; f++) {
        if (face[f] >= 0 && kept[faces.cell[2 * face[f]]]) {
            memmove(body->facet + left * dim, body->facet + f * dim, (size_t)dim * sizeof *body->facet);
            body->group[left++] = body->group[f];
        }
    }
    body->facet_count = left;
    for (int64_t f = faces.boundary_count; f < faces.count && group >= 0; f++) {
        int32_t a = faces.cell[2 * f], b = faces.cell[2 * f + 1], *node = faces.node + f * dim;
        if (kept[a] != kept[b]) {
            int32_t turned[3] = {node[1], node[0], node[dim - 1]};
            RETURN_IF_ERROR(division_add_facet(body, kept[a] ? node : turned, group, error));
        }
    }
    return STATUS_OK;
}

enum status division_take_out(struct division *body, const bool *kept, int32_t group, int32_t *kept_as,
                              struct error *error)
{
    int dim = body->dim;
    int64_t cells = 0, nodes = 0;
    NEW_SCRATCH(bool, lost, body->node_count, error);
    RETURN_IF_ERROR(remake_facets(body, kept, group, error));
    for (int pass = 0; pass < 2; pass++) { /* of a node that some cell keeps, the last word is its */
        for (int64_t i = 0; i < body->cell_count * (dim + 1); i++) {
            if (kept[i / (dim + 1)] == (pass == 1)) {
                lost[body->node[i]] = pass == 0;
            }
        }
    }
    for (int64_t n = 0; n < body->node_count; n++) {
        kept_as[n] = lost[n] ? -1 : (int32_t)nodes;
        if (!lost[n]) {
            memmove(body->x + nodes * dim, body->x + n * dim, (size_t)dim * sizeof(double));
            memmove(body->at + nodes++ * dim, body->at + n * dim, (size_t)dim * sizeof(double));
        }
    }
    for (int64_t c = 0; c < body->cell_count; c++) {
        for (int k = 0; k <= dim && kept[c]; k++) {
            body->node[cells * (dim + 1) + k] = kept_as[body->node[c * (dim + 1) + k]];
        }
        body->of_cell[cells] = body->of_cell[c];
        cells += kept[c];
    }
    for (int64_t i = 0; i < body->facet_count * dim; i++) {
        body->facet[i] = kept_as[body->facet[i]];
    }
    body->node_count = nodes;
    body->cell_count = cells;
    return STATUS_OK;
}
