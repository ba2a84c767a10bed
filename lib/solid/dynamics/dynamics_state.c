/* The memory of explicit dynamics, and what a checkpoint holds of it. */
#include "solid/dynamics/dynamics_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum status dynamics_allocate(struct dynamics *d, struct error *error)
{
    const struct solid_system *system = d->system;
    RETURN_IF_ERROR(NEW_ARRAY(&d->u, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->next, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->before, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->after, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->residual, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->mode, d->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->scratch, 2 * d->size, error));
    if (system->acting.load_count + system->acting.pressure_count > 0) {
        RETURN_IF_ERROR(NEW_ARRAY(&d->loads, d->size, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&d->prestressed, system->curve_count, error));
    if (energy_find_prestress(system, d->prestressed)) {
        RETURN_IF_ERROR(NEW_ARRAY(&d->stored, system->curve_count, error));
    }
    d->mass = system->lumped_mass;
    if (system->dashpot != NULL) {
        RETURN_IF_ERROR(NEW_ARRAY(&d->drag, d->size, error));
        RETURN_IF_ERROR(NEW_ARRAY(&d->mass, system->node_count, error));
        memcpy(d->mass, system->lumped_mass, (size_t)system->node_count * sizeof *d->mass);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&d->factor_before, system->curve_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->factor_now, system->curve_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&d->factor_after, system->curve_count, error));
    return NEW_ARRAY(&d->factor_change, system->curve_count, error);
}

void dynamics_release(struct dynamics *d)
{
    FREE_ALL(d->u, d->next, d->before, d->after, d->residual, d->mode, d->scratch, d->loads, d->prestressed,
             d->stored, d->drag, d->factor_before, d->factor_now, d->factor_after, d->factor_change);
    if (d->mass != d->system->lumped_mass) {
        free(d->mass);
    }
    constraint_free(&d->constraint);
}

enum status dynamics_visit(void *run, const struct state *state, struct error *error)
{
    struct dynamics *d = run;
    struct dynamics_report *report = d->report;
    int64_t curves = d->system->curve_count;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, d->u, d->size},
        {"velocity", STATE_NUMBERS, d->before, d->size},
        {"mode", STATE_NUMBERS, d->mode, d->size},
        {"factor_before", STATE_NUMBERS, d->factor_before, curves},
        {"factor_now", STATE_NUMBERS, d->factor_now, curves},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"time", STATE_NUMBERS, &report->time, 1},
        {"mark", STATE_NUMBERS, &d->mark, 1},
        {"step", STATE_NUMBERS, &d->step, 1},
        {"previous_step", STATE_NUMBERS, &d->previous_step, 1},
        {"steps_done", STATE_COUNTS, &d->done, 1},
        {"steps_left", STATE_COUNTS, &d->left, 1},
        {"frequency", STATE_NUMBERS, &d->frequency, 1},
        {"contact_squared", STATE_NUMBERS, &d->contact_squared, 1},
        {"sample_interval", STATE_COUNTS, &d->sample_interval, 1},
        {"frames", STATE_COUNTS, &d->frames, 1},
        {"balance", STATE_NUMBERS, &d->balance, sizeof d->balance / sizeof(double)},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"step_changes", STATE_COUNTS, &report->step_changes, 1},
        {"first_step", STATE_NUMBERS, &report->first_step, 1},
        {"least_step", STATE_NUMBERS, &report->least_step, 1},
        {"critical_step", STATE_NUMBERS, &report->critical_step, 1},
        {"largest_drift", STATE_NUMBERS, &report->largest_drift, 1},
        {"last_drift", STATE_NUMBERS, &report->last_drift, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    RETURN_IF_ERROR(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    if (d->sample_interval == 0) {
        return fail(error, STATUS_INPUT, "sample_interval: is 0");
    }
    if (d->log != NULL) {
        RETURN_IF_ERROR(energy_log_state(d->log, state, error));
    }
    return system_state(d->system, state, error);
}
