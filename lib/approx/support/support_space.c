#include "approx/support/support_space.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Copy the nodes and cells of one side. local_node[node_count]: scratch, -1 before and after. */
static enum status cut_out(const struct support_space *space, const int32_t *cell, struct support_side *side,
                           int32_t *local_node, struct error *error)
{
    int dim = space->cells.dim, corners = dim + 1;
    int64_t slots = side->cell_count * corners;
    RETURN_IF_ERROR(NEW_ARRAY(&side->local, slots, error));
    RETURN_IF_ERROR(NEW_ARRAY(&side->node, space->cells.node_count, error));
    for (int64_t i = 0; i < slots; i++) {
        local_node[space->cells.node[(int64_t)cell[i / corners] * corners + i % corners]] = 0;
    }
    for (int64_t n = 0; n < space->cells.node_count; n++) {
        if (local_node[n] == 0) {
            local_node[n] = (int32_t)side->node_count;
            side->node[side->node_count++] = (int32_t)n;
        }
    }
    for (int64_t i = 0; i < slots; i++) {
        side->local[i] = local_node[space->cells.node[(int64_t)cell[i / corners] * corners + i % corners]];
        space->place[cell[i / corners]] = (int32_t)(i / corners);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&side->x, side->node_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&side->radius, side->node_count, error));
    for (int64_t n = 0; n < side->node_count; n++) {
        int64_t whole = side->node[n];
        memcpy(side->x + n * dim, space->cells.x + whole * dim, (size_t)dim * sizeof *side->x);
        side->radius[n] = space->radius[whole];
        local_node[whole] = -1;
    }
    return STATUS_OK;
}

/* Divide the body into its sides. */
static enum status cut(struct support_space *space, struct error *error)
{
    SCRATCH int64_t *first = NULL;
    SCRATCH int32_t *cell = NULL;
    int32_t sides = 0;
    const struct cells *cells = &space->cells;
    for (int64_t c = 0; c < cells->count; c++) {
        sides = space->cell_side[c] >= sides ? space->cell_side[c] + 1 : sides;
    }
    RETURN_IF_ERROR(lists_by_row(cells->count, 1, space->cell_side, sides, &first, &cell, error));
    NEW_SCRATCH(int32_t, local_node, cells->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&space->place, cells->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&space->side, sides, error));
    space->side_count = sides;
    memset(local_node, -1, (size_t)cells->node_count * sizeof *local_node);
    for (int32_t s = 0; s < sides; s++) {
        space->side[s].cell_count = first[s + 1] - first[s];
        RETURN_IF_ERROR(cut_out(space, cell + first[s], &space->side[s], local_node, error));
    }
    return STATUS_OK;
}

/* Prepare a side for the search of neighbours. */
static enum status index_side(const struct support_space *space, struct support_side *side,
                              struct error *error)
{
    struct cells own = space->cells;
    if (side->node != NULL) {
        own = (struct cells){own.dim, side->node_count, side->x, side->cell_count, side->local};
    }
    RETURN_IF_ERROR(point_grid_build(&side->grid, own.dim, own.node_count, own.x,
                                     side->node != NULL ? side->radius : space->radius, error));
    RETURN_IF_ERROR(point_grid_list_touching(&side->grid, error));
    return space->by_cells ? visibility_build(&own, &side->grid, &side->visibility, error) : STATUS_OK;
}

static void free_side(struct support_side *side)
{
    visibility_free(&side->visibility);
    point_grid_free(&side->grid);
    FREE_ALL(side->node, side->local, side->x, side->radius);
}

