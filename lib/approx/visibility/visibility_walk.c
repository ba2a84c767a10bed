/* Segments through the cells, and paths along their edges. */
#include "approx/visibility/visibility.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* The barycentric coordinates of two points in a cell. */
static inline void barycentric_in(int dim, const struct cells *cells, int64_t cell, const double *x,
                                  const double *y, double *of_x, double *of_y)
{
    const int32_t *v = cells->node + cell * (dim + 1);
    const double *first = cells->x + (int64_t)v[0] * dim;
    double edge[3][3], dual[3][3], from_x[3], from_y[3];
    for (int k = 0; k < dim; k++) {
        vector_subtract(dim, cells->x + (int64_t)v[k + 1] * dim, first, edge[k]);
    }
    vector_subtract(dim, x, first, from_x);
    vector_subtract(dim, y, first, from_y);
    if (dim == 2) {
        dual[0][0] = edge[1][1];
        dual[0][1] = -edge[1][0];
        dual[1][0] = -edge[0][1];
        dual[1][1] = edge[0][0];
    } else {
        vector_cross(edge[1], edge[2], dual[0]);
        vector_cross(edge[2], edge[0], dual[1]);
        vector_cross(edge[0], edge[1], dual[2]);
    }
    double inverse = 1.0 / vector_dot(dim, edge[0], dual[0]);
    of_x[0] = of_y[0] = 1.0;
    for (int k = 0; k < dim; k++) {
        of_x[k + 1] = vector_dot(dim, from_x, dual[k]) * inverse;
        of_y[k + 1] = vector_dot(dim, from_y, dual[k]) * inverse;
        of_x[0] -= of_x[k + 1];
        of_y[0] -= of_y[k + 1];
    }
}

static void barycentric(const struct cells *cells, int64_t cell, const double *x, const double *y,
                        double *of_x, double *of_y)
{
    if (cells->dim == 2) {
        barycentric_in(2, cells, cell, x, y, of_x, of_y);
    } else {
        barycentric_in(3, cells, cell, x, y, of_x, of_y);
    }
}

/* Whether the segment meets a cell; least[dim + 1]: its barycentric coordinates there; *ahead: the lowest one
 * of its end. */
static bool touches(const struct cells *cells, int64_t cell, const double *x, const double *y, double *least,
                    int *ahead)
{
    double a[4], b[4], begin = 0.0, end = 1.0;
    int corners = cells->dim + 1;
    barycentric(cells, cell, x, y, a, b);
    for (int k = 0; k < corners; k++) {
        if (a[k] < -COARSE_ROUND_OFF) {
            if (b[k] < -COARSE_ROUND_OFF) {
                return false;
            }
            double at = (-COARSE_ROUND_OFF - a[k]) / (b[k] - a[k]);
            begin = at > begin ? at : begin;
        } else if (b[k] < -COARSE_ROUND_OFF) {
            double at = (-COARSE_ROUND_OFF - a[k]) / (b[k] - a[k]);
            end = at < end ? at : end;
        }
    }
    *ahead = 0;
    for (int k = 0; k < corners; k++) {
        *ahead = b[k] < b[*ahead] ? k : *ahead;
        double at_begin = a[k] + begin * (b[k] - a[k]), at_end = a[k] + end * (b[k] - a[k]);
        least[k] = at_begin < at_end ? at_begin : at_end;
    }
    return begin <= end + COARSE_ROUND_OFF;
}

static bool contains(const struct index_list *list, int32_t value)
{
    for (int64_t i = list->count; i-- > 0;) {
        if (list->index[i] == value) {
            return true;
        }
    }
    return false;
}

static enum status visit(int32_t cell, struct visibility_work *work, struct error *error)
{
    if (cell < 0 || contains(&work->visited, cell)) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(index_list_add(&work->visited, cell, error));
    return index_list_add(&work->stack, cell, error);
}

static bool has_node(const struct cells *cells, int64_t cell, int32_t node)
{
    const int32_t *v = cells->node + cell * (cells->dim + 1);
    return v[0] == node || v[1] == node || v[2] == node || (cells->dim == 3 && v[3] == node);
}

/* Whether a cell is beyond an interface at which sight ends. */
static bool is_beyond(const struct visibility *visibility, int32_t cell, const struct visibility_work *work)
{
    return visibility->cell_side != NULL && work->side >= 0 && cell >= 0 &&
           visibility->cell_side[cell] != work->side;
}

/* Follow the segment from the cells of the stack. */
static enum status follow(const struct visibility *visibility, const double *x, int32_t node,
                          struct visibility_work *work, bool *arrives, struct error *error)
{
    int corners = visibility->cells.dim + 1, ahead;
    const double *y = visibility->cells.x + (int64_t)node * visibility->cells.dim;
    while (work->stack.count > 0) {
        double least[4];
        int32_t at = work->stack.index[--work->stack.count];
        if (has_node(&visibility->cells, at, node)) {
            *arrives = true;
            return STATUS_OK;
        }
        if (!touches(&visibility->cells, at, x, y, least, &ahead)) {
            continue;
        }
        for (int i = 1; i <= corners; i++) { /* the cell ahead is the next one */
            int k = ahead + i < corners ? ahead + i : ahead + i - corners;
            int32_t next = visibility->across[(int64_t)at * corners + k];
            if (least[k] <= COARSE_ROUND_OFF && !is_beyond(visibility, next, work)) {
                RETURN_IF_ERROR(visit(next, work, error));
            }
        }
    }
    return STATUS_OK;
}

