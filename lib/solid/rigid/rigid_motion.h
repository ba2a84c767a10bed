/* The motion of a rigid surface: a finite rotation about a fixed axis, then a translation, each scaled by a
 * load curve. The surface itself is not changed: a point is transformed to the frame in which the surface is
 * at rest, and results are transformed back. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct rigid_motion {
    bool moves;            /* false: the surface stays, and the rest is not used */
    double translation[3]; /* at factor 1, m */
    double point[3];       /* on the axis of rotation, m */
    double axis[3];        /* of rotation, unit; in 2D (0, 0, 1) */
    double angle;          /* at factor 1, right-handed about the axis (in 2D counter-clockwise), rad */
    int32_t translation_curve, rotation_curve; /* load curves that scale them */
};

/* The placement of a surface: x = point + R (X - point) + shift for a place X of the surface at rest. Only
 * the first dim components, rows and columns are used. */
struct rigid_place {
    bool moved; /* false: as at rest */
    double R[3][3];
    double point[3], shift[3]; /* m */
};

/* STATUS_INPUT for an axis of length 0 and for numbers that are not finite. Makes the axis unit. */
MUST_CHECK enum status rigid_motion_check(struct rigid_motion *motion, int dim, struct error *error);

/* The place at the curves' values factor[], indexed by the motion's curves. */
struct rigid_place rigid_place_at(const struct rigid_motion *motion, const double *factor);

/* X of the place x, and back; the two arrays must differ. */
void rigid_place_to_rest(const struct rigid_place *place, int dim, const double *x, double *X);
void rigid_place_from_rest(const struct rigid_place *place, int dim, const double *X, double *x);

/* Turn a direction at rest with the surface, in place. */
void rigid_place_turn(const struct rigid_place *place, int dim, double *direction);

/* An upper bound of the length of the path of a point of the surface, at X at rest, as the factors go from 0
 * to 1, m. */
double rigid_motion_path(const struct rigid_motion *motion, int dim, const double *X);
