#include "solid/equilibrium/relaxation.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/preconditioner/frequency.h"
#include "solid/preconditioner/preconditioner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CHECK_INTERVAL = 10 }; /* steps between estimates */
enum { WINDOWS = 8 };         /* recent Rayleigh quotients that the error estimate uses */

/* Steps of loading for a prescribed motion by the spacing of the nodes, and by the body's size; at least. */
static const double steps_per_spacing = 20.0, steps_per_size = 400.0, least_ramp = 75.0;
static const double most_growth = 2.0; /* of the damping's square, from check to check */
/* On the estimate: several modes may be left. */
static const double safety = 2.0;
/* First guess of the lowest eigenvalue, by the largest. */
static const double first_share = 1e-4;
/* Least time between augmentations, of contacts and of nodal pressures, times the damping. Oscillating modes
 * are stable above 2 ln 3. */
static const double least_pause = 3.0;
static const int first_iterations = 20, iterations = 2; /* of the power iteration */
static const int64_t most_augmentations = 100;          /* of contacts at a load */
static const int64_t most_vain = 5000;                  /* steps without half the error */
static const int64_t usual_most_steps = 1000000;

struct relaxation {
    struct solid_system *system;
    const struct statics_options *options;
    struct statics_report *report;
    struct preconditioner mass; /* diagonal, with the projection onto the conditions */
    int64_t size;
    double *u, *row_force; /* the caller's; row_force may be NULL */
    struct {
        double *velocity, *residual, *acceleration, *before, *last_u, *last_residual, *mode, *scratch;
    } at;
    double *factor_change;                /* of the load curves in this step */
    double time_step, damping, frequency; /* frequency: the largest */
    double lowest;                        /* estimate (26) of the least eigenvalue still active */
    double window[WINDOWS];
    double body_size;    /* diagonal of the nodes' box, m */
    double round_off;    /* see statics_round_off */
    double load;         /* share of the load at u */
    double largest_move; /* so far, of a node, m */
    double pressures_lack;
    int64_t ramp, checks, frames;
    struct {
        double best_error;
        int64_t best_step;      /* its step: the error has not halved since */
        int64_t steps;          /* in a row at a constant load; 0 while it grows */
        int64_t small_checks;   /* in a row with a small error */
        int64_t augmented_step; /* of the last augmentation */
        int64_t augmentations, steady_augmentations;
    } held; /* at the load that is held */
    enum status failure;
};

static enum status allocate(struct relaxation *r, struct error *error)
{
    double **vectors[] = {&r->at.velocity, &r->at.residual,      &r->at.acceleration, &r->at.before,
                          &r->at.last_u,   &r->at.last_residual, &r->at.mode};
    RETURN_IF_ERROR(preconditioner_build(r->system, false, &r->mass, error));
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        RETURN_IF_ERROR(NEW_ARRAY(vectors[i], r->size, error));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&r->at.scratch, 2 * r->size, error));
    return NEW_ARRAY(&r->factor_change, r->system->curve_count, error);
}

static void release(struct relaxation *r)
{
    FREE_ALL(r->at.velocity, r->at.residual, r->at.acceleration, r->at.before, r->at.last_u,
             r->at.last_residual, r->at.mode, r->at.scratch, r->factor_change);
    preconditioner_free(&r->mass);
}

