/* Increments of the load, and Newton steps at each. */
#include "solid/equilibrium/newton_private.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/system/energy.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Largest ratio of the bulk to the shear modulus in a step, that of Poisson's ratio .49; multipliers, the
 * nodal pressures held, carry the rest. */
static const double bulk_limit = 50.0;
/* What is left of the residual's norm at the end of a step: of the first increment, of others, which continue
 * the one before, and of corrections. */
static const double left_at_first = 0.01, left = 0.1;
/* An increment prescribes a motion of this many spacings, and moves no node by more than this many. */
static const double prescribed_spacings = 1.0, most_spacings = 2.0;
/* The estimated error at which the load grows on, or the corrections after which it does all the same. */
static const double error_between = 0.25;
static const int64_t most_between = 8;
/* Between facets of the body, a step by the width of a point, of which half is searched (contact_between.c).
 */
static const double step_by_width = 0.25;
static const double least_radius = 1e-3; /* by the spacing: shorter steps are none */
/* With contacts, an error that stays below this is accepted: points that alternate between two facets keep it
 * from falling. */
static const double most_hovering = 1e-3;
/* The pressures are augmented after steps shorter than this, by the largest displacement. */
static const double most_length = 0.1;
static const int64_t most_vain = 12; /* corrections in which the error has not halved */
/* By the body's size: a body that moves farther has no equilibrium. */
static const double most_sizes = 10.0;
static const int64_t usual_most_steps = 100000;

/* How far a node may move in a step: between facets of the body so far that what is opposite a point is still
 * found. */
static double longest_step(const struct newton *n)
{
    const struct solid_system *system = n->system;
    double most = n->body_size;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t p = 0; contact->between != NULL && p < contact->count; p++) {
            most = fmin(most, step_by_width * contact_width(contact, p));
        }
    }
    return most;
}

/* ---- the preconditioner ---- */

/* Set the mass of the preconditioner by the last evaluation, which was at u. */
static enum status weigh(struct newton *n, struct error *error)
{
    system_relaxation_mass(n->system, false, n->scaled);
    return preconditioner_set_mass(&n->preconditioner, n->system, n->scaled, error);
}

/* Measure the coarse fields at u, and evaluate it again. */
static enum status measure(struct newton *n, struct error *error)
{
    struct preconditioner *p = &n->preconditioner;
    n->lowest = 0.0;
    RETURN_IF_ERROR(preconditioner_measure(p, n->system, n->u, &n->report->force_evaluations, error));
    (void)newton_evaluate(n, n->u, &n->at_u);
    (void)preconditioner_follow(p, n->system, true, NULL, NULL);
    return STATUS_OK;
}

/* ---- steps ---- */

/* Evaluate u + share * step; whether no cell is inverted there. */
static bool try_step(struct newton *n, double share)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + share * n->step[i];
    }
    struct deformation deformation = newton_evaluate(n, n->trial, &n->at_trial);
    n->report->least_jacobian = deformation.least_jacobian;
    if (!(deformation.least_jacobian > 0.0)) {
        n->report->inverted_point = deformation.point;
    }
    return deformation.least_jacobian > 0.0;
}

/* Go to what was tried. */
static void take_step(struct newton *n)
{
    double *u = n->at_u.smooth, *contact = n->at_u.contact;
    memcpy(n->u, n->trial, (size_t)n->size * sizeof *n->u);
    n->at_u = n->at_trial;
    n->at_trial.smooth = u;
    n->at_trial.contact = contact;
    system_accept(n->system);
}

/* Set the load; n->factor_change becomes the change of the load curves from those at load `from`. */
static void set_load(struct newton *n, double from, double load)
{
    struct solid_system *system = n->system;
    system_load_factors(system, from);
    memcpy(n->factor_change, system->factor, (size_t)system->curve_count * sizeof *n->factor_change);
    system_load_factors(system, load);
    for (int64_t i = 0; i < system->curve_count; i++) {
        n->factor_change[i] = system->factor[i] - n->factor_change[i];
    }
    n->load = load;
}

