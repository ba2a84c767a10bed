#include "solid/relaxation/relaxation_private.h"

#include "base/clock.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

static const int64_t keep_interval = 50;                /* steps between states to go back to */
static const double usual_rise = 1.5, usual_fall = 0.8; /* of the residual's squared norm in a step */
static const double unstable_rise = 6.0;                /* over what is usual: a mode is unstable */
static const int64_t hover_steps = 50;                  /* without half the error: is a mode unstable? */
/* Largest ratio of the bulk to the shear modulus in a step, that of Poisson's ratio .49; multipliers, the
 * nodal pressures held, carry the rest. */
static const double bulk_limit = 50.0;
/* With contacts, an error that stays below this is accepted: contact nodes that alternate between two facets
 * keep it from falling. */
static const double most_hovering = 1e-3;
/* By the body's size: a body that moves farther has no equilibrium. */
static const double most_sizes = 10.0;
static const int64_t calm_steps = 20; /* after relaxation_calm, before the next test */
/* Of the power iteration at every check. It starts from the mode of the last check, and so converges over the
 * checks; while the load grows the mode changes faster. */
static const int iterations = 1, iterations_loading = 2;

/* Whether the squared norm of the residual, r . M^-1 r with the acceleration M^-1 r in r->scratch, grows as
 * in an unstable run. In a stable run the norm follows the load. A mode whose frequency exceeds the stability
 * limit makes it grow by a constant factor in each step, for many steps before points invert.
 * `usual_square` follows the norm at a bounded rate. */
static bool residual_grows(struct relaxation *r)
{
    double now2 = vector_product(r->size, r->residual, r->scratch), usual2 = r->usual_square;
    bool grows =
        usual2 > 0.0 && now2 > unstable_rise * usual2 && r->report->steps > r->calmed_step + calm_steps;
    r->usual_square = usual2 > 0.0 ? fmin(now2, usual_rise * usual2) : now2;
    r->usual_square = fmax(r->usual_square, usual_fall * usual2);
    return grows;
}

/* After the evaluation of a step that precedes a check: augment the nodal pressures and the contacts, if the
 * last augmentation is long enough ago. The error of the check then includes the residual that the
 * augmentation leaves. */
static void augment(struct relaxation *r)
{
    int64_t pause = r->report->steps - r->augmented_step;
    bool pressures = body_is_limited(&r->system->body);
    if ((r->report->steps + 1) % CHECK_INTERVAL != 0 || pause < 2 * CHECK_INTERVAL ||
        r->damping * (double)pause * r->time_step < RELAXATION_PAUSE) {
        return;
    }
    bool contacts = r->system->contact_count > 0 && relaxation_contacts_lack(r);
    if (pressures) {
        r->steady_augmentations = r->held_steps > pause ? r->steady_augmentations + 1 : 0;
        r->pressures_lack =
            body_augment(&r->system->body, r->steady_augmentations > 1, NODAL_PRESSURE_LACK,
                         r->move / r->body_size);
    }
    if (contacts) {
        system_augment_contacts(r->system, r->held_steps > pause);
        r->augmentations += r->held_steps > 0;
    }
    if (pressures || contacts) {
        r->augmented_step = r->report->steps;
        r->usual_square = 0.0;
    }
}

/* One step; with `measure` r->acceleration receives that of the projected residual at the old u. False if a
 * point is inverted. */
static bool step(struct relaxation *r, double *u, bool measure)
{
    struct solid_system *system = r->system;
    double dt = r->time_step, grow = 2.0 + r->damping * dt, keep = (2.0 - r->damping * dt) / grow;
    r->unstable = false;
    struct deformation deformation = system_residual(system, u, r->residual);
    r->report->force_evaluations++;
    r->report->least_jacobian = deformation.least_jacobian;
    if (!(deformation.least_jacobian > 0.0)) {
        r->report->inverted_point = deformation.point;
        return false;
    }
    system_accept(system);
    memcpy(r->before, u, (size_t)r->size * sizeof *u);
    if (preconditioner_follow(&r->preconditioner, system, measure, r->velocity, r->scratch)) {
        relaxation_note_new_mass(r);
    }
    if (measure) { /* from the velocity after impacts, which are no acceleration */
        memcpy(r->acceleration, r->velocity, (size_t)r->size * sizeof *r->velocity);
    }
    preconditioner_apply(&r->preconditioner, r->residual, r->scratch);
    r->unstable = residual_grows(r);
    augment(r);
    double *move = r->velocity, push = 2.0 * dt / grow;
    for (int64_t i = 0; i < r->size; i++) {
        move[i] = dt * (keep * r->velocity[i] + push * r->scratch[i]);
    }
    /* The increment is projected, not u: the round-off of u would bound the residual from below. */
    double started = clock_seconds();
    constraint_project(&r->preconditioner.constraint, r->factor_change, move);
    system->cost.constraints += clock_seconds() - started;
    for (int64_t i = 0; i < r->size; i++) {
        u[i] += move[i];
        r->velocity[i] = move[i] / dt;
    }
    if (measure) {
        /* (2 + c dt) v_new = (2 - c dt) v_old + 2 dt a */
        for (int64_t i = 0; i < r->size; i++) {
            r->acceleration[i] =
                (grow * r->velocity[i] - (2.0 - r->damping * dt) * r->acceleration[i]) / (2.0 * dt);
        }
    }
    return true;
}