/* Visit all that the next step needs from the steps before; see base/state.h. */
static enum status visit(void *run, const struct state *state, struct error *error)
{
    struct relaxation *r = run;
    struct statics_report *report = r->report;
    struct nodal_pressures *pressures = &r->system->body.volumes.pressures;
    const struct state_value values[] = {
        {"u", STATE_NUMBERS, r->u, r->size},
        {"velocity", STATE_NUMBERS, r->at.velocity, r->size},
        {"last_u", STATE_NUMBERS, r->at.last_u, r->size},
        {"last_residual", STATE_NUMBERS, r->at.last_residual, r->size},
        {"mode", STATE_NUMBERS, r->at.mode, r->size},
        {"time_step", STATE_NUMBERS, &r->time_step, 1},
        {"damping", STATE_NUMBERS, &r->damping, 1},
        {"frequency", STATE_NUMBERS, &r->frequency, 1},
        {"lowest", STATE_NUMBERS, &r->lowest, 1},
        {"window", STATE_NUMBERS, r->window, WINDOWS},
        {"load", STATE_NUMBERS, &r->load, 1},
        {"largest_move", STATE_NUMBERS, &r->largest_move, 1},
        {"best_error", STATE_NUMBERS, &r->held.best_error, 1},
        {"best_step", STATE_COUNTS, &r->held.best_step, 1},
        {"ramp", STATE_COUNTS, &r->ramp, 1},
        {"checks", STATE_COUNTS, &r->checks, 1},
        {"frames", STATE_COUNTS, &r->frames, 1},
        {"held_steps", STATE_COUNTS, &r->held.steps, 1},
        {"small_checks", STATE_COUNTS, &r->held.small_checks, 1},
        {"augmented_step", STATE_COUNTS, &r->held.augmented_step, 1},
        {"augmentations", STATE_COUNTS, &r->held.augmentations, 1},
        {"steady", STATE_COUNTS, &r->held.steady_augmentations, 1},
        {"held", STATE_NUMBERS, pressures->held, pressures->matrix.row_count},
        {"change", STATE_NUMBERS, pressures->change, pressures->matrix.row_count},
        {"lack", STATE_NUMBERS, &r->pressures_lack, 1},
        {"steps", STATE_COUNTS, &report->steps, 1},
        {"loading_steps", STATE_COUNTS, &report->loading_steps, 1},
        {"force_evaluations", STATE_COUNTS, &report->force_evaluations, 1},
        {"error", STATE_NUMBERS, &report->error, 1},
        {"move", STATE_NUMBERS, &report->move, 1},
        {"least_jacobian", STATE_NUMBERS, &report->least_jacobian, 1},
    };
    RETURN_IF_ERROR(state_visit(state, NULL, values, sizeof values / sizeof *values, error));
    RETURN_IF_ERROR(preconditioner_state(&r->mass, state, error));
    return system_state(r->system, state, error);
}

/* ---- loads and frames ---- */

/* Let the load grow by a step; r->factor_change: the change of the load curves. */
static void change_load(struct relaxation *r)
{
    double before = r->load, hold = statics_load_to_hold(r->options, r->frames);
    double next = before + 1.0 / (double)r->ramp;
    bool holds = before == hold;
    r->held.steps = holds ? r->held.steps + 1 : 0;
    r->report->loading_steps += !holds;
    r->load = next < hold * (1.0 - 1e-12) ? next : hold;
    statics_change_load(r->system, before, r->load, r->factor_change);
}

/* The forces of the conditions at u, N (2D: N/m). */
static enum status find_row_forces(struct relaxation *r, struct error *error)
{
    (void)system_residual(r->system, r->u, r->at.residual);
    if (r->row_force == NULL || r->system->rows.count == 0) {
        return STATUS_OK;
    }
    return preconditioner_row_forces(&r->mass, r->at.residual, r->at.scratch, r->row_force, error);
}

/* Report u, which is in equilibrium, as the next frame; whether the run goes on. */
static bool goes_on(struct relaxation *r, struct error *error)
{
    bool last = r->load == 1.0;
    r->failure = find_row_forces(r, error);
    if (r->failure == STATUS_OK) {
        statics_give_frame(r->options, statics_load_share(r->system, r->load), r->u, &r->frames);
    }
    r->held.small_checks = r->held.augmentations = r->held.steady_augmentations = 0;
    return r->failure == STATUS_OK && !last;
}

/* ---- steps ---- */

/* Before a check, if the last augmentation is long enough ago: the error then includes what it leaves. */
static void augment(struct relaxation *r)
{
    int64_t since = r->report->steps - r->held.augmented_step;
    if (since < 2 * CHECK_INTERVAL || r->damping * (double)since * r->time_step < least_pause) {
        return;
    }
    bool held = r->held.steps > since;
    if (body_is_limited(&r->system->body)) {
        r->held.steady_augmentations = held ? r->held.steady_augmentations + 1 : 0;
        r->pressures_lack = body_augment(&r->system->body, r->held.steady_augmentations > 1,
                                         NODAL_PRESSURE_LACK, r->report->move / r->body_size);
    }
    if (r->system->contact_count > 0 && r->held.augmentations < most_augmentations) {
        system_augment_contacts(r->system);
        r->held.augmentations += r->held.steps > 0;
    }
    r->held.augmented_step = r->report->steps;
}

