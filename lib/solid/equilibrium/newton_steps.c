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
/* Spacings by which the body leaves a state that is not stable. */
static const double leaving = 0.05;
/* By the largest displacement: a shorter step leaves the verdict on stability as it is. */
static const double same_state = 0.01;
static const double least_radius = 1e-3; /* by the spacing: shorter steps are none */
/* A step leaves this share of the least volume ratio of a cell, at least: beyond, its model says nothing. */
static const double least_left = 0.7;
/* Of a contact point past what is opposite, by its width: what is opposite after the step is still found. */
static const double step_by_width = 0.5;
static const double same_load = 1e-9; /* loads that differ by less are the same */
/* Places at which the curves are looked at for an increment of the load. */
enum { LOOKS = 100 };

/* Evaluate u + step; whether no cell collapses on the way, and the residual does not grow by too much. */
static bool try_step(struct newton *n)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + n->step.move[i];
    }
    struct deformation deformation = newton_evaluate(n, n->trial, &n->at_trial);
    n->report->least_jacobian = deformation.least_jacobian;
    n->report->inverted_point = deformation.point;
    n->step.collapses = !(deformation.least_jacobian > least_left * n->at_u.least_jacobian);
    return !n->step.collapses && newton_square(n, &n->at_trial) <= most_growth * most_growth * n->step.square;
}

static void shorten(struct newton *n, double part)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->step.move[i] *= part;
    }
    n->step.length *= part;
}

