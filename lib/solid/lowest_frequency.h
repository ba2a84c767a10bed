/* The lowest frequency of a system at a state: what the error of a relaxation decays by, and what bounds it.
 */
#ifndef SOLID_LOWEST_FREQUENCY_H
#define SOLID_LOWEST_FREQUENCY_H

#include "solid/system.h"

/* Least eigenvalue w^2 of M^-1 K at u among the moves that the constraint admits, by Lanczos iteration in the
 * product of the mass from `start` (node_count * dim; best a smooth move, such as the last velocity;
 * overwritten). K is the difference of residuals, one evaluation an iteration; residual must hold the
 * residual at u. The estimate falls toward the eigenvalue from above; it ends when a third more iterations
 * changed it by less than 5 %, or after most_iterations. *value <= 0: no minimum of the energy. *iterations
 * receives how many there were. scratch: 4 * node_count * dim. */
MUST_CHECK enum status system_lowest_eigenvalue(struct solid_system *system, struct constraint *constraint,
                                                const double *u, const double *residual, int most_iterations,
                                                double *start, double *scratch, double *value,
                                                int *iterations, struct error *error);

#endif