enum status support_space_build(const struct support_options *options, const struct cells *cells,
                                const double *radius, struct support_space *space, struct error *error)
{
    *space = (struct support_space){.cells = *cells,
                                    .radius = radius,
                                    .by_cells = options->visibility == VISIBILITY_CELLS && cells->count > 0};
    space->cell_side = space->by_cells ? options->side : NULL;
    if (space->cell_side != NULL) {
        RETURN_IF_ERROR(cut(space, error));
    } else {
        RETURN_IF_ERROR(NEW_ARRAY(&space->side, 1, error));
        space->side_count = 1;
        space->side[0].node_count = cells->node_count;
    }
    for (int64_t s = 0; s < space->side_count; s++) {
        if (space->side[s].node_count > 0) {
            RETURN_IF_ERROR(index_side(space, &space->side[s], error));
        }
    }
    return STATUS_OK;
}

void support_space_free(struct support_space *space)
{
    for (int64_t s = 0; space->side != NULL && s < space->side_count; s++) {
        free_side(&space->side[s]);
    }
    FREE_ALL(space->side, space->place);
    *space = (struct support_space){0};
}

/* side[count]: of each point whose cells are known; -1: not known. */
static void sides_of_cells(const struct support_space *space, const struct visibility_places *places,
                           int64_t count, int32_t *side)
{
    for (int64_t p = 0; p < count; p++) {
        int64_t cells;
        const int32_t *cell = visibility_places_cells(places, p, &cells);
        side[p] = -1;
        for (int64_t i = 0; i < cells; i++) {
            if (cell[i] >= 0 && (side[p] < 0 || space->cell_side[cell[i]] < side[p])) {
                side[p] = space->cell_side[cell[i]];
            }
        }
    }
}

static void sides_of_nodes(const struct support_space *space, int64_t count, int32_t *side)
{
    memset(side, -1, (size_t)count * sizeof *side);
    for (int64_t s = space->side_count - 1; s >= 0; s--) {
        for (int64_t n = 0; n < space->side[s].node_count; n++) {
            side[space->side[s].node[n]] = (int32_t)s;
        }
    }
}

/* Assign each point without side to that of the nearest cell. */
static enum status locate_sides(const struct support_space *space, int64_t count, const double *x,
                                int32_t *side, struct error *error)
{
    FREED_BY(visibility_free) struct visibility whole = {0};
    FREED_BY(visibility_work_free) struct visibility_work work = {0};
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    const struct cells *cells = &space->cells;
    bool all_known = true;
    for (int64_t p = 0; p < count; p++) {
        all_known = all_known && side[p] >= 0;
    }
    if (all_known) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(visibility_build_cells(cells, &whole, error));
    RETURN_IF_ERROR(point_grid_build(&grid, cells->dim, cells->node_count, cells->x, space->radius, error));
    whole.grid = &grid;
    for (int64_t p = 0; p < count; p++) {
        if (side[p] >= 0) {
            continue;
        }
        RETURN_IF_ERROR(visibility_locate(&whole, x + p * cells->dim, &work, error));
        side[p] = work.cell_count > 0 ? space->cell_side[work.cell[0]] : 0;
        for (int64_t i = 1; i < work.cell_count; i++) {
            int32_t other = space->cell_side[work.cell[i]];
            side[p] = other < side[p] ? other : side[p];
        }
    }
    return STATUS_OK;
}

/* The places of points on their sides: nodes or cells, by their numbers there; side_count is the whole body.
 * *ptr and *item hold them, to be freed. */
