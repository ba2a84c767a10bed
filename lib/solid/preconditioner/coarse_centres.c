/* Centres are nodes, each the farthest from those before it. A centre is compared with those before it only
 * at the nodes that it is nearest to: the search along paths ends where a node is nearer to another one. So
 * all searches together take a time that grows like the number of nodes times the logarithm of that of
 * centres. */
#include "solid/preconditioner/coarse_centres.h"

#include "approx/visibility/edge_paths.h"
#include "base/memory.h"
#include "base/queue.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radius of the shares, by the largest distance of a node from its nearest centre: 1.2 to 2.5 give as many
 * steps. */
static const double radius_factor = 1.5;

/* What is known of all nodes. */
struct ways {
    const struct neighbours *neighbours; /* NULL: all distances are straight */
    int32_t *part;  /* the first node of the connected part that each node is in; no ways lead between parts,
                       and few within one that neighbours join in one direction only */
    bool has_parts; /* more than one */
    double *least;  /* distance from the nearest centre so far, m, */
    int32_t *nearest; /* and which one it is */
};

/* Nodes found, and scratch. */
struct search {
    struct queue queue;
    double *length; /* node_count: of the paths so far; infinite between searches */
    int64_t count, touched_count;
    int32_t *node, *touched;
    double *distance; /* m */
};

static void search_free(struct search *search)
{
    queue_free(&search->queue);
    FREE_ALL(search->length, search->node, search->touched, search->distance);
}

static enum status search_begin(int64_t node_count, struct search *search, struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(&search->length, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&search->node, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&search->touched, node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&search->distance, node_count, error));
    for (int64_t n = 0; n < node_count; n++) {
        search->length[n] = INFINITY;
    }
    return STATUS_OK;
}

static enum status find_parts(const struct coarse_space *coarse, struct ways *ways, struct error *error)
{
    const struct neighbours *neighbours = ways->neighbours;
    RETURN_IF_ERROR(NEW_ARRAY(&ways->part, coarse->node_count, error));
    for (int64_t n = 0; n < coarse->node_count; n++) {
        ways->part[n] = (int32_t)n;
    }
    for (int64_t n = 0; n < coarse->node_count; n++) {
        for (int64_t k = neighbours->ptr[n]; k < neighbours->ptr[n + 1]; k++) {
            set_join(ways->part, (int32_t)n, neighbours->idx[k]);
        }
    }
    for (int64_t n = 0; n < coarse->node_count; n++) {
        ways->part[n] = set_first(ways->part, (int32_t)n);
        ways->has_parts = ways->has_parts || ways->part[n] > 0;
    }
    return STATUS_OK;
}

static void note(struct search *search, int64_t node, double distance)
{
    search->node[search->count] = (int32_t)node;
    search->distance[search->count++] = distance;
}

/* Nodes that no way leads to, and that are nearer than within[], or than the radius. */
static void search_straight(const struct coarse_space *coarse, const struct ways *ways, int64_t from,
                            const double *within, struct search *search)
{
    int dim = coarse->dim;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        if (ways->neighbours == NULL || ways->part[n] != ways->part[from]) {
            double distance = vector_distance(dim, coarse->X + n * dim, coarse->X + from * dim);
            if (distance < (within != NULL ? within[n] : coarse->radius)) {
                note(search, n, distance);
            }
        }
    }
}

static enum status go_on(const struct coarse_space *coarse, const struct neighbours *neighbours,
                         const struct path_end *end, struct search *search, struct error *error)
{
    int dim = coarse->dim;
    for (int64_t i = neighbours->ptr[end->node]; i < neighbours->ptr[end->node + 1]; i++) {
        int32_t next = neighbours->idx[i];
        double path = end->length + vector_distance(dim, coarse->X + (int64_t)end->node * dim,
                                                    coarse->X + (int64_t)next * dim);
        if (path < search->length[next]) {
            if (isinf(search->length[next])) {
                search->touched[search->touched_count++] = next;
            }
            search->length[next] = path;
            RETURN_IF_ERROR(queue_push(&search->queue, path, next, error));
        }
    }
    return STATUS_OK;
}

/* Nodes with a distance from node `from` below within[], or NULL: the radius, which paths over such nodes
 * lead to (Dijkstra), or none. */
