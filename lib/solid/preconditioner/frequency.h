/* The extreme frequencies of a system at a state. The largest bounds the time step, equation (22) of
 * lib/README.md; the lowest is the rate at which a critically damped relaxation converges, and bounds its
 * error, equation (27) of lib/README.md. */
#pragma once

#include "solid/preconditioner/preconditioner.h"
#include "solid/system/system.h"

/* Largest frequency, the root of the largest eigenvalue of M^-1 K at u, by `iterations` steps of power
 * iteration that continue from mode[node_count * dim] (a start of zeros is replaced by a fixed pseudo-random
 * one). Contact nodes that the preconditioner counts in are taken as closed: within a step they may be.
 * residual must hold the residual at u. The estimate is from below; repeated calls sharpen it. scratch:
 * 2 * node_count * dim. */
double system_largest_frequency(struct solid_system *system, struct preconditioner *preconditioner,
                                const double *u, const double *residual, int iterations, double *mode,
                                double *scratch);

/* Eigenvalues w^2 of M^-1 K among the moves that the conditions admit. */
struct spectrum {
    double lowest, largest; /* estimates, from above and from below */
    int iterations;         /* evaluations that they cost */
};

/* The spectrum at u by Lanczos iteration in the product of the mass from `start` (node_count * dim; best a
 * smooth move, such as the last velocity; for zeros a fixed pseudo-random one). K is the difference of
 * residuals, one evaluation an iteration; residual must hold the residual at u. It ends when a third more
 * iterations changed the lowest eigenvalue by less than 5 %, when that is negative, or after most_iterations.
 * Lowest <= 0: no minimum of the energy, or a contact that opens or closes there. Both are set to 1 if the
 * conditions leave no degree of freedom. scratch: 5 * node_count * dim. */
MUST_CHECK enum status system_spectrum(struct solid_system *system, struct preconditioner *preconditioner,
                                       const double *u, const double *residual, int most_iterations,
                                       const double *start, double *scratch, struct spectrum *spectrum,
                                       struct error *error);

/* Whether u is stable, by a spectrum that was found from this start. A negative eigenvalue is certain only by
 * its mode, which costs the same iterations twice more: `least` is then the Rayleigh quotient of the mode,
 * which no round-off of the iteration makes negative, the larger one of both ways, as a contact that opens or
 * closes there makes it so along one of them at the most. scratch as before. */
MUST_CHECK enum status system_unstable_mode(struct solid_system *system,
                                            struct preconditioner *preconditioner, const double *u,
                                            const double *residual, const struct spectrum *spectrum,
                                            const double *start, double *scratch, struct stability *stability,
                                            struct error *error);

/* The least eigenvalue of the symmetric tridiagonal matrix (diagonal[n], off_diagonal[n - 1]), to a part in
 * 1e4 (or of its rounding errors). */
double tridiagonal_least(int n, const double *diagonal, const double *off_diagonal);

/* A fixed sequence of pseudo-random numbers in [-1, 1): the same run gives the same bytes. */
void frequency_start(double *mode, int64_t size);
