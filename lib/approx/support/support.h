/* Support domains: the radius R_j of each node, and the neighbour lists of points, equation (1) of
 * lib/README.md. */
#pragma once

#include "approx/mls/mls.h"
#include "approx/points/point_grid.h"
#include "approx/visibility/visibility.h"

struct support_options {
    double radius;         /* constant support radius, m; 0: factor times the local spacing */
    double factor;         /* support radius / local node spacing */
    int64_t least, most;   /* neighbours: widen until `least`; keep the `most` nearest (0: all) */
    bool widen;            /* widen where the moment matrix is unfit or a gradient too large */
    double gradient_bound; /* largest |grad phi| h admitted, h the mean spacing within the support */
    enum visibility_rule visibility; /* whether neighbours must be visible through the cells */
    const int32_t
        *side; /* with cells: the side of the interfaces that each cell is on, from 0; supports stop at
                  interfaces. NULL: no interfaces. Used by support_space.h; support_build ignores it */
    const int32_t *owner; /* with cells and sides: the part that each node belongs to (partition.h). */
    int32_t part;   /* Supports of points of other parts do not stop at interfaces, as the halo may hold too
                       little of a side. owner NULL: the whole body. support_build ignores both */
    struct mls mls; /* what the lists are for */
};

/* Factor 1.8 of the local spacing, in 3D 2; widening on, the default MLS. */
struct support_options support_defaults(int dim);

/* Neighbour lists of `count` points (CSR). */
struct support_lists {
    int64_t count;
    int64_t *ptr;         /* count + 1 */
    int32_t *idx;         /* ptr[count] node indices, ascending within a point */
    double *widen;        /* count: factor on the radii, >= 1 */
    int64_t widened;      /* how many points needed widening */
    double widest;        /* the largest factor */
    int64_t fewest, most; /* neighbours of a point; 0 without points */
    int64_t around_count; /* neighbours seen around corners (see struct around) */
    int64_t *around_pair;
    double *around_offset;
};

/* spacing[node_count], m: mean distance to the 2 dim nearest other nodes. For clouds without cells (with
 * them: cells_node_spacing). */
MUST_CHECK enum status nodes_spacing(int dim, int64_t node_count, const double *x, double *spacing,
                                     struct error *error);

/* radius[node_count], m, from the options and the local spacing. */
MUST_CHECK enum status support_radii(const struct support_options *options, int64_t node_count,
                                     const double *spacing, double *radius, struct error *error);

/* The lists of points x[count * dim]; `what` names them in messages. With `visibility` neighbours must be
 * visible through the cells, or connected around corners within their radius (visibility.h), and `places` are
 * the cells that the points lie in; with visibility NULL all nodes within their radius are neighbours.
 * Threads share the work; the result does not depend on their number. STATUS_VERDICT, naming the point, when
 * widening up to eightfold does not help; without options->widen unfit supports are left for the shape
 * functions to report. STATUS_INPUT for coordinates that are not finite. */
MUST_CHECK enum status support_build(const struct support_options *options, const struct point_grid *grid,
                                     const struct visibility *visibility,
                                     const struct visibility_places *places, int64_t count, const double *x,
                                     const char *what, struct support_lists *lists, struct error *error);

/* A body in which neighbours are searched. */
struct support_body {
    const struct point_grid *grid;
    const struct visibility *visibility; /* as above */
    const int32_t *node; /* the numbers of its nodes in the lists, ascending; NULL: their own */
};
/* The same for several bodies: the neighbours of point p are nodes of the body number body_of[p], or of the
 * first one where body_of is NULL. The places are nodes and cells of that body. */
MUST_CHECK enum status support_build_among(const struct support_options *options, int64_t body_count,
                                           const struct support_body *body, const int32_t *body_of,
                                           const struct visibility_places *places, int64_t count,
                                           const double *x, const char *what, struct support_lists *lists,
                                           struct error *error);
void support_free(struct support_lists *lists);

/* Print "(x, y[, z])" of a point into text[96], for messages. */
void point_text(int dim, const double *x, char text[96]);