enum status visibility_walk(const struct visibility *visibility, const double *x, const int32_t *cell,
                            int64_t cell_count, int32_t node, struct visibility_work *work, bool *arrives,
                            struct error *error)
{
    work->visited.count = work->stack.count = 0;
    *arrives = false;
    for (int64_t i = 0; i < cell_count && !*arrives; i++) {
        RETURN_IF_ERROR(visit(cell[i], work, error));
        RETURN_IF_ERROR(follow(visibility, x, node, work, arrives, error));
    }
    return STATUS_OK;
}

/* pulled[dim]: the point of a cell with the barycentric coordinates of x, negative ones set to 0 and scaled
 * to the sum 1. Returns its distance from x. */
static double pull_into(const struct cells *cells, int64_t cell, const double *x, double *pulled)
{
    int dim = cells->dim;
    double place[4], same[4], sum = 0.0;
    barycentric(cells, cell, x, x, place, same);
    for (int a = 0; a < dim; a++) {
        pulled[a] = 0.0;
    }
    for (int k = 0; k <= dim; k++) {
        place[k] = place[k] > 0.0 ? place[k] : 0.0;
        sum += place[k];
    }
    for (int i = 0; i < (dim + 1) * dim; i++) {
        int32_t node = cells->node[cell * (dim + 1) + i / dim];
        pulled[i % dim] += place[i / dim] / sum * cells->x[(int64_t)node * dim + i % dim];
    }
    return vector_distance(dim, x, pulled);
}

enum status visibility_locate(const struct visibility *visibility, const double *x,
                              struct visibility_work *work, struct error *error)
{
    FREED_BY(index_list_free) struct index_list near = {0};
    double least[4], nearest = INFINITY, pulled[3];
    int ahead;
    work->own.count = 0;
    work->outside = false;
    RETURN_IF_ERROR(point_grid_query_box(&visibility->grid, x, x, 1.0, &near, error));
    for (int64_t i = 0; i < near.count; i++) {
        for (int64_t s = visibility->star_ptr[near.index[i]]; s < visibility->star_ptr[near.index[i] + 1];
             s++) {
            int32_t cell = visibility->star[s];
            if (touches(&visibility->cells, cell, x, x, least, &ahead)) {
                work->own.count = work->outside ? 0 : work->own.count;
                work->outside = false;
                nearest = 0.0;
                RETURN_IF_ERROR(contains(&work->own, cell) ? STATUS_OK
                                                           : index_list_add(&work->own, cell, error));
            } else if (nearest > 0.0 && pull_into(&visibility->cells, cell, x, pulled) < nearest) {
                nearest = pull_into(&visibility->cells, cell, x, work->from);
                work->own.count = 0;
                RETURN_IF_ERROR(index_list_add(&work->own, cell, error));
                work->outside = true;
            }
        }
    }
    if (!work->outside) {
        memcpy(work->from, x, (size_t)visibility->cells.dim * sizeof *x);
    }
    work->cell = work->own.index;
    work->cell_count = work->own.count;
    return STATUS_OK;
}

/* ---- paths ---- */

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

/* Shortest paths along edges from paths->from, up to the length `limit`: each node to which a shorter one is
 * found passes it on (Bellman 1958, Ford 1956). */
static enum status search(struct edge_paths *paths, double limit, struct error *error)
{
    const struct visibility *visibility = &paths->visibility;
    struct index_list *ends = &paths->work.stack;
    const double *x = visibility->cells.x;
    int dim = visibility->cells.dim, corners = dim + 1;
    for (int64_t n = 0; n < visibility->cells.node_count; n++) {
        paths->length[n] = INFINITY;
    }
    paths->searched = limit;
    paths->length[paths->from] = 0.0;
    ends->count = 0;
    RETURN_IF_ERROR(index_list_add(ends, paths->from, error));
    for (int64_t i = 0; i < ends->count; i++) {
        int64_t end = ends->index[i];
        for (int64_t s = visibility->star_ptr[end] * corners; s < visibility->star_ptr[end + 1] * corners;
             s++) {
            int32_t next =
                visibility->cells.node[(int64_t)visibility->star[s / corners] * corners + s % corners];
            double length = paths->length[end] + vector_distance(dim, x + end * dim, x + (int64_t)next * dim);
            if (length < paths->length[next] && length <= limit) {
                paths->length[next] = length;
                RETURN_IF_ERROR(index_list_add(ends, next, error));
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
