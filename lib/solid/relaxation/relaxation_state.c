/* Memory and checkpoints of a relaxation. */
#include "solid/relaxation/relaxation_private.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum status relaxation_allocate(struct relaxation *r, struct error *error)
{
    RETURN_IF_ERROR(preconditioner_build(r->system, true, &r->preconditioner, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->velocity, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->residual, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->before, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->factor_change, r->system->curve_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->mode, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->scratch, 5 * r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->last_u, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->last_residual, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->acceleration, r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->newer.u, 2 * r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->older.u, 2 * r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->check_now.u, 2 * r->size, error));
    RETURN_IF_ERROR(NEW_ARRAY(&r->check_before.u, 2 * r->size, error));
    return STATUS_OK;
}

void relaxation_release(struct relaxation *r)
{
    FREE_ALL(r->velocity, r->residual, r->before, r->factor_change, r->mode, r->scratch, r->last_u,
             r->last_residual, r->acceleration, r->newer.u, r->older.u, r->check_now.u, r->check_before.u);
    preconditioner_free(&r->preconditioner);
}

enum status relaxation_visit(void *run, const struct state *state, struct error *error)
{
    struct relaxation *r = run;
    struct relaxation_report *report = r->report;
    struct nodal_pressures *pressures = &r->system->body.volumes.pressures;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, r->u, r->size},
        {"velocity", STATE_NUMBERS, r->velocity, r->size},
        {"mode", STATE_NUMBERS, r->mode, r->size},
        {"last_u", STATE_NUMBERS, r->last_u, r->size},
        {"last_residual", STATE_NUMBERS, r->last_residual, r->size},
        {"newer.u", STATE_NUMBERS, r->newer.u, 2 * r->size},
        {"newer.load", STATE_NUMBERS, &r->newer.load, 1},
        {"older.u", STATE_NUMBERS, r->older.u, 2 * r->size},
        {"older.load", STATE_NUMBERS, &r->older.load, 1},
        {"check_now.u", STATE_NUMBERS, r->check_now.u, 2 * r->size},
        {"check_now.load", STATE_NUMBERS, &r->check_now.load, 1},
        {"check_before.u", STATE_NUMBERS, r->check_before.u, 2 * r->size},
        {"check_before.load", STATE_NUMBERS, &r->check_before.load, 1},
        {"held", STATE_NUMBERS, pressures->held, pressures->matrix.row_count},
        {"change", STATE_NUMBERS, pressures->change, pressures->matrix.row_count},
        {"lack", STATE_NUMBERS, &r->pressures_lack, 1},
        {"steady_augmentations", STATE_COUNTS, &r->steady_augmentations, 1},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"time_step", STATE_NUMBERS, &r->time_step, 1},
        {"damping", STATE_NUMBERS, &r->damping, 1},
        {"frequency", STATE_NUMBERS, &r->frequency, 1},
        {"usual_square", STATE_NUMBERS, &r->usual_square, 1},
        {"calmed_step", STATE_COUNTS, &r->calmed_step, 1},
        {"back_step", STATE_COUNTS, &r->back_step, 1},
        {"measured_frequency", STATE_NUMBERS, &r->measured_frequency, 1},
        {"measured_move", STATE_NUMBERS, &r->measured_move, 1},
        {"lowest_eigenvalue", STATE_NUMBERS, &r->lowest_eigenvalue, 1},
        {"window", STATE_NUMBERS, r->window, WINDOWS},
        {"lanczos_bound", STATE_NUMBERS, &r->lanczos_bound, 1},
        {"spectrum_known", STATE_FLAGS, &r->spectrum_known, 1},
        {"best_error", STATE_NUMBERS, &r->best_error, 1},
        {"best_step", STATE_COUNTS, &r->best_step, 1},
        {"largest_move", STATE_NUMBERS, &r->largest_move, 1},
        {"moved", STATE_NUMBERS, &r->moved, 1},
        {"checks", STATE_COUNTS, &r->checks, 1},
        {"displacement", STATE_NUMBERS, &r->displacement, 1},
        {"move", STATE_NUMBERS, &r->move, 1},
        {"largest_displacement", STATE_NUMBERS, &r->largest_displacement, 1},
        {"ramp_steps", STATE_COUNTS, &report->ramp_steps, 1},
        {"load", STATE_NUMBERS, &r->load, 1},
        {"load_rate", STATE_NUMBERS, &r->load_rate, 1},
        {"top_rate", STATE_NUMBERS, &r->top_rate, 1},
        {"loading_steps", STATE_COUNTS, &report->loading_steps, 1},
        {"step_safety", STATE_NUMBERS, &r->step_safety, 1},
        {"backtracks", STATE_COUNTS, &r->backtracks, 1},
        {"augmented_step", STATE_COUNTS, &r->augmented_step, 1},
        {"steady_checks", STATE_COUNTS, &r->steady_checks, 1},
        {"slow_mode_step", STATE_COUNTS, &r->slow_mode_step, 1},
        {"augmentations", STATE_COUNTS, &r->augmentations, 1},
        {"frames", STATE_COUNTS, &r->frames, 1},
        {"held_steps", STATE_COUNTS, &r->held_steps, 1},
        {"converged_checks", STATE_COUNTS, &r->converged_checks, 1},
        {"mass_change", STATE_NUMBERS, &r->mass_change, 1},
        {"last_mass_check", STATE_COUNTS, &r->last_mass_check, 1},
        {"next_mass_check", STATE_COUNTS, &r->next_mass_check, 1},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"error", STATE_NUMBERS, &report->error, 1},
        {"lowest_frequency", STATE_NUMBERS, &report->lowest_frequency, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    RETURN_IF_ERROR(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    RETURN_IF_ERROR(preconditioner_state(&r->preconditioner, state, error));
    RETURN_IF_ERROR(system_state(r->system, state, error));
    return STATUS_OK;
}
