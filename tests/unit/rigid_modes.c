/* Rigid modes that conditions leave free: of nodes held one by one, in 2D and 3D, of several bodies, of parts
 * that are joined by nodes. */
#include "unit.h"

#include "solid/system/rigid_modes.h"

enum { MOST_NODES = 16 };

struct held {
    struct solid_system system;
    double X[3 * MOST_NODES];
    int32_t body[MOST_NODES];
};

/* The corners of a box of 0.2 x 0.1 (x 0.1) m at `from`, `bodies` of them one behind the other along x. */
static void begin(struct held *held, int dim, int bodies, double from)
{
    int corners = dim == 2 ? 4 : 8;
    *held = (struct held){.system = {.dim = dim, .node_count = (int64_t)corners * bodies}};
    for (int n = 0; n < corners * bodies; n++) {
        held->body[n] = (int32_t)(n / corners);
        held->X[n * dim] = from + 0.3 * held->body[n] + 0.2 * (n & 1);
        held->X[n * dim + 1] = from + 0.1 * (n >> 1 & 1);
        if (dim == 3) {
            held->X[n * dim + 2] = from + 0.1 * (n >> 2 & 1);
        }
    }
    held->system.X = held->X;
    constraint_rows_init(&held->system.rows, dim);
}

static void hold(struct held *held, int32_t node, int axis)
{
    static const double one = 1.0;
    double direction[3] = {0.0, 0.0, 0.0};
    direction[axis] = 1.0;
    GOOD(constraint_rows_add(&held->system.rows, 1, &node, &one, direction, 0.0, 0, 0, node, &error));
}

static void hold_all(struct held *held, int32_t node)
{
    for (int a = 0; a < held->system.dim; a++) {
        hold(held, node, a);
    }
}

static void expect(struct held *held, int64_t body, int translations, int turns, struct rigid_modes *modes)
{
    struct rigid_modes all[4];
    bool complete, has;
    GOOD(system_rigid_modes(&held->system,
                            (int32_t)(held->system.node_count / (held->system.dim == 2 ? 4 : 8)), held->body,
                            0, NULL, all, &complete, &error));
    assert_true(complete);
    *modes = all[body];
    assert_int_equal(modes->translations, translations);
    assert_int_equal(modes->turns, turns);
    if (held->body[held->system.node_count - 1] == 0) {
        GOOD(system_has_rigid_mode(&held->system, &has, &error));
        assert_int_equal(has, translations + turns > 0);
    }
}

TEST(in_the_plane)
{
    for (double from = 0.0; from < 20.0; from += 10.0) { /* wherever the origin is */
        struct held held;
        struct rigid_modes modes;
        begin(&held, 2, 1, from);
        expect(&held, 0, 2, 1, &modes);
        NEAR_TO(modes.centre[0], from + 0.1, 1e-12);
        hold_all(&held, 1); /* a hinge */
        expect(&held, 0, 0, 1, &modes);
        NEAR_TO(modes.through[0][0], from + 0.2, 1e-9);
        NEAR_TO(modes.through[0][1], from, 1e-9);
        hold(&held, 0, 0); /* in line with it */
        expect(&held, 0, 0, 1, &modes);
        hold(&held, 0, 1);
        expect(&held, 0, 0, 0, &modes);
        constraint_rows_free(&held.system.rows);
        begin(&held, 2, 1, from);
        hold(&held, 0, 0); /* a slide along y */
        hold(&held, 2, 0);
        expect(&held, 0, 1, 0, &modes);
        NEAR_TO(fabs(modes.along[0][1]), 1.0, 1e-12);
        constraint_rows_free(&held.system.rows);
    }
}

TEST(in_space)
{
    struct held held;
    struct rigid_modes modes;
    begin(&held, 3, 1, 5.0);
    expect(&held, 0, 3, 3, &modes);
    hold_all(&held, 0);
    expect(&held, 0, 0, 3, &modes);
    for (int k = 0; k < 3; k++) { /* every axis goes through that node */
        double apart[3], along = 0.0, off = 0.0;
        for (int a = 0; a < 3; a++) {
            apart[a] = 5.0 - modes.through[k][a];
            along += apart[a] * modes.axis[k][a];
        }
        for (int a = 0; a < 3; a++) {
            off += pow(apart[a] - along * modes.axis[k][a], 2);
        }
        NEAR_TO(sqrt(off), 0.0, 1e-9);
    }
    hold_all(&held, 1); /* the edge along x from (5, 5, 5): it turns about that */
    expect(&held, 0, 0, 1, &modes);
    NEAR_TO(fabs(modes.axis[0][0]), 1.0, 1e-9);
    NEAR_TO(modes.through[0][1], 5.0, 1e-9);
    NEAR_TO(modes.through[0][2], 5.0, 1e-9);
    hold(&held, 2, 2);
    expect(&held, 0, 0, 0, &modes);
    constraint_rows_free(&held.system.rows);
    begin(&held, 3, 1, 0.0);
    for (int32_t n = 0; n < 4; n++) { /* a face that slides on a plane */
        hold(&held, n, 2);
    }
    expect(&held, 0, 2, 1, &modes);
    NEAR_TO(fabs(modes.axis[0][2]), 1.0, 1e-9);
    NEAR_TO(modes.along[0][2], 0.0, 1e-9);
    constraint_rows_free(&held.system.rows);
}

/* A box that shares one node with what is held, and one that shares an edge, turn about these; by three nodes
 * it is held. If nothing is held, both move, and turn beside that. */
