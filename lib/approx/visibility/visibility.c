#include "approx/visibility/visibility.h"

#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

const char *const visibility_names[VISIBILITY_RULE_COUNT] = {"cells", "distance"};

/* The longest path to a neighbour that is not visible, by the straight distance. */
static const double most_detour = 1.05;

enum status visibility_build_cells(const struct cells *cells, struct visibility *visibility,
                                   struct error *error)
{
    *visibility = (struct visibility){.cells = *cells};
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->across, cells->count * (cells->dim + 1), error));
    RETURN_IF_ERROR(cells_across(cells, visibility->across, error));
    return lists_by_row(cells->count, cells->dim + 1, cells->node, cells->node_count, &visibility->star_ptr,
                        &visibility->star, error);
}

/* Whether sight ends at face s % (dim + 1) of cell s / (dim + 1): on the boundary or an interface. */
static bool is_end(const struct visibility *visibility, int64_t s)
{
    int32_t next = visibility->across[s];
    const int32_t *side = visibility->cell_side;
    return next < 0 || (side != NULL && side[next] != side[s / (visibility->cells.dim + 1)]);
}

/* Whether a node is of a part of the cells: of_cell[], of_node[], -1: of several. */
static bool is_of(const struct visibility *visibility, const int32_t *of_cell, const int32_t *of_node,
                  int32_t node, int32_t part)
{
    if (of_node[node] >= 0) {
        return of_node[node] == part;
    }
    for (int64_t s = visibility->star_ptr[node]; s < visibility->star_ptr[node + 1]; s++) {
        if (of_cell[visibility->star[s]] == part) {
            return true;
        }
    }
    return false;
}

/* Whether a node is of a side. */
static bool is_on(const struct visibility *visibility, int32_t node, int32_t side)
{
    return is_of(visibility, visibility->cell_side, visibility->node_side, node, side);
}

/* The bodies: cells with a common face on one side. of_cell[cells.count], of_node[cells.node_count]. */
static enum status find_bodies(const struct visibility *visibility, int32_t *of_cell, int32_t *of_node,
                               struct error *error)
{
    const struct cells *cells = &visibility->cells;
    int corners = cells->dim + 1;
    for (int64_t c = 0; c < cells->count; c++) {
        of_cell[c] = (int32_t)c;
    }
    for (int64_t s = 0; s < cells->count * corners; s++) {
        if (!is_end(visibility, s)) {
            set_join(of_cell, (int32_t)(s / corners), visibility->across[s]);
        }
    }
    for (int64_t c = 0; c < cells->count; c++) {
        of_cell[c] = set_first(of_cell, (int32_t)c);
    }
    return nodes_parts(cells, of_cell, of_node, error);
}

/* A facet may hide a node from points of its support if the node is beyond the facet, or on it but not a node
 * of it, or of another body (`apart`). Note from which distance on. */
static void note_facet(struct visibility *visibility, const int32_t *facet, int32_t node, bool apart)
{
    int dim = visibility->cells.dim;
    const double *x = visibility->cells.x, *y = x + (int64_t)node * dim;
    double area[3] = {0.0, 0.0, 0.0}, middle[3], from[3], radius = 0.0;
    double tolerance = COARSE_ROUND_OFF * visibility->supports.radius[node];
    face_area_vector(dim, x, facet, area);
    vector_middle(dim, x, dim, facet, middle);
    vector_subtract(dim, y, middle, from);
    for (int k = 0; k < dim; k++) {
        radius = fmax(radius, vector_distance(dim, middle, x + (int64_t)facet[k] * dim) * (1.0 + 1e-6));
        if (facet[k] == node) {
            return;
        }
    }
    double height = vector_dot(dim, area, from) / vector_length(dim, area);
    double beside = vector_length(dim, from) - radius;
    if (!apart && (height < -tolerance || (height <= tolerance && beside > 0.0))) {
        return;
    }
    double *least = &visibility->hidden_from[node];
    *least = apart ? 0.0 : fmin(*least, fmax(height, beside) - tolerance);
}

