/* Quasi-static solution by Newton's method with conjugate gradients: the other way than relaxation.h, with
 * the same options and report, for solid bodies with or without contacts.
 *
 * The load grows in increments. At each of them the energy of the body and its loads is replaced by its
 * quadratic model at the present state; that of contacts, whose evaluation costs little, is not. Conjugate
 * gradients with the preconditioner (preconditioner.h) lower the sum of both, by one product of the stiffness
 * an iteration: a difference of two forces (Steihaug 1983; the directions of Polak and Ribiere 1969, as
 * contacts bend the model). A step that inverts a cell, or does not lower the energy, is halved. The
 * multipliers of contacts advance within a step, those of nodal pressures after it.
 *
 * Error estimate: a step d that brought the residual down by the factor q, in the norm of M^-1, left an error
 * of about |d| q / (1 - q), with d at the node that moved most. */
#pragma once

#include "solid/relaxation/relaxation.h"

/* As relaxation_run. Of the options, time_step_margin, ramp_steps and folded have no effect; most_steps
 * counts steps of Newton's method, 0: 1e5; an interruption is seen at the end of a step. In the report,
 * loading_steps are the increments of the load, and force_evaluations has the products of the stiffness. */
MUST_CHECK enum status newton_run(struct solid_system *system, const struct relaxation_options *options,
                                  double *u, double *row_force, struct relaxation_report *report,
                                  struct error *error);
