#include "solid/frequency.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const int first_check = 16;
static const double check_growth = 4.0 / 3.0, settled_change = 0.05;
static const double least_share =
    0.6; /* of the ratio of the largest frequency to the lowest: iterations at least */
/* A start of which the conditions leave no more than this has nothing to move. */
static const double least_free = 1e-4;
static const double strain =
    1e-6; /* about that much is a cell strained by the move that K is measured with */

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
    double epsilon = strain * spacing / largest_entry(move, size);
    for (int64_t i = 0; i < size; i++) {
        displaced[i] = u[i] + epsilon * move[i];
    }
    (void)system_residual(system, displaced, response);
    return epsilon;
}

/* A fixed sequence of pseudo-random numbers in [-1, 1): the same run gives the same bytes. */
static void start_mode(double *mode, int64_t size)
{
    uint64_t state = 0x9e3779b97f4a7c15u;
    for (int64_t i = 0; i < size; i++) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        mode[i] = (double)(int64_t)state / 9223372036854775808.0;
    }
}

double system_largest_frequency(struct solid_system *system, struct inertia *inertia, const double *u,
                                const double *residual, int iterations, double *mode, double *scratch)
{
    int64_t size = system->node_count * system->dim;
    double *displaced = scratch, *response = scratch + size;
    double eigenvalue = 0.0;
    if (largest_entry(mode, size) == 0.0) {
        start_mode(mode, size);
        constraint_project(&inertia->constraint, NULL, mode);
    }
    double spacing = point_spacing(system);
    for (int it = 0; it < iterations; it++) {
        double epsilon = residual_along(system, u, spacing, mode, displaced, response);
        double top = 0.0;
        for (int64_t i = 0; i < size; i++) {
            displaced[i] = (residual[i] - response[i]) / epsilon;
            top += mode[i] * displaced[i];
        }
        eigenvalue = top / inertia_product(inertia, mode, mode);
        inertia_accelerate(inertia, displaced, response);
        double scale = 1.0 / largest_entry(response, size);
        for (int64_t i = 0; i < size; i++) {
            mode[i] = response[i] * scale;
        }
    }
    return eigenvalue > 0.0 ? sqrt(eigenvalue) : 0.0;
}

/* Of the largest: an eigenvalue below that is negative by more than differences of residuals can tell. */
static const double least_told = -1e-6;

/* How many eigenvalues of the symmetric tridiagonal matrix (diagonal[n], beside[n - 1]) are below x: Sturm's
 * count. */
static int eigenvalues_below(int n, const double *diagonal, const double *beside, double x)
{
    int below = 0;
    double pivot = 1.0;
    for (int i = 0; i < n; i++) {
        double off2 = i > 0 ? beside[i - 1] * beside[i - 1] : 0.0;
        pivot = diagonal[i] - x - (off2 > 0.0 ? off2 / pivot : 0.0);
        if (fabs(pivot) < 1e-300) {
            pivot = -1e-300;
        }
        below += pivot < 0.0;
    }
    return below;
}

/* Its least eigenvalue, to a part in 1e4 (or of its rounding errors), by bisection between Gershgorin's
 * bounds. */