static enum status places_on_sides(const struct support_space *space, const struct visibility_places *places,
                                   int64_t count, const int32_t *side, int64_t **ptr, int32_t **item,
                                   struct visibility_places *within, struct error *error)
{
    int64_t items = 0, cells;
    for (int64_t p = 0; p < count; p++) {
        (void)visibility_places_cells(places, p, &cells);
        items += places->nodes ? 1 : cells;
    }
    RETURN_IF_ERROR(NEW_ARRAY(ptr, count + 1, error));
    RETURN_IF_ERROR(NEW_ARRAY(item, items, error));
    *within = (struct visibility_places){.nodes = places->nodes};
    if (places->nodes) {
        within->node = *item;
    } else if (places->cell != NULL) {
        within->cell = *item;
        within->ptr = *ptr;
        within->points_per_row = 1;
    }
    items = 0;
    for (int64_t p = 0; p < count; p++) {
        const int32_t *cell = visibility_places_cells(places, p, &cells);
        for (int64_t k = 0; k < cells; k++) {
            bool whole = side[p] == space->side_count;
            if (cell[k] >= 0 && (whole || space->cell_side[cell[k]] == side[p])) {
                (*item)[items++] = whole ? cell[k] : space->place[cell[k]];
            }
        }
        (*ptr)[p + 1] = items;
    }
    for (int64_t n = 0; n < count && places->nodes; n++) {
        (*item)[n] = (int32_t)n;
    }
    for (int32_t s = 0; s < space->side_count && places->nodes; s++) {
        for (int64_t n = 0; n < space->side[s].node_count; n++) {
            int32_t node = space->side[s].node[n];
            (*item)[node] = side[node] == s ? (int32_t)n : (*item)[node];
        }
    }
    return STATUS_OK;
}

/* The lists of points on their sides. */
struct sided {
    const struct support_space *space;
    const struct visibility_places *places;
    int64_t count;
    int32_t *side; /* count */
    int64_t body_count;
    struct support_body *body; /* the sides, and the whole */
};

static enum status build_sided(const struct support_options *options, const struct sided *sided,
                               const double *x, const char *what, bool *unserved, struct support_lists *lists,
                               struct error *error)
{
    struct visibility_places within;
    SCRATCH int64_t *ptr = NULL;
    SCRATCH int32_t *item = NULL;
    RETURN_IF_ERROR(
        places_on_sides(sided->space, sided->places, sided->count, sided->side, &ptr, &item, &within, error));
    return support_build_among(options, sided->body_count, sided->body, sided->side, &within, sided->count, x,
                               what, unserved, lists, error);
}

static enum status lists_of_sides(const struct support_options *options, const struct support_space *space,
                                  const struct visibility_places *places, int64_t count, const double *x,
                                  const char *what, struct support_lists *lists, struct error *error)
{
    FREED_BY(free_side) struct support_side whole = {.node_count = space->cells.node_count};
    bool all_served = true;
    NEW_SCRATCH(bool, unserved, count, error);
    NEW_SCRATCH(int32_t, side, count, error);
    NEW_SCRATCH(struct support_body, body, space->side_count + 1, error);
    struct sided sided = {space, places, count, side, space->side_count, body};
    if (places->nodes) {
        sides_of_nodes(space, count, side);
    } else {
        sides_of_cells(space, places, count, side);
    }
    RETURN_IF_ERROR(locate_sides(space, count, x, side, error));
    for (int64_t s = 0; s < sided.body_count; s++) {
        const struct support_side *of = &space->side[s];
        body[s] = (struct support_body){&of->grid, &of->visibility, of->node};
    }
    RETURN_IF_ERROR(build_sided(options, &sided, x, what, unserved, lists, error));
    for (int64_t p = 0; p < count; p++) {
        side[p] = unserved[p] ? (int32_t)space->side_count : side[p];
        all_served = all_served && !unserved[p];
    }
    if (all_served) {
        return STATUS_OK;
    }
    support_free(lists);
    RETURN_IF_ERROR(index_side(space, &whole, error));
    body[sided.body_count++] = (struct support_body){&whole.grid, &whole.visibility, NULL};
    return build_sided(options, &sided, x, what, NULL, lists, error);
}

enum status support_space_lists(const struct support_options *options, const struct support_space *space,
                                const struct visibility_places *places, int64_t count, const double *x,
                                const char *what, struct support_lists *lists, struct error *error)
{
    static const struct visibility_places unknown = {0};
    const struct support_side *side = &space->side[0];
    if (side->node != NULL) {
        return lists_of_sides(options, space, places != NULL ? places : &unknown, count, x, what, lists,
                              error);
    }
    return support_build(options, &side->grid, space->by_cells ? &side->visibility : NULL, places, count, x,
                         what, lists, error);
}