/* Note what a face of a cell, at which sight ends, may hide from points on its side. */
static enum status note_face(struct visibility *visibility, int64_t cell, int vertex, const int32_t *of_cell,
                             const int32_t *of_node, struct index_list *near, struct error *error)
{
    const struct cells *cells = &visibility->cells;
    int32_t facet[3];
    cell_face(cells, cell, vertex, facet);
    struct box box = box_of_nodes(cells->dim, cells->x, facet, cells->dim);
    near->count = 0;
    RETURN_IF_ERROR(point_grid_query_box(&visibility->grid, box.low, box.high, 1.0, near, error));
    for (int64_t i = 0; i < near->count; i++) {
        int32_t node = near->index[i];
        if (visibility->cell_side == NULL || is_on(visibility, node, visibility->cell_side[cell])) {
            note_facet(visibility, facet, node, !is_of(visibility, of_cell, of_node, node, of_cell[cell]));
        }
    }
    return STATUS_OK;
}

static enum status build_grid(struct visibility *visibility, struct error *error)
{
    const struct cells *cells = &visibility->cells;
    const struct supports *supports = &visibility->supports;
    NEW_SCRATCH(double, largest, cells->node_count, error);
    for (int64_t n = 0; n < cells->node_count; n++) {
        largest[n] = supports->radius[n];
    }
    for (int64_t i = 0; i < supports->side_count; i++) {
        const double *row = supports->sides + i * SIDE_COLUMNS(cells->dim);
        largest[(int64_t)row[0]] = fmax(largest[(int64_t)row[0]], row[2]);
    }
    return point_grid_build(&visibility->grid, cells->dim, cells->node_count, cells->x, largest, error);
}

enum status visibility_build(const struct cells *cells, struct supports supports, enum visibility_rule rule,
                             const int32_t *cell_side, struct visibility *visibility, struct error *error)
{
    FREED_BY(index_list_free) struct index_list near = {0};
    int corners = cells->dim + 1;
    if (rule == VISIBILITY_CELLS && cells->count > 0) {
        RETURN_IF_ERROR(visibility_build_cells(cells, visibility, error));
    } else {
        *visibility = (struct visibility){.cells = *cells};
    }
    visibility->supports = supports;
    RETURN_IF_ERROR(build_grid(visibility, error));
    if (visibility->across == NULL) {
        return STATUS_OK;
    }
    visibility->cell_side = cell_side;
    NEW_SCRATCH(int32_t, of_cell, cells->count, error);
    NEW_SCRATCH(int32_t, of_node, cells->node_count, error);
    RETURN_IF_ERROR(find_bodies(visibility, of_cell, of_node, error));
    if (cell_side != NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&visibility->node_side, cells->node_count, error));
        RETURN_IF_ERROR(nodes_parts(cells, cell_side, visibility->node_side, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&visibility->hidden_from, cells->node_count, error));
    for (int64_t i = 0; i < cells->node_count; i++) {
        visibility->hidden_from[i] = INFINITY;
    }
    for (int64_t s = 0; s < cells->count * corners; s++) {
        if (is_end(visibility, s)) {
            RETURN_IF_ERROR(
                note_face(visibility, s / corners, (int)(s % corners), of_cell, of_node, &near, error));
        }
    }
    return STATUS_OK;
}

void visibility_free(struct visibility *visibility)
{
    point_grid_free(&visibility->grid);
    FREE_ALL(visibility->node_side, visibility->across, visibility->star_ptr, visibility->star,
             visibility->hidden_from);
    *visibility = (struct visibility){0};
}

void visibility_work_free(struct visibility_work *work)
{
    FREE_ALL(work->own.index, work->stack.index, work->visited.index);
    *work = (struct visibility_work){0};
}

