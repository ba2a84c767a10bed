/* Functions shared by the files of the preconditioner; see preconditioner.h. */
#pragma once

#include "solid/preconditioner/preconditioner.h"

/* amount[size] = Z^T P^T force, and acceleration = B force, whose values by the rows of the conditions are
 * left in their multipliers. */
void preconditioner_restrict_force(struct preconditioner *preconditioner, const double *force,
                                   double *acceleration, double *amount);

/* force = B^-1 move = L^-1 D L^-T move; not the same array. */
void preconditioner_unsmooth(const struct preconditioner *preconditioner, const double *move, double *force);

/* field[coarse.count] += the mean of each coarse field: Z^T phi, for one component of the displacement. */
void preconditioner_add_fields(const struct preconditioner *preconditioner, const struct average *average,
                               double *field);

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

/* matrix[size * size] += the stiffness along the coarse fields of the contact nodes that A counts in; `only`
 * those of these, or NULL: all. */
void preconditioner_add_contacts(const struct preconditioner *preconditioner,
                                 const struct solid_system *system, const bool *only, double *matrix);

/* matrix[size * size] = the Cholesky factor of A that belongs to body + contacts. Returns the part of D that
 * it has, so that it is positive definite; 0: none makes it so. */
double preconditioner_factorise(const struct preconditioner *preconditioner, double *matrix);

/* The Cholesky factors, from what body, contacts and mass are. */
void preconditioner_factorise_both(struct preconditioner *preconditioner, const struct solid_system *system);

/* matrix[size * size] += stiffness row^T row */
void preconditioner_add_square(int64_t size, double stiffness, const double *row, double *matrix);

/* Set the stiffness of body and penalties along the coarse fields, as it is at the last evaluation of a body
 * of smoothed cells. */
MUST_CHECK enum status preconditioner_assemble(struct preconditioner *preconditioner,
                                               struct solid_system *system, struct error *error);