static double least_eigenvalue(int n, const double *diagonal, const double *beside)
{
    double low = INFINITY, high = INFINITY, most = 0.0;
    for (int i = 0; i < n; i++) {
        double reach = (i > 0 ? fabs(beside[i - 1]) : 0.0) + (i + 1 < n ? fabs(beside[i]) : 0.0);
        low = fmin(low, diagonal[i] - reach);
        high = fmin(high, diagonal[i]); /* no diagonal entry is below the least eigenvalue */
        most = fmax(most, fabs(diagonal[i]) + reach);
    }
    while (high - low > 1e-4 * fmax(fabs(high), 1e-14 * most)) {
        double middle = 0.5 * (low + high);
        if (eigenvalues_below(n, diagonal, beside, middle) > 0) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

/* Its largest one. */
static double largest_eigenvalue(int n, double *diagonal, const double *beside)
{
    for (int i = 0; i < n; i++) {
        diagonal[i] = -diagonal[i];
    }
    double largest = -least_eigenvalue(n, diagonal, beside);
    for (int i = 0; i < n; i++) {
        diagonal[i] = -diagonal[i];
    }
    return largest;
}

/* product = M^-1 K move, from the change of the residual from u along the move. */
static void apply(struct solid_system *system, struct inertia *inertia, const double *u,
                  const double *residual, double spacing, const double *move, double *displaced,
                  double *product)
{
    double epsilon = residual_along(system, u, spacing, move, displaced, product);
    for (int64_t i = 0; i < system->node_count * system->dim; i++) {
        displaced[i] = (residual[i] - product[i]) / epsilon;
    }
    inertia_accelerate(inertia, displaced, product);
}

/* Whether `count` iterations can tell the least eigenvalue: fewer than a share of the ratio of the
 * frequencies stay on a plateau, at a higher mode. */
static bool enough(int count, double largest, double least)
{
    return count >= least_share * sqrt(largest / fmax(least, 1e-14 * largest));
}

enum status system_spectrum(struct solid_system *system, struct inertia *inertia, const double *u,
                            const double *residual, int most_iterations, double *start, double *scratch,
                            struct spectrum *spectrum, struct error *error)
{
    enum status status;
    int64_t size = system->node_count * system->dim;
    double *vector = start, *before = scratch, *product = scratch + size, *displaced = scratch + 2 * size;
    double *diagonal = NULL, *beside = NULL;
    double spacing = point_spacing(system), last = INFINITY;
    int next_check = first_check;
    *spectrum = (struct spectrum){.lowest = INFINITY};
    TRY(NEW_ARRAY(&diagonal, most_iterations, error));
    TRY(NEW_ARRAY(&beside, most_iterations, error));
    memset(before, 0, (size_t)size * sizeof *before);
    if (largest_entry(vector, size) == 0.0) {
        start_mode(vector, size);
    }
    double norm = sqrt(inertia_product_alone(inertia, vector, vector)), coupling = 0.0, largest = 0.0;
    constraint_project(&inertia->constraint, NULL, vector);
    if (!(sqrt(inertia_product_alone(inertia, vector, vector)) > least_free * norm)) {
        spectrum->lowest = spectrum->largest = 1.0;
        goto done;
    }
    norm = sqrt(inertia_product(inertia, vector, vector));
    for (int k = 0; k < most_iterations && norm > 1e-12 * largest; k++) {
        for (int64_t i = 0; i < size; i++) {
            vector[i] /= norm;
        }
        apply(system, inertia, u, residual, spacing, vector, displaced, product);
        diagonal[k] = inertia_product(inertia, vector, product);
        for (int64_t i = 0; i < size; i++) {
            product[i] -= diagonal[k] * vector[i] + coupling * before[i];
        }
        norm = coupling = beside[k] = sqrt(inertia_product(inertia, product, product));
        largest = fmax(largest, diagonal[k]);
        memcpy(before, vector, (size_t)size * sizeof *before);
        memcpy(vector, product, (size_t)size * sizeof *vector);
        spectrum->iterations = k + 1;
        if (k + 1 == next_check || k + 1 == most_iterations || !(norm > 1e-12 * largest)) {
            double value = least_eigenvalue(k + 1, diagonal, beside);
            bool is_settled = enough(k + 1, largest, value) && last - value < settled_change * value;
            spectrum->lowest = value;
            spectrum->largest = largest_eigenvalue(k + 1, diagonal, beside);
            if (is_settled || value < least_told * largest) {
                break;
            }
            last = value;
            next_check = (int)ceil(next_check * check_growth);
        }
    }
done:
    free(diagonal);
    free(beside);
    return status;
}
