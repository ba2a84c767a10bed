/* The stages between a node cloud and a table of shape functions, on a stream: each adds its sections, and
 * removes those that were made from what it replaces. */
#pragma once

#include "stages/views.h"

#include "approx/adaptive/adaptive.h"
#include "approx/support/support.h"

/* How ipoints places integration points. */
struct ipoints_options {
    bool smoothed;    /* one point per cell, gradients smoothed over the cell */
    int gauss_points; /* else: points per cell */
    bool adaptive;    /* else: cells subdivided; `refinement` says how */
    struct adaptive_options refinement;
    bool given_radius;  /* the radius or factor of refinement.support was given; else the stream's radii are
                           used, if any */
    int64_t lattice[3]; /* else, when lattice[0] > 0: a regular lattice of evaluation points over the box of
                           the nodes, of so many along each axis; with zeros behind the first number, that
                           many along all axes */
};
struct ipoints_options ipoints_defaults(void);

/* Add the sections of ipoints: points.*, faces, faces.cell, facepoints.x (lib/README.md). *unresolved counts
 * the cells that are too coarse even at the last level of adaptive integration. */
MUST_CHECK enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options,
                                     int64_t *unresolved, struct error *error);

/* radius[node_count] as support would choose them: constant, or a factor times the local spacing, which is
 * that of the cells where there are any. */
MUST_CHECK enum status stage_radii(const struct stream *stream, const struct support_options *options,
                                   int64_t node_count, const double *x, double *radius, struct error *error);

/* Statistics of one of the lists of support, */
struct list_report {
    const char *what; /* "points on faces" */
    int64_t points, pairs, fewest, most, widened;
    int64_t around; /* pairs that see each other around corners */
    double widest;
};

/* and for all. */
struct support_report {
    enum visibility_rule visibility; /* by distance also where there are no cells */
    int lists;
    struct list_report list[3];
};

/* side[cells], allocated: the position of each cell's region in the comma-separated list of names, or the
 * number of names. Errors: a region that is not there, or stands twice; no cells. */
MUST_CHECK enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                                        struct error *error);

/* For a part of a body (part.node): set owner and part of the options, so that supports of points that belong
 * to other parts do not stop at interfaces. */
MUST_CHECK enum status stage_own_part(const struct stream *stream, int64_t node_count,
                                      struct support_options *options, struct error *error);

/* Add the sections of support: support.radius, support.side where options->side is given, and the lists nbr,
 * facepoint and node. With sides faces.row and facepoints.x are made again, as faces at interfaces have their
 * own points; so they are without sides where the stream had some. */
MUST_CHECK enum status stage_support(struct stream *stream, const struct support_options *options,
                                     struct support_report *report, struct error *error);

/* Add the sections of shapefn: face.*, or shape.phi and shape.dphi; boundary.*, node.phi (lib/README.md). */
MUST_CHECK enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error);

/* The settings recorded with the radii of supports. */
struct recorded {
    struct support_options support; /* what the lists are made with; radius and factor are the defaults' */
    struct mls shapes;              /* what the shape functions are made with, if it is not support.mls */
};

/* A view of PREFIX.side, the sides of interfaces that supports stop at; NULL: the stream has none. */
MUST_CHECK enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                                   struct error *error);

/* The settings from the attributes of PREFIX.radius, and a view of PREFIX.side, where it exists, as
 * recorded->support.side. Settings that are not recorded are those of support_defaults(). */
MUST_CHECK enum status stage_recorded(const struct stream *stream, const char *prefix, int dim,
                                      struct recorded *recorded, struct error *error);

/* Put radius[node_count] as support.radius, with the settings. */
MUST_CHECK enum status stage_record(struct stream *stream, const struct recorded *recorded,
                                    int64_t node_count, const double *radius, struct error *error);
