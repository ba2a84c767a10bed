/* Choosing nodes, facets and cells by their positions. */
#pragma once

#include "approx/cells/cells.h"

/* Nodes or points (corners = 1), segments (2), triangles (3), tetrahedra (4): facets or cells in dim
 * dimensions. */
struct items {
    int dim;
    int64_t count;
    int corners;
    const int32_t *item; /* count * corners: the places of their corners in x; of items_near and items_nearest
                            also NULL: one after the other */
    const double *x;
};

/* Parts of space; all contain their boundary. */
struct shape {
    enum shape_kind {
        SHAPE_BOX,  /* a: low corner, b: high corner */
        SHAPE_BALL, /* a: centre, size: radius */
        SHAPE_HALF, /* the side of the plane through a to which b points */
        SHAPE_PLANE /* within `size` of the plane through a with the normal b, on either side */
    } kind;
    double a[3], b[3];
    double size;
    double slack; /* points within this distance of the shape count as inside, m, for round-off */
};

/* chosen[items->count]: items whose centre lies in the shape; for SHAPE_PLANE items with all corners in
 * it. */
void items_in_shape(const struct items *items, const struct shape *shape, bool *chosen);

/* chosen[items->count]: facets (corners = dim) whose outward normal is within `degrees` of a direction. */
void items_facing(const struct items *items, const double *direction, double degrees, bool *chosen);

/* nearest[count]: the item nearest to each of points[count * dim], the first of several; -1: all are farther
 * than their reach[items->count], m, positive. */
MUST_CHECK enum status items_nearest(const struct items *items, const double *reach, int64_t count,
                                     const double *points, int64_t *nearest, struct error *error);

/* chosen[items->count]: items whose centre is within `reach` (positive, m) of one of the others. */
MUST_CHECK enum status items_near(const struct items *items, const struct items *others, double reach,
                                  bool *chosen, struct error *error);

/* Nodes that hang on a facet of another cell: they lie on it, but are not its corners, as where two meshes of
 * different fineness meet. The cells are not joined there. */

/* Nodes that hang, and the place of the first one, m. */
/* Where nodes do not join cells: how often, and the first place. A body are cells that common nodes connect.
 */
struct hanging_nodes {
    struct {
        int64_t count;
        double place[3];
    } joined, apart, twice, touching;
};

/* Find the nodes on the boundary that hang on facets of the boundary, joined: on a facet of their own body;
 * apart: on a facet of another body alone, or of another face of a slit: their own facet and the other are
 * among named[named_count * dim]. And the pairs of nodes at one place, to round-off, twice: of one body,
 * neither on a named facet; touching: of two bodies. Errors: as faces_build; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_hanging(const struct cells *cells, int64_t named_count,
                                          const int32_t *named, struct hanging_nodes *found,
                                          struct error *error);
