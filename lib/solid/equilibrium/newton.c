/* Runs by Newton's method. */
#include "solid/equilibrium/newton_private.h"

#include "base/box.h"
#include "base/memory.h"

#include <math.h>
#include <string.h>

/* An increment prescribes a motion of this many spacings, of this part of the narrowest rigid surface. */
static const double prescribed_spacings = 1.4, prescribed_widths = 0.25;
/* By the body's size: a step moves no node by more than this. */
static const double most_of_size = 0.1;
/* The estimated error at which the load grows on, and after an increment whose model had no minimum. */
static const double error_between = 0.2, error_waiting = 0.01;
static const int64_t usual_most_steps = 100000;

/* Set the preconditioner's mass and measure the coarse fields at u, which was evaluated last. */
static enum status measure(struct newton *n, struct error *error)
{
    struct preconditioner *p = &n->preconditioner;
    int64_t before = n->report->force_evaluations;
    system_relaxation_mass(n->system, false, n->cg.scaled);
    preconditioner_set_mass(p, n->cg.scaled);
    RETURN_IF_ERROR(preconditioner_measure(p, n->system, n->u, &n->report->force_evaluations, error));
    n->rate.cost = 1 + n->report->force_evaluations - before;
    n->rate.excess = 0.0;
    n->rate.usual = n->verdict.lowest = INFINITY;
    preconditioner_follow(p, n->system);
    return STATUS_OK;
}

/* An equilibrium at this load: false where the run ends, with the outcome or n->failure. */
static bool goes_on(struct newton *n, struct error *error)
{
    system_slide(n->system);
    n->friction.rests = true;
    n->watch.steps = 0; /* as at every equilibrium */
    n->watch.above = 0.0;
    n->progress.error = INFINITY; /* which is progress */
    n->progress.step = n->report->steps;
    if (n->load.now == n->load.hold) {
        n->failure = newton_give_frame(n, error);
    } else {
        newton_touch(n, n->u, &n->at_u); /* as a run that begins here again does */
    }
    return n->failure == STATUS_OK && n->load.now < 1.0;
}

/* Whether the load grows in the next step. */
static bool loads(const struct newton *n)
{
    return n->load.now < n->load.hold && n->watch.steps == 0 &&
           (n->friction.slides ? n->friction.rests
                               : n->report->error < (n->load.waits ? error_waiting : error_between));
}

/* The next step: an increment of the load, or a correction. The preconditioner is made anew once the products
 * that this would have saved since the last time cost as much. False where cells invert, or on failure. */
static bool step(struct newton *n, struct error *error)
{
    n->report->steps++;
    bool pays = n->rate.excess > (double)n->rate.cost;
    if (pays && n->options->in_time) {
        (void)newton_evaluate(n, n->u, &n->at_u); /* the frame before may have changed the body */
    }
    n->failure = pays ? measure(n, error) : STATUS_OK;
    if (n->failure != STATUS_OK) {
        return false;
    }
    if (loads(n)) {
        double from = n->load.now, to = newton_load_after(n, from, n->load.next);
        if (newton_begin_increment(n, from, to)) {
            n->load.waits = false;
            return newton_take_increment(n, from, to);
        }
        newton_set_load(n, from, from);
        (void)newton_evaluate(n, n->u, &n->at_u);
        if (n->friction.slides) { /* instead of what was predicted */
            system_accept(n->system);
            newton_touch(n, n->u, &n->at_u);
        }
        n->load.next = 0.5 * newton_span(n, from, to);
        n->load.corrections++;
        n->load.waits = true;
        return n->report->error < error_waiting ? newton_leave(n) : newton_correct(n);
    }
    n->load.corrections++;
    return newton_correct(n);
}

