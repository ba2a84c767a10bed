/* Memory, checkpoints, progress and frames of a run by Newton's method. */
#include "base/memory.h"
#include "solid/equilibrium/newton_private.h"

#include <math.h>
#include <stdlib.h>

enum status newton_allocate(struct newton *n, struct error *error)
{
    double **vectors[] = {&n->at_u.smooth,  &n->at_u.contact,  &n->at_trial.smooth, &n->at_trial.contact,
                          &n->model.smooth, &n->model.contact, &n->trial,           &n->step.move,
                          &n->cg.search,    &n->cg.product,    &n->cg.scaled,       &n->load.move,
                          &n->watch.start,  &n->path.u,        &n->progress.u};
    RETURN_IF_ERROR(preconditioner_build(n->system, true, &n->preconditioner, error));
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        RETURN_IF_ERROR(NEW_ARRAY(vectors[i], n->size, error));
    }
    RETURN_IF_ERROR(newton_keep_directions(n, newton_usual_directions(n), error));
    return NEW_ARRAY(&n->load.factor_change, n->system->curve_count, error);
}

void newton_release(struct newton *n)
{
    FREE_ALL(n->at_u.smooth, n->at_u.contact, n->at_trial.smooth, n->at_trial.contact, n->model.smooth,
             n->model.contact, n->trial, n->step.move, n->cg.search, n->cg.product, n->cg.scaled,
             n->load.move, n->watch.start, n->path.u, n->progress.u, n->load.factor_change);
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
        {"last", STATE_NUMBERS, n->load.move, n->size},
        {"last_change", STATE_NUMBERS, &n->load.last, 1},
        {"load", STATE_NUMBERS, &n->load.now, 1},
        {"load_change", STATE_NUMBERS, &n->load.next, 1},
        {"radius", STATE_NUMBERS, &n->step.radius, 1},
        {"square", STATE_NUMBERS, &n->step.square, 1},
        {"lowest", STATE_NUMBERS, &n->verdict.lowest, 1},
        {"waits", STATE_FLAGS, &n->load.waits, 1},
        {"judged", STATE_FLAGS, &n->verdict.judged, 1},
        {"sticks", STATE_FLAGS, &n->friction.sticks, 1},
        {"gives_way", STATE_FLAGS, &n->verdict.gives_way, 1},
        {"settled", STATE_FLAGS, &n->friction.settled, 1},
        {"rests", STATE_FLAGS, &n->friction.rests, 1},
        {"length", STATE_NUMBERS, &n->step.length, 1},
        {"largest_move", STATE_NUMBERS, &n->progress.largest_move, 1},
        {"kept", STATE_NUMBERS, n->watch.start, n->size},
        {"kept_length", STATE_NUMBERS, &n->watch.length, 1},
        {"uphill", STATE_COUNTS, &n->watch.steps, 1},
        {"above", STATE_NUMBERS, &n->watch.above, 1},
        {"usual", STATE_NUMBERS, &n->rate.usual, 1},
        {"excess", STATE_NUMBERS, &n->rate.excess, 1},
        {"cost", STATE_COUNTS, &n->rate.cost, 1},
        {"marked", STATE_NUMBERS, n->progress.u, n->size},
        {"best_load", STATE_NUMBERS, &n->progress.load, 1},
        {"best_error", STATE_NUMBERS, &n->progress.error, 1},
        {"path", STATE_NUMBERS, n->path.u, n->size},
        {"reach", STATE_NUMBERS, &n->path.reach, 1},
        {"most", STATE_NUMBERS, &n->path.most, 1},
        {"from", STATE_NUMBERS, &n->path.from, 1},
        {"returned", STATE_FLAGS, &n->path.returned, 1},
        {"best_step", STATE_COUNTS, &n->progress.step, 1},
        {"moves", STATE_COUNTS, &n->progress.moves, 1},
        {"corrections", STATE_COUNTS, &n->load.corrections, 1},
        {"frames", STATE_COUNTS, &n->load.frames, 1},
        {"hold", STATE_NUMBERS, &n->load.hold, 1},
        {"held", STATE_NUMBERS, pressures->held, pressures->matrix.row_count},
        {"change", STATE_NUMBERS, pressures->change, pressures->matrix.row_count},
        {"lack", STATE_NUMBERS, &n->verdict.pressures_lack, 1},
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
    return statics_tell(n->options, n->report, statics_load_share(n->system, n->load.now), n->u, newton_visit,
                        n);
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
    return preconditioner_row_forces(&n->preconditioner, n->trial, n->cg.scaled, n->row_force, error);
}

enum status newton_give_frame(struct newton *n, struct error *error)
{
    RETURN_IF_ERROR(newton_row_forces(n, error));
    statics_give_frame(n->options, statics_load_share(n->system, n->load.now), n->u, &n->load.frames);
    n->load.hold = n->options->hold != NULL ? n->options->hold(n->options->context, n->load.now)
                                            : statics_load_to_hold(n->options, n->load.frames);
    return STATUS_OK;
}
