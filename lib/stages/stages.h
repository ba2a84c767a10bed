/* The stages between a node cloud and a table of shape functions, on a stream: each adds its sections, and
 * removes those that were made from what it replaces. */
#pragma once

#include "stages/views.h"

#include "approx/adaptive/adaptive.h"
#include "approx/support/support.h"

/* How ipoints places integration points; by default for smoothed cells. */
struct ipoints_options {
    bool smoothed;    /* one point per cell, gradients smoothed over the cell */
    int gauss_points; /* else: points per cell */
    bool adaptive;    /* else: adaptively subdivided cells, see `refinement` */
    struct adaptive_options refinement;
    bool given_radius;  /* use the radius or factor of refinement.support; else the stream's radii, if any */
    int64_t lattice[3]; /* else, if lattice[0] > 0: a regular lattice of evaluation points over the box of the
                           nodes, with this number along each axis; with zeros behind the first number, along
                           all axes */
};

/* Add the sections of ipoints: points.*, faces, faces.cell, facepoints.x (lib/README.md). *unresolved counts
 * the cells that are too coarse even at the last level of adaptive integration. */
MUST_CHECK enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options,
                                     int64_t *unresolved, struct error *error);

/* radius[node_count] as the stage `support` sets them: constant, or a factor times the local spacing, that of
 * the cells if there are any. */
MUST_CHECK enum status stage_radii(const struct stream *stream, const struct support_options *options,
                                   int64_t node_count, const double *x, double *radius, struct error *error);

/* Statistics of one of the lists of `support`, */
struct list_report {
    const char *what; /* "points on faces" */
    int64_t points, pairs, fewest, most, widened;
    int64_t around; /* pairs that see each other around corners */
    double widest;
};

/* and of all lists. */
struct support_report {
    enum visibility_rule visibility; /* VISIBILITY_DISTANCE if there are no cells */
    int lists;
    struct list_report list[3];
};

/* (*side)[cells], to be freed: the position of each cell's region in the comma-separated list of names; the
 * number of names for regions not in it. STATUS_INPUT for an unknown or repeated region, or no cells. */
MUST_CHECK enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                                        struct error *error);

/* For a part of a body (part.node): set owner and part of the options, so that supports of other parts'
 * points do not stop at interfaces. */
MUST_CHECK enum status stage_own_part(const struct stream *stream, int64_t node_count,
                                      struct support_options *options, struct error *error);

/* Add the sections of support: support.radius, support.side where options->side is given, and the lists nbr,
 * facepoint and node. */
MUST_CHECK enum status stage_support(struct stream *stream, const struct support_options *options,
                                     struct support_report *report, struct error *error);

/* Add the sections of shapefn: edge.*, or shape.phi and shape.dphi; boundary.*, node.phi (lib/README.md). */
MUST_CHECK enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error);

/* The settings recorded with the radii of supports. */
struct recorded {
    struct support_options support; /* of the lists; radius and factor are the defaults */
    struct mls shapes;              /* of the shape functions, if different from support.mls */
};

/* A view of PREFIX.side, the sides of interfaces at which supports stop; NULL: the stream has none. */
MUST_CHECK enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                                   struct error *error);

/* The settings from the attributes of PREFIX.radius, and a view of PREFIX.side, if it exists, as
 * recorded->support.side. Settings that are not recorded are those of support_defaults(). */
MUST_CHECK enum status stage_recorded(const struct stream *stream, const char *prefix, int dim,
                                      struct recorded *recorded, struct error *error);

/* Put radius[node_count] as support.radius, with the settings. */
MUST_CHECK enum status stage_record(struct stream *stream, const struct recorded *recorded,
                                    int64_t node_count, const double *radius, struct error *error);
