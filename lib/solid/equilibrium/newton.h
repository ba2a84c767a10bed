/* Quasi-static solution by Newton's method with conjugate gradients, for bodies with or without contacts
 * ("Newton's method" in lib/README.md).
 *
 * The load grows in increments. At each of them the energy of the body and its loads is replaced by its
 * quadratic model at the present state; that of contacts, whose evaluation costs little, is not. Conjugate
 * gradients with the preconditioner (preconditioner.h) lower the sum of both, by one product of the stiffness
 * an iteration: a difference of two forces (Steihaug 1983; along directions conjugate to the last few, as
 * following pressures may have no potential: Saad 2003, 6.4). A few steps in a row may raise the energy
 * before it must be lower (Chamberlain et al. 1982); a step in which a cell collapses is halved. The
 * multipliers of contacts advance within a step, those of nodal pressures after it. Error estimate: equations
 * (27) and (28) of lib/README.md. */
#pragma once

#include "solid/equilibrium/statics.h"

/* Go from u (usually zeros) to equilibrium at the full load. row_force[system->rows.count], zeros, unless
 * NULL, receives the forces of the conditions at each frame and at the end, N (2D: N/m); system->stability
 * whether the last equilibrium is stable. In the report force_evaluations has the products of the stiffness.
 * STATUS_VERDICT for constraints that depend on each other (the message names the node); an outcome other
 * than converged is no error status: see the report. */
MUST_CHECK enum status newton_run(struct solid_system *system, const struct statics_options *options,
                                  double *u, double *row_force, struct statics_report *report,
                                  struct error *error);
