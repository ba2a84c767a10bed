/* The frequencies of a system at a state: the largest bounds the time step; by the lowest the error of a
 * relaxation decays, and it bounds that error. */
#ifndef SOLID_FREQUENCY_H
#define SOLID_FREQUENCY_H

#include "solid/inertia.h"
#include "solid/system.h"

/* Largest frequency, the root of the largest eigenvalue of M^-1 K at u, by `iterations` steps of power
 * iteration that continue from mode[node_count * dim] (a start of zeros is replaced by a fixed pseudo-random
 * one). residual must hold the residual at u. The estimate is from below; repeated calls sharpen it. scratch:
 * 2 * node_count * dim. */
double system_largest_frequency(struct solid_system *system, struct inertia *inertia, const double *u,
                                const double *residual, int iterations, double *mode, double *scratch);

/* Least eigenvalue w^2 of M^-1 K at u among the moves that the conditions admit, by Lanczos iteration in the
 * product of the mass from `start` (node_count * dim; best a smooth move, such as the last velocity;
 * overwritten). K is the difference of residuals, one evaluation an iteration; residual must hold the
 * residual at u. The estimate falls toward the eigenvalue from above; it ends when a third more iterations
 * changed it by less than 5 %, when it is negative, or after most_iterations. *value <= 0: no minimum of the
 * energy, or a contact that opens or closes there; which system->spectrum keeps, with the place. *iterations
 * receives how many there were. scratch: 3 * node_count * dim. */
MUST_CHECK enum status system_lowest_eigenvalue(struct solid_system *system, struct inertia *inertia,
                                                const double *u, const double *residual, int most_iterations,
                                                double *start, double *scratch, double *value,
                                                int *iterations, struct error *error);

#endif
