/* Centres are nodes, each the farthest from those before it. A centre is compared with those before it only
 * at the nodes that it is nearest to: the search along paths ends where a node is nearer to another one. So
 * all searches together take a time that grows like the number of nodes times the logarithm of that of
 * centres. */
#include "solid/preconditioner/coarse_centres.h"

#include "approx/visibility/edge_paths.h"
#include "base/chunks.h"
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
enum { NODES_FOR_THREAD = 10000 }; /* see chunks_of */

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

static enum status choose(struct coarse_space *coarse, struct ways *ways, int64_t *from, struct error *error)
{
    FREED_BY(search_free) struct search search = {0};
    int64_t next = 0;
    RETURN_IF_ERROR(search_begin(coarse->node_count, &search, error));
    for (int64_t n = 0; n < coarse->node_count; n++) {
        ways->least[n] = INFINITY;
    }
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        from[c] = next;
        memcpy(coarse->centre + c * coarse->dim, coarse->X + next * coarse->dim,
               (size_t)coarse->dim * sizeof *coarse->centre);
        RETURN_IF_ERROR(find_near(coarse, ways, next, ways->least, &search, error));
        for (int64_t i = 0; i < search.count; i++) {
            ways->least[search.node[i]] = search.distance[i];
            ways->nearest[search.node[i]] = (int32_t)c;
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

/* The nodes near a centre. */
struct near {
    int64_t count;
    int32_t *node;
    double *distance;
};

/* The nodes within the radius of some centres. */
static enum status list_some(const struct coarse_space *coarse, const struct ways *ways, const int64_t *from,
                             int64_t begin, int64_t end, struct near *near, struct error *error)
{
    FREED_BY(search_free) struct search search = {0};
    RETURN_IF_ERROR(search_begin(coarse->node_count, &search, error));
    for (int64_t c = begin; c < end; c++) {
        RETURN_IF_ERROR(find_near(coarse, ways, from[c], NULL, &search, error));
        RETURN_IF_ERROR(NEW_ARRAY(&near[c].node, search.count, error));
        RETURN_IF_ERROR(NEW_ARRAY(&near[c].distance, search.count, error));
        near[c].count = search.count;
        memcpy(near[c].node, search.node, (size_t)search.count * sizeof *search.node);
        memcpy(near[c].distance, search.distance, (size_t)search.count * sizeof *search.distance);
    }
    return STATUS_OK;
}

/* Into one table, and with it the nodes that are in no list. */
static enum status join_lists(struct coarse_space *coarse, const struct ways *ways, const struct near *near,
                              struct error *error)
{
    int64_t entries = coarse->node_count, at = 0;
    NEW_SCRATCH(bool, listed, coarse->node_count, error);
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        entries += near[c].count;
        for (int64_t i = 0; i < near[c].count; i++) {
            listed[near[c].node[i]] = true;
        }
    }
    RETURN_IF_ERROR(sparse_new(coarse->centre_count, coarse->node_count, entries, &coarse->of_centre, error));
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        memcpy(coarse->of_centre.idx + at, near[c].node, (size_t)near[c].count * sizeof *near[c].node);
        memcpy(coarse->of_centre.value + at, near[c].distance,
               (size_t)near[c].count * sizeof *near[c].distance);
        at += near[c].count;
        coarse->of_centre.ptr[c + 1] = at;
    }
    for (int64_t n = 0; n < coarse->node_count; n++) { /* on a way that leads farther away: hardly ever */
        if (!listed[n]) {
            int64_t end = coarse->of_centre.ptr[ways->nearest[n] + 1];
            memmove(coarse->of_centre.idx + end + 1, coarse->of_centre.idx + end,
                    (size_t)(at - end) * sizeof *coarse->of_centre.idx);
            memmove(coarse->of_centre.value + end + 1, coarse->of_centre.value + end,
                    (size_t)(at++ - end) * sizeof *coarse->of_centre.value);
            coarse->of_centre.idx[end] = (int32_t)n;
            coarse->of_centre.value[end] = 0.0;
            for (int64_t c = ways->nearest[n]; c < coarse->centre_count; c++) {
                coarse->of_centre.ptr[c + 1]++;
            }
        }
    }
    return STATUS_OK;
}

static enum status list_near(struct coarse_space *coarse, const struct ways *ways, const int64_t *from,
                             struct near *near, struct error *error)
{
    struct first_failure failure = {STATUS_OK};
    struct chunks chunks = chunks_for_threads(coarse->centre_count, coarse->node_count, NODES_FOR_THREAD);
#pragma omp parallel for schedule(static, 1) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        struct error own;
        int64_t begin = chunks_begin(&chunks, c), end = chunks_begin(&chunks, c + 1);
        note_failure(&failure, c, list_some(coarse, ways, from, begin, end, near, &own), &own, error);
    }
    return failure.status == STATUS_OK ? join_lists(coarse, ways, near, error) : failure.status;
}

enum status coarse_centres_pick(struct coarse_space *coarse, const struct neighbours *neighbours,
                                struct error *error)
{
    struct ways ways = {.neighbours = neighbours};
    SCRATCH int64_t *from = NULL;
    SCRATCH struct near *near = NULL;
    enum status status;
    TRY(NEW_ARRAY(&from, coarse->centre_count, error));
    TRY(NEW_ARRAY(&near, coarse->centre_count, error));
    TRY(NEW_ARRAY(&ways.least, coarse->node_count, error));
    TRY(NEW_ARRAY(&ways.nearest, coarse->node_count, error));
    if (neighbours != NULL) {
        TRY(find_parts(coarse, &ways, error));
    }
    TRY(choose(coarse, &ways, from, error));
    TRY(list_near(coarse, &ways, from, near, error));
done:
    for (int64_t c = 0; near != NULL && c < coarse->centre_count; c++) {
        FREE_ALL(near[c].node, near[c].distance);
    }
    FREE_ALL(ways.part, ways.least, ways.nearest);
    return status;
}
