/* Time: quasi-linear viscoelasticity by Prony series, equation (11a) of lib/README.md.
 *
 * Convolved is, as X, what works along the objective strains E = (F^T F - I) / 2, J / det F, and F^T s_e of
 * the offsets s_e = m_e - (v_i + v_j) / 2 in a smoothed cell: the second Piola-Kirchhoff stress S of the
 * isochoric energy, of c in the coupling (11b) and of the variance (10); c g' of (11b); and the derivatives
 * of (10) by F^T s_e, all without bulk moduli (Simo 1987; Taylor et al. 2009). In a step of dt, each term
 * goes from h to exp(-dt/tau) h + g b (X - X_before), b = (1 - exp(-dt/tau)) tau / dt, which is exact where X
 * is linear in time. So what acts is a multiple of X plus a constant: it derives from an energy,
 *
 *   factor (W_iso + W_c + W_v) + rest_S : E + rest_J J / det F + sum_e s_e . F rest_e,
 *
 * and each evaluation takes a trial of it. A state that is accepted becomes the history. */
#pragma once

#include "base/state.h"
#include "solid/body/time_error.h"
#include "solid/material/material.h"

struct body;

/* Components of X, weighted by the volume: S and c g', J (2D: J/m), and of the offsets, edge by edge, N (2D:
 * N/m). */
enum { PRONY_RATIO = 6, PRONY_OFFSETS = 7, PRONY_MOST = PRONY_OFFSETS + 18 };

/* The places of S, and the component at a place. */
static const int tensor_row[] = {0, 1, 2, 0, 1, 0}, tensor_column[] = {0, 1, 2, 1, 2, 2};
static const int tensor_component[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

/* Of a material in a step: exp(-dt/tau), g b, and what multiplies X, 1 - sum g + sum g b. */
struct prony_step {
    double keep[PRONY_MOST_TERMS], add[PRONY_MOST_TERMS], factor;
};

struct prony {
    int terms;     /* most of a material; 0: none, and there is no memory */
    double step;   /* s; 0: a jump */
    bool accepted; /* the last state has been accepted, and no step begun since: as a jump from there */
    struct prony_step *steps; /* of each material in such a step, and behind them in a jump */
    double *history;   /* rows of point_count: X, each term h, the strains, and the work of the terms, J (2D:
                          J/m) */
    double *rest;      /* as X: the constants, */
    double *left;      /* of each material, the share of mu that is left, 1 in dynamics; and scratch */
    double rest_step;  /* in a step of this length; nan: none yet */
    double *stress;    /* PRONY_OFFSETS rows: X but for (10) at the last evaluation */
    double dissipated; /* by the terms, at the last call of body_energy, J (2D: J/m) */
    struct time_error time_error;
};

/* Components of X at a point. */
int prony_components(const struct body *body);

/* Of each material in the present step. */
const struct prony_step *prony_steps(const struct body *body);

/* Once the materials and points of a body are known. */
MUST_CHECK enum status prony_build(struct body *body, struct error *error);
void prony_free(struct prony *prony);

/* Before own points are evaluated, or all. */
void prony_prepare(struct body *body, bool all);

/* Of a viscoelastic point q: from the derivatives of W_iso + W_c by F and J / det F to those at the end of
 * the step. */
void prony_stress(const struct body *body, int64_t q, const double F[9], double P[9], double *by_ratio);

/* Of a viscoelastic point q: the stored energy, J (2D: J/m), where that of the law but for its volumetric
 * part is W, with W_v of the variance, without its own. A term of the last accepted state stores W |h|^2 / (g
 * |X|^2), the norm being that of W at small strain; which is g W before it relaxes, and 0 at last.
 * *dissipated grows by the work of the terms up to that state, less what they store. */
double prony_energy(const struct body *body, int64_t q, double W, double W_v, double *dissipated);

/* Visit the histories, see base/state.h. */
MUST_CHECK enum status prony_state(struct body *body, const struct state *state, struct error *error);
