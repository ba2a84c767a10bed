/* Functions shared by the files of the preconditioner; see preconditioner.h. */
#pragma once

#include "solid/preconditioner/preconditioner.h"

/* amount[size] = Z^T P^T force, and acceleration = B force; S^-1 G times that is left in the multipliers of
 * the conditions. */
void preconditioner_restrict_force(struct preconditioner *preconditioner, const double *force,
                                   double *acceleration, double *amount);

/* force = B^-1 move = L^-1 D L^-T move; not the same array. */
void preconditioner_unsmooth(const struct preconditioner *preconditioner, const double *move, double *force);

MUST_CHECK enum status coarse_mean_begin(const struct coarse_space *coarse, struct coarse_mean *mean,
                                         struct error *error);
void coarse_mean_free(struct coarse_mean *mean);

/* Set the mean to zero; add factor times that of one coarse field; take those of an average, Z^T phi, for one
 * component of the displacement, without nodes that are held; held[node_count], or NULL: none is. */
void coarse_mean_clear(const struct coarse_space *coarse, struct coarse_mean *mean);
void coarse_mean_add(const struct coarse_space *coarse, int64_t field, double value,
                     struct coarse_mean *mean);
void coarse_mean_of_average(const struct coarse_space *coarse, const struct average *average,
                            const bool *held, struct coarse_mean *mean);

/* The coarse fields' means of averages: a row for each. */
MUST_CHECK enum status coarse_mean_table(const struct coarse_space *coarse, int64_t count,
                                         struct average (*average)(const void *context, int64_t i),
                                         const void *context, const bool *held, struct coarse_mean *mean,
                                         struct sparse *table, struct error *error);

/* Set up G Z: the rows of the conditions, applied to the coarse fields. */
MUST_CHECK enum status preconditioner_build_coarse_constraints(const struct solid_system *system,
                                                               struct preconditioner *preconditioner,
                                                               struct error *error);

/* value[rows of the conditions] = G Z amount, and amount[size] -= (G Z)^T value. */
void preconditioner_coarse_constraint_values(const struct preconditioner *preconditioner,
                                             const double *amount, double *value);
void preconditioner_subtract_constraint_forces(const struct preconditioner *preconditioner,
                                               const double *value, double *amount);

/* sum of D */
double preconditioner_sum_of_mass(const struct preconditioner *preconditioner);

/* A velocity of moves that the conditions admit is y = P (B f + Z a), with
 *
 *   a = (A + Z^T B^-1 P Z)^-1 (P Z)^T B^-1 y.
 *
 * amount[size] = a, and momentum[size] = A a. What prescribed motion adds to y does not count. */
void preconditioner_momentum(struct preconditioner *preconditioner, const double *velocity, double *amount,
                             double *momentum);

/* field[node_count * dim] = P Z amount */
void preconditioner_prolongate(struct preconditioner *preconditioner, const double *amount, double *field);

/* matrix[size * size], its lower triangle, += the stiffness along the coarse fields of the contact nodes that
 * A counts in; `only` those of these, or NULL: all. */
void preconditioner_add_contacts(struct preconditioner *preconditioner, const struct solid_system *system,
                                 const bool *only, double *matrix);

/* matrix[size * size] = the Cholesky factor of A that belongs to body + contacts. Returns the part of D that
 * it has, so that it is positive definite; 0: none makes it so. */
double preconditioner_factorise(const struct preconditioner *preconditioner, double *matrix);

/* The Cholesky factors, from what body, contacts and mass are. */
void preconditioner_factorise_both(struct preconditioner *preconditioner, const struct solid_system *system);

/* column[rows of the conditions] = S^-1 G Z e_k: the multipliers by which P changes coarse field k. False: no
 * condition acts on it. */
bool preconditioner_constrain_field(const struct preconditioner *preconditioner, int64_t k, double *column);

/* Set the stiffness of body and penalties along the coarse fields, as it is at the last evaluation of a body
 * of smoothed cells. */
MUST_CHECK enum status preconditioner_assemble(struct preconditioner *preconditioner,
                                               struct solid_system *system, struct error *error);
