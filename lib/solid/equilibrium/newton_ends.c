/* The ends of a Newton run: multipliers, the error, progress, and the outcome. */
#include "solid/equilibrium/newton_private.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* With contacts, an error that stays below this is accepted: points that alternate between two facets keep it
 * from falling. */
static const double most_hovering = 1e-3;
/* Equilibria on the way, at which points that slip take their anchors along: their error by the tolerance,
 * and what hovers there by the largest motion that the run prescribes. */
static const double on_the_way = 100.0, hovering_on_the_way = 5e-3;
/* A body that has moved by this share of its largest displacement has not come to its end: a slender one that
 * has buckled may turn for long, by small steps; but one that has gone ten times as far goes round in
 * circles. Nor has one whose load has grown by this share. */
static const double moves_on = 0.1, least_growth = 1e-3;
static const int64_t most_moves = 100; /* in a row */
/* The pressures are augmented after steps shorter than this, by the largest displacement. */
static const double most_length = 0.1;
static const int64_t most_vain = 12; /* corrections in which the error has not halved */

static bool contacts_lack(const struct newton *n)
{
    return n->report->move > n->scale.round_off &&
           system_contacts_give_way(n->system, n->u, n->report->move, n->options->tolerance);
}

/* What the nodal pressures may lack. */
static double most_lack(const struct newton *n)
{
    return fmin(NODAL_PRESSURE_LACK, 10.0 * n->options->tolerance);
}

/* Whether the pressures are those of u, as far as an equilibrium needs. */
static bool has_pressures(const struct newton *n)
{
    return !body_is_limited(&n->system->body) || n->verdict.pressures_lack <= most_lack(n);
}

void newton_augment(struct newton *n)
{
    if (n->watch.steps > 0) {
        return;
    }
    bool near = n->load.corrections > 0 && n->step.length < most_length * n->report->move;
    bool stiffened = near && body_stiffen(&n->system->body, most_lack(n));
    bool pressures = near && body_is_limited(&n->system->body);
    n->verdict.gives_way = n->system->contact_count > 0 && contacts_lack(n);
    bool contacts = n->system->contact_count > 0 && (n->load.corrections <= 1 || n->verdict.gives_way);
    if (pressures) {
        n->verdict.pressures_lack = body_augment(&n->system->body, n->load.corrections > 1, most_lack(n),
                                                 n->report->move / n->scale.body);
    }
    if (contacts) {
        system_augment_contacts(n->system);
    }
    bool stiffer = system_stiffen(n->system);
    if (stiffer || stiffened || pressures) {
        (void)newton_evaluate(n, n->u, &n->at_u);
    } else {
        newton_touch(n, n->u, &n->at_u);
    }
    preconditioner_follow(&n->preconditioner, n->system);
}

/* The least eigenvalue by which the error is estimated, in units of the preconditioner's. */
static double lowest_of(const struct newton *n)
{
    return isinf(n->verdict.lowest) ? NEWTON_LEAST_TOLD
                                    : fmin(1.0, fmax(n->verdict.lowest, NEWTON_LEAST_TOLD));
}

/* What round-off of positions admits of the estimated error. */
static double admitted(const struct newton *n)
{
    return n->scale.round_off / (lowest_of(n) * n->report->move);
}

void newton_estimate(struct newton *n)
{
    struct statics_report *report = n->report;
    double square = newton_square(n, &n->at_u), move = newton_longest(n, n->u, NULL);
    n->progress.largest_move = fmax(n->progress.largest_move, move);
    report->move = fmax(move, n->options->tolerance * n->progress.largest_move);
    double error = newton_longest(n, n->cg.scaled, &report->worst_node) / lowest_of(n);
    bool at_rest = report->move <= n->scale.round_off || !(square > 0.0);
    double way = system_longest_way(n->system);
    bool minute = way > 0.0 && way <= n->scale.round_off;
    report->lost = at_rest && (minute || error > DBL_EPSILON * n->scale.body);
    report->error = !isfinite(square) ? INFINITY : at_rest ? 0.0 : error / report->move;
}

/* Note progress at this load: neither a body that slides comes to its end, nor one that is not let slip.
 * Returns the steps without. */
static int64_t note_progress(struct newton *n)
{
    struct statics_report *report = n->report;
    bool halved = report->error < 0.5 * n->progress.error && !n->friction.sticks;
    for (int64_t i = 0; i < n->size; i++) {
        n->cg.product[i] = n->u[i] - n->progress.u[i];
    }
    bool moved = newton_longest(n, n->cg.product, NULL) > moves_on * report->move &&
                 !system_held_by_friction(n->system);
    bool better = n->load.now > n->progress.load + least_growth || report->steps == 1 || halved;
    n->progress.moves = better ? 0 : n->progress.moves + moved;
    if (better || (moved && n->progress.moves <= most_moves)) {
        n->progress.load = n->load.now;
        n->progress.error = better ? report->error : n->progress.error;
        memcpy(n->progress.u, n->u, (size_t)n->size * sizeof *n->u);
        n->progress.step = report->steps;
    }
    return report->steps - n->progress.step;
}

/* Whether u is the equilibrium at this load. */
static bool is_found(struct newton *n, bool vain, struct error *error)
{
    struct statics_report *report = n->report;
    bool reported = n->load.now == n->load.hold;
    double most = (reported ? 1.0 : on_the_way) * n->options->tolerance;
    if (reported && (report->error <= most || (vain && isinf(n->verdict.lowest))) && !n->verdict.judged) {
        n->failure = newton_judge_stability(n, error);
        n->verdict.judged = true;
        newton_estimate(n);
    }
    if (vain) {
        bool hovers = system_has_touched(n->system) && !system_held_by_friction(n->system);
        double way = reported ? 0.0 : hovering_on_the_way * system_longest_way(n->system) / report->move;
        most = fmax(most, hovers ? fmax(most_hovering, way) : admitted(n));
    }
    bool rounds = report->error <= (vain ? admitted(n) : 0.0); /* and so do the pressures */
    bool pressures = rounds || has_pressures(n);
    bool contacts = !contacts_lack(n);
    report->penetration = system_contact_miss(n->system);
    report->penetration_allowed = system_penetration_allowed(report->move);
    return report->error <= most && pressures && contacts;
}

bool newton_ends(struct newton *n, bool stuck, enum statics_outcome *outcome, struct error *error)
{
    int64_t vain = note_progress(n);
    bool holds = n->friction.slides || n->load.now == n->load.hold;
    bool found = n->load.corrections > 0 && holds && !n->friction.sticks &&
                 is_found(n, stuck || vain > most_vain, error);
    bool away = statics_is_away(n->system, n->report, n->scale.body);
    *outcome = found                                        ? STATICS_CONVERGED
               : away || system_held_by_friction(n->system) ? STATICS_AWAY
                                                            : STATICS_STALLED;
    return found || stuck || away || vain > 4 * most_vain;
}
