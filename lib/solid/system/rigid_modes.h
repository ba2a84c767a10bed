/* Rigid-body modes that the conditions of a system leave free. */
#pragma once

#include "solid/system/system.h"

/* The rigid motions of a body that violate no condition. Contacts do not count; springs of measured points
 * count as conditions. */
struct rigid_modes {
    int64_t nodes;        /* of the body */
    double centre[3];     /* of the box of its nodes, m */
    int translations;     /* the free ones, */
    double along[3][3];   /* orthonormal directions of them */
    int turns;            /* and free rotations beside them */
    double through[3][3]; /* a point of the axis of each, m; in 2D the point it turns about */
    double axis[3][3];    /* orthogonal unit vectors; in 2D not used */
};

/* A body is held at a node that it shares with others. */
struct hinge {
    int32_t body, node;
};

/* modes[body_count]: those of each body; body[node_count]: the body of each node, negative: none.
 * Of a condition's average, the part on the nodes of a body constrains that body. A body is fixed at its
 * hinges, hinge[hinge_count], whose nodes are of no body. */
MUST_CHECK enum status system_rigid_modes(const struct solid_system *system, int64_t body_count,
                                          const int32_t *body, int64_t hinge_count, const struct hinge *hinge,
                                          struct rigid_modes *modes, struct error *error);

/* Whether the nodes, taken as one body, have a free rigid-body mode. */
bool system_has_rigid_mode(const struct solid_system *system);
