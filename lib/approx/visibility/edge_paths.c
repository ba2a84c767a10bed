#include "approx/visibility/edge_paths.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

static void assign_nodes(struct edge_paths *paths, int64_t stride, const double *place, double unit)
{
    const struct cells *cells = &paths->visibility.cells;
    for (int64_t p = 0; p < paths->place_count; p++) {
        double nearest2 = INFINITY;
        paths->node[p] = -1;
        for (int32_t n = 0; n < cells->node_count; n++) {
            double distance2 = 0.0;
            for (int a = 0; a < cells->dim; a++) {
                double difference = place[p * stride + a] * unit - cells->x[(int64_t)n * cells->dim + a];
                distance2 += difference * difference;
            }
            if (distance2 < nearest2 && paths->visibility.star_ptr[n] < paths->visibility.star_ptr[n + 1]) {
                nearest2 = distance2;
                paths->node[p] = n;
            }
        }
    }
}

enum status edge_paths_build(const struct cells *cells, int64_t place_count, int64_t stride,
                             const double *place, double unit, struct edge_paths *paths, struct error *error)
{
    *paths = (struct edge_paths){.place_count = place_count, .from = -1, .searched = -1.0};
    RETURN_IF_ERROR(visibility_build_cells(cells, &paths->visibility, error));
    RETURN_IF_ERROR(NEW_ARRAY(&paths->node, place_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&paths->verdict, place_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&paths->length, cells->node_count, error));
    assign_nodes(paths, stride, place, unit);
    return STATUS_OK;
}

void edge_paths_free(struct edge_paths *paths)
{
    visibility_free(&paths->visibility);
    visibility_work_free(&paths->work);
    queue_free(&paths->queue);
    FREE_ALL(paths->node, paths->verdict, paths->length);
    *paths = (struct edge_paths){0};
}

void edge_paths_begin(struct edge_paths *paths, int32_t from)
{
    if (from != paths->from) {
        memset(paths->verdict, PATH_UNKNOWN, (size_t)paths->place_count);
        paths->from = from;
        paths->searched = -1.0;
    }
}

/* Shortest paths along edges from paths->from, up to the length `limit` (Dijkstra 1959). */
static enum status search(struct edge_paths *paths, double limit, struct error *error)
{
    const struct visibility *visibility = &paths->visibility;
    int dim = visibility->cells.dim;
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        paths->length[n] = INFINITY;
    }
    paths->searched = limit;
    paths->queue.count = 0;
    paths->length[paths->from] = 0.0;
    RETURN_IF_ERROR(queue_push(&paths->queue, 0.0, paths->from, error));
    while (paths->queue.count > 0) {
        struct path_end end = queue_pop(&paths->queue);
        for (int64_t s = visibility->star_ptr[end.node];
             end.length <= paths->length[end.node] && s < visibility->star_ptr[end.node + 1]; s++) {
            for (int k = 0; k <= dim; k++) {
                int32_t next = visibility->cells.node[(int64_t)visibility->star[s] * (dim + 1) + k];
                double length =
                    end.length + vector_distance(dim, visibility->cells.x + (int64_t)end.node * dim,
                                                 visibility->cells.x + (int64_t)next * dim);
                if (length < paths->length[next] && length <= limit) {
                    paths->length[next] = length;
                    RETURN_IF_ERROR(queue_push(&paths->queue, length, next, error));
                }
            }
        }
    }
    return STATUS_OK;
}

enum status edge_paths_reach(struct edge_paths *paths, int64_t place, bool *reached, struct error *error)
{
    const struct visibility *visibility = &paths->visibility;
    int dim = visibility->cells.dim;
    int32_t from = paths->from, node = paths->node[place];
    if (paths->verdict[place] == PATH_UNKNOWN && node >= 0) {
        const double *x = visibility->cells.x + (int64_t)from * dim;
        bool sees;
        RETURN_IF_ERROR(visibility_walk(visibility, x, visibility->star + visibility->star_ptr[from],
                                        visibility->star_ptr[from + 1] - visibility->star_ptr[from], node,
                                        &paths->work, &sees, error));
        double limit = PATH_MOST_DETOUR * vector_distance(dim, x, visibility->cells.x + (int64_t)node * dim);
        if (!sees && paths->searched < limit) {
            RETURN_IF_ERROR(
                search(paths, 1.5 * limit, error)); /* farther than needed, for the next queries */
        }
        paths->verdict[place] = sees || paths->length[node] <= limit ? PATH_GOOD : PATH_NONE;
    }
    *reached = paths->verdict[place] != PATH_NONE;
    return STATUS_OK;
}
