#include "solid/preconditioner/frequency.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const int first_check = 16;
static const double check_growth = 4.0 / 3.0, settled_change = 0.05;
static const double least_share =
    0.6; /* of the ratio of the largest frequency to the lowest: iterations at least */
/* A start vector whose projection onto the admissible moves is below this share of it is taken for zero. */
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
        constraint_project(&p->constraint, NULL, mode);
    }
    double spacing = point_spacing(system);
    for (int it = 0; it < iterations; it++) {
        double epsilon = residual_along(system, u, spacing, mode, displaced, response);
        for (int64_t i = 0; i < size; i++) {
            displaced[i] = (residual[i] - response[i]) / epsilon;
        }
        preconditioner_resist_open(p, system, mode, displaced);
        eigenvalue = vector_product(size, mode, displaced) / preconditioner_square(p, mode);
        preconditioner_apply(p, displaced, response);
        double scale = 1.0 / largest_entry(response, size);
        for (int64_t i = 0; i < size; i++) {
            mode[i] = response[i] * scale;
        }
    }
    return eigenvalue > 0.0 ? sqrt(eigenvalue) : 0.0;
}

/* Share of the largest: a negative eigenvalue above minus that is within the round-off of the differences of
 * residuals. */
static const double least_told = -1e-6;

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

/* Its largest one. */
static double largest_eigenvalue(int n, double *diagonal, const double *off_diagonal)
{
    for (int i = 0; i < n; i++) {
        diagonal[i] = -diagonal[i];
    }
    double largest = -tridiagonal_least(n, diagonal, off_diagonal);
    for (int i = 0; i < n; i++) {
        diagonal[i] = -diagonal[i];
    }
    return largest;
}

/* Whether `count` iterations suffice for the least eigenvalue: with fewer than a share of the ratio of the
 * frequencies the Ritz value stays on a plateau, at a higher mode. */
static bool enough(int count, double largest, double least)
{
    return count >= least_share * sqrt(largest / fmax(least, 1e-14 * largest));
}

/* y[n]: the eigenvector of that matrix to its least eigenvalue, by inverse iteration from just below it. */
static void least_eigenvector(int n, const double *diagonal, const double *off_diagonal, double least,
                              double *pivot, double *y)
{
    double shift = least - 1e-3 * fabs(least);
    for (int i = 0; i < n; i++) {
        pivot[i] =
            diagonal[i] - shift - (i > 0 ? off_diagonal[i - 1] * off_diagonal[i - 1] / pivot[i - 1] : 0.0);
        y[i] = 1.0;
    }
    for (int turn = 0; turn < 4; turn++) {
        for (int i = 1; i < n; i++) {
            y[i] -= off_diagonal[i - 1] / pivot[i - 1] * y[i - 1];
        }
        for (int i = n - 1; i >= 0; i--) {
            y[i] = (y[i] - (i + 1 < n ? off_diagonal[i] * y[i + 1] : 0.0)) / pivot[i];
        }
        double scale = 1.0 / largest_entry(y, n);
        for (int i = 0; i < n; i++) {
            y[i] *= scale;
        }
    }
}

/* A Lanczos iteration at a state. With each vector goes M times it. */
struct lanczos {
    struct solid_system *system;
    struct preconditioner *preconditioner;
    const double *u, *residual;
    double spacing;
    double *vector, *force, *force_before, *displaced, *response; /* system->node_count * dim */
    double norm;                                                  /* of vector, in the product of the mass */
};

static int64_t lanczos_size(const struct lanczos *l)
{
    return l->system->node_count * l->system->dim;
}

/* From l->vector; false when its projection onto the admissible moves vanishes. */
static bool lanczos_begin(struct lanczos *l)
{
    double whole = preconditioner_square_diagonal(l->preconditioner, l->vector);
    constraint_project(&l->preconditioner->constraint, NULL, l->vector);
    memset(l->force_before, 0, (size_t)lanczos_size(l) * sizeof *l->force_before);
    preconditioner_multiply(l->preconditioner, l->vector, l->force);
    l->norm = sqrt(vector_product(lanczos_size(l), l->vector, l->force));
    return preconditioner_square_diagonal(l->preconditioner, l->vector) > least_free * least_free * whole;
}

/* Vectors in scratch[5 * node_count * dim]; l->vector is a copy of `start`, or pseudo-random for zeros. */
static struct lanczos lanczos_at(struct solid_system *system, struct preconditioner *p, const double *u,
                                 const double *residual, const double *start, double *scratch)
{
    int64_t size = system->node_count * system->dim;
    struct lanczos l = {.system = system,
                        .preconditioner = p,
                        .u = u,
                        .residual = residual,
                        .spacing = point_spacing(system),
                        .vector = scratch,
                        .force = scratch + size,
                        .force_before = scratch + 2 * size,
                        .displaced = scratch + 3 * size,
                        .response = scratch + 4 * size};
    memcpy(l.vector, start, (size_t)size * sizeof *start);
    if (largest_entry(start, size) == 0.0) {
        frequency_start(l.vector, size);
    }
    return l;
}

