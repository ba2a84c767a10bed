/* Memory, checkpoints, progress and frames of a run by Newton's method. */
#include "base/memory.h"
#include "solid/equilibrium/newton_private.h"

#include <math.h>
#include <stdlib.h>

enum status newton_allocate(struct newton *n, struct error *error)
{
    double **vectors[] = {&n->at_u.smooth,  &n->at_u.contact,  &n->at_trial.smooth, &n->at_trial.contact,
                          &n->model.smooth, &n->model.contact, &n->trial,           &n->step,
                          &n->search,       &n->product,       &n->scaled,          &n->last,
                          &n->kept,         &n->nearest,       &n->marked};
    RETURN_IF_ERROR(preconditioner_build(n->system, true, &n->preconditioner, error));
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        RETURN_IF_ERROR(NEW_ARRAY(vectors[i], n->size, error));
    }
    RETURN_IF_ERROR(newton_keep_directions(n, newton_usual_directions(n), error));
    return NEW_ARRAY(&n->factor_change, n->system->curve_count, error);
}

void newton_release(struct newton *n)
{
    FREE_ALL(n->at_u.smooth, n->at_u.contact, n->at_trial.smooth, n->at_trial.contact, n->model.smooth,
             n->model.contact, n->trial, n->step, n->search, n->product, n->scaled, n->last, n->kept,
             n->nearest, n->marked, n->factor_change);
    newton_free_directions(n);
    preconditioner_free(&n->preconditioner);
}

enum status newton_visit(void *run, const struct state *state, struct error *error)
{
    struct newton *n = run;
    struct statics_report *report = n->report;
    struct nodal_pressures *pressures = &n->system->body.volumes.pressures;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, n->u, n->size},
        {"last", STATE_NUMBERS, n->last, n->size},
        {"last_change", STATE_NUMBERS, &n->last_change, 1},
        {"load", STATE_NUMBERS, &n->load, 1},
        {"load_change", STATE_NUMBERS, &n->load_change, 1},
        {"radius", STATE_NUMBERS, &n->radius, 1},
        {"square", STATE_NUMBERS, &n->square, 1},
        {"lowest", STATE_NUMBERS, &n->lowest, 1},
        {"waits", STATE_FLAGS, &n->waits, 1},
        {"judged", STATE_FLAGS, &n->judged, 1},
        {"sticks", STATE_FLAGS, &n->sticks, 1},
        {"gives_way", STATE_FLAGS, &n->gives_way, 1},
        {"settled", STATE_FLAGS, &n->settled, 1},
        {"rests", STATE_FLAGS, &n->rests, 1},
        {"length", STATE_NUMBERS, &n->length, 1},
        {"largest_move", STATE_NUMBERS, &n->largest_move, 1},
        {"kept", STATE_NUMBERS, n->kept, n->size},
        {"kept_length", STATE_NUMBERS, &n->kept_length, 1},
        {"uphill", STATE_COUNTS, &n->uphill, 1},
        {"above", STATE_NUMBERS, &n->above, 1},
        {"usual", STATE_NUMBERS, &n->usual, 1},
        {"excess", STATE_NUMBERS, &n->excess, 1},
        {"cost", STATE_COUNTS, &n->cost, 1},
        {"marked", STATE_NUMBERS, n->marked, n->size},
        {"best_load", STATE_NUMBERS, &n->best_load, 1},
        {"best_error", STATE_NUMBERS, &n->best_error, 1},
        {"nearest", STATE_NUMBERS, n->nearest, n->size},
        {"nearest_error", STATE_NUMBERS, &n->nearest_error, 1},
        {"falls", STATE_FLAGS, &n->falls, 1},
        {"best_step", STATE_COUNTS, &n->best_step, 1},
        {"moves", STATE_COUNTS, &n->moves, 1},
        {"corrections", STATE_COUNTS, &n->corrections, 1},
        {"frames", STATE_COUNTS, &n->frames, 1},
        {"hold", STATE_NUMBERS, &n->hold, 1},
        {"held", STATE_NUMBERS, pressures->held, pressures->matrix.row_count},
        {"change", STATE_NUMBERS, pressures->change, pressures->matrix.row_count},
        {"lack", STATE_NUMBERS, &n->pressures_lack, 1},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"loading_steps", STATE_COUNTS, &report->loading_steps, 1},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"error", STATE_NUMBERS, &report->error, 1},
        {"move", STATE_NUMBERS, &report->move, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    RETURN_IF_ERROR(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    RETURN_IF_ERROR(preconditioner_state(&n->preconditioner, state, error));
    return system_state(n->system, state, error);
}

bool newton_tell(struct newton *n)
{
    return statics_tell(n->options, n->report, statics_load_share(n->system, n->load), n->u, newton_visit, n);
}

enum status newton_row_forces(struct newton *n, struct error *error)
{
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->row_force == NULL || n->system->rows.count == 0) {
        return STATUS_OK;
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->at_u.smooth[i] + n->at_u.contact[i];
    }
    return preconditioner_row_forces(&n->preconditioner, n->trial, n->scaled, n->row_force, error);
}

enum status newton_give_frame(struct newton *n, struct error *error)
{
    RETURN_IF_ERROR(newton_row_forces(n, error));
    statics_give_frame(n->options, statics_load_share(n->system, n->load), n->u, &n->frames);
    n->hold = n->options->hold != NULL ? n->options->hold(n->options->context, n->load)
                                       : statics_load_to_hold(n->options, n->frames);
    return STATUS_OK;
}
