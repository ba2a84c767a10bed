/* Nodes that are visible from a point through the cells of the body, so that supports do not act across gaps.
 *
 * A node is visible from a point if the straight segment between them stays within the cells, passing from
 * face to face (visibility: Belytschko, Lu and Gu 1994); so nodes of other connected bodies never are, also
 * where bodies touch or overlap a little. Cells that share only a node are not connected by it; the node
 * itself sees what each of these cells sees. A neighbour is visible, or it is so from a node of the
 * point's cells by way of which the path is hardly longer than straight: along a concave side few are
 * missing. If cells have sides, a point sees the nodes of its own side only, through the cells of that. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/points/point_grid.h"
#include "approx/points/supports.h"

/* The neighbours among the nodes within their radius: if there are cells, those visible through these; or
 * all. */
enum visibility_rule { VISIBILITY_CELLS, VISIBILITY_DISTANCE, VISIBILITY_RULE_COUNT };

/* Names for command lines and headers: "cells", "distance". */
extern const char *const visibility_names[VISIBILITY_RULE_COUNT];

/* The nodes of a body with their support radii, and its cells. If cells have sides, a neighbour of a point is
 * a node of the cells on the point's side. So shape functions have a kink at an interface, like a
 * displacement where the stiffness jumps. Points of faces and nodes on an interface take the lowest of the
 * sides that meet there, so that the field has a single value there. The arrays of the cells, their sides and
 * the supports are the caller's and must outlive this. */
struct visibility {
    struct cells cells;
    struct supports supports;
    struct point_grid grid;   /* of the nodes with the largest radius of each; by distance, or without cells,
                                 there is nothing else */
    const int32_t *cell_side; /* of each cell: its side of the interfaces at which sight ends; NULL: none */
    int32_t *node_side;       /* of each node: the side, -1 on an interface; NULL without interfaces */
    int32_t *across;          /* cells_across */
    int64_t *star_ptr;        /* node_count + 1: the cells at each node (CSR) */
    int32_t *star;
    double *hidden_from; /* node_count: distance, m, from which on facets of the boundary or of an interface
                            may hide the node from a point on their side; infinite: none does */
};

/* supports: of all nodes; cell_side[count], or NULL. Errors: STATUS_INPUT for cells that share a face with
 * more than one other; STATUS_SYSTEM (memory). */
MUST_CHECK enum status visibility_build(const struct cells *cells, struct supports supports,
                                        enum visibility_rule rule, const int32_t *cell_side,
                                        struct visibility *visibility, struct error *error);
void visibility_free(struct visibility *visibility);

/* The cells that contain points. All members zero: not known; they are searched for. A point outside of all
 * cells sees what the nearest place in a cell sees; a point far from all cells sees all nodes near it, of the
 * first side if there are sides. */
struct visibility_places {
    bool nodes;          /* point p is node p; */
    const int32_t *cell; /* else, unless NULL: one cell for each row of points, -1 alone: none; */
    const int64_t *ptr;  /* or, unless NULL: the cells of row r are cell[ptr[r]] to before cell[ptr[r + 1]] */
    int64_t points_per_row; /* of the first long_rows rows; the others have one point */
    int64_t long_rows;      /* 0: all rows */
};

/* Scratch space for one thread, all zero at first; grows on demand. */
struct visibility_work {
    const double *x; /* the current point, */
    double from[3];  /* the same, or the nearest place in a cell for a point outside, */
    bool outside;
    const int32_t *cell; /* and the cells that contain it */
    int64_t cell_count;  /* -1: not searched for yet */
    int32_t side;        /* of these cells, the lowest; -1: sight does not end at interfaces */
    struct index_list own, stack, visited;
};
void visibility_work_free(struct visibility_work *work);

/* Set the current point: point p, at x. It sees its side of the interfaces, on one the lowest side; or the
 * whole body. */
MUST_CHECK enum status visibility_begin(const struct visibility *visibility,
                                        const struct visibility_places *places, int64_t p, const double *x,
                                        bool whole, struct visibility_work *work, struct error *error);

/* Of the candidates index[*count], nodes nearer than `widen` times their radius, keep the neighbours. */
MUST_CHECK enum status visibility_filter(const struct visibility *visibility, double widen, int32_t *index,
                                         int64_t *count, struct visibility_work *work, struct error *error);

/* *arrives: whether the segment from x to a node can be followed through faces of cells, starting in one of
 * the given cells, which contain x. */
MUST_CHECK enum status visibility_walk(const struct visibility *visibility, const double *x,
                                       const int32_t *cell, int64_t cell_count, int32_t node,
                                       struct visibility_work *work, bool *arrives, struct error *error);

/* Set the cells of `work` to those that contain x, or else to the nearest one and work->from to the nearest
 * place in it. Only cells at nodes whose supports contain x are searched; without such nodes there is no
 * cell. */
MUST_CHECK enum status visibility_locate(const struct visibility *visibility, const double *x,
                                         struct visibility_work *work, struct error *error);

/* ---- paths ---- */

/* Only `across` and the stars, for paths along edges. Errors as above. */
MUST_CHECK enum status visibility_build_cells(const struct cells *cells, struct visibility *visibility,
                                              struct error *error);

/* Places that are connected to a node, so that measured values do not act across gaps and slits.
 *
 * A place belongs to the node nearest to it. It is connected to another node when the straight segment
 * between the two nodes stays within the cells, or when the shortest path along edges of the cells is at most
 * twice as long as that segment. So places around a mild fold of the boundary are connected, the two faces of
 * a slit are not. */

/* The longest path that connects two places, by their distance. */
#define PATH_MOST_DETOUR 2.0

enum path_verdict { PATH_UNKNOWN, PATH_GOOD, PATH_NONE };

struct edge_paths {
    struct visibility visibility; /* its cells only */
    struct visibility_work work;
    int64_t place_count;
    int32_t *node;    /* place_count: the node to which each place belongs; -1: no node is in a cell */
    uint8_t *verdict; /* place_count, enum path_verdict: whether each place is connected to `from` */
    int32_t from;     /* the node; -1: none yet */
    double searched;  /* shortest paths from it are known up to this length, m; negative: none */
    double *length;   /* node_count: their lengths; infinite: longer */
};

/* place[place_count * stride], the first dim of each row, in units of `unit` m. The cells must outlive this.
 * Errors: STATUS_INPUT for cells that share a face with more than one other; STATUS_SYSTEM (memory). */
MUST_CHECK enum status edge_paths_build(const struct cells *cells, int64_t place_count, int64_t stride,
                                        const double *place, double unit, struct edge_paths *paths,
                                        struct error *error);
void edge_paths_free(struct edge_paths *paths);

/* Set the node `from`; the paths known so far are kept if it is the same as before. */
void edge_paths_begin(struct edge_paths *paths, int32_t from);

MUST_CHECK enum status edge_paths_reach(struct edge_paths *paths, int64_t place, bool *reached,
                                        struct error *error);
