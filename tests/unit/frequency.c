/* The lowest frequency of a system: against the eigenvalues of its whole stiffness matrix, by GSL. */
#include "lattice_fixture.h"

#include "solid/preconditioner/frequency.h"

#include <gsl/gsl_eigen.h>

/* Eigenvalues of P M^-1 K P, the least of those that are not the constraints' zeros. The matrix is symmetric
 * in the scaling M^1/2, and measured column by column. */
static double least_of_all(struct lattice *l, struct constraint *constraint, const double *mass,
                           const double *u, const double *residual)
{
    int dim = l->system.dim;
    int64_t size = l->system.node_count * dim;
    gsl_matrix *matrix = gsl_matrix_alloc((size_t)size, (size_t)size);
    gsl_vector *values = gsl_vector_alloc((size_t)size);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc((size_t)size);
    double *move = lattice_vector(l), *displaced = lattice_vector(l), *after = lattice_vector(l);
    const double epsilon = 1e-8;
    for (int64_t j = 0; j < size; j++) {
        memset(move, 0, (size_t)size * sizeof *move);
        move[j] = 1.0 / sqrt(mass[j / dim]);
        constraint_project(constraint, NULL, move);
        for (int64_t i = 0; i < size; i++) {
            displaced[i] = u[i] + epsilon * move[i];
        }
        (void)system_residual(&l->system, displaced, after);
        for (int64_t i = 0; i < size; i++) {
            after[i] = (residual[i] - after[i]) / epsilon / mass[i / dim];
        }
        constraint_project(constraint, NULL, after);
        for (int64_t i = 0; i < size; i++) {
            gsl_matrix_set(matrix, (size_t)i, (size_t)j, after[i] * sqrt(mass[i / dim]));
        }
    }
    for (size_t i = 0; i < (size_t)size; i++) { /* GSL reads the lower triangle */
        for (size_t j = 0; j < i; j++) {
            double mean = 0.5 * (gsl_matrix_get(matrix, i, j) + gsl_matrix_get(matrix, j, i));
            gsl_matrix_set(matrix, i, j, mean);
        }
    }
    gsl_eigen_symm(matrix, values, work);
    double largest = gsl_vector_max(values), least = INFINITY;
    for (size_t i = 0; i < (size_t)size; i++) {
        double value = gsl_vector_get(values, i);
        least = value > 1e-6 * largest ? fmin(least, value) : least;
    }
    gsl_eigen_symm_free(work);
    gsl_vector_free(values);
    gsl_matrix_free(matrix);
    return least;
}

TEST_IN_EACH_DIM(agrees_with_all_eigenvalues)
{
    FREED_BY(lattice_free) struct lattice l = {0};
    FREED_BY(preconditioner_free) struct preconditioner preconditioner = {0};
    struct lattice_options options = lattice_defaults(dim, dim == 2 ? 9 : 4);
    double *mass, *scratch;
    struct spectrum spectrum;
    options.jitter = 0.2;
    options.size[0] = 0.3;
    lattice_build(&l, &options);
    int32_t curve = lattice_curve(&l, curve_of_kind(CURVE_SMOOTH));
    lattice_slide(&l, dim == 2 ? 1u << 0 | 1u << 2 : 1u << 0 | 1u << 2 | 1u << 4, curve);
    int64_t size = l.system.node_count * dim;
    double *u = lattice_vector(&l), *residual = lattice_vector(&l), *start = lattice_vector(&l);
    mass = zeros(l.system.node_count, sizeof *mass);
    scratch = zeros(5 * size, sizeof *scratch);
    for (int64_t i = 0; i < size; i++) { /* a strained state; a start without favour */
        u[i] = (i % dim == 0 ? -0.05 : 0.05 / (dim - 1)) * l.system.X[i];
        start[i] = sin(1.0 + (double)(i * i % 97));
    }
    (void)system_residual(&l.system, u, residual);
    system_relaxation_mass(&l.system, false, mass);
    GOOD(preconditioner_build(&l.system, false, &preconditioner, &error));
    GOOD(preconditioner_set_mass(&preconditioner, &l.system, mass, &error));
    double least = least_of_all(&l, &preconditioner.constraint, mass, u, residual);
    GOOD(system_spectrum(&l.system, &preconditioner, u, residual, 1000, start, scratch, &spectrum, &error));
    print_message("%dD: %g for %g after %d iterations\n", dim, spectrum.lowest, least, spectrum.iterations);
    /* From above; a relaxation takes .8 of it for the least. */
    assert_true(spectrum.lowest > (1.0 - 1e-9) * least);
    AT_MOST(0.8 * spectrum.lowest, least);
}

/* A block in plane strain between sliding ends, compressed along the first axis, its free side along it: a
 * half-space wrinkles at a stretch of .544 (Biot 1963). */
TEST(a_block_compressed_beyond_biots_limit_is_not_stable)
{
    const double stretch[] = {0.8, 0.5}, across[] = {1.2379, 1.9123}; /* lateral: of no stress there */
    for (int k = 0; k < 2; k++) {
        FREED_BY(lattice_free) struct lattice l = {0};
        FREED_BY(preconditioner_free) struct preconditioner preconditioner = {0};
        struct lattice_options options = lattice_defaults(2, 9);
        struct spectrum spectrum;
        struct stability stability;
        double *mass, *scratch;
        options.jitter = 0.15;
        lattice_build(&l, &options);
        lattice_slide(&l, 1u << 0 | 1u << 1 | 1u << 2, lattice_curve(&l, curve_of_kind(CURVE_SMOOTH)));
        int64_t size = l.system.node_count * 2;
        double *u = lattice_vector(&l), *residual = lattice_vector(&l), *start = lattice_vector(&l);
        mass = zeros(l.system.node_count, sizeof *mass);
        scratch = zeros(5 * size, sizeof *scratch);
        for (int64_t i = 0; i < size; i++) {
            u[i] = ((i % 2 == 0 ? stretch[k] : across[k]) - 1.0) * l.system.X[i];
            start[i] = sin(1.0 + (double)(i * i % 97));
        }
        (void)system_residual(&l.system, u, residual);
        system_relaxation_mass(&l.system, false, mass);
        GOOD(preconditioner_build(&l.system, false, &preconditioner, &error));
        GOOD(preconditioner_set_mass(&preconditioner, &l.system, mass, &error));
        GOOD(system_spectrum(&l.system, &preconditioner, u, residual, 1000, start, scratch, &spectrum,
                             &error));
        GOOD(system_unstable_mode(&l.system, &preconditioner, u, residual, &spectrum, start, scratch,
                                  &stability, &error));
        print_message("stretch %g: %g of the largest\n", stretch[k], stability.least);
        if (k == 0) {
            assert_true(spectrum.lowest > 0.0 && stability.least > 0.0);
        } else {
            assert_true(spectrum.lowest < 0.0 && stability.least < 0.0);
            AT_MOST(0.1 - l.system.X[stability.node * 2 + 1], 1e-9); /* on the free side */
        }
    }
}

RUN_TESTS(NULL, NULL)
