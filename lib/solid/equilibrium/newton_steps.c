/* Newton steps: increments of the load, corrections, and leaving a state that is not stable. */
#include "solid/equilibrium/newton_private.h"

#include "base/vector.h"

#include <math.h>
#include <string.h>

/* What is left of the residual's norm at the end of a step: of the first increment, of others, which continue
 * the one before, and of corrections. */
static const double left_at_first = 0.01, left = 0.1;
static const double far = 1e6; /* by the body's size: no bound of the model's step of an increment */
/* No step makes the residual's norm larger than by this factor. */
static const double most_growth = 10.0;
/* Steps in a row that may end where the energy is higher: where a body turns, the step along a straight line
 * stretches it, which the next steps take back (the watchdog of Chamberlain et al. 1982). */
static const int64_t most_uphill = 3;
/* The step after one that went too far, by that. */
static const double shorter = 0.25;
/* Spacings by which the body leaves a state that is not stable. */
static const double leaving = 0.05;
/* By the largest displacement: a shorter step leaves the verdict on stability as it is. */
static const double same_state = 0.01;
static const double least_radius = 1e-3; /* by the spacing: shorter steps are none */
/* A step leaves this share of the least volume ratio of a cell, at least: beyond, its model says nothing. */
static const double least_left = 0.7;
/* Of a contact point past what is opposite, by its width: what is opposite after the step is still found. */
static const double step_by_width = 0.5;

bool newton_held_by_friction(const struct newton *n)
{
    return n->system->floats;
}

/* Evaluate u + step; whether no cell collapses on the way, and the residual does not grow by too much. */
static bool try_step(struct newton *n)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + n->step[i];
    }
    struct deformation deformation = newton_evaluate(n, n->trial, &n->at_trial);
    n->report->least_jacobian = deformation.least_jacobian;
    n->report->inverted_point = deformation.point;
    n->collapses = !(deformation.least_jacobian > least_left * n->at_u.least_jacobian);
    return !n->collapses && newton_square(n, &n->at_trial) <= most_growth * most_growth * n->square;
}

static void shorten(struct newton *n, double part)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->step[i] *= part;
    }
    n->length *= part;
}

/* The share of the step that is taken at most. */
static double most_share(const struct newton *n)
{
    double share = fmin(1.0, n->longest_step / n->length);
    for (int64_t c = 0; c < n->system->contact_count; c++) {
        share = fmin(share, step_by_width / contact_passes(&n->system->contacts[c], n->step));
    }
    return share;
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

void newton_set_load(struct newton *n, double from, double load)
{
    statics_change_load(n->system, from, load, n->factor_change);
    n->load = load;
}

/* Let the step follow the conditions. Of nearly dependent rows one pass leaves 1e-6 of what it takes. */
static void meet_conditions(struct newton *n)
{
    constraint_project(&n->preconditioner.constraint, n->factor_change, n->step);
    constraint_project(&n->preconditioner.constraint, n->factor_change, n->step);
}

/* Take the forces of contacts at u with the multipliers as they are now, which may have advanced with the
 * model. */
static void take_multipliers(struct newton *n)
{
    if (n->system->contact_count > 0) {
        newton_touch(n, n->u, &n->at_u);
        n->square = fmax(n->square, newton_square(n, &n->at_u));
    }
}

bool newton_begin_increment(struct newton *n, double from, double change)
{
    double target = n->hold;
    newton_set_load(n, from, from + change > target * (1.0 - 1e-12) ? target : from + change);
    memset(n->step, 0, (size_t)n->size * sizeof *n->step);
    meet_conditions(n);
    system_predict_friction(n->system, newton_held_by_friction(n));
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->slides) {
        preconditioner_follow(&n->preconditioner, n->system);
    }
    bool continues = n->last_change != 0.0;
    bool whole = newton_solve_model(n, continues ? change / n->last_change : 0.0,
                                    continues ? left : left_at_first, far * n->body_size);
    n->length = newton_longest(n, n->step, NULL);
    take_multipliers(n);
    return whole;
}

/* Whether what the trial lacks is less than the step: from a prediction that has next to no residual, any
 * grows. */
static bool lacks_less(const struct newton *n)
{
    return !n->collapses && newton_longest(n, n->scaled, NULL) <= n->length;
}

bool newton_take_increment(struct newton *n, double from, double change)
{
    double share = most_share(n), part = 1.0;
    for (;; share = 0.5) {
        if (share < 1.0) {
            part *= share;
            shorten(n, share);
            newton_set_load(n, from, from + part * change);
            meet_conditions(n);
        }
        if (try_step(n) || lacks_less(n)) {
            break;
        }
        if (n->length < least_radius * n->spacing) {
            newton_set_load(n, from, from);
            return false;
        }
    }
    n->length = part < 1.0 ? INFINITY : n->length;
    n->last_change = n->load - from;
    memcpy(n->last, n->step, (size_t)n->size * sizeof *n->last);
    take_step(n);
    n->load_change = fmin(n->most_change, fmax(2.0 * n->last_change, shorter * change));
    n->report->loading_steps++;
    n->corrections = n->uphill = 0;
    n->above = 0.0;
    n->pressures_lack = INFINITY;
    n->judged = n->rests = n->settled = false;
    return true;
}

/* By how much the energy rises from u to the trial: that of contacts, less the work of the other forces by
 * Simpson's rule, which is exact for energies of fourth degree; by the trapezium rule where that shows a
 * fall. */
