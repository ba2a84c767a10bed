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

/* What is left of the residual's norm at the end of a step: of the first increment, of others, which continue
 * the one before, and of corrections. */
static const double left_at_first = 0.01, left = 0.1;
/* An increment prescribes a motion of this many spacings. */
static const double prescribed_spacings = 0.7;
/* By the body's size: a step moves no node by more than this, */
static const double most_of_size = 0.1, far = 1e6; /* but the model's step of an increment */
/* and no step makes the residual's norm larger than by this factor. */
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
/* The estimated error at which the load grows on. */
static const double error_between = 0.2;
/* Between facets of the body, a step by the width of a point, of which half is searched (contact_between.c).
 */
static const double step_by_width = 0.25;
static const double least_radius = 1e-3; /* by the spacing: shorter steps are none */
/* With contacts, an error that stays below this is accepted: points that alternate between two facets keep it
 * from falling. */
static const double most_hovering = 1e-3;
/* A body whose largest displacement grows by this factor has not come to its end; nor one whose load does by
 * this share. */
static const double moves_on = 1.1, least_growth = 1e-3;
/* The pressures are augmented after steps shorter than this, by the largest displacement. */
static const double most_length = 0.1;
static const int64_t most_vain = 12; /* corrections in which the error has not halved */
static const int64_t usual_most_steps = 100000;

/* Whether friction alone may hold a body, which slides if it does not. */
static bool held_by_friction(const struct newton *n)
{
    return n->slides && n->preconditioner.has_rigid_mode;
}

/* How far a node may move in a step: between facets of the body so far that what is opposite a point is still
 * found. */
static double longest_step(const struct newton *n)
{
    const struct solid_system *system = n->system;
    double most = most_of_size * n->body_size;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t p = 0; contact->between != NULL && p < contact->count; p++) {
            most = fmin(most, step_by_width * contact_width(contact, p));
        }
    }
    return most;
}

/* ---- the preconditioner ---- */

/* Set the preconditioner's mass and measure the coarse fields at u, which was evaluated last. */
static enum status measure(struct newton *n, struct error *error)
{
    struct preconditioner *p = &n->preconditioner;
    int64_t before = n->report->force_evaluations;
    system_relaxation_mass(n->system, false, n->scaled);
    preconditioner_set_mass(p, n->scaled);
    RETURN_IF_ERROR(preconditioner_measure(p, n->system, n->u, &n->report->force_evaluations, error));
    n->cost = n->report->force_evaluations - before;
    n->excess = 0.0;
    n->usual = n->lowest = INFINITY;
    (void)newton_evaluate(n, n->u, &n->at_u);
    preconditioner_follow(p, n->system);
    return STATUS_OK;
}

/* ---- steps ---- */

/* Evaluate u + step; whether no cell is inverted there, and the residual has not grown by too much. */
static bool try_step(struct newton *n)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + n->step[i];
    }
    struct deformation deformation = newton_evaluate(n, n->trial, &n->at_trial);
    n->report->least_jacobian = deformation.least_jacobian;
    if (!(deformation.least_jacobian > 0.0)) {
        n->report->inverted_point = deformation.point;
        return false;
    }
    return newton_square(n, &n->at_trial) <= most_growth * most_growth * n->square;
}

