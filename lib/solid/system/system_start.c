/* The start of a run near its result. */
#include "base/memory.h"
#include "base/vector.h"
#include "solid/system/system.h"

#include <math.h>

/* Replace each curve by the constant that is its value at the end. */
static enum status hold_curves(struct solid_system *system, struct error *error)
{
    for (int64_t i = 0; i < system->curve_count; i++) {
        double end = curve_value(&system->curves[i], 1.0);
        const double held[] = {0.0, end, 1.0, end};
        curve_free(&system->curves[i]);
        RETURN_IF_ERROR(curve_tabulate(&system->curves[i], 2, held, 1.0, false, error));
    }
    return STATUS_OK;
}

/* Append a curve that falls from 1 to 0. */
static enum status add_falling_curve(struct solid_system *system, struct error *error)
{
    static const double falling[] = {0.0, 1.0, 1.0, 0.0};
    int64_t added = system->curve_count;
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->factor, added + 1, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&system->curves, added + 1, error));
    RETURN_IF_ERROR(curve_tabulate(&system->curves[added], 2, falling, 1.0, false, error));
    system->curve_count++;
    return STATUS_OK;
}

enum status system_start(struct solid_system *system, const double *u, struct error *error)
{
    struct constraint_rows *rows = &system->rows;
    int dim = system->dim;
    NEW_SCRATCH(double, at_node, system->node_count * dim, error);
    RETURN_IF_ERROR(hold_curves(system, error));
    rows->start_curve = (int32_t)system->curve_count;
    RETURN_IF_ERROR(add_falling_curve(system, error));
    RETURN_IF_ERROR(NEW_ARRAY(&rows->start, rows->count, error));
    system_load_factors(system, 1.0);
    for (int64_t r = 0; r < rows->count; r++) {
        rows->start[r] = constraint_rows_value(rows, r, u) - constraint_rows_target(rows, r, system->factor);
    }
    for (int64_t r = 0; r < rows->count; r++) {
        add_scaled(dim, rows->start[r], rows->direction + r * dim, at_node + rows->node[r] * dim);
    }
    prescribed_values_start(&system->body, rows->start_curve, at_node);
    return STATUS_OK;
}

double system_narrowest_tool(const struct solid_system *system)
{
    double narrowest = INFINITY;
    for (int64_t c = 0; c < system->contact_count; c++) {
        if (system->contacts[c].between == NULL) {
            narrowest = fmin(narrowest, rigid_width(&system->contacts[c].surface));
        }
    }
    return narrowest;
}

double system_longest_change(const struct solid_system *system)
{
    const struct constraint_rows *rows = &system->rows;
    double longest = 0.0;
    if (rows->start == NULL) {
        return system_longest_way(system);
    }
    for (int64_t r = 0; r < rows->count; r++) {
        longest = fmax(longest, fabs(rows->start[r]));
    }
    return longest;
}

double system_load_factor(const struct solid_system *system, int64_t curve, double s)
{
    return fmin(1.0, 1.0 + s) * curve_value(&system->curves[curve], s);
}

void system_load_factors(struct solid_system *system, double s)
{
    for (int64_t i = 0; i < system->curve_count; i++) {
        system->factor[i] = system_load_factor(system, i, s);
    }
}

bool system_begins_loaded(const struct solid_system *system)
{
    bool loaded = false;
    for (int64_t i = 0; i < system->curve_count; i++) {
        loaded = loaded || fabs(curve_value(&system->curves[i], 0.0)) > 0.0;
    }
    return loaded;
}