/* The share of the step that is taken at most. */
static double most_share(const struct newton *n)
{
    double share = fmin(1.0, n->scale.longest_step / n->step.length);
    for (int64_t c = 0; c < n->system->contact_count; c++) {
        share = fmin(share, step_by_width / contact_passes(&n->system->contacts[c], n->step.move));
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
    statics_change_load(n->system, from, load, n->load.factor_change);
    n->load.now = load;
}

/* Let the step follow the conditions. Of nearly dependent rows one pass leaves 1e-6 of what it takes. */
static void meet_conditions(struct newton *n)
{
    constraint_project(&n->preconditioner.constraint, n->load.factor_change, n->step.move);
    constraint_project(&n->preconditioner.constraint, n->load.factor_change, n->step.move);
}

/* Take the forces of contacts at u with the multipliers as they are now, which may have advanced with the
 * model. */
static void take_multipliers(struct newton *n)
{
    if (n->system->contact_count > 0) {
        newton_touch(n, n->u, &n->at_u);
        n->step.square = fmax(n->step.square, newton_square(n, &n->at_u));
    }
}

double newton_span(const struct newton *n, double from, double to)
{
    double span = 0.0;
    for (int64_t c = 0; c < n->system->curve_count; c++) {
        double largest = curve_largest(&n->system->curves[c]);
        double change = system_load_factor(n->system, c, to) - system_load_factor(n->system, c, from);
        span = fmax(span, largest > 0.0 ? fabs(change) / largest : 0.0);
    }
    return span;
}

/* Where the step of the load ends that goes on at `from`, no later than where a curve turns. */
static double end_of_step(const struct newton *n, double from)
{
    double steps = (double)n->options->steps, passed = from + same_load;
    double end = steps > 0.0 ? floor(fmax(passed, 0.0) * steps + 1.0) / steps : INFINITY;
    for (int64_t c = 0; c < n->system->curve_count; c++) {
        end = fmin(end, curve_next_turn(&n->system->curves[c], passed));
    }
    return end < n->load.hold * (1.0 - 1e-12) ? end : n->load.hold;
}

double newton_load_after(const struct newton *n, double from, double span)
{
    double end = end_of_step(n, from), low = from, high = from, part = (end - from) / LOOKS;
    span = span > 0.0 ? span : n->load.most;
    while (high < end) {
        low = high;
        high = high + part < end * (1.0 - 1e-12) ? high + part : end;
        if (newton_span(n, from, high) > span * (1.0 + 1e-9)) {
            break;
        }
        low = high;
    }
    while (high - low > 1e-9 * part) { /* a curve may leap within that */
        double middle = 0.5 * (low + high);
        *(newton_span(n, from, middle) > span ? &high : &low) = middle;
    }
    return high;
}

bool newton_begin_increment(struct newton *n, double from, double to)
{
    struct prescribed_values *values = &n->system->body.cells.prescribed;
    double span = newton_span(n, from, to);
    newton_set_load(n, from, to);
    values->lag = 1.0; /* they are where u is */
    values->change = n->load.factor_change;
    memset(n->step.move, 0, (size_t)n->size * sizeof *n->step.move);
    meet_conditions(n);
    system_predict_friction(n->system, system_held_by_friction(n->system));
    if (system_acts_outside(n->system)) {
        system_change_load(n->system, n->u, from, to, n->cg.product, n->at_u.smooth);
        newton_touch(n, n->u, &n->at_u);
    } else {
        (void)newton_evaluate(n, n->u, &n->at_u);
    }
    if (n->friction.slides) {
        preconditioner_follow(&n->preconditioner, n->system);
    }
    bool continues = n->load.last != 0.0;
    bool whole = newton_solve_model(n, continues ? span / n->load.last : 0.0,
                                    continues ? left : left_at_first, far * n->scale.body);
    values->change = NULL;
    n->step.length = newton_longest(n, n->step.move, NULL);
    take_multipliers(n);
    return whole;
}

/* Whether what the trial lacks is finite and less than the step: from a prediction that has next to no
 * residual, any grows. */
static bool lacks_less(const struct newton *n)
{
    return !n->step.collapses && isfinite(vector_dot(n->size, n->cg.scaled, n->cg.scaled)) &&
           newton_longest(n, n->cg.scaled, NULL) <= n->step.length;
}

bool newton_take_increment(struct newton *n, double from, double to)
{
    double share = most_share(n), part = 1.0, span = newton_span(n, from, to);
    for (;; share = 0.5) {
        if (share < 1.0) {
            part *= share;
            shorten(n, share);
            newton_set_load(n, from, newton_load_after(n, from, part * span));
            meet_conditions(n);
        }
        if (try_step(n) || lacks_less(n)) {
            break;
        }
        if (n->step.length < least_radius * n->scale.spacing) {
            newton_set_load(n, from, from);
            return false;
        }
    }
    n->step.length = part < 1.0 ? INFINITY : n->step.length;
    n->load.last = newton_span(n, from, n->load.now);
    memcpy(n->load.move, n->step.move, (size_t)n->size * sizeof *n->load.move);
    take_step(n);
    n->load.next = fmin(fmin(n->load.most, n->path.most),
                        part < 1.0 ? fmax(2.0 * n->load.last, NEWTON_SHORTER * span) : 2.0 * n->load.next);
    n->report->loading_steps++;
    n->load.corrections = n->watch.steps = 0;
    n->watch.above = 0.0;
    n->verdict.pressures_lack = INFINITY;
    n->verdict.judged = n->friction.rests = n->friction.settled = false;
    newton_begin_path(n, from);
    return true;
}

/* By how much the energy rises from u to the trial: that of contacts, less the work of the other forces by
 * Simpson's rule, which is exact for energies of fourth degree; by the trapezium rule where that shows a
 * fall. */
static double rise(struct newton *n)
{
    double contact = n->at_trial.contact_energy - n->at_u.contact_energy;
    double first = vector_dot(n->size, n->step.move, n->at_u.smooth);
    double last = vector_dot(n->size, n->step.move, n->at_trial.smooth);
    if (n->watch.steps == 0 && 0.5 * (first + last) > contact) {
        return contact - 0.5 * (first + last);
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->cg.search[i] = 0.5 * (n->u[i] + n->trial[i]);
    }
    (void)system_smooth_residual(n->system, n->cg.search, n->cg.product);
    double middle = vector_dot(n->size, n->step.move, n->cg.product);
    (void)newton_evaluate(n, n->trial, &n->at_trial);
    n->report->force_evaluations++;
    return contact - (first + 4.0 * middle + last) / 6.0;
}

void newton_return(struct newton *n, const double *u)
{
    memcpy(n->u, u, (size_t)n->size * sizeof *n->u);
    n->watch.steps = 0;
    n->watch.above = 0.0;
    n->step.length = INFINITY;
    (void)newton_evaluate(n, n->u, &n->at_u);
    system_accept(n->system);
}

/* Let no point that presses slip, or let them slip again, from u on. */
static void hold(struct newton *n, bool sticks)
{
    n->friction.sticks = sticks;
    newton_touch(n, n->u, &n->at_u);
    system_hold_friction(n->system, sticks);
    newton_touch(n, n->u, &n->at_u);
    preconditioner_follow(&n->preconditioner, n->system);
}

void newton_let_slip(struct newton *n)
{
    hold(n, false);
    n->friction.settled = true;
}

/* What a correction leaves of the residual's norm: as much as the model's own error, which is about the
 * square of the step's, or half of what the tolerance asks; no less than usual while pressures advance
 * between steps, or yields of friction. */
static double left_of_correction(const struct newton *n)
{
    double error = n->report->error, most = fmax(n->options->tolerance, n->scale.round_off / n->report->move);
    double enough = fmax(error, 0.5 * most / error);
    return error > 0.0 && !n->friction.slides && !body_is_limited(&n->system->body) ? fmin(left, enough)
                                                                                    : left;
}

/* The step of the model from u. Where that has no minimum, as friction does not hold the body, the pressures
 * may still be those of a step before, or of another distribution of friction: the body sticks until they
 * have settled. */
static bool solve(struct newton *n)
{
    memset(n->step.move, 0, (size_t)n->size * sizeof *n->step.move);
    bool whole = newton_solve_model(n, 0.0, n->friction.settled ? left_at_first : left_of_correction(n),
                                    n->step.radius);
    n->friction.settled = false;
    if (whole || n->friction.sticks || !system_held_by_friction(n->system)) {
        return whole;
    }
    hold(n, true);
    memset(n->step.move, 0, (size_t)n->size * sizeof *n->step.move);
    return newton_solve_model(n, 0.0, left, n->step.radius);
}

/* After what was tried: the forces at u, and yields of friction by the pressures there. */
static void stay(struct newton *n)
{
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->friction.slides) {
        system_accept(n->system);
    }
}

