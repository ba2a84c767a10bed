/* Quasi-static solution by dynamic relaxation: central differences with a diagonal fictitious mass and a
 * damping that follows the lowest mode still active (a running Rayleigh quotient), stopped by an estimate of
 * the remaining error (Underwood 1983; Papadrakakis 1981; equations (21) to (28) of lib/README.md). The plain
 * scheme of the founding papers, for comparison: newton.h takes a tenth of the evaluations, and is the one
 * that judges stability.
 *
 * Error estimate: with the acceleration a of the residual and the lowest frequency w, |e| <= |a| / w^2, which
 * is exact for a mode of a linear system; at the worst node. */
#pragma once

#include "solid/equilibrium/statics.h"

/* As newton_run. A cell that is inverted ends the run: more ramp_steps apply the load more slowly. */
MUST_CHECK enum status relaxation_run(struct solid_system *system, const struct statics_options *options,
                                      double *u, double *row_force, struct statics_report *report,
                                      struct error *error);