/* Start the model's step at what continues the last increment by `part` of it and follows the conditions. */
static void predict(struct newton *n, double part)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->step[i] = part * n->last[i];
    }
    constraint_project(&n->preconditioner.constraint, n->factor_change, n->step);
}

/* Increase the load, by less where the body would move too far or cells would invert. False where no
 * increment is small enough. */
static bool increase_load(struct newton *n)
{
    double from = n->load, target = newton_load_to_hold(n), square = 0.0, radius = n->body_size;
    double share = n->last_change != 0.0 ? left : left_at_first, least = 0.5 * n->report->least_jacobian;
    const double most = fmin(most_spacings * n->spacing, n->longest_step);
    n->report->loading_steps++;
    while (radius > least_radius * n->spacing) {
        double change = fmin(n->load_change, target - from);
        set_load(n, from, from + change > target * (1.0 - 1e-12) ? target : from + change);
        predict(n, n->last_change != 0.0 ? change / n->last_change : 0.0);
        (void)newton_evaluate(n, n->u, &n->at_u);
        (void)newton_solve_model(n, share, radius, &square);
        double length = newton_longest(n, n->step, NULL);
        bool far = radius > most && length > most;
        if (!far && try_step(n, 1.0) && n->report->least_jacobian > least) {
            n->last_change = n->load - from;
            memcpy(n->last, n->step, (size_t)n->size * sizeof *n->last);
            take_step(n);
            n->load_change = fmin(n->most_change, 2.0 * n->load_change);
            return true;
        }
        n->load_change = change * (far ? most / length : 0.5);
        radius = radius > most ? most : 0.5 * radius;
        set_load(n, from, from);
    }
    return false;
}

/* Whether the energy falls from u to u + share * step, which was tried. That of the body is the work of its
 * forces by the trapezium rule. */
static bool falls(const struct newton *n, double share)
{
    double work = 0.0;
    for (int64_t i = 0; i < n->size; i++) {
        work += n->step[i] * (n->at_u.smooth[i] + n->at_trial.smooth[i]);
    }
    return 0.5 * share * work > n->at_trial.contact_energy - n->at_u.contact_energy;
}

static bool contacts_lack(const struct newton *n)
{
    return system_contacts_give_way(n->system, n->u, n->report->move, n->options->tolerance);
}

/* What the nodal pressures may lack. */
static double most_lack(const struct newton *n)
{
    return fmin(NODAL_PRESSURE_LACK, 10.0 * n->options->tolerance);
}

/* Let the multipliers of nodal pressures and contacts advance by what was evaluated at u, and evaluate it
 * with the new ones. */
static void augment(struct newton *n)
{
    bool near = n->corrections > 0 && n->length < most_length * n->report->move;
    bool pressures = near && body_is_limited(&n->system->body);
    bool contacts = n->system->contact_count > 0 && n->corrections < NEWTON_MOST_AUGMENTATIONS &&
                    (n->corrections <= 1 || contacts_lack(n));
    if (pressures) {
        n->pressures_lack =
            body_augment(&n->system->body, n->corrections > 1, most_lack(n), n->report->move / n->body_size);
    }
    if (contacts) {
        system_augment_contacts(n->system, false);
    }
    if (system_stiffen_contacts(n->system)) {
        preconditioner_take_penalties(&n->preconditioner, n->system);
    }
    if (pressures || n->system->contact_count > 0) {
        (void)newton_evaluate(n, n->u, &n->at_u);
        (void)preconditioner_follow(&n->preconditioner, n->system, true, NULL, NULL);
    }
}

