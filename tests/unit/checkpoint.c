/* Checkpoints: a run that is interrupted at any step, put away in a file and taken up by another process's
 * fresh system goes on to the same bits; states that do not fit are refused. */
#include "lattice_fixture.h"

#include "io/checkpoint/checkpoint.h"
#include "solid/dynamics/dynamics.h"
#include "solid/equilibrium/newton.h"
#include "solid/equilibrium/relaxation.h"

#include <stdio.h>
#include <unistd.h>

static const struct checkpoint_identity identity = {.scene = 0x12345678, .input = 0xff};
static char folder[64], file[96];
static double modulus; /* of the contact's penalty, Pa; 0: the penalty is 1e5 Pa/m */

/* A soft block over a floor, its top pushed down so far that it touches the floor. */
static void build(struct lattice *l)
{
    struct rigid_surface floor;
    static const double corners[4] = {-1, -0.004, 1, -0.004};
    struct lattice_options options = lattice_defaults(2, 5);
    options.jitter = 0.2;
    options.poisson_ratio = 0.495; /* so that pressures are held */
    lattice_build(l, &options);
    int32_t curve = lattice_curve(l, curve_of_kind(CURVE_SMOOTH));
    lattice_slide(l, 1u << 0, curve);
    lattice_push(l, 3, -0.03, curve);
    struct boundary_averages *averages = malloc(sizeof *averages);
    l->system.contacts = malloc(sizeof *l->system.contacts);
    assert_true(averages != NULL && l->system.contacts != NULL);
    *averages = lattice_averages(l, 1u << 2);
    GOOD(rigid_build(2, 1, corners, true, &floor, &error));
    GOOD(contact_build(averages, NULL, l->system.X, 2, &floor, 1e5, l->system.contacts, &error));
    if (modulus > 0.0) {
        contact_set_stiffness(l->system.contacts, modulus);
    }
    l->system.contact_points = averages;
    l->system.contact_count = 1;
}

/* Where to interrupt, and what happened. */
struct interruption {
    int64_t at; /* step; 0: never */
    bool done;
    double frames; /* sum over what was given */
};

static bool interrupt(void *context, const struct progress *progress)
{
    struct interruption *interruption = context;
    struct stream stream = {0};
    if (progress->step != interruption->at) {
        return true;
    }
    GOOD(checkpoint_fill(&stream, &identity, progress->step, progress->state, progress->run, &error));
    GOOD(checkpoint_write(file, &stream, &error));
    stream_free(&stream);
    interruption->done = true;
    return false;
}

static void frame(void *context, int64_t number, double time, const double *u)
{
    ((struct interruption *)context)->frames += (double)number * time * u[1];
}

static const sig_atomic_t always = 1;

/* All that a run leaves behind. */
struct result {
    double u[100], row_force[100];
    struct energy_log log;
    struct statics_report statics;
    struct dynamics_report dynamics;
};

enum method { NEWTON, RELAXATION, DYNAMICS };

static void run(enum method method, struct interruption *interruption, const struct state *restored,
                struct result *result)
{
    FREED_BY(lattice_free) struct lattice l = {0};
    build(&l);
    assert_true(l.system.rows.count <= 100 && l.system.node_count <= 50);
    *result = (struct result){.log = {0}};
    if (method == DYNAMICS) {
        struct dynamics_options options = {.end_time = 0.6,
                                           .time_step_margin = 0.9,
                                           .damping = 5,
                                           .frame_interval = 0.01,
                                           .frame = frame,
                                           .progress = interrupt,
                                           .context = interruption,
                                           .interrupted = &always,
                                           .restored = restored};
        GOOD(dynamics_run(&l.system, &options, result->u, NULL, result->row_force, &result->log,
                          &result->dynamics, &error));
        assert_int_equal(result->dynamics.outcome, interruption->at > 0 ? DYNAMICS_STOPPED : DYNAMICS_DONE);
    } else {
        struct statics_options options = {.tolerance = 1e-6,
                                          .time_step_margin = 0.9,
                                          .frames = 5,
                                          .frame = frame,
                                          .progress = interrupt,
                                          .context = interruption,
                                          .restored = restored};
        GOOD((method == NEWTON ? newton_run : relaxation_run)(&l.system, &options, result->u,
                                                              result->row_force, &result->statics, &error));
        assert_int_equal(result->statics.outcome, interruption->at > 0 ? STATICS_STOPPED : STATICS_CONVERGED);
    }
    if (interruption->at == 0) { /* the test is of something only if they are in play */
        double pressure = 0;
        for (int64_t a = 0; a < l.system.contacts->count; a++) {
            pressure += l.system.contacts->pressure[a];
        }
        assert_true(pressure > 0);
        assert_true((l.system.contacts->modulus > modulus) == (modulus > 0.0));
    }
}

