/* Support domains: the radius R_j of each node, and the neighbour lists of points, equation (1) of
 * lib/README.md. */
#pragma once

#include "approx/mls/mls.h"
#include "approx/points/point_grid.h"
#include "approx/visibility/visibility.h"

struct support_options {
    double radius;         /* constant support radius, m; 0: factor times the local spacing */
    double factor;         /* support radius / local node spacing */
    int64_t least, most;   /* neighbours: widen until there are `least`; keep the `most` nearest (0: all) */
    bool widen;            /* widen where the moment matrix is ill-conditioned or a gradient too large */
    double gradient_bound; /* largest |grad phi| h admitted, h the mean spacing within the support */
    enum visibility_rule visibility; /* whether neighbours must be visible through the cells */
    struct mls mls;                  /* the shape functions for which the lists are made */
    const int32_t *side; /* of each cell: its side of the interfaces at which supports stop; NULL: none */
};

/* Radii of 1.8 times the local spacing, in 3D 2 times; with widening, and the default MLS. */
struct support_options support_defaults(int dim);

/* Points whose gradients exceed their bound. */
struct steep_points {
    int64_t count;
    int64_t point;    /* the worst one, of equals the first, */
    double steepness; /* and its largest |grad phi| times the spacing */
};

/* Neighbour lists of `count` points (CSR); of a view of lists elsewhere only the first four. */
struct neighbours {
    int64_t count;
    int64_t *ptr;    /* count + 1 */
    int32_t *idx;    /* ptr[count] node indices, ascending within a point */
    double *widen;   /* count: factor on the radii, >= 1 */
    int32_t *side;   /* count: the side from which supports are seen, or -1; NULL where they have no sides */
    int64_t widened; /* how many points needed widening */
    double widest;   /* the largest factor */
    struct steep_points steep;
    int64_t fewest, most; /* neighbours of a point; 0 without points */
};

/* spacing[node_count], m: mean distance to the 2 dim nearest other nodes, for clouds without cells (with
 * cells: cells_node_spacing). */
MUST_CHECK enum status nodes_spacing(int dim, int64_t node_count, const double *x, double *spacing,
                                     struct error *error);

void supports_free(struct supports *made);

/* *made: the supports of the nodes of cells. They are balls, and longer where the
 * cells around the node are: T is the mean of x (x) x over the edges of these cells, with eigenvalues t_1 >=
 * t_i. A has the eigenvectors of T, and the squares of its eigenvalues are max(1, t_1 / t_i - 3 dim + 1), at
 * most those of supports that are 32 times as long as wide. Of a lattice of cubes that are cut along one
 * diagonal t_1 / t_i is 4, in 2D 3. The spacing by which the radii are set is that of the cells in lengths |A
 * edge|, and a little more where A is not 1. A flat lattice becomes one of equilateral triangles, whose
 * second neighbours, at 3^(1/2) spacings, must not be just outside of supports of 1.8.
 *
 * On an interface where cells are flat each side has the supports that it has alone: a layer within a body
 * must not have wider ones than by itself. With a constant radius all are balls. */
MUST_CHECK enum status support_sizes(const struct support_options *options, const struct cells *cells,
                                     struct supports *made, struct error *error);

/* radius[node_count], m, from the options and the local spacing. */
MUST_CHECK enum status support_radii(const struct support_options *options, int64_t node_count,
                                     const double *spacing, double *radius, struct error *error);

/* The neighbour lists of points x[count * dim] in the cells of `places` (NULL: not known), by the rule and
 * the sides of `visibility`; `what` names these in messages. Points that have no good support on their side
 * of the interfaces, e.g. in a sliver, see the whole body. Threaded; the result does not depend on the number
 * of threads. Widening ends at eightfold: gradients may exceed their bound then, as little as any of these
 * radii lets them (lists->steep). STATUS_VERDICT, naming the point, if no moment matrix is well-conditioned;
 * without options->widen the shape functions report that. STATUS_INPUT for coordinates that are not finite.
 */
MUST_CHECK enum status support_build(const struct support_options *options,
                                     const struct visibility *visibility,
                                     const struct visibility_places *places, int64_t count, const double *x,
                                     const char *what, struct neighbours *lists, struct error *error);
void support_free(struct neighbours *lists);

/* Print "(x, y[, z])" of a point into text[96], for messages; returns text. POINT_TEXT: a text that lasts as
 * long as the block. */
const char *point_text(int dim, const double *x, char text[96]);
#define POINT_TEXT(dim, x) point_text((dim), (x), (char[96]){""})
