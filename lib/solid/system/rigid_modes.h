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

/* A second part to which a node belongs: both move it alike. */
struct joint {
    int32_t part, node;
};

/* modes[part_count]: the free rigid modes of each part, with any motions of the other parts.
 * part[node_count]: the part of each node; joint[joint_count]: nodes with a second part. A condition may
 * couple several parts. *complete: false if too many free motions are coupled; then some of the modes may not
 * be free. STATUS_SYSTEM: memory. */
MUST_CHECK enum status system_rigid_modes(const struct solid_system *system, int32_t part_count,
                                          const int32_t *part, int64_t joint_count, const struct joint *joint,
                                          struct rigid_modes *modes, bool *complete, struct error *error);

/* *has: whether the nodes, as one body, have a free rigid-body mode. STATUS_SYSTEM: memory. */
MUST_CHECK enum status system_has_rigid_mode(const struct solid_system *system, bool *has,
                                             struct error *error);
