/* The stages between a node cloud and a table of shape functions, on a stream: each adds its sections, and
 * removes those that were made from what it replaces. STATUS_INPUT for sections that are missing or do not
 * fit. */
#pragma once

#include "stages/views.h"

#include "approx/adaptive/adaptive.h"
#include "approx/field/field.h"

/* How ipoints places integration points; by default for smoothed cells. */
struct ipoints_options {
    bool smoothed;    /* one point per cell, gradients smoothed over the cell */
    int gauss_points; /* else: points per cell */
    bool adaptive;    /* else: adaptively subdivided cells, see `refinement` */
    struct adaptive_options refinement;
    bool given_radius;  /* use the radius or factor of refinement.support; else the stream's radii, if any */
    int64_t lattice[3]; /* else, if lattice[0] > 0: a regular lattice of evaluation points over the box of the
                           nodes, with this number along each axis */
};

/* Add the sections of ipoints: points.*, faces, faces.cell, facepoints.x (lib/README.md). *unresolved counts
 * the cells that are too coarse even at the last level of adaptive integration. */
MUST_CHECK enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options,
                                     int64_t *unresolved, struct error *error);

/* The supports as the stage `support` sets them: constant balls, or a factor times the local spacing, by
 * support_sizes if there are cells. */
MUST_CHECK enum status stage_sizes(const struct stream *stream, const struct support_options *options,
                                   int64_t node_count, const double *x, struct supports *sizes,
                                   struct error *error);

/* Statistics of one of the lists of `support`, */
struct list_report {
    const char *what; /* "points on faces" */
    int64_t pairs;
    struct neighbours lists; /* without its arrays */
    char steepest[96];       /* the place of the worst of lists.steep */
};

/* and of all lists. */
struct support_report {
    enum visibility_rule visibility; /* VISIBILITY_DISTANCE if there are no cells */
    int lists;
    struct list_report list[3];
};

/* (*side)[cells], to be freed: the position of each cell's region in the comma-separated list of names; the
 * number of names for regions not in it. STATUS_INPUT for an unknown or repeated region, or no cells. With
 * names NULL the region of each cell; *side is NULL if there are no two regions. */
MUST_CHECK enum status stage_interfaces(const struct stream *stream, const char *names, int32_t **side,
                                        struct error *error);

/* Add the sections of support: those of stage_record, support.side where options->side is given, and the
 * lists nbr, facepoint and node. */
MUST_CHECK enum status stage_support(struct stream *stream, const struct support_options *options,
                                     struct support_report *report, struct error *error);

/* A step of these stages: facepoints.x from the faces. */
MUST_CHECK enum status stage_face_points(struct stream *stream, struct error *error);

/* Make the lists and the sections of shapefn again, with the recorded settings and these sides of the
 * cells. */
MUST_CHECK enum status stage_renew(struct stream *stream, const int32_t *side, struct error *error);

/* Add the sections of shapefn: edge.*, or shape.phi and shape.dphi; boundary.*, node.phi (lib/README.md). */
MUST_CHECK enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error);

/* The options of the shape functions as text; NULL: not given. `mu` is one value or one for each second-order
 * monomial (3 in 2D: x2,xy,y2; 6 in 3D: x2,xy,xz,y2,yz,z2). With mls->dim 0, the dimension is not known yet,
 * and either number is accepted. */
struct mls_texts {
    const char *basis, *weight, *mu, *mu_unit;
};
MUST_CHECK enum status mls_apply(const struct mls_texts *texts, struct mls *mls, struct error *error);

/* A view of PREFIX.side, the sides of interfaces at which supports stop; NULL: the stream has none. */
MUST_CHECK enum status stage_sides(const struct stream *stream, const char *prefix, const int32_t **side,
                                   struct error *error);

/* Views of PREFIX.radius, PREFIX.stretch and PREFIX.sides, the settings from the attributes, and a view of
 * PREFIX.side, if it exists, as recorded->support.side. Settings that are not recorded are those of
 * support_defaults(). PREFIX is support; or parameters, for the field that mtled computed. */
MUST_CHECK enum status stage_recorded(const struct stream *stream, const char *prefix,
                                      struct field_shapes *recorded, struct error *error);

/* Put the supports of the nodes as support.radius, support.stretch and support.sides, with the settings. */
MUST_CHECK enum status stage_record(struct stream *stream, const struct field_shapes *recorded,
                                    int64_t node_count, struct error *error);

/* The field that mtled computed is u_h(x) = sum_j phi_j(x) d_j. Its results hold the parameters d_j in the
 * sections parameters and parameters.frame.K, and the supports of phi_j in parameters.radius,
 * parameters.stretch and parameters.sides, as `recorded`.
 * The section to evaluate for a field: for u and u.frame.K their parameters, if they exist and fit; else the
 * field itself, whose values are taken as parameters. */
const struct section *solved_parameters(const struct stream *stream, const struct field_shapes *recorded,
                                        const struct section *field);

/* Whether a section contains parameters, so that it is not a field itself. */
bool solved_is_parameters(const struct section *section);

/* Set the first part of *input, up to cell_side, as views of the cloud and the tables of shape functions in
 * the stream, and complete it (assembly_complete). */
struct assembly;
MUST_CHECK enum status stage_tables(const struct stream *stream, struct assembly *input, struct error *error);

/* Check every section that is in the table of sections. First each by itself: type, columns, rows and
 * numbers. If these are right, sections together: positive volumes of cells, groups, faces, ascending lists,
 * partition of unity within 1e-9. Violations, of which only the first one of a section is told, are added as
 * lines, "section: row: what". Absent sections are no violation. STATUS_SYSTEM: memory. */
MUST_CHECK enum status stream_check(const struct stream *stream, struct names *violations,
                                    struct error *error);
