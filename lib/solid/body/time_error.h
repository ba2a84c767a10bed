/* The error that the steps of time cause in a viscoelastic body (prony.h): within a step S changes linearly.
 * The part of its change that is of second order, X'', which the rates in the last two steps give, leaves
 * g X'' tau^2 d in a term h, d = x/2 - 1 + exp(-x) (1 + x/2), x = dt/tau; this fades as h does. Norms are of
 * S, root mean square over the body. */
#pragma once

#include "base/state.h"

struct body;

struct time_error {
    double *rows;  /* point_count each: the rate of S in the last step, a bound of the error of each term, and
                      what is summed over the points; NULL: the error is not estimated */
    int64_t steps; /* since the last jump */
    double before; /* the step before, s */
    double stress; /* the largest of the states accepted, that fades and that does not, */
    double largest; /* and the largest error, Pa; */
    double steady;  /* the error that many steps like the last one would leave, Pa */
};

/* From now on body_accept estimates the error. Nothing without viscoelastic materials. */
MUST_CHECK enum status body_estimate_time_error(struct body *body, struct error *error);

/* The largest error so far, by the largest stress; 0 if it is not estimated. */
double body_time_error(const struct body *body);

/* A first step, s, in which stresses that relax on their own would err by `error`; INFINITY without any. */
double body_first_step(const struct body *body, double error);

/* By what to multiply the last step for this error: 2 at most. */
double body_next_step(const struct body *body, double error);

/* The rates jump here, as at a corner of a load curve. */
void body_turn(struct body *body);

/* Before the state evaluated last is accepted; for prony.c. */
void time_error_note(struct body *body);
void time_error_free(struct time_error *estimate);
MUST_CHECK enum status time_error_state(struct body *body, const struct state *state, struct error *error);
