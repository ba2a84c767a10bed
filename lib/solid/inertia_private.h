/* What the parts of the inertia share; see inertia.h. */
#ifndef SOLID_INERTIA_PRIVATE_H
#define SOLID_INERTIA_PRIVATE_H

#include "solid/inertia.h"

/* amount[size] = Z^T P^T force, and acceleration = D^-1 force, whose values by the rows of the conditions are
 * left in their multipliers. */
void inertia_collect_force(struct inertia *inertia, const double *force, double *acceleration,
                           double *amount);

/* amount[size] = Z^T D move */
void inertia_collect(const struct inertia *inertia, const double *move, double *amount);

/* row[size] += Z^T phi direction, of an average along a direction. */
void inertia_add_row(const struct inertia *inertia, const struct average *average, const double *direction,
                     double *row);

/* sum of D */
double inertia_sum_of_mass(const struct inertia *inertia);

/* The inverses, from what body, contacts and mass are. */
void inertia_invert(struct inertia *inertia, const struct solid_system *system);

#endif
