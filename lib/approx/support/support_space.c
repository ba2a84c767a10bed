#include "approx/support/support_space.h"

enum status support_space_build(const struct support_options *options, const struct cells *cells,
                                const double *radius, struct support_space *space, struct error *error)
{
    *space = (struct support_space){.cells = *cells, .radius = radius};
    RETURN_IF_ERROR(point_grid_build(&space->grid, cells->dim, cells->node_count, cells->x, radius, error));
    return options->visibility == VISIBILITY_CELLS && cells->count > 0
               ? visibility_build(cells, options->side, &space->grid, &space->visibility, error)
               : STATUS_OK;
}

void support_space_free(struct support_space *space)
{
    visibility_free(&space->visibility);
    point_grid_free(&space->grid);
    *space = (struct support_space){0};
}

enum status support_space_lists(const struct support_options *options, const struct support_space *space,
                                const struct visibility_places *places, int64_t count, const double *x,
                                const char *what, struct support_lists *lists, struct error *error)
{
    return support_build(options, &space->grid, space->visibility.grid != NULL ? &space->visibility : NULL,
                         places, count, x, what, lists, error);
}
