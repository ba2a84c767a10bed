/* Quasi-static solution: linear patch test, closed forms, work and reaction, the error estimate as a bound,
 * and the plain relaxation. */
#include "lattice_fixture.h"

#include "solid/equilibrium/newton.h"
#include "solid/equilibrium/relaxation.h"

static struct statics_options to(double tolerance)
{
    return (struct statics_options){.tolerance = tolerance, .time_step_margin = 0.9};
}

static struct statics_report solve(struct lattice *l, const struct statics_options *options, double *u,
                                   double *row_force)
{
    struct statics_report report;
    GOOD(newton_run(&l->system, options, u, row_force, &report, &error));
    return report;
}

/* From rest to rest, which must be reached. */
static double *solved(struct lattice *l, double tolerance, double *row_force)
{
    double *u = lattice_vector(l);
    struct statics_options options = to(tolerance);
    assert_int_equal(solve(l, &options, u, row_force).outcome, STATICS_CONVERGED);
    return u;
}

/* A row of a gradient times X. */
static double linear(const double *X, const double *row)
{
    return row[0] * X[0] + row[1] * X[1] + row[2] * X[2];
}

static double linear_2d(const double *X, const double *row)
{
    return row[0] * X[0] + row[1] * X[1];
}

/* u = A X on all sides, all components. */
static void prescribe_all(struct lattice *l, const double A[9], int32_t curve)
{
    int dim = l->options.dim;
    for (int a = 0; a < dim; a++) {
        double direction[3] = {0, 0, 0};
        direction[a] = 1;
        lattice_prescribe(l, (1u << 2 * dim) - 1, direction, dim == 2 ? linear_2d : linear, A + 3 * a, curve);
    }
}

/* Largest error of the field at the nodes against A X, relative to the largest displacement. */
static double patch_error(const struct lattice *l, const double A[9], const double *u)
{
    int dim = l->options.dim;
    double error = 0, largest = 0;
    for (int64_t n = 0; n < l->system.node_count; n++) {
        for (int a = 0; a < dim; a++) {
            double exact = 0;
            for (int b = 0; b < dim; b++) {
                exact += A[3 * a + b] * l->system.X[n * dim + b];
            }
            double difference = fabs(lattice_field(l, u, n, a) - exact);
            error = difference <= error ? error : difference;
            largest = fmax(largest, fabs(exact));
        }
    }
    return error / largest;
}

static double patch(int dim, double jitter, int gauss_points, bool nodal_volume)
{
    static const double A[9] = {0.05, 0.08, -0.03, -0.06, -0.04, 0.02, 0.07, 0.01, -0.02};
    struct lattice_options options = lattice_defaults(dim, dim == 2 ? 8 : 6);
    FREED_BY(lattice_free) struct lattice l = {0};
    options.jitter = jitter;
    options.gauss_points = gauss_points;
    options.nodal_volume = nodal_volume;
    lattice_build(&l, &options);
    prescribe_all(&l, A, lattice_curve(&l, curve_of_kind(CURVE_SMOOTH)));
    double *u = solved(&l, gauss_points > 0 ? 1e-6 : 1e-9, NULL), error = patch_error(&l, A, u);
    return error;
}

/* Smoothed cells with boundary averages split at corners pass to round-off; Gauss points do not, by far. */
TEST(linear_patch)
{
    for (int nodal = 0; nodal < 2; nodal++) {
        AT_MOST(patch(2, 0.0, 0, nodal), 1e-9);
        AT_MOST(patch(2, 0.3, 0, nodal), 1e-9);
        AT_MOST(patch(3, 0.1, 0, nodal), 1e-9);
    }
}

TEST(linear_patch_at_gauss_points)
{
    double worst2 = patch(2, 0.3, 3, true), worst3 = patch(3, 0.1, 4, true);
    print_message("patch test at Gauss points, largest relative error: 2D %.2g, 3D %.2g\n", worst2, worst3);
    AT_MOST(worst2, 4e-2);
    AT_MOST(worst3, 4e-2);
    assert_true(worst2 > 1e-9);
}