TEST(hinges)
{
    static const struct joint joint[] = {{1, 0}, {1, 2}, {1, 4}, {1, 4}};
    static const int turns[] = {3, 1, 0, 0};
    struct held held;
    struct rigid_modes modes[2];
    bool complete;
    begin(&held, 3, 2, 5.0);
    for (int count = 1; count <= 4; count++) {
        GOOD(system_rigid_modes(&held.system, 2, held.body, count, joint, modes, &complete, &error));
        assert_int_equal(modes[0].translations + modes[1].translations, 6);
        assert_int_equal(modes[0].turns + modes[1].turns, 6);
    }
    for (int32_t n = 0; n < 3; n++) {
        hold_all(&held, n);
    }
    for (int count = 1; count <= 4; count++) {
        GOOD(system_rigid_modes(&held.system, 2, held.body, count, joint, modes, &complete, &error));
        assert_int_equal(modes[1].translations, 0);
        assert_int_equal(modes[1].turns, turns[count - 1]);
        assert_int_equal(modes[0].translations + modes[0].turns, 0);
        if (count == 2) { /* nodes 0 and 2: along y */
            NEAR_TO(fabs(modes[1].axis[0][1]), 1.0, 1e-9);
            NEAR_TO(modes[1].through[0][0], 5.0, 1e-9);
            NEAR_TO(modes[1].through[0][2], 5.0, 1e-9);
        }
    }
    constraint_rows_free(&held.system.rows);
}

/* Four bars in a loop, joined at corners, as nodes 4 p to 4 p + 3 of bar p, p from 0: the first one is held.
 * The others move as one mechanism: those beside it turn about the joints, the last one moves along x while
 * they stand upright. With a diagonal bar, a fifth one, nothing moves. */
TEST(closed_chain)
{
    static const struct {
        double low[2], high[2];
    } bar[] = {{{0, 0}, {4, 1}}, {{-1, 1}, {0, 5}}, {{4, 1}, {5, 5}}, {{0, 5}, {4, 6}}};
    static const struct joint joint[] = {{1, 2}, {2, 3}, {3, 7}, {3, 10}, {4, 1}, {4, 12}};
    struct held held;
    struct rigid_modes modes[5];
    bool complete;
    begin(&held, 2, 4, 0.0);
    for (int n = 0; n < 16; n++) {
        held.X[2 * n] = n & 1 ? bar[n / 4].high[0] : bar[n / 4].low[0];
        held.X[2 * n + 1] = n & 2 ? bar[n / 4].high[1] : bar[n / 4].low[1];
    }
    hold_all(&held, 0);
    hold_all(&held, 1);
    GOOD(system_rigid_modes(&held.system, 4, held.body, 4, joint, modes, &complete, &error));
    assert_int_equal(modes[0].translations + modes[0].turns, 0);
    for (int p = 1; p <= 2; p++) {
        assert_int_equal(modes[p].translations, 0);
        assert_int_equal(modes[p].turns, 1);
        NEAR_TO(modes[p].through[0][0], p == 1 ? 0.0 : 4.0, 1e-9);
        NEAR_TO(modes[p].through[0][1], 1.0, 1e-9);
    }
    assert_int_equal(modes[3].translations, 1);
    assert_int_equal(modes[3].turns, 0);
    NEAR_TO(fabs(modes[3].along[0][0]), 1.0, 1e-9);
    GOOD(system_rigid_modes(&held.system, 5, held.body, 6, joint, modes, &complete, &error));
    for (int p = 0; p < 5; p++) {
        assert_int_equal(modes[p].translations + modes[p].turns, 0);
    }
    constraint_rows_free(&held.system.rows);
}

/* A chain of very many bars has more free motions than are looked at. */
TEST(long_chain)
{
    enum { MOST_BARS = 400 };
    static double X[2 * (MOST_BARS + 1)];
    static int32_t part[MOST_BARS + 1];
    static struct joint joint[MOST_BARS];
    static struct rigid_modes modes[MOST_BARS];
    for (int bars = MOST_BARS / 2; bars <= MOST_BARS; bars += MOST_BARS / 2) {
        struct solid_system system = {.dim = 2, .node_count = bars + 1, .X = X};
        bool complete;
        for (int32_t n = 0; n <= bars; n++) {
            X[2 * n] = n;
            X[2 * n + 1] = n & 1;
            part[n] = n < bars ? n : bars - 1;
        }
        for (int32_t p = 0; p + 1 < bars; p++) {
            joint[p] = (struct joint){p, p + 1};
        }
        GOOD(system_rigid_modes(&system, bars, part, bars - 1, joint, modes, &complete, &error));
        assert_int_equal(complete, bars < MOST_BARS);
        assert_int_equal(modes[0].translations + modes[0].turns, 3);
    }
}

/* Of three bodies the one in the middle is free; a row over nodes of two bodies holds either. */
TEST(several_bodies)
{
    struct held held;
    struct rigid_modes modes;
    begin(&held, 2, 3, 0.0);
    for (int32_t n = 0; n < 4; n++) {
        hold_all(&held, n);
        hold_all(&held, n + 8);
    }
    expect(&held, 0, 0, 0, &modes);
    expect(&held, 2, 0, 0, &modes);
    expect(&held, 1, 2, 1, &modes);
    NEAR_TO(modes.centre[0], 0.4, 1e-12);
    static const int32_t both[2] = {1, 4};
    static const double half[2] = {0.5, 0.5}, along_x[2] = {1.0, 0.0};
    GOOD(constraint_rows_add(&held.system.rows, 2, both, half, along_x, 0.0, 0, 0, 1, &error));
    expect(&held, 1, 1, 1, &modes);
    constraint_rows_free(&held.system.rows);
}

RUN_TESTS(NULL, NULL)
