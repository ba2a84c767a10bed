/* Cutting a cloud into parts of equal work with few nodes between them, by METIS (Karypis and Kumar 1998. A
 * fast and high quality multilevel scheme for partitioning irregular graphs. SIAM J. Sci. Comput.
 * 20:359-392), and what each part needs of the others. METIS rather than Scotch: one call on plain arrays, a
 * bound on the imbalance, the same result for the same graph and seed, and no global state. Every node has an
 * owner. A cell belongs to the part that owns most of its vertices; if several do, to the part that owns the
 * first of these vertices. A part evaluates its own cells and their faces, which needs the nodes whose
 * supports reach them (the halo). To compute the same supports and shape functions there as in the whole
 * body, it also needs all cells at these nodes, and the cells around those. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/points/point_grid.h"

/* The cells at each node (CSR), ascending; to be freed also on failure. */
struct cell_stars {
    int64_t *ptr; /* node_count + 1 */
    int32_t *cell;
};

MUST_CHECK enum status cell_stars_build(const struct cells *cells, struct cell_stars *stars,
                                        struct error *error);
void cell_stars_free(struct cell_stars *stars);

/* work[cells->count]: the number of nodes whose supports meet the box of each cell. The cost of evaluating
 * the cell is proportional to it. The grid has the nodes with the radii of their supports. Threaded. */
MUST_CHECK enum status partition_work(const struct cells *cells, const struct point_grid *grid, int32_t *work,
                                      struct error *error);

/* owner[node_count], 0 to parts - 1: parts of about equal work with few edges between them. The same for any
 * number of threads. STATUS_INPUT if there are fewer nodes than parts, or a part would have none. */
MUST_CHECK enum status partition_nodes(const struct cells *cells, const struct cell_stars *stars,
                                       const int32_t *work, int32_t parts, int32_t *owner,
                                       struct error *error);

/* The part to which a cell belongs. */
int32_t partition_cell_owner(const struct cells *cells, int64_t cell, const int32_t *owner);

/* A part of a body: global numbers, ascending. */
struct body_part {
    int64_t node_count, own_nodes;
    int32_t *node; /* node_count */
    int64_t cell_count, own_cells;
    int32_t *cell;  /* cell_count */
    int64_t needed; /* nodes of other parts whose supports reach its own cells: the most that an evaluation
                       exchanges */
    int64_t others; /* number of parts that own these */
    double work;    /* of its own cells */
};

/* Scratch of body_part_build for one thread, initially zero. */
struct body_part_work {
    int32_t *mark, *cell_mark, *part_mark;
    struct index_list near;
};
void body_part_work_free(struct body_part_work *work);

/* A body in parts. */
struct partition {
    const struct cells *cells;
    const struct cell_stars *stars;
    const struct point_grid *grid; /* the nodes with the radii of their supports */
    int32_t parts;
    const int32_t *owner; /* node_count */
    const int32_t *work;  /* cells->count */
    double widen;         /* largest factor by which supports will be widened, at least 1 */
};

/* own_ptr[parts + 1], own_cell[cells->count]: the cells of each part (CSR), ascending; to be freed, also on
 * failure. */
MUST_CHECK enum status partition_own_cells(const struct partition *partition, int64_t **own_ptr,
                                           int32_t **own_cell, struct error *error);

/* Build part number `part`, whose own cells are own_cell[count]; without cells_wanted `cell` is left out. */
MUST_CHECK enum status body_part_build(const struct partition *partition, int32_t part,
                                       const int32_t *own_cell, int64_t count, bool cells_wanted,
                                       struct body_part_work *work, struct body_part *body,
                                       struct error *error);
void body_part_free(struct body_part *body);