/* l->vector, of norm 1 now, is the k-th one. */
static void lanczos_scale(struct lanczos *l)
{
    double scale = 1.0 / l->norm;
    for (int64_t i = 0; i < lanczos_size(l); i++) {
        l->vector[i] *= scale;
        l->force[i] *= scale;
    }
}

/* Entries k of the diagonal and beside it, from the k-th vector; then the next one. K is the change of the
 * residual from u along the vector. */
static void lanczos_step(struct lanczos *l, int k, double *diagonal, double *off_diagonal)
{
    int64_t size = lanczos_size(l);
    double coupling = k > 0 ? l->norm : 0.0, *next = l->force_before;
    double epsilon = residual_along(l->system, l->u, l->spacing, l->vector, l->displaced, l->response);
    for (int64_t i = 0; i < size; i++) {
        next[i] = (l->residual[i] - l->response[i]) / epsilon - coupling * l->force_before[i];
    }
    diagonal[k] = vector_product(size, l->vector, next);
    for (int64_t i = 0; i < size; i++) {
        next[i] -= diagonal[k] * l->force[i];
    }
    l->force_before = l->force;
    l->force = next;
    preconditioner_apply(l->preconditioner, next, l->vector);
    /* `next` is M times that but for reactions, which would grow from step to step */
    preconditioner_multiply(l->preconditioner, l->vector, next);
    l->norm = off_diagonal[k] = sqrt(vector_product(size, l->vector, next));
}

enum status system_spectrum(struct solid_system *system, struct preconditioner *p, const double *u,
                            const double *residual, int most_iterations, const double *start, double *scratch,
                            struct spectrum *spectrum, struct error *error)
{
    double last = INFINITY, largest = 0.0;
    int next_check = first_check;
    *spectrum = (struct spectrum){.lowest = INFINITY};
    NEW_SCRATCH(double, diagonal, most_iterations, error);
    NEW_SCRATCH(double, off_diagonal, most_iterations, error);
    struct lanczos l = lanczos_at(system, p, u, residual, start, scratch);
    if (!lanczos_begin(&l)) {
        spectrum->lowest = spectrum->largest = 1.0;
        return STATUS_OK;
    }
    for (int k = 0; k < most_iterations && l.norm > 1e-12 * largest; k++) {
        lanczos_scale(&l);
        lanczos_step(&l, k, diagonal, off_diagonal);
        largest = fmax(largest, diagonal[k]);
        spectrum->iterations = k + 1;
        if (k + 1 == next_check || k + 1 == most_iterations || !(l.norm > 1e-12 * largest)) {
            double value = tridiagonal_least(k + 1, diagonal, off_diagonal);
            bool is_settled = enough(k + 1, largest, value) && last - value < settled_change * value;
            spectrum->lowest = value;
            spectrum->largest = largest_eigenvalue(k + 1, diagonal, off_diagonal);
            if (is_settled || value < least_told * largest) {
                break;
            }
            last = value;
            next_check = (int)ceil(next_check * check_growth);
        }
    }
    return STATUS_OK;
}

enum status system_unstable_mode(struct solid_system *system, struct preconditioner *p, const double *u,
                                 const double *residual, const struct spectrum *spectrum, const double *start,
                                 double *scratch, struct stability *stability, struct error *error)
{
    int count = spectrum->iterations;
    int64_t size = system->node_count * system->dim;
    *stability = (struct stability){.least = spectrum->lowest / spectrum->largest};
    if (!(spectrum->lowest < least_told * spectrum->largest)) {
        return STATUS_OK;
    }
    NEW_SCRATCH(double, diagonal, count, error);
    NEW_SCRATCH(double, off_diagonal, count, error);
    NEW_SCRATCH(double, share, count, error);
    NEW_SCRATCH(double, pivot, count, error);
    NEW_SCRATCH(double, mode, size, error);
    struct lanczos l = lanczos_at(system, p, u, residual, start, scratch);
    (void)lanczos_begin(&l);
    for (int k = 0; k < count; k++) { /* the matrix first, */
        lanczos_scale(&l);
        lanczos_step(&l, k, diagonal, off_diagonal);
    }
    least_eigenvector(count, diagonal, off_diagonal, spectrum->lowest, pivot, share);
    l = lanczos_at(system, p, u, residual, start, scratch);
    (void)lanczos_begin(&l);
    for (int k = 0; k < count; k++) { /* then its vectors, of which the mode is a sum */
        lanczos_scale(&l);
        for (int64_t i = 0; i < size; i++) {
            mode[i] += share[k] * l.vector[i];
        }
        lanczos_step(&l, k, diagonal, off_diagonal);
    }
    stability->least = -INFINITY;
    for (int way = 0; way < 2; way++) { /* a contact that opens or closes does so one way */
        l = lanczos_at(system, p, u, residual, mode, scratch);
        (void)lanczos_begin(&l);
        lanczos_scale(&l);
        lanczos_step(&l, 0, diagonal, off_diagonal);
        stability->least = fmax(stability->least, diagonal[0] / spectrum->largest);
        for (int64_t i = 0; i < size; i++) {
            mode[i] = -mode[i];
        }
    }
    stability->least = stability->least < least_told ? stability->least : 0.0;
    (void)vector_longest(system->dim, system->node_count, mode, &stability->node);
    return STATUS_OK;
}
