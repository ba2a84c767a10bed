#include "solid/preconditioner/frequency.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/preconditioner/preconditioner_private.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static double largest_entry(const double *vector, int64_t size)
{
    double largest = 0.0;
    for (int64_t i = 0; i < size; i++) {
        largest = fabs(vector[i]) > largest ? fabs(vector[i]) : largest;
    }
    return largest;
}

/* Mean spacing of the points. */
static double point_spacing(const struct solid_system *system)
{
    return pow(body_volume(&system->body) / (double)system->body.point_count, 1.0 / system->dim);
}

/* response = the residual at displaced = u + epsilon move, which strains the body by about `strain`; returns
 * epsilon. */
static double residual_along(struct solid_system *system, const double *u, double spacing, const double *move,
                             double *displaced, double *response)
{
    int64_t size = system->node_count * system->dim;
    double epsilon = DIFFERENCE_STEP * spacing / largest_entry(move, size);
    for (int64_t i = 0; i < size; i++) {
        displaced[i] = u[i] + epsilon * move[i];
    }
    (void)system_residual(system, displaced, response);
    return epsilon;
}

void frequency_start(double *mode, int64_t size)
{
    uint64_t state = 0x9e3779b97f4a7c15u;
    for (int64_t i = 0; i < size; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        mode[i] = (double)(int64_t)state / 9223372036854775808.0;
    }
}

double system_largest_frequency(struct solid_system *system, struct preconditioner *p, const double *u,
                                const double *residual, int iterations, double *mode, double *scratch)
{
    int64_t size = system->node_count * system->dim;
    double *displaced = scratch, *response = scratch + size;
    double eigenvalue = 0.0;
    if (largest_entry(mode, size) == 0.0) {
        frequency_start(mode, size);
        preconditioner_project(p, mode);
    }
    double spacing = point_spacing(system);
    for (int it = 0; it < iterations; it++) {
        double epsilon = residual_along(system, u, spacing, mode, displaced, response);
        for (int64_t i = 0; i < size; i++) {
            displaced[i] = (residual[i] - response[i]) / epsilon;
        }
        double product = vector_dot(size, mode, displaced);
        preconditioner_apply(p, displaced, response);
        eigenvalue = vector_dot(size, response, displaced) / product;
        double scale = 1.0 / largest_entry(response, size);
        for (int64_t i = 0; i < size; i++) {
            mode[i] = response[i] * scale;
        }
    }
    return eigenvalue > 0.0 ? sqrt(eigenvalue) : 0.0;
}

/* How many eigenvalues of the symmetric tridiagonal matrix (diagonal[n], off_diagonal[n - 1]) are below x:
 * Sturm's count. */
static int eigenvalues_below(int n, const double *diagonal, const double *off_diagonal, double x)
{
    int below = 0;
    double pivot = 1.0;
    for (int i = 0; i < n; i++) {
        double off2 = i > 0 ? off_diagonal[i - 1] * off_diagonal[i - 1] : 0.0;
        pivot = diagonal[i] - x - (off2 > 0.0 ? off2 / pivot : 0.0);
        if (fabs(pivot) < 1e-300) {
            pivot = -1e-300;
        }
        below += pivot < 0.0;
    }
    return below;
}

/* By bisection between Gershgorin's bounds. */
double tridiagonal_least(int n, const double *diagonal, const double *off_diagonal)
{
    double low = INFINITY, high = INFINITY, most = 0.0;
    for (int i = 0; i < n; i++) {
        double reach = (i > 0 ? fabs(off_diagonal[i - 1]) : 0.0) + (i + 1 < n ? fabs(off_diagonal[i]) : 0.0);
        low = fmin(low, diagonal[i] - reach);
        high = fmin(high, diagonal[i]); /* no diagonal entry is below the least eigenvalue */
        most = fmax(most, fabs(diagonal[i]) + reach);
    }
    while (high - low > 1e-4 * fmax(fabs(high), 1e-14 * most)) {
        double middle = 0.5 * (low + high);
        if (eigenvalues_below(n, diagonal, off_diagonal, middle) > 0) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}