static void shorten(struct newton *n, double part)
{
    for (int64_t i = 0; i < n->size; i++) {
        n->step[i] *= part;
    }
    n->length *= part;
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

/* Let the step follow the conditions. Of nearly dependent rows one pass leaves 1e-6 of what it takes. */
static void meet_conditions(struct newton *n)
{
    constraint_project(&n->preconditioner.constraint, n->factor_change, n->step);
    constraint_project(&n->preconditioner.constraint, n->factor_change, n->step);
}

/* Start the model's step at what continues the last increment and follows the conditions. */
static void predict(struct newton *n, double change)
{
    bool goes_on =
        n->last_change != 0.0 && n->system->contact_count == 0; /* else it may go through a surface */
    double part = goes_on ? change / n->last_change : 0.0;
    for (int64_t i = 0; i < n->size; i++) {
        n->step[i] = part * n->last[i];
    }
    meet_conditions(n);
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

/* Increase the load and find the step of the model there. False where that has no minimum. */
static bool begin_increment(struct newton *n, double from, double change)
{
    double target = newton_load_to_hold(n);
    set_load(n, from, from + change > target * (1.0 - 1e-12) ? target : from + change);
    predict(n, change);
    system_predict_friction(n->system, held_by_friction(n));
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->slides) {
        preconditioner_follow(&n->preconditioner, n->system);
    }
    bool whole = newton_solve_model(n, n->last_change != 0.0 ? left : left_at_first, far * n->body_size);
    n->length = newton_longest(n, n->step, NULL);
    take_multipliers(n);
    return whole;
}

/* Go along that step with the load, not so far that the body would move too far or cells would invert. False
 * where no increment is small enough. */
static bool take_increment(struct newton *n, double from, double change)
{
    double share = fmin(1.0, n->longest_step / n->length), part = 1.0;
    for (;; share = 0.5) {
        if (share < 1.0) {
            part *= share;
            shorten(n, share);
            set_load(n, from, from + part * change);
            meet_conditions(n);
        }
        if (try_step(n)) {
            break;
        }
        if (n->length < least_radius * n->spacing) {
            set_load(n, from, from);
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
    n->judged = n->rests = false;
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
    if (n->uphill > 0) {
        return;
    }
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
    bool stiffer = system_stiffen(n->system);
    if (stiffer || pressures || n->system->contact_count > 0) {
        (void)newton_evaluate(n, n->u, &n->at_u);
        preconditioner_follow(&n->preconditioner, n->system);
    }
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

/* The step of the model from u. Where friction does not hold the body, as its pressures are those of a step
 * before, the step with the predicted ones is taken, as long as that finds better pressures. */
static bool solve(struct newton *n)
{
    memset(n->step, 0, (size_t)n->size * sizeof *n->step);
    if (newton_solve_model(n, left, n->radius)) {
        return true;
    }
    for (int held = 1; held >= 0 && held_by_friction(n); held--) {
        if (held == 1) {
            newton_touch(n, n->u, &n->at_u);
            system_predict_friction(n->system, true);
        } else {
            system_accept(n->system);
        }
        newton_touch(n, n->u, &n->at_u);
        preconditioner_follow(&n->preconditioner, n->system);
        memset(n->step, 0, (size_t)n->size * sizeof *n->step);
        bool whole = newton_solve_model(n, left, n->radius);
        if (held == 1 && whole &&
            newton_longest(n, n->step, NULL) > n->options->tolerance * n->report->move) {
            return true;
        }
        newton_touch(n, n->u, &n->at_u);
    }
    return false;
}

/* A Newton step at this load. False where even a short one inverts cells. */
static bool correct(struct newton *n)
{
    bool whole = solve(n);
    n->length = newton_longest(n, n->step, &n->report->worst_node);
    if (n->length == 0.0) {
        return true;
    }
    take_multipliers(n);
    double least = fmin(least_radius * n->spacing, n->options->tolerance * n->report->move);
    while (!try_step(n)) {
        if (!(n->length > least)) {
            return false;
        }
        shorten(n, 0.5);
        whole = false;
        n->radius = 0.5 * n->length;
    }
    if (n->uphill == 0) {
        memcpy(n->kept, n->u, (size_t)n->size * sizeof *n->u);
        n->kept_length = n->length;
    }
    n->above += rise(n);
    n->uphill = n->above > 0.0 ? n->uphill + 1 : 0;
    n->above = fmax(n->above, 0.0);
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

/* ---- ends ---- */

/* Estimate the error of u, with the residual of the multipliers that were advanced. */
static void estimate(struct newton *n)
{
    struct statics_report *report = n->report;
    double square = newton_square(n, &n->at_u), move = newton_longest(n, n->u, NULL);
    n->largest_move = fmax(n->largest_move, move);
    report->move = fmax(move, n->options->tolerance * n->largest_move);
    double lowest = isinf(n->lowest) ? NEWTON_LEAST_TOLD : fmax(n->lowest, NEWTON_LEAST_TOLD);
    double error = newton_longest(n, n->scaled, &report->worst_node) / lowest;
    bool at_rest = report->move <= DBL_EPSILON * n->body_size || !(square > 0.0);
    report->error = at_rest ? 0.0 : error / report->move;
}

/* The error estimate that round-off alone causes, some units in the last place of positions. */
static double round_off(const struct newton *n)
{
    return 32.0 * DBL_EPSILON * n->body_size / n->report->move;
}

/* Whether the body has moved farther than any equilibrium is. */
static bool is_away(const struct newton *n)
{
    double own_way =
        n->report->move - STATICS_MOST_SIZES * n->body_size; /* beyond what is prescribed, if that is far */
    return own_way > 0.0 && own_way > system_longest_way(n->system);
}

/* Note progress at this load. Returns the steps without. */
static int64_t note_progress(struct newton *n)
{
    struct statics_report *report = n->report;
    if (n->load > n->best_load + least_growth || report->steps == 1 || report->error < 0.5 * n->best_error ||
        report->move > moves_on * n->best_move) {
        n->best_load = n->load;
        n->best_error = report->error;
        n->best_move = report->move;
        n->best_step = report->steps;
    }
    return report->steps - n->best_step;
}

/* Whether u is the equilibrium at this load. */
static bool is_found(struct newton *n, bool vain)
{
    struct statics_report *report = n->report;
    double most = n->options->tolerance;
    if (report->error <= most && !n->judged) {
        newton_judge_stability(n);
        n->judged = true;
        estimate(n);
    }
    if (vain) {
        bool hovers = system_has_touched(n->system) && !held_by_friction(n);
        most = fmax(most, hovers ? most_hovering : round_off(n));
    }
    bool pressures = !body_is_limited(&n->system->body) || n->pressures_lack <= most_lack(n);
    bool contacts = !contacts_lack(n) || n->corrections >= NEWTON_MOST_AUGMENTATIONS;
    report->penetration = system_contact_miss(n->system);
    report->penetration_allowed = system_penetration_allowed(report->move);
    return report->error <= most && pressures && contacts;
}

/* Whether the run at this load ends, and its outcome. */
static bool ends(struct newton *n, enum statics_outcome *outcome)
{
    int64_t vain = note_progress(n);
    bool holds = n->slides || n->load == newton_load_to_hold(n);
    bool found = n->corrections > 0 && holds && is_found(n, vain > most_vain);
    *outcome = found ? STATICS_CONVERGED : is_away(n) ? STATICS_AWAY : STATICS_STALLED;
    return found || is_away(n) || vain > 4 * most_vain;
}

/* An equilibrium at this load: false where the run ends, with the outcome or n->failure. */
static bool goes_on(struct newton *n, struct error *error)
{
    system_slide(n->system);
    n->rests = true;
    n->failure = n->load == newton_load_to_hold(n) ? newton_give_frame(n, error) : STATUS_OK;
    return n->failure == STATUS_OK && n->load < 1.0;
}

/* Whether the load grows in the next step. */
static bool loads(const struct newton *n)
{
    return n->load < newton_load_to_hold(n) && n->uphill == 0 &&
           (n->slides ? n->rests : n->report->error < error_between);
}

/* Leave a state near an equilibrium that is not stable, along the last search direction, of negative
 * stiffness, twice as far each time while the energy falls. False where cells invert at once. */
static bool leave(struct newton *n)
{
    double lowest = 0.0, now;
    memcpy(n->step, n->search, (size_t)n->size * sizeof *n->step);
    n->length = newton_longest(n, n->step, NULL);
    shorten(n, leaving * n->spacing / n->length);
    n->square = INFINITY;
    bool good = try_step(n);
    if (!good) {
        return false;
    }
    for (now = rise(n); good && now < lowest && n->length < n->longest_step; now = good ? rise(n) : 0.0) {
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

/* The next step: an increment of the load, or a correction. The preconditioner is made anew once the products
 * that this would have saved since the last time cost as much. False where cells invert, or on failure. */
static bool step(struct newton *n, struct error *error)
{
    n->report->steps++;
    n->failure = n->excess > (double)n->cost ? measure(n, error) : STATUS_OK;
    if (n->failure != STATUS_OK) {
        return false;
    }
    if (loads(n)) {
        double from = n->load, change = fmin(n->load_change, newton_load_to_hold(n) - from);
        if (begin_increment(n, from, change)) {
            return take_increment(n, from, change);
        }
        set_load(n, from, from);
        (void)newton_evaluate(n, n->u, &n->at_u);
        if (n->slides) { /* instead of what was predicted */
            system_accept(n->system);
            newton_touch(n, n->u, &n->at_u);
        }
        n->load_change = 0.5 * change;
        n->corrections++;
        return leave(n);
    }
    n->corrections++;
    return correct(n);
}

static enum statics_outcome iterate(struct newton *n, struct error *error)
{
    enum statics_outcome outcome;
    int64_t most = n->options->most_steps > 0 ? n->options->most_steps : usual_most_steps;
    while (n->report->steps < most) {
        if (!step(n, error)) {
            bool slides = n->slides && n->report->least_jacobian > 0.0;
            return n->failure != STATUS_OK ? STATICS_STOPPED : slides ? STATICS_STALLED : STATICS_INVERTED;
        }
        augment(n);
        estimate(n);
        if (ends(n, &outcome) && (outcome != STATICS_CONVERGED || !goes_on(n, error))) {
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
    n->load = system->rows.start == NULL && system_begins_loaded(system) ? -1.0 : 0.0;
    system_load_factors(system, n->load);
    system_measure_contacts(system, n->u, true);
    system_accept(system);
    (void)newton_evaluate(n, n->u, &n->at_u);
    if (n->options->frame != NULL && n->options->frames > 0 && !n->options->in_time) {
        n->options->frame(n->options->context, 0, 0.0, n->u);
    }
    constraint_project(&n->preconditioner.constraint, system->factor, n->u);
    n->radius = fmin(n->spacing, n->longest_step);
    n->load_change = n->most_change;
    n->rests = true;
    return measure(n, error);
}

/* Continue from the state of another run. */
static enum status resume(struct newton *n, struct error *error)
{
    RETURN_IF_ERROR(newton_visit(n, n->options->restored, error));
    preconditioner_restore(&n->preconditioner, n->system);
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
                       .slides = system_has_friction(system),
                       .u = u,
                       .row_force = row_force};
    struct box box = box_of(system->dim, system->node_count, system->X);
    *report = (struct statics_report){.least_jacobian = 1.0};
    body_limit_bulk(&system->body, STATICS_BULK_LIMIT);
    RETURN_IF_ERROR(newton_allocate(&n, error));
    n.spacing = system_node_spacing(system);
    n.body_size = box_diagonal(&box);
    n.most_change = 1.0 / fmax(1.0, ceil(system_longest_change(system) / (prescribed_spacings * n.spacing)));
    n.longest_step = longest_step(&n);
    RETURN_IF_ERROR(options->restored != NULL ? resume(&n, error) : begin(&n, error));
    report->outcome = iterate(&n, error);
    RETURN_IF_ERROR(n.failure);
    report->load = newton_load_share(&n);
    return report->outcome == STATICS_CONVERGED ? STATUS_OK : newton_row_forces(&n, error);
}