/* A Newton step at this load. False where even a short one inverts cells. */
static bool correct(struct newton *n)
{
    double share = 1.0;
    memset(n->step, 0, (size_t)n->size * sizeof *n->step);
    bool solved = newton_solve_model(n, left, n->radius, &n->square);
    double length = newton_longest(n, n->step, &n->report->worst_node);
    if (length == 0.0) {
        n->length = length;
        return true;
    }
    newton_touch(n, n->u, &n->at_u); /* with the multipliers as they are now */
    double least = fmin(least_radius * n->spacing, n->options->tolerance * n->report->move);
    bool good = try_step(n, share);
    while (!(good && falls(n, share)) && share * length > least) {
        share *= 0.5;
        good = try_step(n, share);
    }
    if (!good) {
        return false;
    }
    take_step(n);
    n->length = share < 1.0 || !solved ? INFINITY : length;
    n->radius = share < 1.0 ? share * length : fmin(2.0 * n->radius, n->longest_step);
    n->radius = fmax(n->radius, least_radius * n->spacing);
    return true;
}

/* ---- ends ---- */

/* Estimate the error of u, with the residual of the multipliers that were advanced. */
static void estimate(struct newton *n)
{
    struct relaxation_report *report = n->report;
    double square = newton_square(n), move = newton_longest(n, n->u, NULL);
    n->largest_move = fmax(n->largest_move, move);
    report->move = fmax(move, n->options->tolerance * n->largest_move);
    double left_of = n->square > 0.0 ? sqrt(fmax(square, 0.0) / n->square) : 0.0;
    double error = left_of < 1.0 ? n->length * left_of / (1.0 - left_of) : INFINITY;
    if (n->lowest > 0.0) {
        error = newton_longest(n, n->scaled, &report->worst_node) / n->lowest;
    }
    bool at_rest = report->move <= DBL_EPSILON * n->body_size || !(square > 0.0);
    report->error = at_rest ? 0.0 : n->corrections > 0 ? error / report->move : INFINITY;
}

/* The error estimate that round-off alone causes, some units in the last place of positions. */
static double round_off(const struct newton *n)
{
    return 32.0 * DBL_EPSILON * n->body_size / n->report->move;
}

/* Whether the run at this load ends, and its outcome. */
static bool ends(struct newton *n, enum relaxation_outcome *outcome)
{
    struct relaxation_report *report = n->report;
    double own_way = report->move - most_sizes * n->body_size; /* beyond what is prescribed, if that is far */
    if (n->corrections <= 1 || report->error < 0.5 * n->best_error) {
        n->best_error = report->error;
        n->best_step = report->steps;
    }
    if (own_way > 0.0 && own_way > system_longest_way(n->system)) {
        *outcome = RELAXATION_AWAY;
        return true;
    }
    if (report->error <= n->options->tolerance && n->lowest == 0.0) {
        newton_judge_stability(n);
        estimate(n);
    }
    bool vain = report->steps - n->best_step > most_vain;
    double most = n->options->tolerance;
    if (vain) {
        most = fmax(most, system_has_touched(n->system) ? most_hovering : round_off(n));
    }
    bool pressures = !body_is_limited(&n->system->body) || n->pressures_lack <= most_lack(n);
    bool contacts = !contacts_lack(n) || n->corrections >= NEWTON_MOST_AUGMENTATIONS;
    bool found = report->error <= most && pressures && contacts;
    report->penetration = system_contact_miss(n->system);
    report->penetration_allowed = system_penetration_allowed(report->move);
    *outcome = found ? RELAXATION_CONVERGED : RELAXATION_STALLED;
    return found || report->steps - n->best_step > 4 * most_vain;
}

/* An equilibrium at this load: false where the run ends, with the outcome or n->failure. */
static bool goes_on(struct newton *n, struct error *error)
{
    n->failure = newton_give_frame(n, error);
    return n->failure == STATUS_OK && n->load < 1.0;
}

/* Whether the load grows in the next step. */
static bool loads(const struct newton *n)
{
    return n->load < newton_load_to_hold(n) &&
           (n->corrections > most_between || (n->corrections > 0 && n->report->error < error_between));
}

