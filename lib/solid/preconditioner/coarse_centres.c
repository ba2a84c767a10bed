/* Centres are nodes, each the farthest from those before it. A centre is compared with those before it only
 * at the nodes that it is nearest to: the search along paths ends where a node is nearer to another one. So
 * all searches together take a time that grows like the number of nodes times the logarithm of that of
 * centres. */
#include "solid/preconditioner/coarse_centres.h"

#include "approx/visibility/edge_paths.h"
#include "base/memory.h"
#include "base/queue.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Radius of the shares, by the largest distance of a node from its nearest centre: 1.2 to 2.5 give as many
 * steps. */
static const double radius_factor = 1.5;

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

static void note(struct search *search, int64_t node, double distance)
{
    search->node[search->count] = (int32_t)node;
    search->distance[search->count++] = distance;
}

/* Nodes that are nearer than within[], or than the radius, straight. */
static void search_straight(const struct coarse_space *coarse, int64_t from, const double *within,
                            struct search *search)
{
    int dim = coarse->dim;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double distance = vector_distance(dim, coarse->X + n * dim, coarse->X + from * dim);
        if (distance < (within != NULL ? within[n] : coarse->radius)) {
            note(search, n, distance);
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
 * lead to (Dijkstra); without neighbours all of them. */
static enum status find_near(const struct coarse_space *coarse, const struct neighbours *neighbours,
                             int64_t from, const double *within, struct search *search, struct error *error)
{
    int dim = coarse->dim;
    search->count = search->touched_count = 0;
    if (neighbours == NULL) {
        search_straight(coarse, from, within, search);
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
            RETURN_IF_ERROR(go_on(coarse, neighbours, &end, search, error));
        }
    }
    for (int64_t i = 0; i < search->touched_count; i++) {
        search->length[search->touched[i]] = INFINITY;
    }
    return STATUS_OK;
}

/* The farthest node of those that a centre reaches; or one that none does. */
static int64_t farthest(const struct coarse_space *coarse, const double *least, bool reached)
{
    int64_t node = 0;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        node = least[n] > least[node] && !(reached && isinf(least[n])) ? n : node;
    }
    return node;
}

/* Choose the centres from[], and the radius. */
static enum status choose(struct coarse_space *coarse, const struct neighbours *neighbours, int64_t *from,
                          struct search *search, struct error *error)
{
    NEW_SCRATCH(double, least, coarse->node_count, error); /* distance from the nearest centre so far, m */
    for (int64_t n = 0; n < coarse->node_count; n++) {
        least[n] = INFINITY;
    }
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        from[c] = farthest(coarse, least, false);
        memcpy(coarse->centre + c * coarse->dim, coarse->X + from[c] * coarse->dim,
               (size_t)coarse->dim * sizeof *coarse->centre);
        RETURN_IF_ERROR(find_near(coarse, neighbours, from[c], least, search, error));
        for (int64_t i = 0; i < search->count; i++) {
            least[search->node[i]] = search->distance[i];
        }
    }
    coarse->radius = fmax(radius_factor * least[farthest(coarse, least, true)], DBL_MIN); /* not 0 */
    return STATUS_OK;
}

/* The nodes within the radius of each centre. */
static enum status list_near(struct coarse_space *coarse, const struct neighbours *neighbours,
                             const int64_t *from, struct search *search, struct error *error)
{
    struct sparse *lists = &coarse->of_centre;
    int64_t room = 0, values = 0;
    RETURN_IF_ERROR(sparse_new(coarse->centre_count, coarse->node_count, 0, lists, error));
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        RETURN_IF_ERROR(find_near(coarse, neighbours, from[c], NULL, search, error));
        int64_t at = lists->ptr[c], end = at + search->count;
        RETURN_IF_ERROR(GROW_ARRAY(&lists->idx, end, &room, error));
        RETURN_IF_ERROR(GROW_ARRAY(&lists->value, end, &values, error));
        memcpy(lists->idx + at, search->node, (size_t)search->count * sizeof *search->node);
        memcpy(lists->value + at, search->distance, (size_t)search->count * sizeof *search->distance);
        lists->ptr[c + 1] = end;
    }
    return STATUS_OK;
}

enum status coarse_centres_pick(struct coarse_space *coarse, const struct neighbours *neighbours,
                                struct error *error)
{
    FREED_BY(search_free) struct search search = {0};
    NEW_SCRATCH(int64_t, from, coarse->centre_count, error);
    RETURN_IF_ERROR(search_begin(coarse->node_count, &search, error));
    RETURN_IF_ERROR(choose(coarse, neighbours, from, &search, error));
    return list_near(coarse, neighbours, from, &search, error);
}
