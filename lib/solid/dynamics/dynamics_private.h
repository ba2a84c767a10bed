/* The state of an explicit run, shared by the files of dynamics.h. */
#pragma once

#include "solid/dynamics/dynamics.h"

struct dynamics {
    struct solid_system *system;
    const struct dynamics_options *options;
    struct dynamics_report *report;
    struct constraint constraint;
    int64_t size;
    double *u, *next;       /* at this step, at the next one */
    double *before, *after; /* velocities half a step before and after this one */
    double *residual, *mode, *scratch;
    double *loads;                                     /* NULL without loads */
    double *factor_before, *factor_now, *factor_after; /* of the load curves */
    double *factor_change;                             /* in this step */
    /* Time runs in spans of equal steps: t = mark + done * step; `left` more of them end at T. */
    double mark, step, previous_step;
    int64_t done, left;
    double frequency;       /* largest, followed */
    double contact_squared; /* bound of what contacts add to its square */
    int64_t sample_interval;
    int64_t frames;
    struct energy_balance balance;
    struct energy_log *log; /* the caller's, or NULL */
    enum status failure;    /* of the log */
};

/* ---- dynamics_step.c: the length of the steps, and the move itself ---- */

/* Time of this step and of the next one, s; the last one is the end time, to the bit. */
double dynamics_time_now(const struct dynamics *d);
double dynamics_time_next(const struct dynamics *d);

/* Bound what contacts can add to the square of the largest frequency, whatever touches. */
void dynamics_bound_contacts(struct dynamics *d);

/* Follow the largest frequency; `residual` is that at u. */
void dynamics_estimate_frequency(struct dynamics *d, int iterations);

/* Start a span of equal steps to the end where the last ones have become too long, or shorter than need be.
 * False: the step has collapsed. */
bool dynamics_choose_step(struct dynamics *d);

/* v+ and the next u from the residual at u, the conditions met; the forces of the conditions, N (2D: N/m),
 * are left in constraint.multiplier. */
void dynamics_advance(struct dynamics *d, bool is_first);

/* ---- dynamics_energy.c: works, and the balance of energies ---- */

/* Half of the work that the forces at this step do over the step before or after it, in which the factors of
 * the load curves go from one to the other. */
void dynamics_add_work(struct dynamics *d, const double *velocity, double step, const double *factor_from,
                       const double *factor_to);

/* Energies at this step, with that of the contacts, into the log. False when their balance is off, or on
 * failure. */
bool dynamics_sample(struct dynamics *d, double contact, struct error *error);

/* ---- dynamics_state.c: memory, and what a checkpoint holds ---- */

MUST_CHECK enum status dynamics_allocate(struct dynamics *d, struct error *error);

void dynamics_release(struct dynamics *d);

/* Visit the state that the next step needs: see base/state.h. */
MUST_CHECK enum status dynamics_visit(void *run, const struct state *state, struct error *error);