/* A clamped block in 2D, its top moved down and, by `aside`, sideways. */
static void clamp(struct lattice *l, int64_t n, double down, double aside, bool nodal_volume)
{
    struct lattice_options options = lattice_defaults(2, n);
    options.jitter = 0.2;
    options.nodal_volume = nodal_volume;
    lattice_build(l, &options);
    int32_t curve = lattice_curve(l, curve_of_kind(CURVE_SMOOTH));
    static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    lattice_prescribe(l, 1u << 2, x, NULL, NULL, curve);
    lattice_prescribe(l, 1u << 2, y, NULL, NULL, curve);
    lattice_prescribe(l, 1u << 3, x, lattice_constant, &aside, curve);
    lattice_push(l, 3, down, curve);
    /* The last rows are those of the push: told apart by their label. */
    for (int64_t r = 0; r < l->system.rows.count; r++) {
        bool pushes = l->system.rows.section[r] == 1 << 3 && l->system.rows.direction[2 * r + 1] == 1;
        l->system.rows.section[r] = pushes ? 1 : 0;
    }
}

/* Small displacements: energy = reaction x displacement / 2. Large ones: reaction = d energy / d
 * displacement. */
TEST(reaction_does_the_work)
{
    for (int large = 0; large < 2; large++) {
        double energy[3], force[3], down = large ? -0.02 : -1e-7, change = large ? 1e-4 : 0;
        for (int k = 0; k < 3; k++) {
            FREED_BY(lattice_free) struct lattice l = {0};
            clamp(&l, 7, down + (k - 1) * change, 0, true);
            double *row_force = zeros(l.system.rows.count, sizeof *row_force);
            double *u = solved(&l, 1e-9, row_force);
            force[k] = lattice_reaction(&l, row_force, 1);
            energy[k] = body_energy(&l.system.body, u);
        }
        if (large) {
            NEAR_TO((energy[2] - energy[0]) / (2 * change) / force[1], 1, 1e-4);
        } else {
            NEAR_TO(0.5 * force[1] * down / energy[1], 1, 1e-4);
        }
        assert_true(force[1] < 0);
    }
}

static double largest_move(const struct lattice *l, const double *a, const double *b)
{
    int dim = l->system.dim;
    double largest2 = 0;
    for (int64_t n = 0; n < l->system.node_count; n++) {
        double sum = 0;
        for (int64_t i = n * dim; i < (n + 1) * dim; i++) {
            double difference = a[i] - (b != NULL ? b[i] : 0);
            sum += difference * difference;
        }
        largest2 = fmax(largest2, sum);
    }
    return sqrt(largest2);
}

/* Problems 0 to 3: clamped. 4: between sliding supports, nearly incompressible, where slow moves aside follow
 * fast ones. */
static void problem_of_bound(struct lattice *l, int problem)
{
    static const double down[] = {-0.001, -0.03, 0.01, 0}, aside[] = {0, 0.0, 0.02, 0.04};
    if (problem < 4) {
        clamp(l, problem == 1 ? 9 : 6, down[problem], aside[problem], problem < 3);
        return;
    }
    struct lattice_options options = lattice_defaults(2, 9);
    options.jitter = 0.2;
    options.poisson_ratio = 0.499;
    options.size[1] = 0.2;
    lattice_build(l, &options);
    int32_t curve = lattice_curve(l, curve_of_kind(CURVE_SMOOTH));
    lattice_slide(l, 1u << 0 | 1u << 2, curve);
    lattice_push(l, 3, -0.02, curve);
}