static double rise(struct newton *n)
{
    double contact = n->at_trial.contact_energy - n->at_u.contact_energy;
    double first = vector_product(n->size, n->step, n->at_u.smooth);
    double last = vector_product(n->size, n->step, n->at_trial.smooth);
    if (n->uphill == 0 && 0.5 * (first + last) > contact) {
        return contact - 0.5 * (first + last);
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->search[i] = 0.5 * (n->u[i] + n->trial[i]);
    }
    (void)system_smooth_residual(n->system, n->search, n->product);
    double middle = vector_product(n->size, n->step, n->product);
    (void)newton_evaluate(n, n->trial, &n->at_trial);
    n->report->force_evaluations++;
    return contact - (first + 4.0 * middle + last) / 6.0;
}

/* Return to where the energy was lowest. */
static void go_back(struct newton *n)
{
    memcpy(n->u, n->kept, (size_t)n->size * sizeof *n->u);
    n->uphill = 0;
    n->above = 0.0;
    n->length = INFINITY;
    n->radius = shorter * n->kept_length;
    (void)newton_evaluate(n, n->u, &n->at_u);
    system_accept(n->system);
}

/* Let no point that presses slip, or let them slip again, from u on. */
static void hold(struct newton *n, bool sticks)
{
    n->sticks = sticks;
    newton_touch(n, n->u, &n->at_u);
    system_hold_friction(n->system, sticks);
    newton_touch(n, n->u, &n->at_u);
    preconditioner_follow(&n->preconditioner, n->system);
}

void newton_let_slip(struct newton *n)
{
    hold(n, false);
    n->settled = true;
}

/* What a correction leaves of the residual's norm: as much as the model's own error, which is about the
 * square of the step's, or half of what the tolerance asks; no less than usual while pressures advance
 * between steps, or yields of friction. */
static double left_of_correction(const struct newton *n)
{
    double error = n->report->error, most = fmax(n->options->tolerance, n->round_off / n->report->move);
    double enough = fmax(error, 0.5 * most / error);
    return error > 0.0 && !n->slides && !body_is_limited(&n->system->body) ? fmin(left, enough) : left;
}

/* The step of the model from u. Where that has no minimum, as friction does not hold the body, the pressures
 * may still be those of a step before, or of another distribution of friction: the body sticks until they
 * have settled. */
static bool solve(struct newton *n)
{
    memset(n->step, 0, (size_t)n->size * sizeof *n->step);
    bool whole = newton_solve_model(n, 0.0, n->settled ? left_at_first : left_of_correction(n), n->radius);
    n->settled = false;
    if (whole || n->sticks || !newton_held_by_friction(n)) {
        return whole;
    }
    hold(n, true);
    memset(n->step, 0, (size_t)n->size * sizeof *n->step);
    return newton_solve_model(n, 0.0, left, n->radius);
}

/* After what was tried: the forces at u, and yields of friction by the pressures there. */
static void stay(struct newton *n)
{
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->slides) {
        system_accept(n->system);
    }
}

bool newton_correct(struct newton *n)
{
    double lowest = n->lowest;
    if (n->slides) {
        system_relax_friction(n->system);
        newton_touch(n, n->u, &n->at_u);
    }
    bool whole = solve(n);
    n->length = newton_longest(n, n->step, &n->report->worst_node);
    if (n->length == 0.0) {
        stay(n);
        return true;
    }
    take_multipliers(n);
    double share = most_share(n),
           least = fmin(least_radius * n->spacing, n->options->tolerance * n->report->move);
    if (share < 1.0) {
        shorten(n, share);
        whole = false;
        n->radius = n->length;
    }
    while (!try_step(n)) {
        if (!(n->length > least)) {
            n->lowest = lowest; /* that of a step that goes nowhere is one of round-off */
            stay(n);
            return n->report->error <= n->options->tolerance; /* u needs no step, but perhaps pressures */
        }
        shorten(n, 0.5);
        whole = false;
        n->radius = 0.5 * n->length;
    }
    if (n->uphill == 0) {
        memcpy(n->kept, n->u, (size_t)n->size * sizeof *n->u);
        n->kept_length = n->length;
    }
    n->above = n->length > least ? fmax(0.0, n->above + rise(n)) : 0.0; /* else it is round-off */
    n->uphill = n->above > 0.0 ? n->uphill + 1 : 0;
    if (n->uphill > most_uphill && n->kept_length > least) {
        go_back(n);
        return true;
    }
    take_step(n);
    n->judged = n->judged && n->length < same_state * n->report->move;
    n->radius = fmax(fmin(2.0 * n->radius, n->longest_step), least_radius * n->spacing);
    n->length = whole && n->uphill == 0 ? n->length : INFINITY;
    return true;
}

bool newton_leave(struct newton *n)
{
    double lowest = 0.0, now;
    if (!(newton_curvature(n) < 0.0)) {
        return true;
    }
    memcpy(n->step, n->search, (size_t)n->size * sizeof *n->step);
    n->length = newton_longest(n, n->step, NULL);
    shorten(n, leaving * n->spacing / n->length);
    n->square = INFINITY;
    bool good = try_step(n);
    if (!good) {
        return false;
    }
    for (now = rise(n); good && now < lowest && most_share(n) == 1.0; now = good ? rise(n) : 0.0) {
        lowest = now;
        shorten(n, 2.0);
        good = try_step(n);
    }
    if (!good || now > lowest) {
        shorten(n, 0.5);
        (void)try_step(n);
    }
    take_step(n);
    n->length = INFINITY;
    n->judged = false;
    return true;
}
