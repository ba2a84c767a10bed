/* The largest frequency of a system at a state, which bounds the time step, equation (22) of lib/README.md.
 */
#pragma once

#include "solid/preconditioner/preconditioner.h"
#include "solid/system/system.h"

/* Largest frequency, the root of the largest eigenvalue of M^-1 K at u, by `iterations` steps of power
 * iteration that continue from mode[node_count * dim] (a start of zeros is replaced by a fixed pseudo-random
 * one). residual must hold the residual at u. The estimate is from below; repeated calls sharpen it. scratch:
 * 2 * node_count * dim. */
double system_largest_frequency(struct solid_system *system, struct preconditioner *preconditioner,
                                const double *u, const double *residual, int iterations, double *mode,
                                double *scratch);

/* The least eigenvalue of the symmetric tridiagonal matrix (diagonal[n], off_diagonal[n - 1]), to a part in
 * 1e4 (or of its rounding errors). */
double tridiagonal_least(int n, const double *diagonal, const double *off_diagonal);

/* A fixed sequence of pseudo-random numbers in [-1, 1): the same run gives the same bytes. */
void frequency_start(double *mode, int64_t size);