static enum status find_near(const struct coarse_space *coarse, const struct ways *ways, int64_t from,
                             const double *within, struct search *search, struct error *error)
{
    int dim = coarse->dim;
    search->count = search->touched_count = 0;
    if (ways->neighbours == NULL || ways->has_parts) {
        search_straight(coarse, ways, from, within, search);
    }
    if (ways->neighbours == NULL) {
        return STATUS_OK;
    }
    search->length[from] = 0.0;
    search->touched[search->touched_count++] = (int32_t)from;
    RETURN_IF_ERROR(queue_push(&search->queue, 0.0, (int32_t)from, error));
    while (search->queue.count > 0) {
        struct path_end end = queue_pop(&search->queue);
        if (end.length > search->length[end.node]) {
            continue;
        }
        double straight = vector_distance(dim, coarse->X + (int64_t)end.node * dim, coarse->X + from * dim);
        /* So that in convex bodies the Euclidean distance counts. */
        double distance = fmax(straight, end.length / PATH_MOST_DETOUR);
        if (distance < (within != NULL ? within[end.node] : coarse->radius)) {
            note(search, end.node, distance);
            RETURN_IF_ERROR(go_on(coarse, ways->neighbours, &end, search, error));
        }
    }
    for (int64_t i = 0; i < search->touched_count; i++) {
        search->length[search->touched[i]] = INFINITY;
    }
    return STATUS_OK;
}

/* Nodes that no way from a centre leads to have the straight distance from the nearest one. */
static void reach_all(const struct coarse_space *coarse, struct ways *ways)
{
    int dim = coarse->dim;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        bool reached = isfinite(ways->least[n]);
        for (int64_t c = 0; c < coarse->centre_count && !reached; c++) {
            double straight = vector_distance(dim, coarse->X + n * dim, coarse->centre + c * dim);
            if (straight < ways->least[n]) {
                ways->least[n] = straight;
                ways->nearest[n] = (int32_t)c;
            }
        }
    }
}

static enum status choose(struct coarse_space *coarse, struct ways *ways, int64_t *from,
                          struct search *search, struct error *error)
{
    int64_t next = 0;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        ways->least[n] = INFINITY;
    }
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        from[c] = next;
        memcpy(coarse->centre + c * coarse->dim, coarse->X + next * coarse->dim,
               (size_t)coarse->dim * sizeof *coarse->centre);
        RETURN_IF_ERROR(find_near(coarse, ways, next, ways->least, search, error));
        for (int64_t i = 0; i < search->count; i++) {
            ways->least[search->node[i]] = search->distance[i];
            ways->nearest[search->node[i]] = (int32_t)c;
        }
        for (int64_t n = 0; n < coarse->node_count; n++) {
            next = ways->least[n] > ways->least[next] ? n : next;
        }
    }
    reach_all(coarse, ways);
    for (int64_t n = 0; n < coarse->node_count; n++) {
        next = ways->least[n] > ways->least[next] ? n : next;
    }
    coarse->radius = radius_factor * ways->least[next];
    return STATUS_OK;
}

/* The nodes within the radius of each centre; and those that it is nearest to, where only ways that lead
 * farther away reach them. */
static enum status list_near(struct coarse_space *coarse, const struct ways *ways, const int64_t *from,
                             struct search *search, struct error *error)
{
    struct sparse *lists = &coarse->of_centre;
    int64_t room = 0, values = 0;
    NEW_SCRATCH(int64_t, listed, coarse->node_count, error); /* 1 + the last centre that lists it */
    RETURN_IF_ERROR(sparse_new(coarse->centre_count, coarse->node_count, 0, lists, error));
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        RETURN_IF_ERROR(find_near(coarse, ways, from[c], NULL, search, error));
        for (int64_t i = 0; i < search->count; i++) {
            listed[search->node[i]] = c + 1;
        }
        for (int64_t n = 0; n < coarse->node_count; n++) {
            if (ways->nearest[n] == c && listed[n] != c + 1) {
                note(search, n, ways->least[n]);
            }
        }
        int64_t at = lists->ptr[c], end = at + search->count;
        RETURN_IF_ERROR(GROW_ARRAY(&lists->idx, end, &room, error));
        RETURN_IF_ERROR(GROW_ARRAY(&lists->value, end, &values, error));
        memcpy(lists->idx + at, search->node, (size_t)search->count * sizeof *search->node);
        memcpy(lists->value + at, search->distance, (size_t)search->count * sizeof *search->distance);
        lists->ptr[c + 1] = end;
    }
    return STATUS_OK;
}

static void ways_free(struct ways *ways)
{
    FREE_ALL(ways->part, ways->least, ways->nearest);
}

enum status coarse_centres_pick(struct coarse_space *coarse, const struct neighbours *neighbours,
                                struct error *error)
{
    FREED_BY(ways_free) struct ways ways = {.neighbours = neighbours};
    FREED_BY(search_free) struct search search = {0};
    NEW_SCRATCH(int64_t, from, coarse->centre_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&ways.least, coarse->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&ways.nearest, coarse->node_count, error));
    RETURN_IF_ERROR(neighbours != NULL ? find_parts(coarse, &ways, error) : STATUS_OK);
    RETURN_IF_ERROR(search_begin(coarse->node_count, &search, error));
    RETURN_IF_ERROR(choose(coarse, &ways, from, &search, error));
    return list_near(coarse, &ways, from, &search, error);
}
