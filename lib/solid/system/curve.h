/* Load curves: the factor of a load over the time s = t/T of the scene, 0 at its begin and 1 at its end. */
#pragma once

#include "base/status.h"

#include <gsl/gsl_interp.h>
#include <stdint.h>

enum curve_kind {
    CURVE_SMOOTH, /* 10 s^3 - 15 s^4 + 6 s^5: begins and ends without velocity and acceleration */
    CURVE_LINEAR, /* s */
    CURVE_STEP,   /* 1 from the begin */
    CURVE_TABLE   /* through given points, monotone between them */
};

struct load_curve {
    enum curve_kind kind;
    double end;            /* CURVE_TABLE: T, the time of s = 1 */
    int64_t count;         /* CURVE_TABLE: points, >= 2 */
    double *time, *factor; /* CURVE_TABLE: count; times strictly increasing, over [0, end] at least */
    gsl_interp *spline;    /* CURVE_TABLE */
};

/* A curve of the kinds without table. Needs no curve_free, allows it. */
struct load_curve curve_of_kind(enum curve_kind kind);

/* A curve through `count` points (time, factor), rows of 2 in `points`, which are copied: Steffen's piecewise
 * cubic (Astron. Astrophys. 239, 1990), which is smooth, takes every point, and never overshoots between two
 * of them; a line for 2 points. `end` > 0 is the time of s = 1: the scene's end_time, or 1 in a quasi-static
 * scene. Errors, as `row N: ...` counting from 1: STATUS_INPUT for fewer than two points, values that are not
 * finite, times that do not increase, a first time after 0, a last time before `end`; STATUS_SYSTEM for
 * memory. */
MUST_CHECK enum status curve_tabulate(struct load_curve *curve, int64_t count, const double *points,
                                      double end, struct error *error);

/* The factor at s, and its derivative by s. Outside of [0, 1] the factor stays at its end value. Safe to call
 * from several threads. */
double curve_value(const struct load_curve *curve, double s);

/* The largest factor that it takes, by its size; of a table at its points. */
double curve_largest(const struct load_curve *curve);
double curve_rate(const struct load_curve *curve, double s);

void curve_free(struct load_curve *curve);
