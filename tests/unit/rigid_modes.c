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
    bool has;
    GOOD(system_rigid_modes(&held->system,
                            (int32_t)(held->system.node_count / (held->system.dim == 2 ? 4 : 8)), held->body,
                            all, &error));
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

/* Of three bodies the one in the middle is free. */
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
    constraint_rows_free(&held.system.rows);
}

RUN_TESTS(NULL, NULL)
