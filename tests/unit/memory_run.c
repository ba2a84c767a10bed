/* Fault 25: whichever allocation fails, quasi-static and dynamic runs report it with STATUS_SYSTEM and leave
 * nothing allocated. */
#include "lattice_fixture.h"

#ifndef __clang__ /* whose OpenMP cannot be replaced as simply */
#include "failing_allocator.h"
#endif

#ifdef FAILING_ALLOCATOR

#include "solid/dynamics.h"
#include "solid/relaxation.h"

/* In place of libgomp's, which ends the program when it gets no memory: all work on this thread. */
void GOMP_parallel(void (*work)(void *), void *data, unsigned threads, unsigned flags);
void GOMP_parallel(void (*work)(void *), void *data, unsigned threads, unsigned flags)
{
    (void)threads;
    (void)flags;
    work(data);
}

static struct lattice lattice; /* made before any allocation fails */
static double *u, *v;

static void to_rest(void)
{
    memset(u, 0, (size_t)(lattice.system.node_count * lattice.system.dim) * sizeof *u);
    memset(v, 0, (size_t)(lattice.system.node_count * lattice.system.dim) * sizeof *v);
}

static enum status try_relaxation(struct error *error)
{
    struct relaxation_options options = {.tolerance = 1e-3, .time_step_margin = 0.9};
    struct relaxation_report report;
    to_rest();
    return relaxation_run(&lattice.system, &options, u, NULL, &report, error);
}

static enum status try_dynamics(struct error *error)
{
    struct dynamics_options options = {.end_time = 0.01, .time_step_margin = 0.9};
    struct dynamics_report report;
    struct energy_log log = {0};
    to_rest();
    enum status status = dynamics_run(&lattice.system, &options, u, v, NULL, &log, &report, error);
    energy_log_free(&log);
    return status;
}

static void relaxations(void **state)
{
    (void)state;
    fail_each(try_relaxation, 15);
}

static void dynamics(void **state)
{
    (void)state;
    fail_each(try_dynamics, 15);
}

static int run_in(int dim)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(relaxations), cmocka_unit_test(dynamics)};
    struct lattice_options options = lattice_defaults(dim, dim == 2 ? 4 : 3);
    lattice_build(&lattice, &options);
    int32_t curve = lattice_curve(&lattice, curve_of_kind(CURVE_SMOOTH));
    lattice_slide(&lattice, 1u << 2, curve);
    lattice_push(&lattice, 3, -0.001, curve);
    lattice_push(&lattice, 3, -0.001, curve); /* twice: dropped conditions are checked */
    u = lattice_vector(&lattice);
    v = lattice_vector(&lattice);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    free(u);
    free(v);
    lattice_free(&lattice);
    return failed;
}

int main(void)
{
    return run_in(2) + run_in(3);
}

#else

int main(void)
{
    return 0;
}

#endif
