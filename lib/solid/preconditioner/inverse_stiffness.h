/* A sparse approximate inverse of the stiffness of smoothed cells, in factors: K^-1 ~ L^T D^-1 L with a lower
 * triangular L of dim x dim blocks (Kolotilina and Yeremin 1993).
 *
 * The wider the supports, the more vectors of parameters there are whose field nearly vanishes. With a
 * diagonal mass these are slow modes; L removes them, and with blocks also what nearly incompressible
 * materials add. The pattern p of row i of L is i itself and, of the nodes around it of lower number,
 * the nearest ones. Its blocks are L_ip = (R^-1)_ip, with the Cholesky factor K_pp = R R^T, so that the
 * diagonal blocks of L K L^T are 1. K: stiffness_rows.h. */
#pragma once

#include "solid/operators/inverse_factor.h"

struct solid_system;

/* For a system whose body is made of smoothed cells and that knows the values at its nodes. */
MUST_CHECK enum status inverse_stiffness_factor(const struct solid_system *system,
                                                struct inverse_factor *factor, struct error *error);

/* The same, holding at one time the rows of K of at most `batch` nodes and of those that they need. */
MUST_CHECK enum status inverse_stiffness_factor_by(const struct solid_system *system, int64_t batch,
                                                   struct inverse_factor *factor, struct error *error);
