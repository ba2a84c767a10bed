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

#include "base/ranks.h"
#include "base/sparse.h"
#include "solid/constraint.h"

#include <stdbool.h>
#include <stdint.h>

struct solid_system;

struct inverse_factor {
    struct sparse rows, transposed; /* L, the diagonal last in each row, and L^T, the diagonal first; without
                                       rows there is none */
    const struct ranks *ranks;      /* NULL: one process; else all have all of L, */
    int64_t *first;                 /* and each applies the rows of its own nodes; */
    struct halo halo;               /* what these rows of L^T need of the other nodes */
};

/* For a system whose body is made of smoothed cells and that knows the values at its nodes. */
MUST_CHECK enum status inverse_factor_build(const struct solid_system *system, struct inverse_factor *factor,
                                            struct error *error);
/* The same, holding at one time the rows of S of at most `batch` nodes and of those that they need. */
MUST_CHECK enum status inverse_factor_build_by(const struct solid_system *system, int64_t batch,
                                               struct inverse_factor *factor, struct error *error);
void inverse_factor_free(struct inverse_factor *factor);

/* (*wanted)[node_count], to be freed: the nodes whose values this process needs to apply its rows of L^T. */
MUST_CHECK enum status inverse_factor_wanted(const struct inverse_factor *factor, bool **wanted,
                                             struct error *error);

/* y = L x, of several processes where its own rows of L^T need it, and y = L^T x, of vectors of
 * node_count * dim, dim at most 3, not the same. */
void inverse_factor_apply(const struct inverse_factor *factor, int dim, const double *x, double *y);
void inverse_factor_apply_transposed(const struct inverse_factor *factor, int dim, const double *x,
                                     double *y);

/* x := L^-T x */
void inverse_factor_solve_transposed(const struct inverse_factor *factor, int dim, double *x);

/* The rows G as rows G L^T, in the same order. */
MUST_CHECK enum status inverse_factor_transform_rows(const struct inverse_factor *factor,
                                                     const struct constraint_rows *rows,
                                                     struct constraint_rows *transformed,
                                                     struct error *error);
