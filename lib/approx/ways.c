#include "approx/ways.h"

#include "approx/reach_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* A way may be so many times as long as the straight one. */
static const double most_detour = 2.0;

static void assign_nodes(struct ways *ways, int64_t stride, const double *place, double unit)
{
    const struct cells *cells = &ways->reach.cells;
    for (int64_t p = 0; p < ways->place_count; p++) {
        double nearest2 = INFINITY;
        ways->node[p] = -1;
        for (int32_t n = 0; n < cells->node_count; n++) {
            double distance2 = 0.0;
            for (int a = 0; a < cells->dim; a++) {
                double difference = place[p * stride + a] * unit - cells->x[(int64_t)n * cells->dim + a];
                distance2 += difference * difference;
            }
            if (distance2 < nearest2 && ways->reach.star_ptr[n] < ways->reach.star_ptr[n + 1]) {
                nearest2 = distance2;
                ways->node[p] = n;
            }
        }
    }
}

enum status ways_build(const struct cells *cells, int64_t place_count, int64_t stride, const double *place,
                       double unit, struct ways *ways, struct error *error)
{
    *ways = (struct ways){.place_count = place_count, .from = -1, .searched = -1.0};
    RETURN_IF_ERROR(reach_build_cells(cells, &ways->reach, error));
    RETURN_IF_ERROR(NEW_ARRAY(&ways->node, place_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&ways->verdict, place_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&ways->length, cells->node_count, error));
    assign_nodes(ways, stride, place, unit);
    return STATUS_OK;
}

void ways_free(struct ways *ways)
{
    reach_free(&ways->reach);
    reach_work_free(&ways->work);
    queue_free(&ways->queue);
    FREE_ALL(ways->node, ways->verdict, ways->length);
    *ways = (struct ways){0};
}

void ways_begin(struct ways *ways, int32_t from)
{
    if (from != ways->from) {
        memset(ways->verdict, WAY_UNKNOWN, (size_t)ways->place_count);
        ways->from = from;
        ways->searched = -1.0;
    }
}

/* Shortest ways along edges from ways->from, up to that length (Dijkstra 1959). */
static enum status search(struct ways *ways, double limit, struct error *error)
{
    const struct reach *reach = &ways->reach;
    int dim = reach->cells.dim;
    for (int64_t n = 0; n < reach->cells.node_count; n++) {
        ways->length[n] = INFINITY;
    }
    ways->searched = limit;
    ways->queue.count = 0;
    ways->length[ways->from] = 0.0;
    RETURN_IF_ERROR(queue_push(&ways->queue, 0.0, ways->from, error));
    while (ways->queue.count > 0) {
        struct way_end end = queue_pop(&ways->queue);
        for (int64_t s = reach->star_ptr[end.node];
             end.length <= ways->length[end.node] && s < reach->star_ptr[end.node + 1]; s++) {
            for (int k = 0; k <= dim; k++) {
                int32_t next = reach->cells.node[(int64_t)reach->star[s] * (dim + 1) + k];
                double length = end.length + vector_distance(dim, reach->cells.x + (int64_t)end.node * dim,
                                                             reach->cells.x + (int64_t)next * dim);
                if (length < ways->length[next] && length <= limit) {
                    ways->length[next] = length;
                    RETURN_IF_ERROR(queue_push(&ways->queue, length, next, error));
                }
            }
        }
    }
    return STATUS_OK;
}

enum status ways_reach(struct ways *ways, int64_t place, bool *reached, struct error *error)
{
    const struct reach *reach = &ways->reach;
    int dim = reach->cells.dim;
    int32_t from = ways->from, node = ways->node[place];
    if (ways->verdict[place] == WAY_UNKNOWN && node >= 0) {
        const double *x = reach->cells.x + (int64_t)from * dim;
        bool sees;
        RETURN_IF_ERROR(reach_walk(reach, x, reach->star + reach->star_ptr[from],
                                   reach->star_ptr[from + 1] - reach->star_ptr[from], node, &ways->work,
                                   &sees, error));
        double limit = most_detour * vector_distance(dim, x, reach->cells.x + (int64_t)node * dim);
        if (!sees && ways->searched < limit) {
            RETURN_IF_ERROR(
                search(ways, 1.5 * limit, error)); /* farther than needed here, for the next queries */
        }
        ways->verdict[place] = sees || ways->length[node] <= limit ? WAY_GOOD : WAY_NONE;
    }
    *reached = ways->verdict[place] != WAY_NONE;
    return STATUS_OK;
}
