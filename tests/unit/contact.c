/* Contact of contact nodes with rigid surfaces: forces are the gradient of the energy and balance, contact
 * nodes are skipped only where that changes nothing, multipliers remove the penetration, and forces do not
 * jump where the closest facet changes. */
#include "contact_fixture.h"

/* force = - d energy / du, with and without multipliers. */
TEST(force_is_gradient)
{
    struct random random = {1};
    struct contact_nodes contact_nodes;
    int contacts = 0;
    for (int round = 0; round < 40; round++) {
        int dim = 2 + round % 2;
        make_contact_nodes(&contact_nodes, dim, 10.0, &random);
        FREED_BY(contact_free)
        struct contact contact = built(&contact_nodes, make_shell(dim, 4, 0.8, false), 7e3);
        double u[NODES * 3], force[NODES * 3] = {0.0}, aside[NODES * 3], h = 1e-7;
        push_out(u, &random);
        for (int i = 0; i < CONTACT_NODES * dim && round >= 20; i++) {
            contact.multiplier[i] = contact.held[i] = uniform(&random, -2e3, 2e3);
        }
        contact_force(&contact, u, force);
        contacts += touching(&contact);
        for (int i = 0; i < NODES * dim; i++) {
            double at = u[i], energy[2];
            for (int side = 0; side < 2; side++) {
                u[i] = at + (side ? h : -h);
                contact_force(&contact, u, aside);
                energy[side] = contact_energy(&contact);
            }
            u[i] = at;
            NEAR_TO(force[i], -(energy[1] - energy[0]) / (2.0 * h), 1e-2);
        }
    }
    assert_true(contacts > 100);
}

/* Along walks in and out of closed and open shells the forces are the same bits as when every contact node is
 * always looked at. */
TEST(skipping)
{
    struct random random = {3};
    struct contact_nodes contact_nodes;
    int contacts = 0, steps = 0, skipped = 0;
    for (int round = 0; round < 16; round++) {
        int dim = 2 + round % 2;
        make_contact_nodes(&contact_nodes, dim, 10.0, &random);
        FREED_BY(contact_free)
        struct contact contact = built(&contact_nodes, make_shell(dim, 24, 0.8, round % 4 >= 2), 1e4);
        FREED_BY(contact_free)
        struct contact always = built(&contact_nodes, make_shell(dim, 24, 0.8, round % 4 >= 2), 1e4);
        double u[NODES * 3] = {0.0}, velocity[NODES * 3] = {0.0};
        for (int step = 0; step < 2000; step++) {
            double force[NODES * 3] = {0.0}, expected[NODES * 3] = {0.0};
            for (int i = 0; i < NODES * dim; i++) {
                velocity[i] = 0.98 * velocity[i] - 1e-4 * u[i] + uniform(&random, -2e-3, 2e-3);
                u[i] += velocity[i];
            }
            if (step % 500 == 499) {
                contact_augment(&contact);
                contact_augment(&always);
            }
            contact_force(&contact, u, force);
            contact_force(&always, u, expected);
            assert_memory_equal(force, expected, sizeof force);
            contact_accept(&contact);
            contact_measure(&always, u, true);
            contact_accept(&always);
            contacts += touching(&contact);
            for (int a = 0; a < CONTACT_NODES; a++) {
                skipped += !contact.view[a].searched;
            }
            steps++;
        }
    }
    assert_true(contacts > steps && contacts < steps * CONTACT_NODES * 3 / 4);
    assert_true(skipped > steps * CONTACT_NODES / 3);
}

/* Along such walks evaluations at other places and back again change nothing: forces, gaps and the state are
 * the same bytes. */
TEST(evaluations_change_no_state)
{
    struct random random = {5};
    struct contact_nodes contact_nodes;
    int changes = 0, touches = 0;
    for (int round = 0; round < 8; round++) {
        int dim = 2 + round % 2;
        make_contact_nodes(&contact_nodes, dim, 10.0, &random);
        FREED_BY(contact_free)
        struct contact walks = built(&contact_nodes, make_shell(dim, 24, 0.8, round % 4 >= 2), 1e4);
        FREED_BY(contact_free)
        struct contact strays = built(&contact_nodes, make_shell(dim, 24, 0.8, round % 4 >= 2), 1e4);
        double u[NODES * 3] = {0.0}, away[NODES * 3], last[NODES * 3] = {0.0};
        for (int step = 0; step < 300; step++) {
            double force[NODES * 3] = {0.0}, other[NODES * 3] = {0.0}, elsewhere[NODES * 3] = {0.0};
            for (int i = 0; i < NODES * dim; i++) {
                u[i] += uniform(&random, -5e-2, 5e-2);
            }
            contact_force(&walks, u, force);
            for (int k = 0; k < 3; k++) {
                for (int i = 0; i < NODES * dim; i++) {
                    away[i] = u[i] + uniform(&random, -0.5, 0.5);
                }
                contact_force(&strays, away, elsewhere);
            }
            contact_force(&strays, u, other);
            assert_memory_equal(force, other, sizeof force);
            assert_memory_equal(walks.gap, strays.gap, sizeof(double) * CONTACT_NODES);
            assert_memory_equal(walks.normal, strays.normal, sizeof(double) * (size_t)(CONTACT_NODES * dim));
            contact_accept(&walks);
            contact_accept(&strays);
            if (step % 50 == 49) {
                contact_augment(&walks);
                contact_augment(&strays);
            }
            assert_memory_equal(walks.multiplier, strays.multiplier,
                                sizeof(double) * (size_t)(CONTACT_NODES * dim));
            assert_memory_equal(walks.behind, strays.behind, sizeof(bool) * CONTACT_NODES);
            assert_memory_equal(walks.checked_x, strays.checked_x,
                                sizeof(double) * (size_t)(CONTACT_NODES * dim));
            assert_memory_equal(walks.checked_distance, strays.checked_distance,
                                sizeof(double) * CONTACT_NODES);
            changes += memcmp(last, force, sizeof force) != 0;
            touches += touching(&walks);
            memcpy(last, force, sizeof force);
        }
    }
    assert_true(changes > 500 && touches > 500);
}

