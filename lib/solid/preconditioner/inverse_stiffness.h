/* A sparse approximate inverse of the stiffness of smoothed cells, in factors: K^-1 ~ L^T D^-1 L with a lower
 * triangular L (Kolotilina and Yeremin 1993).
 *
 * The wider the supports, the more vectors of parameters there are whose field nearly vanishes. With a
 * diagonal mass these are slow modes; L removes them. It approximates the inverse factor of the scalar
 * stiffness
 *
 *   S = sum_q w_q ( c_q g_q (x) g_q + k_q (h_q - g_q) (x) (h_q - g_q) ) + sum_r s_r phi_r (x) phi_r
 *
 * at rest, with the smoothed gradients g_q of the shape functions in cell q, those of the linear interpolant
 * h_q, the modulus c_q of pressure waves, limited as the body's, that of the stabilisation k_q, a multiple of
 * the shear modulus alone, and the penalties of conditions and contacts. The pattern p of row i of L is i
 * itself and, of the nodes of lower number that S couples to i, the nearest ones. Its entries are L_ip = y /
 * sqrt(y_i), S_pp y = e_i. So the diagonal of L S L^T is 1. */
#pragma once

#include "solid/constraint/constraint.h"
#include "solid/operators/inverse_factor.h"

struct solid_system;

/* For a system whose body is made of smoothed cells and that knows the values at its nodes. */
MUST_CHECK enum status inverse_stiffness_factor(const struct solid_system *system,
                                                struct inverse_factor *factor, struct error *error);

/* The same, holding at one time the rows of S of at most `batch` nodes and of those that they need. */
MUST_CHECK enum status inverse_stiffness_factor_by(const struct solid_system *system, int64_t batch,
                                                   struct inverse_factor *factor, struct error *error);

/* The rows G as rows G L^T, in the same order. */
MUST_CHECK enum status inverse_stiffness_rows(const struct inverse_factor *factor,
                                              const struct constraint_rows *rows,
                                              struct constraint_rows *transformed, struct error *error);
