/* Rigid-body modes that the conditions of a system leave free. */
#pragma once

#include "solid/system/system.h"

/* The rigid motions of a part that violate no condition. Contacts do not count; springs of measured points
 * count as conditions. */
struct rigid_modes {
    double centre[3];     /* of the box of its nodes, m */
    int translations;     /* the free ones, */
    double along[3][3];   /* orthonormal directions of them */
    int turns;            /* and free rotations beside them */
    double through[3][3]; /* a point of the axis of each, m; in 2D the point it turns about */
    double axis[3][3];    /* orthogonal unit vectors; in 2D not used */
};

/* Another part that a node is of: it moves with either. */
struct joint {
    int32_t part, node;
};

/* modes[part_count]: those of each part, as the others may move, too; part[node_count]: the part of each
 * node. A condition holds its average over all parts that its nodes are of.
 * joint[joint_count]. *complete: false where more free motions hang together than are looked at, so that
 * what is free in truth may be less. STATUS_SYSTEM for memory. */
MUST_CHECK enum status system_rigid_modes(const struct solid_system *system, int32_t part_count,
                                          const int32_t *part, int64_t joint_count, const struct joint *joint,
                                          struct rigid_modes *modes, bool *complete, struct error *error);

/* *has: whether the nodes, taken as one body, have a free rigid-body mode. STATUS_SYSTEM for memory. */
MUST_CHECK enum status system_has_rigid_mode(const struct solid_system *system, bool *has,
                                             struct error *error);
