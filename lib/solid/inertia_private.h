/* What the parts of the inertia share; see inertia.h. */
#ifndef SOLID_INERTIA_PRIVATE_H
#define SOLID_INERTIA_PRIVATE_H

#include "solid/inertia.h"

/* amount[size] = Z^T P^T force, and acceleration = D^-1 force, whose values by the rows H are left in `seen`.
 */
void inertia_collect_force(struct inertia *inertia, const double *force, double *acceleration,
                           double *amount);

/* amount[size] = Z^T D move */
void inertia_collect(const struct inertia *inertia, const double *move, double *amount);

/* ---- inertia_rows.c: conditions and nodal volumes, the rows H ---- */

int64_t inertia_row_count(const struct inertia *inertia);

/* seen = H x; x += D^-1 H^T amount; amount = S^-1 amount. */
void inertia_rows_see(struct inertia *inertia, const double *x, double *seen);
void inertia_rows_spread(const struct inertia *inertia, const double *amount, double *x);
void inertia_rows_solve(const struct inertia *inertia, double *amount);
MUST_CHECK enum status inertia_rows_solve_many(const struct inertia *inertia, int64_t count, double *amount,
                                               struct error *error);

/* Factor S anew where there are volumes: mass, conditions and C are set. */
MUST_CHECK enum status inertia_couple(struct inertia *inertia, struct error *error);

/* ---- inertia_mass.c, inertia_stiffness.c ---- */

/* row[size] += Z^T phi direction, of an average along a direction. */
void inertia_add_row(const struct inertia *inertia, const struct average *average, const double *direction,
                     double *row);

/* sum of D */
double inertia_sum_of_mass(const struct inertia *inertia);

/* The inverses, from what body, contacts and mass are. */
void inertia_invert(struct inertia *inertia, const struct solid_system *system);

#endif