/* What is estimated to remain is no less than what does, at the worst node. */
TEST(estimate_is_a_bound)
{
    static const double tolerances[] = {1e-2, 1e-3, 1e-4, 1e-6, 1e-8};
    for (int problem = 0; problem < 5; problem++) {
        FREED_BY(lattice_free) struct lattice l = {0};
        double largest_overestimate = 0;
        problem_of_bound(&l, problem);
        double *exact = solved(&l, 1e-10, NULL);
        for (size_t k = 0; k < sizeof tolerances / sizeof *tolerances; k++) {
            double *u = lattice_vector(&l);
            struct statics_options options = to(tolerances[k]);
            struct statics_report report = solve(&l, &options, u, NULL);
            assert_int_equal(report.outcome, STATICS_CONVERGED);
            AT_MOST(report.error, tolerances[k]);
            double remaining = largest_move(&l, u, exact) / largest_move(&l, exact, NULL);
            AT_MOST(remaining, report.error);
            largest_overestimate = fmax(largest_overestimate, report.error / remaining);
        }
        print_message("problem %d: the error is overestimated by at most %.3g\n", problem,
                      largest_overestimate);
    }
}

static double largest_difference(const double *a, const double *b, int64_t size)
{
    double largest = 0;
    for (int64_t i = 0; i < size; i++) {
        double difference = fabs(a[i] - b[i]);
        largest = difference <= largest ? largest : difference;
    }
    return largest;
}

/* The plain relaxation comes to the same states, however fast the load is applied; a cell that this inverts
 * ends the run. */
TEST(relaxation_agrees)
{
    static const int64_t ramps[] = {0, 150, 1000, 3};
    FREED_BY(lattice_free) struct lattice l = {0};
    clamp(&l, 9, -0.02, 0.01, true);
    double *exact = solved(&l, 1e-8, NULL);
    for (int k = 0; k < 4; k++) {
        FREED_BY(lattice_free) struct lattice again = {0};
        clamp(&again, 9, -0.02, 0.01, true);
        double *u = lattice_vector(&again);
        struct statics_options options = to(1e-7);
        struct statics_report report;
        options.ramp_steps = ramps[k];
        GOOD(relaxation_run(&again.system, &options, u, NULL, &report, &error));
        assert_int_equal(report.outcome, k < 3 ? STATICS_CONVERGED : STATICS_INVERTED);
        if (k < 3) {
            assert_true(k == 0 || report.loading_steps == ramps[k]);
            AT_MOST(largest_difference(exact, u, again.system.node_count * 2), 1e-7 * 0.0224);
        }
    }
}

/* Augmentations reach the pressures that the bulk modulus itself makes of the volumes: the same forces
 * without a limit, for which a strain of 1e-9 counts by 500 000 shear moduli. */
TEST(pressures_are_augmented)
{
    for (int dim = 2; dim <= 3; dim++) {
        FREED_BY(lattice_free) struct lattice l = {0};
        struct lattice_options options = lattice_defaults(dim, 5);
        static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
        options.jitter = 0.2;
        options.poisson_ratio = 0.499999;
        lattice_build(&l, &options);
        int32_t curve = lattice_curve(&l, curve_of_kind(CURVE_SMOOTH));
        for (int a = 0; a < dim; a++) {
            lattice_prescribe(&l, 1u << 2, axes[a], NULL, NULL, curve);
        }
        lattice_push(&l, 3, -0.01, curve);
        double *u = solved(&l, 1e-9, NULL), *force = lattice_vector(&l), *expected = lattice_vector(&l);
        int64_t size = l.system.node_count * dim;
        assert_true(body_is_limited(&l.system.body));
        (void)body_force(&l.system.body, u, force);
        body_limit_bulk(&l.system.body, INFINITY);
        (void)body_force(&l.system.body, u, expected);
        double most = 0.0;
        for (int64_t i = 0; i < size; i++) {
            most = fmax(most, fabs(expected[i]));
        }
        AT_MOST(largest_difference(force, expected, size), 0.01 * most);
    }
}

RUN_TESTS(one_thread, NULL)