/* One step, with the acceleration of the projected residual at the old u. False if a point is inverted. */
static bool step(struct relaxation *r)
{
    struct solid_system *system = r->system;
    double dt = r->time_step, grow = 2.0 + r->damping * dt, keep = (2.0 - r->damping * dt) / grow;
    struct deformation deformation = system_residual(system, r->u, r->at.residual);
    r->report->force_evaluations++;
    r->report->least_jacobian = deformation.least_jacobian;
    if (!(deformation.least_jacobian > 0.0)) {
        r->report->inverted_point = deformation.point;
        return false;
    }
    system_accept(system);
    memcpy(r->at.before, r->u, (size_t)r->size * sizeof *r->u);
    preconditioner_apply(&r->mass, r->at.residual, r->at.acceleration);
    for (int64_t i = 0; i < r->size; i++) {
        r->at.velocity[i] = dt * (keep * r->at.velocity[i] + 2.0 * dt / grow * r->at.acceleration[i]);
    }
    /* The increment is projected, not u: the round-off of u would bound the residual from below. */
    constraint_project(&r->mass.constraint, r->factor_change, r->at.velocity);
    for (int64_t i = 0; i < r->size; i++) {
        r->u[i] += r->at.velocity[i];
        r->at.velocity[i] /= dt;
    }
    return true;
}

/* ---- checks ---- */

/* Set the mass and the time step at `before`, where the residual is known. */
static void weigh(struct relaxation *r, const double *u, int turns)
{
    system_relaxation_mass(r->system, false, r->at.scratch);
    preconditioner_set_mass(&r->mass, r->at.scratch);
    double frequency =
        system_largest_frequency(r->system, &r->mass, u, r->at.residual, turns, r->at.mode, r->at.scratch);
    r->report->force_evaluations += turns;
    /* The power iteration estimates from below and fluctuates: follow a rise at once, a fall slowly. */
    r->frequency = frequency > r->frequency ? frequency : 0.98 * r->frequency + 0.02 * frequency;
    r->time_step = r->options->time_step_margin * 2.0 / r->frequency;
}

static void estimate(struct relaxation *r)
{
    double *du = r->at.scratch, along = 0.0, bottom, least = INFINITY; /* along: the change of the residual */
    for (int64_t i = 0; i < r->size; i++) {
        du[i] = r->at.before[i] - r->at.last_u[i];
    }
    constraint_project(&r->mass.constraint, NULL, du);
    for (int64_t i = 0; i < r->size; i++) {
        along += du[i] * (r->at.last_residual[i] - r->at.residual[i]);
    }
    bottom = preconditioner_square_diagonal(&r->mass, du);
    memcpy(r->at.last_u, r->at.before, (size_t)r->size * sizeof *r->at.before);
    memcpy(r->at.last_residual, r->at.residual, (size_t)r->size * sizeof *r->at.residual);
    if (along > 0.0 && bottom > 0.0 && r->checks > 0 &&
        r->report->steps - r->held.augmented_step >= CHECK_INTERVAL) {
        double quotient = fmin(along / bottom, r->frequency * r->frequency);
        r->lowest = fmin(quotient, most_growth * r->lowest);
        r->damping = 2.0 * sqrt(r->lowest);
        r->window[r->checks % WINDOWS] = r->lowest;
    }
    r->checks++;
    for (int i = 0; i < WINDOWS; i++) {
        least = fmin(least, r->window[i]);
    }
    double move = vector_longest(r->system->dim, r->system->node_count, r->at.before, NULL);
    r->largest_move = fmax(r->largest_move, move);
    r->report->move = fmax(move, r->options->tolerance * r->largest_move);
    move = vector_longest(r->system->dim, r->system->node_count, r->at.acceleration, &r->report->worst_node);
    bool at_rest = r->report->move <= r->round_off;
    r->report->error = at_rest ? 0.0 : safety * move / (least * r->report->move);
}

/* Whether the multipliers of contacts and of nodal pressures have converged. */
static bool multipliers_hold(struct relaxation *r)
{
    bool pressures = !body_is_limited(&r->system->body) || r->pressures_lack <= NODAL_PRESSURE_LACK;
    r->report->penetration = system_contact_miss(r->system);
    r->report->penetration_allowed = system_penetration_allowed(r->report->move);
    return pressures &&
           (r->held.augmentations >= most_augmentations || r->report->move <= r->round_off ||
            !system_contacts_give_way(r->system, r->at.before, r->report->move, r->options->tolerance));
}

