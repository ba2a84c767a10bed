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

/* Linear momentum, and the angular one about the origin (2D: its third component). */
static void momenta(const struct lattice *l, const double *u, const double *v, double p[3], double L[3])
{
    int dim = l->options.dim;
    for (int a = 0; a < 3; a++) {
        p[a] = L[a] = 0;
    }
    for (int64_t n = 0; n < l->system.node_count; n++) {
        double x[3] = {0}, w[3] = {0}, mass = l->system.lumped_mass[n];
        for (int a = 0; a < dim; a++) {
            x[a] = l->system.X[n * dim + a] + u[n * dim + a];
            w[a] = v[n * dim + a];
            p[a] += mass * w[a];
        }
        for (int a = 0; a < 3; a++) {
            L[a] += mass * (x[(a + 1) % 3] * w[(a + 2) % 3] - x[(a + 2) % 3] * w[(a + 1) % 3]);
        }
    }
}

/* A free body, thrown and spinning, keeps its momenta to round-off however it swings. */
TEST_IN_EACH_DIM(free_spin)
{
    struct lattice_options options = lattice_defaults(dim, dim == 2 ? 7 : 4);
    FREED_BY(lattice_free) struct lattice l = {0};
    options.jitter = 0.1;
    lattice_build(&l, &options);
    double *u = lattice_vector(&l), *v = lattice_vector(&l), p[2][3], L[2][3];
    static const double spin[3] = {0, 0, 12}, tumble[3] = {5, 3, 12};
    const double *w = dim == 2 ? spin : tumble;
    for (int64_t n = 0; n < l.system.node_count; n++) {
        double X[3] = {0};
        memcpy(X, l.system.X + n * dim, (size_t)dim * sizeof *X);
        for (int a = 0; a < dim; a++) {
            v[n * dim + a] = w[(a + 1) % 3] * X[(a + 2) % 3] - w[(a + 2) % 3] * X[(a + 1) % 3] + 0.1 * a;
        }
    }
    momenta(&l, u, v, p[0], L[0]);
    struct dynamics_options dynamics = over(0.5); /* about one turn */
    struct dynamics_report report = run(&l, &dynamics, u, v, NULL);
    assert_int_equal(report.outcome, DYNAMICS_DONE);
    momenta(&l, u, v, p[1], L[1]);
    double scale = fabs(L[0][2]);
    for (int a = 0; a < 3; a++) {
        NEAR_TO(p[1][a], p[0][a], 1e-10 * scale / 0.1);
        /* L at a time between two half steps differs from the conserved one by dt^2/4 sum m v x a = 0 */
        NEAR_TO(L[1][a], L[0][a], 1e-10 * scale);
    }
    AT_MOST(report.largest_drift, 1e-3);
}

/* A side pushed in and held: the work of the condition is what the energies hold, with and without damping,
 * and a damped body comes to the rest of the closed form for confined compression. */
TEST(pushed)
{
    static const double dampings[] = {0, 100};
    for (int k = 0; k < 2; k++) {
        struct lattice_options options = lattice_defaults(2, 7);
        FREED_BY(lattice_free) struct lattice l = {0};
        FREED_BY(energy_log_free) struct energy_log log = {0};
        struct dynamics_report report;
        lattice_build(&l, &options);
        static const double points[] = {0, 0, 0.05, 1, 0.3, 1};
        struct load_curve curve;
        GOOD(curve_tabulate(&curve, 3, points, 0.3, &error));
        int32_t index = lattice_curve(&l, curve);
        lattice_slide(&l, 1u << 0 | 1u << 1 | 1u << 2, index);
        lattice_push(&l, 3, -0.005, index);
        double *u = lattice_vector(&l), *row_force;
        row_force = zeros(l.system.rows.count, sizeof *row_force);
        struct dynamics_options dynamics = over(0.3);
        dynamics.damping = dampings[k];
        GOOD(dynamics_run(&l.system, &dynamics, u, NULL, row_force, &log, &report, &error));
        assert_int_equal(report.outcome, DYNAMICS_DONE);
        AT_MOST(report.largest_drift, 2e-3);
        const struct energy *end = &log.rows[log.count - 1];
        assert_true(end->work > 0);
        if (k == 0) {
            NEAR_TO(end->dissipated, 0, 0);
        } else {
            assert_true(end->dissipated > 0 && end->kinetic < 1e-6 * end->internal);
            double P = lattice_reaction(&l, row_force, 1u << 3) / 0.1;
            double mu = 1006.711409, kappa = 50000, J = 0.95, I1 = 2 + J * J;
            double expected = mu * pow(J, -2.0 / 3) * (J - I1 / (3 * J)) + kappa * (J - 1);
            NEAR_TO(P / expected, 1.0, 1e-4);
            NEAR_TO(end->work, end->internal + end->dissipated, 2e-3 * end->work);
        }
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

/* Weight put on a confined column at once: it sinks to twice the depth of rest, and returns. */
TEST(sudden_weight)
{
    struct lattice_options options = lattice_defaults(2, 3);
    FREED_BY(lattice_free) struct lattice l = {0};
    FREED_BY(energy_log_free) struct energy_log log = {0};
    options.count[1] = 11;
    options.size[0] = 0.02;
    lattice_build(&l, &options);
    int32_t curve = lattice_curve(&l, curve_of_kind(CURVE_STEP));
    lattice_slide(&l, 1u << 0 | 1u << 1 | 1u << 2, curve);
    struct dead_load *load = calloc(1, sizeof *load);
    assert_non_null(load);
    *load =
        (struct dead_load){.force = array_or_fail(l.system.node_count * 2, sizeof(double)), .curve = curve};
    for (int64_t c = 0; c < l.assembly.cells.count; c++) {
        for (int64_t i = l.smoothed.ptr[c]; i < l.smoothed.ptr[c + 1]; i++) {
            load->force[2 * l.smoothed.idx[i] + 1] -= 1e-2 * 1000 * l.assembly.weight[c] * l.smoothed.phi[i];
        }
    }
    l.system.loads = load;
    l.system.load_count = 1;
    double *u = lattice_vector(&l);
    struct dynamics_options dynamics = over(0.5 / 17.91338);
    struct dynamics_report report = run(&l, &dynamics, u, NULL, &log);
    assert_int_equal(report.outcome, DYNAMICS_DONE);
    AT_MOST(report.largest_drift, 1e-3);
    double rest = 1000 * 1e-2 * 0.1 * 0.1 / (2 * 51342.28);
    double top = 0;
    for (int i = 0; i < 3; i++) { /* its mean */
        top += (i == 1 ? 0.5 : 0.25) * lattice_field(&l, u, l.system.node_count - 1 - i, 1);
    }
    NEAR_TO(top / (-2 * rest), 1.0, 0.01);
    assert_true(log.rows[log.count - 1].work > 0);
}

RUN_TESTS(one_thread, NULL)