/* What the penalty leaves falls as a geometric sequence. */
TEST(augmentations_of_springs)
{
    struct contact_nodes contact_nodes;
    make_particles(&contact_nodes, 3, 0.5);
    FREED_BY(contact_free)
    struct contact contact = built(&contact_nodes, make_shell(3, 6, 0.5, false), 100.0);
    double u[NODES * 3] = {0.0}, force[NODES * 3], stiffness = 0.5 * 100.0, spring = 20.0, depth = 0.02;
    for (int round = 0; round < 4; round++) {
        for (int a = 0; a < CONTACT_NODES; a++) {
            double holds = contact.multiplier[a * 3 + 1] * -0.5;
            u[a * 3] = 0.03 * a;
            u[a * 3 + 2] = -0.01 * a;
            u[a * 3 + 1] = 0.5 + (spring * depth - holds) / (spring + stiffness);
        }
        memset(force, 0, sizeof force);
        contact_force(&contact, u, force);
        NEAR_TO(contact_miss(&contact), pow(2.0 / 7.0, round) * 20.0 / 70.0 * depth, 1e-12);
        contact_augment(&contact);
    }
}

/* A line y = 0 from x = 0 to 1, the body above. One particle goes through it and is held; one goes round its
 * end to the back and is not, until it has been in front again. */
TEST(round_the_rim)
{
    static const double corners[] = {1, 0, 0, 0};
    static const double path[][2] = {{1.2, 0.3}, {1.2, 0.05}, {1.2, -0.2}, {0.9, -0.2}, {0.5, -0.2},
                                     {0.5, 0.2}, {0.5, -0.2}, {1.2, -0.2}, {1.2, 0.2},  {0.5, 0.1}};
    static const bool held[] = {false, false, false, false, false, false, true, false, false, false};
    for (int detail = 1; detail <= 1000; detail *= 10) { /* in long and in short steps */
        struct rigid_surface surface;
        struct contact_nodes contact_nodes;
        GOOD(rigid_build(2, 1, corners, false, &surface, &error));
        make_particles(&contact_nodes, 2, 0.1);
        for (int a = 0; a < CONTACT_NODES; a++) {
            contact_nodes.X[2 * a] = path[0][0];
            contact_nodes.X[2 * a + 1] = path[0][1];
        }
        FREED_BY(contact_free) struct contact contact = built(&contact_nodes, surface, 100.0);
        double u[NODES * 3] = {0.0}, force[NODES * 3];
        for (int leg = 1; leg < 10; leg++) {
            for (int step = 1; step <= detail; step++) {
                double part = (double)step / detail;
                u[0] = (1.0 - part) * path[leg - 1][0] + part * path[leg][0] - path[0][0];
                u[1] = (1.0 - part) * path[leg - 1][1] + part * path[leg][1] - path[0][1];
                contact_force(&contact, u, force);
                contact_accept(&contact);
            }
            assert_int_equal(contact.pressure[0] > 0.0, held[leg]);
        }
    }
}

/* Closed convex shells, with creases of two and three planes, inside which particles have multipliers of any
 * direction, before and behind the surface: moved by d, each force changes by at most k A d, as the
 * projection onto a convex set is a contraction. */
TEST(forces_do_not_jump_in_creases)
{
    struct random random = {31};
    const double stiffness = 1e3, area = 0.5, step = 1e-4;
    for (int round = 0; round < 300; round++) {
        int dim = 2 + round % 2;
        struct contact_nodes contact_nodes;
        make_particles(&contact_nodes, dim, area);
        FREED_BY(contact_free)
        struct contact contact =
            built(&contact_nodes, make_shell(dim, 3 + round % 11, 1.0, false), stiffness);
        double u[NODES * 3] = {0.0}, before[NODES * 3] = {0.0}, after[NODES * 3] = {0.0};
        contact_force(&contact, u, before); /* in front, to begin with */
        contact_accept(&contact);
        for (int i = 0; i < CONTACT_NODES * dim; i++) {
            u[i] = uniform(&random, -1.2, 1.2);
            contact.multiplier[i] = uniform(&random, -500.0, 500.0);
        }
        contact_spread_multipliers(&contact);
        for (int k = 0; k < 50; k++) {
            memset(before, 0, sizeof before);
            memset(after, 0, sizeof after);
            contact_force(&contact, u, before);
            for (int i = 0; i < CONTACT_NODES * dim; i++) {
                u[i] += uniform(&random, -step, step);
            }
            contact_force(&contact, u, after);
            for (int i = 0; i < CONTACT_NODES * dim; i++) {
                AT_MOST(fabs(after[i] - before[i]), 1.01 * stiffness * area * step * sqrt(dim));
            }
        }
        assert_true(touching(&contact) > 0);
    }
}

RUN_TESTS(NULL, NULL)
