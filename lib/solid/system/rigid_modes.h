/* Rigid-body modes that the conditions of a system leave free. */
#pragma once

#include "solid/system/system.h"

/* The rigid motions of a part that violate no condition; along the normals of curved sides, none but by what
 * the facets deviate from a surface. Springs of measured points count as conditions, contacts do not. */
struct rigid_modes {
    double centre[3];     /* of the box of its nodes, m */
    int translations;     /* number of free translations, */
    double along[3][3];   /* and orthonormal directions of these */
    int turns;            /* number of further free rotations, */
    double through[3][3]; /* a point on the axis of each, in 2D the centre, m, */
    double axis[3][3];    /* and in 3D the axes, orthogonal unit vectors */
};

/* Indifferent rotations: free ones that map the surface of a part onto itself, but for what its facets
 * deviate from a round one. Set system->turns to those of the parts with alike[part_count] > 0. surface: all
 * faces on the boundary, with their averages; per_face: points of a face. STATUS_SYSTEM: memory. */
MUST_CHECK enum status system_find_turns(struct solid_system *system, int32_t part_count, const int32_t *part,
                                         const int32_t *alike, const struct facet_set *surface, int per_face,
                                         const struct boundary_averages *averages, struct error *error);

/* modes[part_count]: the free rigid modes of each part; part[node_count]: the part of each node. No condition
 * is on nodes of two parts. STATUS_SYSTEM: memory. */
MUST_CHECK enum status system_rigid_modes(const struct solid_system *system, int32_t part_count,
                                          const int32_t *part, struct rigid_modes *modes,
                                          struct error *error);