/* Whether the run at this load ends at this check, and its outcome. */
static bool ends(struct relaxation *r, enum statics_outcome *outcome)
{
    struct statics_report *report = r->report;
    bool small = r->held.steps > 2 * CHECK_INTERVAL && report->error <= r->options->tolerance;
    /* Just after an augmentation the error includes what the multipliers lacked. */
    bool augmented = r->held.augmented_step >= report->steps - 2 || !body_is_limited(&r->system->body);
    r->held.small_checks = small ? r->held.small_checks + augmented : 0;
    if (r->held.steps <= CHECK_INTERVAL || report->error < 0.5 * r->held.best_error) {
        r->held.best_error = report->error;
        r->held.best_step = report->steps;
    }
    bool found = r->held.small_checks >= 2 && multipliers_hold(r);
    bool away = statics_is_away(r->system, report, r->body_size);
    *outcome = found ? STATICS_CONVERGED : away ? STATICS_AWAY : STATICS_STALLED;
    return found || away || report->steps - r->held.best_step > most_vain;
}

/* After a step with the last one of an interval: whether the run ends, and its outcome. */
static bool check(struct relaxation *r, enum statics_outcome *outcome, struct error *error)
{
    estimate(r);
    if (r->held.steps <= CHECK_INTERVAL) { /* remove the round-off of the increments' sum */
        constraint_project(&r->mass.constraint, r->system->factor, r->u);
    }
    if (system_stiffen(r->system)) {
        (void)system_residual(r->system, r->at.before, r->at.residual);
    }
    if (ends(r, outcome) && (*outcome != STATICS_CONVERGED || !goes_on(r, error))) {
        return true;
    }
    weigh(r, r->at.before, iterations);
    *outcome = STATICS_STOPPED;
    return !statics_tell(r->options, r->report, statics_load_share(r->system, r->load), r->u, visit, r);
}

static enum statics_outcome iterate(struct relaxation *r, struct error *error)
{
    enum statics_outcome outcome;
    int64_t most = r->options->most_steps > 0 ? r->options->most_steps : usual_most_steps;
    while (r->report->steps < most) {
        bool last = ++r->report->steps % CHECK_INTERVAL == 0;
        change_load(r);
        if (!step(r)) {
            return STATICS_INVERTED;
        }
        if (last && check(r, &outcome, error)) {
            return outcome;
        }
        if (r->report->steps % CHECK_INTERVAL == CHECK_INTERVAL - 2) {
            augment(r);
        }
    }
    return STATICS_TOO_MANY_STEPS;
}

/* Start at rest from u, projected onto the conditions. */
static void begin(struct relaxation *r)
{
    struct solid_system *system = r->system;
    double longest = system_longest_change(system);
    double steps = fmax(steps_per_spacing * longest / system_node_spacing(system),
                        steps_per_size * longest / r->body_size);
    r->ramp =
        r->options->ramp_steps > 0 ? r->options->ramp_steps : (int64_t)fmin(1e7, fmax(steps, least_ramp));
    system_load_factors(system, 0.0);
    (void)system_residual(system, r->u, r->at.residual);
    if (r->options->frame != NULL && r->options->frames > 0) {
        r->options->frame(r->options->context, 0, 0.0, r->u);
    }
    weigh(r, r->u, first_iterations);
    constraint_project(&r->mass.constraint, system->factor, r->u);
    memcpy(r->at.last_u, r->u, (size_t)r->size * sizeof *r->u);
    r->pressures_lack = INFINITY;
    r->lowest = first_share * r->frequency * r->frequency;
    r->damping = 2.0 * sqrt(r->lowest);
    for (int i = 0; i < WINDOWS; i++) {
        r->window[i] = r->lowest;
    }
}

static enum status resume(struct relaxation *r, struct error *error)
{
    RETURN_IF_ERROR(visit(r, r->options->restored, error));
    preconditioner_factorise(&r->mass, r->system);
    return STATUS_OK;
}

enum status relaxation_run(struct solid_system *system, const struct statics_options *options, double *u,
                           double *row_force, struct statics_report *report, struct error *error)
{
    FREED_BY(release)
    struct relaxation r = {.system = system,
                           .options = options,
                           .report = report,
                           .size = system->node_count * system->dim,
                           .u = u,
                           .row_force = row_force};
    struct box box = box_of(system->dim, system->node_count, system->X);
    *report = (struct statics_report){.least_jacobian = 1.0};
    r.body_size = box_diagonal(&box);
    r.round_off = statics_round_off(system);
    body_limit_bulk(&system->body, STATICS_BULK_LIMIT);
    RETURN_IF_ERROR(allocate(&r, error));
    if (options->restored != NULL) {
        RETURN_IF_ERROR(resume(&r, error));
    } else {
        begin(&r);
    }
    report->outcome = iterate(&r, error);
    RETURN_IF_ERROR(r.failure);
    report->load = statics_load_share(system, r.load);
    return report->outcome == STATICS_CONVERGED ? STATUS_OK : find_row_forces(&r, error);
}