/* After the equilibrium of a frame: reset what refers to the load that was held. */
static void resume_loading(struct relaxation *r)
{
    r->held_steps = r->converged_checks = 0;
    relaxation_note_new_mass(r);
    r->augmentations = 0;
    r->steady_augmentations = 0;
    r->steady_checks = 0;
    preconditioner_drop_slow_modes(&r->preconditioner);
}

/* Set the load factors at the share s of the load, and r->factor_change to their changes. */
static void change_load(struct relaxation *r, double s)
{
    struct solid_system *system = r->system;
    for (int64_t i = 0; i < system->curve_count; i++) {
        r->factor_change[i] = -system->factor[i];
    }
    system_load_factors(system, s);
    for (int64_t i = 0; i < system->curve_count; i++) {
        r->factor_change[i] += system->factor[i];
    }
}

/* Whether the load is held and the error has not halved for long. At a contact that opens and closes, a mode
 * beyond the stability limit does not grow but persists. */
static bool hovers(const struct relaxation *r)
{
    int64_t since = r->best_step > r->calmed_step ? r->best_step : r->calmed_step;
    return r->held_steps > hover_steps && r->report->steps - since > hover_steps;
}

/* After a measured step: estimate the error, and adapt load, mass, time step and preconditioner to the state.
 * False on failure. */
static bool follow(struct relaxation *r, struct error *error)
{
    double *u = r->u;
    relaxation_estimate(r);
    if (!relaxation_add_slow_mode(r, r->scratch, error)) {
        return false;
    }
    relaxation_control_load(r);
    if (r->held_steps <= CHECK_INTERVAL) { /* remove the round-off of the increments' sum */
        constraint_project(&r->preconditioner.constraint, r->system->factor, u);
    }
    if (r->report->steps % keep_interval == 0) {
        relaxation_keep_state(r);
    }
    relaxation_keep_check(r);
    r->residual_at = r->before;
    if (system_stiffen_contacts(r->system)) {
        (void)system_residual(r->system, r->residual_at, r->residual);
        r->report->force_evaluations++;
        preconditioner_take_penalties(&r->preconditioner, r->system);
        relaxation_note_new_mass(r);
        r->next_mass_check = r->checks;
    }
    if (r->checks >= r->next_mass_check && !relaxation_update_mass(r, error)) {
        return false;
    }
    relaxation_follow_time_step(r, r->residual_at, r->held_steps == 0 ? iterations_loading : iterations);
    if (hovers(r)) {
        (void)relaxation_calm(r, r->acceleration);
    }
    return relaxation_update_preconditioner(r, error);
}

/* Whether the multipliers of contacts and of nodal pressures have converged. */
static bool multipliers_hold(struct relaxation *r)
{
    bool pressures = !body_is_limited(&r->system->body) || r->pressures_lack <= NODAL_PRESSURE_LACK;
    return pressures && relaxation_contacts_hold(r);
}

/* Whether the run ends at this check, and its outcome. A failure ends it, too. */
static bool ends(struct relaxation *r, enum relaxation_outcome *outcome, struct error *error)
{
    const double *error_now = &r->report->error, tolerance = r->options->tolerance;
    bool whole = r->held_steps > 2 * CHECK_INTERVAL;
    bool small = whole && *error_now <= tolerance;
    bool augmented = r->augmented_step == r->report->steps - 1;
    if (!small) {
        r->converged_checks = 0;
    } else if (augmented || !body_is_limited(&r->system->body)) {
        r->converged_checks++; /* only just after an augmentation the error includes what the multipliers
                                  still lack */
    }
    *outcome = RELAXATION_STOPPED;
    if (r->converged_checks >= 2 && !r->spectrum_known &&
        !relaxation_find_lowest_mode(r, r->residual_at, error)) {
        return true;
    }
    *outcome = RELAXATION_CONVERGED;
    if (r->converged_checks >= 2 && *error_now <= tolerance) {
        if (multipliers_hold(r)) {
            return true;
        }
        r->converged_checks = 0;
    }
    relaxation_note_best(r);
    double own_way = r->move - most_sizes * r->body_size; /* beyond what is prescribed, if that is far */
    if (own_way > 0.0 && own_way > system_longest_way(r->system)) {
        *outcome = RELAXATION_AWAY;
        return true;
    }
    bool round_off = *error_now <= relaxation_round_off(r) && relaxation_stays(r, 2.0, 200);
    bool hovering =
        r->system->contact_count > 0 && *error_now <= most_hovering && relaxation_stays(r, 20.0, 1000);
    if (whole && (round_off || hovering) && multipliers_hold(r)) {
        return true;
    }
    *outcome = RELAXATION_STALLED;
    bool folded = r->options->folded != NULL && *r->options->folded;
    return relaxation_stays(r, 20.0, folded ? 1000 : 5000);
}

