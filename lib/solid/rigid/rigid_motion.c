#include "solid/rigid/rigid_motion.h"

#include <math.h>

enum status rigid_motion_check(struct rigid_motion *motion, int dim, struct error *error)
{
    double length2 = 0.0;
    for (int i = 0; i < 3; i++) {
        length2 += motion->axis[i] * motion->axis[i];
        if (!isfinite(motion->translation[i]) || !isfinite(motion->point[i])) {
            return fail(error, STATUS_INPUT, "rigid surface: its motion is not finite");
        }
    }
    if (!isfinite(motion->angle) || !isfinite(length2)) {
        return fail(error, STATUS_INPUT, "rigid surface: its motion is not finite");
    }
    if (!(length2 > 0.0)) {
        return fail(error, STATUS_INPUT, "rigid surface: the axis of rotation has no length");
    }
    for (int i = 0; i < 3; i++) {
        motion->axis[i] = dim == 2 ? (double)(i == 2) : motion->axis[i] / sqrt(length2);
    }
    return STATUS_OK;
}

/* Rodrigues' formula: R = 1 + sin W + (1 - cos) W^2, W the cross product with the axis. */
static void fill_rotation(const double n[3], double angle, double R[3][3])
{
    double s = sin(angle), half = sin(0.5 * angle), c1 = 2.0 * half * half;
    double W[3][3] = {{0.0, -n[2], n[1]}, {n[2], 0.0, -n[0]}, {-n[1], n[0], 0.0}};
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            double square = W[i][0] * W[0][j] + W[i][1] * W[1][j] + W[i][2] * W[2][j];
            R[i][j] = (double)(i == j) + s * W[i][j] + c1 * square;
        }
    }
}

struct rigid_place rigid_place_at(const struct rigid_motion *motion, const double *factor)
{
    struct rigid_place place = {.moved = motion->moves};
    if (motion->moves) {
        fill_rotation(motion->axis, motion->angle * factor[motion->rotation_curve], place.R);
        for (int i = 0; i < 3; i++) {
            place.point[i] = motion->point[i];
            place.shift[i] = motion->translation[i] * factor[motion->translation_curve];
        }
    }
    return place;
}

void rigid_place_to_rest(const struct rigid_place *place, int dim, const double *x, double *X)
{
    for (int i = 0; i < dim; i++) {
        X[i] = place->moved ? place->point[i] : x[i];
        for (int j = 0; j < dim && place->moved; j++) {
            X[i] += place->R[j][i] * (x[j] - place->shift[j] - place->point[j]);
        }
    }
}

void rigid_place_from_rest(const struct rigid_place *place, int dim, const double *X, double *x)
{
    for (int i = 0; i < dim; i++) {
        x[i] = place->moved ? place->point[i] + place->shift[i] : X[i];
        for (int j = 0; j < dim && place->moved; j++) {
            x[i] += place->R[i][j] * (X[j] - place->point[j]);
        }
    }
}

void rigid_place_turn(const struct rigid_place *place, int dim, double *direction)
{
    double turned[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < dim && place->moved; i++) {
        for (int j = 0; j < dim; j++) {
            turned[i] += place->R[i][j] * direction[j];
        }
    }
    for (int i = 0; i < dim && place->moved; i++) {
        direction[i] = turned[i];
    }
}

double rigid_motion_path(const struct rigid_motion *motion, int dim, const double *X)
{
    double way2 = 0.0, along = 0.0, radius2 = 0.0;
    for (int i = 0; i < dim && motion->moves; i++) {
        double arm = X[i] - motion->point[i];
        way2 += motion->translation[i] * motion->translation[i];
        radius2 += arm * arm;
        along += arm * motion->axis[i];
    }
    return sqrt(way2) + fabs(motion->angle) * sqrt(fmax(0.0, radius2 - along * along));
}
