/* Load curves: the factor of a load over the time s = t/T of the scene, from 0 to 1. */
#pragma once

#include "base/status.h"
#include "solid/system/kinds.h"

#include <gsl/gsl_interp.h>
#include <stdint.h>

struct load_curve {
    enum curve_kind kind;
    double end;            /* CURVE_TABLE: T, the time of s = 1 */
    int64_t count;         /* CURVE_TABLE: points, >= 2 */
    double *time, *factor; /* CURVE_TABLE: count; times strictly increasing, over [0, end] at least */
    gsl_interp *spline;    /* CURVE_TABLE */
};

/* A curve of a kind without table; curve_free is allowed but not needed. */
struct load_curve curve_of_kind(enum curve_kind kind);

/* A curve through `count` points (time, factor), rows of 2 in `points`, which are copied: straight lines; or,
 * if `smooth`, as corners are impacts in dynamics, Steffen's piecewise cubic (Astron. Astrophys. 239, 1990),
 * which never overshoots between two points, and is a line for 2 points. `end` > 0 is the time of s = 1: the
 * scene's end_time, or 1 in a quasi-static scene. STATUS_INPUT, with a message `row N: ...` counting from 1,
 * for fewer than two points, values that are not finite, times that do not increase, a first time after 0,
 * and a last time before `end`. STATUS_SYSTEM: memory. */
MUST_CHECK enum status curve_tabulate(struct load_curve *curve, int64_t count, const double *points,
                                      double end, bool smooth, struct error *error);

/* The factor at s, and its derivative by s. Outside of [0, 1] the factor keeps its value at the end.
 * Thread-safe. */
double curve_value(const struct load_curve *curve, double s);
double curve_rate(const struct load_curve *curve, double s);

/* The largest absolute factor; of a table at its points. */
double curve_largest(const struct load_curve *curve);

/* The first point after s, as a share of [0, 1], where a table turns, or begins or ends to be constant;
 * INFINITY: none. */
double curve_next_turn(const struct load_curve *curve, double s);

void curve_free(struct load_curve *curve);