static bool is_interrupted(const struct relaxation *r)
{
    return r->options->interrupted != NULL &&
           ranks_most(r->system->body.share.ranks, *r->options->interrupted) != 0;
}

static enum relaxation_outcome iterate(struct relaxation *r, struct error *error)
{
    double ramp = (double)r->report->ramp_steps;
    int64_t most = r->options->most_steps > 0 ? r->options->most_steps : 1000000;
    enum relaxation_outcome outcome;
    while (r->report->steps < most) {
        bool measure = ++r->report->steps % CHECK_INTERVAL == 0;
        double hold = relaxation_load_to_hold(r);
        r->load = fmin(hold, r->load + r->load_rate);
        r->held_steps = r->load < hold ? 0 : r->held_steps + 1;
        r->report->loading_steps += r->held_steps == 0;
        change_load(r, r->load / ramp);
        if (!step(r, r->u, measure)) {
            measure = false;
            if (!relaxation_step_back(r, error)) {
                return RELAXATION_INVERTED;
            }
        }
        if (r->unstable && relaxation_calm(r, r->scratch)) {
            measure = false;
        }
        if (measure && !follow(r, error)) {
            return RELAXATION_STOPPED;
        }
        if (measure && ends(r, &outcome, error)) {
            if (outcome != RELAXATION_CONVERGED || hold == ramp) {
                return outcome;
            }
            if (!relaxation_give_frame(r, error)) {
                return RELAXATION_STOPPED;
            }
            resume_loading(r);
        }
        if ((measure || is_interrupted(r)) && !relaxation_tell(r)) {
            return RELAXATION_STOPPED;
        }
    }
    return RELAXATION_TOO_MANY_STEPS;
}

/* Start at rest from u, projected onto the conditions, without load or with that of a given start
 * (system_start). */
static enum status begin(struct relaxation *r, struct error *error)
{
    struct solid_system *system = r->system;
    system_load_factors(system, 0.0);
    (void)system_residual(system, r->u, r->residual);
    if (relaxation_gives_frames(r)) {
        r->options->frame(r->options->context, 0, 0.0, r->u);
    }
    system_relaxation_mass(system, false, r->scratch);
    RETURN_IF_ERROR(preconditioner_set_mass(&r->preconditioner, system, r->scratch, error));
    constraint_project(&r->preconditioner.constraint, system->factor, r->u);
    memcpy(r->last_u, r->u, (size_t)r->size * sizeof *r->u);
    r->residual_at = r->u;
    r->lowest_eigenvalue = r->pressures_lack = INFINITY;
    for (int i = 0; i < WINDOWS; i++) {
        r->window[i] = INFINITY;
    }
    RETURN_IF_ERROR(relaxation_measure_preconditioner(r, error));
    for (int i = 0; i < 2; i++) {
        relaxation_keep_state(r);
        relaxation_keep_check(r);
    }
    r->report->ramp_steps = r->options->ramp_steps > 0 ? r->options->ramp_steps : relaxation_choose_ramp(r);
    return STATUS_OK;
}

/* Continue from the state of another run. */
static enum status resume(struct relaxation *r, struct error *error)
{
    RETURN_IF_ERROR(relaxation_visit(r, r->options->restored, error));
    r->residual_at = r->u;
    return preconditioner_restore(&r->preconditioner, r->system, error);
}

enum status relaxation_run(struct solid_system *system, const struct relaxation_options *options, double *u,
                           double *row_force, struct relaxation_report *report, struct error *error)
{
    FREED_BY(relaxation_release)
    struct relaxation r = {.system = system,
                           .options = options,
                           .report = report,
                           .size = system->node_count * system->dim,
                           .u = u,
                           .row_force = row_force,
                           .load_rate = 1.0,
                           .top_rate = 1.0,
                           .step_safety = 1.0,
                           .lanczos_bound = INFINITY};
    *report = (struct relaxation_report){.least_jacobian = 1.0};
    body_limit_bulk(&system->body, bulk_limit);
    RETURN_IF_ERROR(relaxation_allocate(&r, error));
    r.spacing = system_node_spacing(system);
    r.body_size = relaxation_body_size(system);
    r.thickness = relaxation_thickness(system);
    RETURN_IF_ERROR(options->restored != NULL ? resume(&r, error) : begin(&r, error));
    report->outcome = iterate(&r, error);
    RETURN_IF_ERROR(r.failure);
    report->largest_frequency = r.frequency;
    report->move = r.move;
    if (report->outcome == RELAXATION_INVERTED) {
        relaxation_go_back(&r, &r.older);
    }
    report->load = relaxation_load_share(&r);
    if (report->outcome == RELAXATION_CONVERGED && relaxation_gives_frames(&r)) {
        (void)relaxation_give_frame(&r, error);
    } else {
        r.failure = relaxation_row_forces(&r, r.u, row_force, error);
    }
    return r.failure;
}
