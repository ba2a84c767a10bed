/* What the parts of the preconditioner share; see preconditioner.h. */
#ifndef SOLID_PRECONDITIONER_PRIVATE_H
#define SOLID_PRECONDITIONER_PRIVATE_H

#include "solid/preconditioner.h"

/* amount[size] = Z^T P^T force, and acceleration = B force, whose values by the rows of the conditions are
 * left in their multipliers. */
void preconditioner_restrict_force(struct preconditioner *preconditioner, const double *force,
                                   double *acceleration, double *amount);

/* field[coarse.count] += the mean of each coarse field: Z^T phi, for one component of the displacement. */
void preconditioner_add_fields(const struct preconditioner *preconditioner, const struct average *average,
                               double *field);

/* sum of D */
double preconditioner_sum_of_mass(const struct preconditioner *preconditioner);

/* The inverses, from what body, contacts and mass are. */
void preconditioner_invert(struct preconditioner *preconditioner, const struct solid_system *system);

#endif
