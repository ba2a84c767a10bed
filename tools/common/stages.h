/* The stages between a node cloud and a table of shape functions, on a stream. Each tool of that name runs
 * its stage; a later tool that finds an earlier stage's sections missing runs that stage's defaults itself.
 */
#ifndef TOOLS_STAGES_H
#define TOOLS_STAGES_H

#include "tool.h"

#include "approx/adaptive.h"
#include "approx/cells.h"
#include "approx/shape.h"
#include "approx/support.h"

/* How ipoints places integration points. */
struct ipoints_options {
    bool conforming;  /* one point per cell, gradients smoothed over the cell */
    int gauss_points; /* else: points per cell */
    bool adaptive;    /* else: cells subdivided; `refinement` says how */
    struct adaptive_options refinement;
    bool given_radius; /* refinement.support's radius or factor was asked for: else the stream's radii, if any
                        */
    int64_t lattice[3]; /* else, when lattice[0] > 0: a regular lattice of evaluation points over the nodes'
                           box */
};
struct ipoints_options ipoints_defaults(void);

/* Nodes and background cells of a stream, in view. cells->count is 0 when there are none. */
MUST_CHECK enum status stream_cells(const struct stream *stream, bool needed, struct cells *cells,
                                    struct error *error);

/* A CSR list of a stream, in view and checked: PREFIX.ptr (rows + 1), PREFIX.idx (within [0, columns)). */
MUST_CHECK enum status stream_neighbours(const struct stream *stream, const char *prefix, int64_t rows,
                                         int64_t columns, struct neighbours *lists, struct error *error);

/* Node coordinates, checked to be finite. */
MUST_CHECK enum status stream_nodes(const struct stream *stream, int *dim, int64_t *node_count,
                                    const double **x, struct error *error);

/* Attributes of a section of one vector in each row, "unit=UNIT cols=x,y[,z]", into text[64]; returns it. */
const char *vector_attributes(int dim, const char *unit, char text[64]);

/* Add the sections of ipoints: points.*, faces, faces.cell, facepoints.* (lib/README.md). *unresolved counts
 * the cells that are too coarse even at the last level of adaptive integration. */
MUST_CHECK enum status stage_ipoints(struct stream *stream, const struct ipoints_options *options,
                                     int64_t *unresolved, struct error *error);

/* radius[node_count] as support would choose them: constant, or a factor times the local spacing, which is
 * that of the cells where there are any. */
MUST_CHECK enum status stage_radii(const struct stream *stream, const struct support_options *options,
                                   int64_t node_count, const double *x, double *radius, struct error *error);

/* What support found, for each of its lists. */
struct support_report {
    int lists;
    struct {
        const char *what; /* "points on faces" */
        int64_t points, pairs, fewest, most, widened;
        double widest;
    } list[3];
};

/* Add the sections of support: support.radius, and the lists nbr, face and node. */
MUST_CHECK enum status stage_support(struct stream *stream, const struct support_options *options,
                                     struct support_report *report, struct error *error);

/* Add the sections of shapefn: shape.phi, shape.dphi, face.phi, node.phi. */
MUST_CHECK enum status stage_shapefn(struct stream *stream, const struct mls *mls, struct error *error);

/* The MLS settings that support recorded in the stream; mls_default() where it recorded none. */
MUST_CHECK enum status stage_recorded_mls(const struct stream *stream, int dim, struct mls *mls,
                                          struct error *error);

/* Run the defaults of every stage up to shapefn whose sections are missing, saying so once on standard error
 * and adding the provenance of the stages run. `upto` is "ipoints", "support" or "shapefn". Exits on failure.
 */
void stage_fill(const struct tool *tool, struct stream *stream, const char *upto);

#endif
