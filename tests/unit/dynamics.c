/* Explicit dynamics: the discrete frequency of central differences, energy and momenta conserved; waves and
 * releases are those of pipelines/hard/13-dynamics.sh. */
#include "lattice_fixture.h"

#include "solid/dynamics/dynamics.h"

#include <gsl/gsl_eigen.h>

static const double x_axis[3] = {1, 0, 0};

static struct dynamics_options over(double end_time)
{
    return (struct dynamics_options){.end_time = end_time, .time_step_margin = 0.9};
}

static struct dynamics_report run(struct lattice *l, const struct dynamics_options *options, double *u,
                                  double *v, struct energy_log *log)
{
    struct dynamics_report report;
    GOOD(dynamics_run(&l->system, options, u, v, NULL, log, &report, &error));
    return report;
}

static double product_of_mass(const struct lattice *l, const double *a, const double *b)
{
    return 2.0 * energy_kinetic(&l->system, a, b);
}

/* The fastest mode of the free body at rest and its frequency, from all eigenvalues. */
static double fastest_mode(struct lattice *l, double *mode)
{
    int dim = l->options.dim;
    size_t size = (size_t)(l->system.node_count * dim);
    double epsilon = 1e-7, *residual = lattice_vector(l);
    gsl_matrix *K = gsl_matrix_alloc(size, size), *vectors = gsl_matrix_alloc(size, size);
    gsl_vector *values = gsl_vector_alloc(size);
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(size);
    assert_true(K != NULL && vectors != NULL && values != NULL && work != NULL);
    const double *mass = l->system.lumped_mass;
    for (size_t j = 0; j < size; j++) {
        double column[2][64];
        assert_true(size <= 64);
        for (int sign = 0; sign < 2; sign++) {
            memset(mode, 0, size * sizeof *mode);
            mode[j] = sign ? epsilon : -epsilon;
            (void)system_residual(&l->system, mode, residual);
            memcpy(column[sign], residual, size * sizeof *residual);
        }
        for (size_t i = 0; i < size; i++) {
            gsl_matrix_set(K, i, j,
                           (column[0][i] - column[1][i]) / (2 * epsilon) /
                               sqrt(mass[i / (size_t)dim] * mass[j / (size_t)dim]));
        }
    }
    gsl_eigen_symmv(K, values, vectors, work);
    size_t fastest = gsl_vector_max_index(values);
    double square = gsl_vector_get(values, fastest);
    for (size_t i = 0; i < size; i++) {
        mode[i] = gsl_matrix_get(vectors, i, fastest) / sqrt(mass[i / (size_t)dim]);
    }
    gsl_matrix_free(K);
    gsl_matrix_free(vectors);
    gsl_vector_free(values);
    gsl_eigen_symmv_free(work);
    return sqrt(square);
}

/* A body released in one of its modes is one oscillator; central differences let it swing faster, by
 * asin(r) / r at the share r of the critical step. */
TEST(one_oscillator)
{
    static const double shares[] = {0.1, 0.5, 0.9}, quicker[] = {1.001674, 1.047198, 1.244188};
    enum { STEPS = 8 };
    struct lattice_options options = lattice_defaults(2, 4);
    FREED_BY(lattice_free) struct lattice l = {0};
    options.poisson_ratio = 0.3;
    lattice_build(&l, &options);
    double *mode = lattice_vector(&l), *u = lattice_vector(&l), *v = lattice_vector(&l);
    double frequency = fastest_mode(&l, mode);
    for (int k = 0; k < 3; k++) {
        /* The estimate of the critical step is from above: a little less time makes it STEPS exactly. */
        struct dynamics_options dynamics = over((1 - 1e-6) * STEPS * shares[k] * 2 / frequency);
        dynamics.time_step_margin = shares[k];
        for (int64_t i = 0; i < l.system.node_count * 2; i++) {
            u[i] = 1e-7 * mode[i];
            v[i] = 0;
        }
        struct dynamics_report report = run(&l, &dynamics, u, v, NULL);
        assert_int_equal(report.outcome, DYNAMICS_DONE);
        assert_int_equal(report.steps, STEPS);
        double phase = frequency * quicker[k] * dynamics.end_time;
        NEAR_TO(product_of_mass(&l, u, mode) / 1e-7, cos(phase), 1e-4);
        /* The velocity at the end, (v- + v+)/2, is of the amplitude w cos(w_h dt / 2). */
        double swing = sqrt(1 - shares[k] * shares[k]);
        NEAR_TO(product_of_mass(&l, v, mode) / 1e-7 / frequency, -swing * sin(phase), 1e-4);
        NEAR_TO(report.critical_step * frequency / 2, 1.0, 0.02);
    }
}

/* The end at the speed of a linear curve, without a jerk: balance and reaction stay right to the last row.
 * The begin at that speed is a blow, whose work counts. */
TEST(moved_at_constant_speed)
{
    FREED_BY(lattice_free) struct lattice l = {0};
    FREED_BY(energy_log_free) struct energy_log log = {0};
    int32_t curve = lattice_begin(&l, 2, 5, 0.0, CURVE_LINEAR);
    double there = 0.01;
    lattice_prescribe(&l, 15, x_axis, lattice_constant, &there, curve);
    double *u = lattice_vector(&l), *v = lattice_vector(&l);
    struct dynamics_options dynamics = over(0.25);
    struct dynamics_report report = run(&l, &dynamics, u, v, &log);
    assert_int_equal(report.outcome, DYNAMICS_DONE);
    const struct energy *end = &log.rows[log.count - 1];
    AT_MOST(report.largest_drift, 1e-3);
    AT_MOST(fabs(end->error), 1e-3);
    assert_true(log.rows[0].work > 0 && end->work > log.rows[0].work);
    for (int64_t n = 0; n < l.system.node_count; n++) {
        const double *X = l.system.X + 2 * n;
        if (X[0] == 0.0) {
            NEAR_TO(lattice_field(&l, u, n, 0), 0.01, 0.0005);
        }
    }
}

RUN_TESTS(one_thread, NULL)