/* The next step: an increment of the load, or a correction. False where cells invert, or on failure. */
static bool step(struct newton *n, struct error *error)
{
    n->report->steps++;
    if (!loads(n)) {
        n->corrections++;
        return correct(n);
    }
    n->corrections = 0;
    if (!increase_load(n)) {
        return false;
    }
    n->failure = weigh(n, error);
    if (n->failure == STATUS_OK) {
        n->failure = measure(n, error);
    }
    return n->failure == STATUS_OK;
}

static enum relaxation_outcome iterate(struct newton *n, struct error *error)
{
    enum relaxation_outcome outcome;
    int64_t most = n->options->most_steps > 0 ? n->options->most_steps : usual_most_steps;
    while (n->report->steps < most) {
        if (!step(n, error)) {
            return n->failure == STATUS_OK ? RELAXATION_INVERTED : RELAXATION_STOPPED;
        }
        augment(n);
        estimate(n);
        if (n->corrections > 0 && n->load == newton_load_to_hold(n) && ends(n, &outcome) &&
            (outcome != RELAXATION_CONVERGED || !goes_on(n, error))) {
            return outcome;
        }
        if (!newton_tell(n)) {
            return RELAXATION_STOPPED;
        }
    }
    return RELAXATION_TOO_MANY_STEPS;
}

/* Start at rest from u, projected onto the conditions, without load or with that of a given start
 * (system_start). */
static enum status begin(struct newton *n, struct error *error)
{
    struct solid_system *system = n->system;
    n->load = n->options->in_time && system_begins_loaded(system) ? -1.0 : 0.0;
    system_load_factors(system, n->load);
    system_measure_contacts(system, n->u, true);
    system_accept(system);
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->options->frame != NULL && n->options->frames > 0 && !n->options->in_time) {
        n->options->frame(n->options->context, 0, 0.0, n->u);
    }
    RETURN_IF_ERROR(weigh(n, error));
    constraint_project(&n->preconditioner.constraint, system->factor, n->u);
    n->radius = fmin(n->spacing, n->longest_step);
    n->load_change = n->most_change;
    n->corrections = most_between + 1;
    return measure(n, error);
}

/* Continue from the state of another run. */
static enum status resume(struct newton *n, struct error *error)
{
    RETURN_IF_ERROR(newton_visit(n, n->options->restored, error));
    RETURN_IF_ERROR(preconditioner_restore(&n->preconditioner, n->system, error));
    (void)newton_evaluate(n, n->u, &n->at_u);
    return STATUS_OK;
}

enum status newton_run(struct solid_system *system, const struct relaxation_options *options, double *u,
                       double *row_force, struct relaxation_report *report, struct error *error)
{
    FREED_BY(newton_release)
    struct newton n = {.system = system,
                       .options = options,
                       .report = report,
                       .size = system->node_count * system->dim,
                       .u = u,
                       .row_force = row_force};
    struct box box = box_of(system->dim, system->node_count, system->X);
    *report = (struct relaxation_report){.least_jacobian = 1.0};
    body_limit_bulk(&system->body, bulk_limit);
    RETURN_IF_ERROR(newton_allocate(&n, error));
    n.spacing = system_node_spacing(system);
    n.body_size = box_diagonal(&box);
    n.most_change = 1.0 / fmax(1.0, ceil(system_longest_change(system) / (prescribed_spacings * n.spacing)));
    n.longest_step = longest_step(&n);
    RETURN_IF_ERROR(options->restored != NULL ? resume(&n, error) : begin(&n, error));
    report->outcome = iterate(&n, error);
    RETURN_IF_ERROR(n.failure);
    report->load = newton_load_share(&n);
    return report->outcome == RELAXATION_CONVERGED ? STATUS_OK : newton_row_forces(&n, error);
}