static void resume(enum method method, struct interruption *interruption, struct result *result)
{
    FREED_BY(stream_free) struct stream stream = {0};
    bool exists;
    int64_t step;
    GOOD(checkpoint_read(file, &identity, &stream, &exists, &step, &error));
    assert_true(exists);
    struct state state = checkpoint_state(&stream);
    run(method, interruption, &state, result);
}

static void same_bits(enum method method, int64_t first, int64_t second)
{
    struct result whole, part;
    struct interruption none = {0}, once = {.at = first}, twice = {.at = second};
    run(method, &none, NULL, &whole);
    run(method, &once, NULL, &part);
    energy_log_free(&part.log);
    twice.frames = once.frames;
    resume(method, &twice, &part);
    energy_log_free(&part.log);
    assert_true(once.done && twice.done);
    struct interruption rest = {.frames = twice.frames};
    resume(method, &rest, &part);
    assert_memory_equal(whole.u, part.u, sizeof whole.u);
    assert_memory_equal(whole.row_force, part.row_force, sizeof whole.row_force);
    assert_memory_equal(&whole.statics, &part.statics, sizeof whole.statics);
    assert_memory_equal(&whole.dynamics, &part.dynamics, sizeof whole.dynamics);
    assert_int_equal(whole.log.count, part.log.count);
    assert_memory_equal(whole.log.rows, part.log.rows, (size_t)whole.log.count * sizeof *whole.log.rows);
    assert_true(none.frames != 0 && none.frames == rest.frames);
    energy_log_free(&whole.log);
    energy_log_free(&part.log);
}

TEST(statics_go_on)
{
    static const int64_t at[][2] = {{1, 2}, {3, 7}, {6, 10}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        same_bits(NEWTON, at[i][0], at[i][1]);
        same_bits(RELAXATION, 10 * at[i][0], 10 * at[i][1]);
    }
}

/* Also where the pressures call for larger penalties, at some check. */
TEST(penalties_grow)
{
    modulus = 1e4;
    for (int64_t step = 1; step < 9; step++) {
        same_bits(NEWTON, step, step + 1);
    }
    modulus = 0.0;
}

TEST(dynamics_goes_on)
{
    static const int64_t at[][2] = {{1, 2}, {19, 20}, {21, 60}, {81, 99}};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        same_bits(DYNAMICS, at[i][0], at[i][1]);
    }
}

/* A state of two values, for tests of the files. */
struct pair {
    int64_t count;
    double number;
};

static enum status visit_pair(void *owner, const struct state *state, struct error *error)
{
    struct pair *pair = owner;
    const struct state_value values[] = {{"count", STATE_COUNTS, &pair->count, 1},
                                         {"number", STATE_NUMBERS, &pair->number, 1}};
    return state_visit(state, NULL, values, 2, error);
}

/* Values that are missing, of another size or out of range. */
TEST(states_that_do_not_fit)
{
    FREED_BY(stream_free) struct stream stream = {0};
    struct pair pair = {.count = -1};
    struct state empty = checkpoint_state(&stream);
    FAILS(visit_pair(&pair, &empty, &error), STATUS_INPUT, "");
    GOOD(stream_put(&stream, "state.count", TYPE_I8, 1, 1, "", &pair.count, false, &error));
    FAILS(visit_pair(&pair, &empty, &error), STATUS_INPUT, "negative");
    pair.count = 2;
    FAILS(visit_pair(&pair, &empty, &error), STATUS_INPUT, "state.number");
    static double two[2];
    GOOD(stream_put(&stream, "state.number", TYPE_F8, 2, 1, "", two, false, &error));
    FAILS(visit_pair(&pair, &empty, &error), STATUS_INPUT, "");
}

static int make_folder(void **state)
{
    (void)state;
    const char *temporary = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%.40s/checkpointXXXXXX", temporary != NULL ? temporary : "/tmp");
    snprintf(file, sizeof file, "%s/run.ckpt", mkdtemp(folder) != NULL ? folder : "");
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    struct error error;
    return checkpoint_remove(file, &error) != STATUS_OK || rmdir(folder) != 0;
}

RUN_TESTS(make_folder, remove_folder)