static enum statics_outcome iterate(struct newton *n, struct error *error)
{
    enum statics_outcome outcome;
    int64_t most = n->options->most_steps > 0 ? n->options->most_steps : usual_most_steps;
    while (n->report->steps < most) {
        bool stuck = !step(n, error);
        if (n->failure != STATUS_OK || (stuck && n->step.collapses)) {
            return n->failure != STATUS_OK ? STATICS_STOPPED : STATICS_INVERTED;
        }
        if (stuck) { /* the steps tried were evaluated last */
            (void)newton_evaluate(n, n->u, &n->at_u);
        }
        newton_augment(n);
        newton_estimate(n);
        if (n->friction.sticks && n->report->error <= n->options->tolerance) {
            newton_let_slip(n);
            newton_estimate(n);
        }
        newton_keep_to_path(n);
        bool ends = newton_ends(n, stuck, &outcome, error);
        if (n->failure != STATUS_OK) {
            return STATICS_STOPPED;
        }
        if (ends && (outcome != STATICS_CONVERGED || !goes_on(n, error))) {
            return outcome;
        }
        if (!newton_tell(n)) {
            return STATICS_STOPPED;
        }
    }
    return STATICS_TOO_MANY_STEPS;
}

/* Start at rest from u: that of a given start (system_start), or zeros. Loads and motions that curves have at
 * the beginning grow first. */
static enum status begin(struct newton *n, struct error *error)
{
    struct solid_system *system = n->system;
    n->load.now = system->rows.start == NULL && system_begins_loaded(system) ? -1.0 : 0.0;
    system_load_factors(system, n->load.now);
    system_measure_contacts(system, n->u, true);
    system_accept(system);
    if (n->options->frame != NULL && n->options->frames > 0 && !n->options->in_time) {
        (void)newton_evaluate(n, n->u, &n->at_u);
        n->options->frame(n->options->context, 0, 0.0, n->u);
    }
    constraint_project(&n->preconditioner.constraint, system->factor, n->u);
    (void)newton_evaluate(n, n->u, &n->at_u);
    n->step.radius = fmin(n->scale.spacing, n->scale.longest_step);
    n->load.next = n->load.most;
    n->load.hold = statics_load_to_hold(n->options, 0);
    n->friction.rests = true;
    n->path.reach = n->path.most = n->verdict.pressures_lack = INFINITY;
    return measure(n, error);
}

/* Continue from the state of another run. */
static enum status resume(struct newton *n, struct error *error)
{
    RETURN_IF_ERROR(newton_visit(n, n->options->restored, error));
    preconditioner_factorise(&n->preconditioner, n->system);
    (void)newton_evaluate(n, n->u, &n->at_u);
    n->report->force_evaluations--; /* it counted before */
    return STATUS_OK;
}

enum status newton_run(struct solid_system *system, const struct statics_options *options, double *u,
                       double *row_force, struct statics_report *report, struct error *error)
{
    FREED_BY(newton_release)
    struct newton n = {.system = system,
                       .options = options,
                       .report = report,
                       .size = system->node_count * system->dim,
                       .slackens = body_slackens(&system->body),
                       .friction = {.slides = system_has_friction(system)},
                       .u = u,
                       .row_force = row_force};
    struct box box = box_of(system->dim, system->node_count, system->X);
    *report = (struct statics_report){.least_jacobian = 1.0};
    body_limit_bulk(&system->body, STATICS_BULK_LIMIT);
    RETURN_IF_ERROR(newton_allocate(&n, error));
    n.scale.spacing = system_node_spacing(system);
    n.scale.body = box_diagonal(&box);
    n.scale.round_off = statics_round_off(system);
    double most =
        fmin(prescribed_spacings * n.scale.spacing, prescribed_widths * system_narrowest_tool(system));
    n.load.most = 1.0 / fmax(1.0, ceil(system_longest_change(system) / most));
    n.scale.longest_step = most_of_size * n.scale.body;
    RETURN_IF_ERROR(options->restored != NULL ? resume(&n, error) : begin(&n, error));
    report->outcome = iterate(&n, error);
    RETURN_IF_ERROR(n.failure);
    report->load = statics_load_share(system, n.load.now);
    return report->outcome == STATICS_CONVERGED ? STATUS_OK : newton_row_forces(&n, error);
}