bool newton_correct(struct newton *n)
{
    double lowest = n->verdict.lowest;
    if (n->friction.slides) {
        system_relax_friction(n->system);
        newton_touch(n, n->u, &n->at_u);
    }
    bool whole = solve(n);
    n->step.length = newton_longest(n, n->step.move, &n->report->worst_node);
    if (n->step.length == 0.0) {
        stay(n);
        return true;
    }
    take_multipliers(n);
    double share = most_share(n),
           least = fmin(least_radius * n->scale.spacing, n->options->tolerance * n->report->move);
    if (share < 1.0) {
        shorten(n, share);
        whole = false;
        n->step.radius = n->step.length;
    }
    while (!try_step(n)) {
        if (!(n->step.length > least)) {
            n->verdict.lowest = lowest; /* that of a step that goes nowhere is one of round-off */
            stay(n);
            return n->report->error <= n->options->tolerance; /* u needs no step, but perhaps pressures */
        }
        shorten(n, 0.5);
        whole = false;
        n->step.radius = 0.5 * n->step.length;
    }
    if (n->watch.steps == 0) {
        memcpy(n->watch.start, n->u, (size_t)n->size * sizeof *n->u);
        n->watch.length = n->step.length;
    }
    n->watch.above =
        n->step.length > least ? fmax(0.0, n->watch.above + rise(n)) : 0.0; /* else it is round-off */
    n->watch.steps = n->watch.above > 0.0 ? n->watch.steps + 1 : 0;
    if (n->watch.steps > most_uphill && n->watch.length > least) {
        newton_return(n, n->watch.start); /* where the energy was lowest */
        n->step.radius = NEWTON_SHORTER * n->watch.length;
        return true;
    }
    take_step(n);
    n->verdict.judged = n->verdict.judged && n->step.length < same_state * n->report->move;
    n->step.radius = fmax(fmin(2.0 * n->step.radius, n->scale.longest_step), least_radius * n->scale.spacing);
    n->step.length = whole && n->watch.steps == 0 ? n->step.length : INFINITY;
    return true;
}

bool newton_leave(struct newton *n)
{
    double lowest = 0.0, now;
    if (!(newton_curvature(n) < 0.0)) {
        return true;
    }
    int64_t node;
    memcpy(n->step.move, n->cg.search, (size_t)n->size * sizeof *n->step.move);
    n->step.length = newton_longest(n, n->step.move, &node);
    newton_leave_path(n, node);
    shorten(n, leaving * n->scale.spacing / n->step.length);
    n->step.square = INFINITY;
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
    n->step.length = INFINITY;
    n->verdict.judged = false;
    return true;
}
