/* The stages between a node cloud and a table of shape functions, on a stream: each adds its sections, and
 * removes those that were made from what it replaces. */
#pragma once

#include "stages/views.h"

#include "approx/adaptive.h"
#include "approx/support.h"

/* How ipoints places integration points. */
struct ipoints_options {
    bool smoothed;    /* one point per cell, gradients smoothed over the cell */
    int gauss_points; /* else: points per cell */
    bool adaptive;    /* else: cells subdivided; `refinement` says how */
    struct adaptive_options refinement;
    bool given_radius; /* refinement.support's radius or factor was asked for: else the stream's radii, if any
                        */
    int64_t lattice[3]; /* else, when lattice[0] > 0: a regular lattice of evaluation points over the nodes'
                           box; zeros behind the first: as that one along all axes */
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

/* What support found, for one of its lists, */
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

/* side[cells], allocated: the place of each cell's region in the list of names, with commas between, or
 * behind it. Errors: a region that is not there, or stands twice; no cells. */
MUST_CHECK enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                                        struct error *error);

/* Of a part of a body (part.node), whose each node is and which part it is, for support_options: where
 * supports stop at interfaces, those of what belongs to others do not. */
MUST_CHECK enum status stage_own_part(const struct stream *stream, int64_t node_count,
                                      struct support_options *options, struct error *error);

/* Add the sections of support: support.radius, support.side where options->side is given, and the lists nbr,
 * facepoint and node. With sides faces.row and facepoints.x are made anew, as faces at interfaces have points
 * of their own; likewise without, where there were sides before. */
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

/* As the stream's section of radii tells, PREFIX.radius, and PREFIX.side where there is one, whose view
 * recorded->support.side is; support_defaults() where there is none, or for what it does not tell. */
MUST_CHECK enum status stage_recorded(const struct stream *stream, const char *prefix, int dim,
                                      struct recorded *recorded, struct error *error);

/* Put radius[node_count] as support.radius, with the settings. */
MUST_CHECK enum status stage_record(struct stream *stream, const struct recorded *recorded,
                                    int64_t node_count, const double *radius, struct error *error);
