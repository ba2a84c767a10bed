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
    double *loads;       /* NULL without loads */
    bool *prestressed;   /* of each curve: energy_find_prestress; */
    double *stored;      /* and energy_of_prestress at u; NULL without */
    double *mass;        /* node_count: the lumped one, with half a step of the dashpots of supports: see
                            dynamics_weigh_dashpots; without dashpots that of the system */
    double *drag;        /* force of the dashpots in this step, against the motion; NULL: none */
    double weighed_step; /* step that `mass` and `constraint` are for */
    double *factor_before, *factor_now, *factor_after; /* of the load curves */
    double *factor_change;                             /* in this step */
    /* Time runs in spans of equal steps: t = mark + done * step; `left` more of them end at T. */
    double mark, step, previous_step;
    int64_t done, left;
    double frequency;       /* estimate of the largest, rad/s */
    double contact_squared; /* bound of the contacts' contribution to its square */
    int64_t sample_interval;
    int64_t frames;
    struct energy_balance balance;
    struct energy_log *log; /* the caller's, or NULL */
    enum status failure;    /* of the log, or of memory */
};

/* ---- dynamics_step.c: the length of the steps, and the move itself ---- */

/* Time of this step and of the next one, s; the last one is the end time, to the bit. */
double dynamics_time_now(const struct dynamics *d);
double dynamics_time_next(const struct dynamics *d);

/* Bound the contribution of contacts to the square of the largest frequency, whatever touches. */
void dynamics_bound_contacts(struct dynamics *d);

/* Update the estimate of the largest frequency; d->residual is that at u. */
void dynamics_estimate_frequency(struct dynamics *d, int iterations);

/* If the steps have become too long, or shorter than necessary, begin a new span of equal steps to the end.
 * False: the step has collapsed. */
bool dynamics_choose_step(struct dynamics *d);

/* With dashpots c, the step is implicit, c (v- + v+)/2, so that it is stable for any c: v+ has the mass M + c
 * dt/2, which the constraint takes as well. Let both be those of the step. False on failure. */
bool dynamics_weigh_dashpots(struct dynamics *d, struct error *error);

/* Compute v+ and the next u from the residual at u, and meet the conditions. constraint.multiplier receives
 * the forces of the conditions, N (2D: N/m). */
void dynamics_advance(struct dynamics *d, bool is_first);

/* ---- dynamics_energy.c: works, and the balance of energies ---- */

/* Add half of the work of the forces at this step over the step before or after it, in which the factors of
 * the load curves change as given. */
void dynamics_add_work(struct dynamics *d, const double *velocity, double step, const double *factor_from,
                       const double *factor_to);

/* Append the energies at this step, with this energy of the contacts, to the log. False if their balance is
 * off, or on failure. */
bool dynamics_sample(struct dynamics *d, double contact, struct error *error);

/* ---- dynamics_state.c: memory, and what a checkpoint holds ---- */

MUST_CHECK enum status dynamics_allocate(struct dynamics *d, struct error *error);

void dynamics_release(struct dynamics *d);

/* Visit the state of the run: see base/state.h. */
MUST_CHECK enum status dynamics_visit(void *run, const struct state *state, struct error *error);
