/* Analytic clouds of nodes in a box; those on a lattice have background cells. */
#pragma once

#include "base/status.h"

#include <stdint.h>

enum cloud_kind {
    CLOUD_REGULAR,  /* lattice, its ends on the faces of the box */
    CLOUD_JITTERED, /* the same, inner nodes moved at random */
    CLOUD_HALTON,   /* inner points of the Halton sequence */
    CLOUD_GRADED    /* lattice whose spacing grows geometrically along each axis, from the low end */
};

struct cloud_options {
    enum cloud_kind kind;
    int dim;                /* 2 or 3 */
    int64_t count[3];       /* nodes along each axis, at least 2; CLOUD_HALTON: count[0] nodes in all */
    double low[3], high[3]; /* the box, m; low < high */
    double jitter;          /* CLOUD_JITTERED: largest move along each axis, in spacings; 0 .. 0.5 */
    uint32_t seed;          /* CLOUD_JITTERED: of GSL's mt19937 */
    double ratio;           /* CLOUD_GRADED: largest over smallest spacing, at least 1 */
};

struct cloud {
    int dim;
    int64_t node_count;
    double *x; /* node_count x dim, m; lattices: x fastest */
    int64_t cell_count;
    int32_t *cells; /* cell_count x (dim + 1), positively oriented */
    int64_t facet_count;
    int32_t *facets;    /* facet_count x dim: the faces of the box, oriented outward */
    int32_t *facet_set; /* facet_count, ascending: 2 * axis, + 1 at the high end */
};

/* Make a cloud. The squares of a lattice are split into two triangles along the diagonal from low to high; in
 * a jittered lattice along the diagonal that gives the larger least area, so that all areas are positive for
 * jitter up to 0.5. Cubes are split into six tetrahedra (Kuhn); if jitter (above about 0.15) inverts one of
 * them, the cloud has neither cells nor facets. STATUS_INPUT for a box or counts out of range or more than
 * 2^31 - 1 nodes or cells. */
MUST_CHECK enum status cloud_make(const struct cloud_options *options, struct cloud *cloud,
                                  struct error *error);
void cloud_free(struct cloud *cloud);
