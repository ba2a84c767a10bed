/* Explicit dynamics: a body that is moved; oscillators, waves and releases are those of
 * pipelines/hard/13-dynamics.sh. */
#include "lattice_fixture.h"

#include "solid/dynamics/dynamics.h"

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
