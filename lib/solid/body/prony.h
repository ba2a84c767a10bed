/* Time: quasi-linear viscoelasticity by Prony series, equation (11a) of lib/README.md.
 *
 * Convolved is the isochoric second Piola-Kirchhoff stress S of a point (Simo 1987; Taylor et al. 2009). In a
 * step of dt, each term goes from h to exp(-dt/tau) h + g b (S - S_before), b = (1 - exp(-dt/tau)) tau / dt,
 * which is exact where S is linear in time. So the stress is a multiple of S plus a constant: it derives from
 * an energy, and each evaluation takes a trial of it. A state that is accepted becomes the history. */
#pragma once

#include "base/state.h"
#include "solid/material/material.h"

struct body;

/* Of a material in a step: exp(-dt/tau), g b, and what multiplies S, 1 - sum g + sum g b. */
struct prony_step {
    double keep[PRONY_MOST_TERMS], add[PRONY_MOST_TERMS], factor;
};

struct prony {
    int terms;     /* most of a material; 0: none, and there is no memory */
    double step;   /* s; 0: a jump */
    bool accepted; /* the last state has been accepted, and no step begun since: as a jump from there */
    struct prony_step *steps; /* of each material in such a step, and behind them in a jump */
    double *history;   /* point_count rows of prony_row: S, E = (F^T F - I) / 2, the work of the terms per
                          volume, Pa, and each term h; 6 components of a tensor */
    double *stress;    /* point_count * 6: S at the last evaluation; */
    double dissipated; /* by the terms, at the last call of body_energy, J (2D: J/m) */
};

/* Numbers of a point in the history. */
int prony_row(const struct prony *prony);

/* Once the materials and points of a body are known. */
MUST_CHECK enum status prony_build(struct body *body, struct error *error);
void prony_free(struct prony *prony);

/* Of point q: from P = dW_iso/dF to the stress at the end of the step. */
void prony_stress(const struct body *body, int64_t q, const double F[9], double P[9]);

/* Of point q: the stored energy at the end of the step, per volume, Pa, where that of the law but for its
 * volumetric part is W. A term stores W |h|^2 / (g |S|^2), which is g W before it relaxes, 0 at last, and at
 * small strain |h|^2 / (4 mu g). *dissipated: the work of the terms up to the last accepted state, less what
 * they store. */
double prony_energy(const struct body *body, int64_t q, const double F[9], double W, double *dissipated);

/* Visit the histories, see base/state.h. */
MUST_CHECK enum status prony_state(struct body *body, const struct state *state, struct error *error);
