#include "solid/system/curve.h"

#include "base/memory.h"

#include <math.h>

struct load_curve curve_of_kind(enum curve_kind kind)
{
    return (struct load_curve){.kind = kind, .end = 1};
}

static enum status check_points(int64_t count, const double *points, double end, struct error *error)
{
    if (count < 2) {
        return fail(error, STATUS_INPUT, "load curve of %lld point: give at least two, times from 0 to %g",
                    (long long)count, end);
    }
    for (int64_t i = 0; i < count; i++) {
        const double *point = points + 2 * i;
        if (!isfinite(point[0]) || !isfinite(point[1])) {
            return fail(error, STATUS_INPUT, "row %lld: time or factor is not finite", (long long)i + 1);
        }
        if (i > 0 && !(point[0] > point[-2])) {
            return fail(error, STATUS_INPUT,
                        "row %lld: time %g does not come after %g: order the rows by time", (long long)i + 1,
                        point[0], point[-2]);
        }
    }
    if (!(points[0] <= 0)) {
        return fail(error, STATUS_INPUT, "row 1: load curve begins at time %g: it must cover 0 to %g",
                    points[0], end);
    }
    if (!(points[2 * (count - 1)] >= end)) {
        return fail(error, STATUS_INPUT, "row %lld: load curve ends at time %g: it must cover 0 to %g",
                    (long long)count, points[2 * (count - 1)], end);
    }
    return STATUS_OK;
}

/* The caller has checked the points, so only memory can fail: with GSL's default error handler that
 * ends the program, see base/status.h. */
static gsl_interp *make_spline(const struct load_curve *curve, bool smooth)
{
    const gsl_interp_type *type = smooth && curve->count > 2 ? gsl_interp_steffen : gsl_interp_linear;
    gsl_interp *spline = gsl_interp_alloc(type, (size_t)curve->count);
    if (spline != NULL && gsl_interp_init(spline, curve->time, curve->factor, (size_t)curve->count) != 0) {
        gsl_interp_free(spline);
        spline = NULL;
    }
    return spline;
}

enum status curve_tabulate(struct load_curve *curve, int64_t count, const double *points, double end,
                           bool smooth, struct error *error)
{
    *curve = (struct load_curve){.kind = CURVE_TABLE, .end = end, .count = count};
    RETURN_IF_ERROR(check_points(count, points, end, error));
    RETURN_IF_ERROR(NEW_ARRAY(&curve->time, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&curve->factor, count, error));
    for (int64_t i = 0; i < count; i++) {
        curve->time[i] = points[2 * i];
        curve->factor[i] = points[2 * i + 1];
    }
    curve->spline = make_spline(curve, smooth);
    if (curve->spline == NULL) {
        return fail_memory(error, "load curve");
    }
    return STATUS_OK;
}

double curve_value(const struct load_curve *curve, double s)
{
    s = fmin(fmax(s, 0), 1);
    switch (curve->kind) {
    case CURVE_SMOOTH:
        return s * s * s * (10 - s * (15 - 6 * s));
    case CURVE_LINEAR:
        return s;
    case CURVE_STEP:
        return 1;
    case CURVE_TABLE: /* no accelerator: it would be shared between threads */
        return gsl_interp_eval(curve->spline, curve->time, curve->factor, s * curve->end, NULL);
    }
    return 0;
}

double curve_next_turn(const struct load_curve *curve, double s)
{
    for (int64_t i = 1; i + 1 < curve->count; i++) {
        double before = curve->factor[i] - curve->factor[i - 1];
        double after = curve->factor[i + 1] - curve->factor[i];
        bool turns = before * after <= 0.0 && (before != 0.0 || after != 0.0);
        if (turns && curve->time[i] > s * curve->end) {
            return curve->time[i] / curve->end;
        }
    }
    return (double)INFINITY;
}

double curve_largest(const struct load_curve *curve)
{
    double largest = curve->count > 0 ? 0.0 : 1.0;
    for (int64_t i = 0; i < curve->count; i++) {
        largest = fmax(largest, fabs(curve->factor[i]));
    }
    return largest;
}

double curve_rate(const struct load_curve *curve, double s)
{
    if (s < 0 || s > 1) {
        return 0;
    }
    switch (curve->kind) {
    case CURVE_SMOOTH:
        return 30 * s * s * (1 - s) * (1 - s);
    case CURVE_LINEAR:
        return 1;
    case CURVE_STEP:
        return 0;
    case CURVE_TABLE:
        return curve->end *
               gsl_interp_eval_deriv(curve->spline, curve->time, curve->factor, s * curve->end, NULL);
    }
    return 0;
}

void curve_free(struct load_curve *curve)
{
    if (curve->spline != NULL) {
        gsl_interp_free(curve->spline);
    }
    FREE_ALL(curve->time, curve->factor);
    *curve = (struct load_curve){0};
}
