/* Nodes that are visible from a point, or connected to it, through the cells of the body, so that supports do
 * not act across gaps.
 *
 * A node is visible from a point if the straight segment between them stays within the cells, passing from
 * face to face (visibility: Belytschko, Lu and Gu 1994). Around a re-entrant corner the distance is the
 * length of the shortest path through the body (diffraction: Organ, Fleming, Terry and Belytschko 1996). It
 * is a continuous function of the point, and so are the weights. A node is not a neighbour if every path to
 * it is longer than its support radius. Paths bend at re-entrant nodes, in 3D also within re-entrant edges.
 * Nodes of other connected bodies are none, also where bodies touch or overlap a little.
 * Cells that share only a node are not connected by it; the node itself sees what each of these cells
 * sees. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/points/point_grid.h"

/* The neighbours among the nodes within their radius: if there are cells, those visible or connected through
 * these; or all. */
enum visibility_rule { VISIBILITY_CELLS, VISIBILITY_DISTANCE, VISIBILITY_RULE_COUNT };

/* Names for command lines and headers: "cells", "distance". */
extern const char *const visibility_names[VISIBILITY_RULE_COUNT];

/* A facet of the boundary in the plane normal . x = offset; the body is on the side of lower values. */
struct visibility_facet {
    int32_t node[3], cell;
    double normal[3], offset;
    double dual[2][3], from[2]; /* dual . x - from: the second and third barycentric coordinates of x */
    double middle[3], radius;   /* of a ball around it */
};

/* A facet that may hide a node from points of its support: the node is beyond the facet, or on it but not a
 * node of it. */
struct visibility_shadow {
    int32_t facet, node;
};

/* The cells and the grid are the caller's and must outlive this. */
struct visibility {
    struct cells cells;
    const struct point_grid *grid;
    int32_t *across;   /* cells_across */
    int32_t *part;     /* node_count: see nodes_parts; NULL: there is one body */
    int64_t *star_ptr; /* node_count + 1: the cells at each node (CSR) */
    int32_t *star;
    int64_t facet_count;
    struct visibility_facet *facet;
    int64_t shadow_count, shadow_capacity;
    struct visibility_shadow *shadow; /* by facets, ascending */
    bool *shadowed;                   /* node_count: whether there are shadows of the node */
    bool *corner;                     /* node_count: paths may bend there */
    int64_t *edge_ptr; /* node_count + 1: 3D: the other ends of the re-entrant edges at each node (CSR) */
    int32_t *edge;
    int64_t *seen_ptr; /* node_count + 1: the corners within its radius from which a node is visible (CSR) */
    int32_t *seen;
    double *seen_length; /* for each of `seen`: the distance, m */
    int64_t
        *hidden_ptr; /* node_count + 1: the nodes nearer than their radius that are hidden from each node */
    int32_t *hidden;
};

/* Errors: STATUS_INPUT for cells that share a face with more than one other; STATUS_SYSTEM (memory). */
MUST_CHECK enum status visibility_build(const struct cells *cells, const struct point_grid *grid,
                                        struct visibility *visibility, struct error *error);
/* Only `across` and the stars, for paths along edges (edge_paths.h). Errors as above. */
MUST_CHECK enum status visibility_build_cells(const struct cells *cells, struct visibility *visibility,
                                              struct error *error);
void visibility_free(struct visibility *visibility);

/* The cells that contain points. All members zero: not known; they are searched for. A point outside of all
 * cells sees what the nearest place in a cell sees; a point far from all cells sees all nodes near it. */
struct visibility_places {
    bool nodes;          /* point p is node p; */
    const int32_t *node; /* or, unless NULL, node[p]; */
    const int32_t *cell; /* else, unless NULL: one cell for each row of points, -1: none; */
    const int64_t *ptr;  /* or, unless NULL: the cells of row r are cell[ptr[r]] to before cell[ptr[r + 1]] */
    int64_t points_per_row; /* of the first long_rows rows; the others have one point */
    int64_t long_rows;      /* 0: all rows */
};

/* The row of point p; *first: the first point of the row. */
static inline int64_t visibility_places_row(const struct visibility_places *places, int64_t p, int64_t *first)
{
    int64_t row = p / places->points_per_row, rest = p - places->long_rows * places->points_per_row;
    if (places->long_rows > 0 && rest >= 0) {
        *first = p;
        return places->long_rows + rest;
    }
    *first = row * places->points_per_row;
    return row;
}

/* The known cells of point p, *count of them. */
static inline const int32_t *visibility_places_cells(const struct visibility_places *places, int64_t p,
                                                     int64_t *count)
{
    *count = 0;
    if (places->nodes || places->cell == NULL) {
        return NULL;
    }
    int64_t unused, row = visibility_places_row(places, p, &unused);
    int64_t first = places->ptr != NULL ? places->ptr[row] : row;
    *count = (places->ptr != NULL ? places->ptr[row + 1] : row + 1) - first;
    return places->cell + first;
}

/* The shadows that may contain each of some points (CSR): the number s in visibility->shadow, or ~s if the
 * shadow certainly does. */
struct visibility_shadows {
    int64_t *ptr;
    int32_t *shadow;
};
/* Find the shadows for the points x[count * dim]; with body_of[count], unless NULL, only for the points of
 * body number `body`. */
MUST_CHECK enum status visibility_shadows_build(const struct visibility *visibility, int64_t count,
                                                const double *x, const int32_t *body_of, int32_t body,
                                                struct visibility_shadows *shadows, struct error *error);
void visibility_shadows_free(struct visibility_shadows *shadows);

/* Scratch space for one thread, all zero at first; grows on demand. */
struct visibility_work {
    int64_t point;   /* number of the current point, */
    int64_t node;    /* the node at which it is, or -1, */
    const double *x; /* and its coordinates */
    double from[3];  /* the point itself, or the nearest place in a cell for a point outside */
    bool outside;
    const int32_t *cell;       /* the cells that contain the point */
    int64_t cell_count;        /* -1: not searched for yet */
    struct index_list own;     /* storage for `cell` */
    uint32_t serial;           /* of the point */
    uint32_t *mark;            /* node_count: 2 serial, or 2 serial + 1 for a hidden node */
    double *length;            /* node_count: of the shortest path found so far; infinite: none */
    int32_t *before;           /* the previous node on that path; -1: the point itself */
    struct index_list reached; /* nodes for which the last search for paths may have set a length */
    struct index_list hidden, stack, visited;
    int64_t changed; /* number of candidates of the last filter that were hidden */
    int64_t around;  /* number of neighbours of the last filter that are seen around corners */
    int64_t image_room;
    double *image; /* offsets from the point to the images of the neighbours, see mls_support */
};
void visibility_work_free(struct visibility_work *work);

/* Set the current point: point p, at x. */
MUST_CHECK enum status visibility_begin(const struct visibility *visibility,
                                        const struct visibility_places *places, int64_t p, const double *x,
                                        struct visibility_work *work, struct error *error);

/* Of the candidates index[*count], nodes nearer than `widen` times their radius, keep those whose shortest
 * path is also shorter than that. If work->around > 0, work->image[*count * dim] holds the offset to each: to
 * a visible node itself; to others along the first leg of the path, with the length of the path. If the
 * points are nodes, `shadows` may be empty. */
MUST_CHECK enum status visibility_filter(const struct visibility *visibility,
                                         const struct visibility_shadows *shadows, double widen,
                                         int32_t *index, int64_t *count, struct visibility_work *work,
                                         struct error *error);
