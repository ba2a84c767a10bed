/* Progress and frames of a relaxation, and the forces of the conditions. */
#include "solid/relaxation/relaxation_private.h"

#include <math.h>

double relaxation_load_share(const struct relaxation *r)
{
    return r->system->rows.start != NULL ? 1.0 : r->load / (double)r->report->ramp_steps;
}

bool relaxation_tell(struct relaxation *r)
{
    if (r->options->progress == NULL) {
        return true;
    }
    int64_t at = r->report->steps, check = at - at % CHECK_INTERVAL;
    struct progress progress = {.step = at,
                                .u = r->u,
                                .move = check - r->back_step <= CHECK_INTERVAL ? INFINITY : r->moved,
                                .raised = check == r->slow_mode_step ? SLOW_MODE_GAIN : 1.0,
                                .error = r->report->error,
                                .remaining = -1.0,
                                .state = relaxation_visit,
                                .run = r};
    double ramp = (double)r->report->ramp_steps;
    progress.time = relaxation_load_share(r);
    if (r->load >= ramp && r->report->error > 0.0 && isfinite(r->report->error)) {
        /* The error falls by about exp(-w dt) a step. */
        double to_go = log(fmax(1.0, r->report->error / r->options->tolerance)) /
                       (r->report->lowest_frequency * r->time_step);
        progress.remaining = to_go / (to_go + (double)at);
    }
    return r->options->progress(r->options->context, &progress);
}

enum status relaxation_row_forces(struct relaxation *r, const double *u, double *row_force,
                                  struct error *error)
{
    (void)system_residual(r->system, u, r->residual);
    if (row_force == NULL || r->system->rows.count == 0) {
        return STATUS_OK;
    }
    return preconditioner_row_forces(&r->preconditioner, r->residual, r->scratch, row_force, error);
}

bool relaxation_gives_frames(const struct relaxation *r)
{
    return r->options->frame != NULL && r->options->frames > 0;
}

double relaxation_load_to_hold(const struct relaxation *r)
{
    double ramp = (double)r->report->ramp_steps, frames = (double)r->options->frames;
    return relaxation_gives_frames(r) ? ramp * fmin(1.0, (double)(r->frames + 1) / frames) : ramp;
}

bool relaxation_give_frame(struct relaxation *r, struct error *error)
{
    r->failure = relaxation_row_forces(r, r->u, r->row_force, error);
    if (r->failure != STATUS_OK) {
        return false;
    }
    r->frames++;
    r->options->frame(r->options->context, r->frames, relaxation_load_share(r), r->u);
    return true;
}