/* Keep the point's cells that are on the lowest of their sides; search for them where they are not known. */
static enum status take_side(const struct visibility *visibility, struct visibility_work *work,
                             struct error *error)
{
    if (work->cell_count <= 0) {
        RETURN_IF_ERROR(visibility_locate(visibility, work->x, work, error));
    } else {
        work->own.count = 0;
        RETURN_IF_ERROR(index_list_reserve(&work->own, work->cell_count, error));
    }
    work->side = work->cell_count > 0 ? INT32_MAX : 0;
    for (int64_t i = 0; i < work->cell_count; i++) {
        int32_t side = visibility->cell_side[work->cell[i]];
        work->side = side < work->side ? side : work->side;
    }
    work->own.count = 0;
    for (int64_t i = 0; i < work->cell_count; i++) {
        if (visibility->cell_side[work->cell[i]] == work->side) {
            work->own.index[work->own.count++] = work->cell[i];
        }
    }
    work->cell = work->own.index;
    work->cell_count = work->own.count;
    return STATUS_OK;
}

enum status visibility_begin(const struct visibility *visibility, const struct visibility_places *places,
                             int64_t p, const double *x, bool whole, struct visibility_work *work,
                             struct error *error)
{
    work->x = x;
    work->outside = false;
    memcpy(work->from, x, (size_t)visibility->cells.dim * sizeof *x);
    work->cell_count = -1;
    work->side = -1;
    if (places->nodes) {
        work->cell = visibility->star + visibility->star_ptr[p];
        work->cell_count = visibility->star_ptr[p + 1] - visibility->star_ptr[p];
    } else if (places->cell != NULL) {
        int64_t rest = p - places->long_rows * places->points_per_row;
        int64_t row =
            places->long_rows > 0 && rest >= 0 ? places->long_rows + rest : p / places->points_per_row;
        int64_t first = places->ptr != NULL ? places->ptr[row] : row;
        int64_t count = (places->ptr != NULL ? places->ptr[row + 1] : row + 1) - first;
        work->cell = places->cell + first;
        work->cell_count = count > 0 && work->cell[0] >= 0 ? count : -1;
    }
    return visibility->cell_side != NULL && !whole ? take_side(visibility, work, error) : STATUS_OK;
}

/* Whether a node is visible; or it is so from a node of the point's cells, by way of which the path is not
 * much longer than straight. */
static enum status look(const struct visibility *visibility, int32_t node, struct visibility_work *work,
                        bool *seen, struct error *error)
{
    const struct cells *cells = &visibility->cells;
    int dim = cells->dim, corners = dim + 1;
    const double *y = cells->x + (int64_t)node * dim;
    double most = most_detour * vector_distance(dim, work->from, y);
    RETURN_IF_ERROR(
        visibility_walk(visibility, work->from, work->cell, work->cell_count, node, work, seen, error));
    for (int64_t i = 0; i < work->cell_count * corners && !*seen; i++) {
        int32_t corner = cells->node[(int64_t)work->cell[i / corners] * corners + i % corners];
        const double *by = cells->x + (int64_t)corner * dim;
        if (vector_distance(dim, work->from, by) + vector_distance(dim, by, y) < most) {
            RETURN_IF_ERROR(
                visibility_walk(visibility, by, work->cell, work->cell_count, node, work, seen, error));
        }
    }
    return STATUS_OK;
}

enum status visibility_filter(const struct visibility *visibility, double widen, int32_t *index,
                              int64_t *count, struct visibility_work *work, struct error *error)
{
    int64_t kept = 0;
    int dim = visibility->cells.dim;
    bool whole = visibility->cell_side != NULL && work->side < 0; /* hidden_from is for sides */
    for (int64_t i = 0; i < *count; i++) {
        bool seen = true;
        if (work->side >= 0 && !is_on(visibility, index[i], work->side)) {
            continue;
        }
        /* Nearer than all that may hide it? */
        bool near = vector_distance(dim, visibility->cells.x + (int64_t)index[i] * dim, work->x) <
                    visibility->hidden_from[index[i]];
        if (widen > 1.0 || work->outside || whole || !near) {
            RETURN_IF_ERROR(work->cell_count < 0 ? visibility_locate(visibility, work->x, work, error)
                                                 : STATUS_OK);
            RETURN_IF_ERROR(work->cell_count > 0 ? look(visibility, index[i], work, &seen, error)
                                                 : STATUS_OK);
        }
        if (seen) {
            index[kept++] = index[i];
        }
    }
    *count = kept;
    return STATUS_OK;
}
