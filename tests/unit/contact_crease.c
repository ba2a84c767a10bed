/* Contact in creases that are concave as the body sees them, of two and of three planes: forces do not jump
 * where the closest facet changes, and what is pressed into a crease comes to rest there.
 */
#include "contact_fixture.h"

/* Closed convex shells, inside which particles have multipliers of any direction, before and behind the
 * surface: moved by d, each force changes by at most k A d, as the projection onto a convex set is a
 * contraction. */
TEST(forces_do_not_jump)
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

/* A groove along the third axis, its sides rising from the origin by `angle` to either side. */
static struct rigid_surface groove(int dim, double angle)
{
    struct rigid_surface surface;
    double x = 2.0 * cos(angle), y = 2.0 * sin(angle);
    if (dim == 2) {
        const double corners[] = {-x, y, 0.0, 0.0, 0.0, 0.0, x, y};
        GOOD(rigid_build(2, 2, corners, true, &surface, &error));
    } else {
        const double corners[] = {-x, y, -2, 0, 0, 2, 0, 0, -2, -x, y, -2, -x, y, 2, 0, 0, 2,
                                  0,  0, -2, x, y, 2, x, y, -2, 0,  0, -2, 0,  0, 2, x, y, 2};
        GOOD(rigid_build(3, 4, corners, false, &surface, &error));
    }
    return surface;
}

/* Descend to equilibrium under springs to the origin of X and a pull[dim] on all, augmenting now and then.
 * Returns the sum of the squares of what a last step changes. */
static double settle(struct contact *contact, double spring, const double *pull, double *u)
{
    double change2 = 0.0, force[NODES * 3];
    int dim = contact->dim;
    for (int step = 0; step < 20000; step++) {
        memset(force, 0, sizeof force);
        contact_force(contact, u, force);
        contact_accept(contact);
        change2 = 0.0;
        for (int i = 0; i < CONTACT_NODES * dim; i++) {
            double move = 0.015 * (force[i] + pull[i % dim] - spring * u[i]);
            u[i] += move;
            change2 += move * move;
        }
        if (step % 500 == 499 && step < 18000) {
            contact_augment(contact, false);
        }
    }
    return change2;
}

/* Particles are pulled into a groove of sides at several angles. Those that are pulled between the two
 * normals come to rest in the crease, held by the whole pull; the others on the side that they are pulled
 * towards, held along its normal. One starts at the crease itself. */
TEST(rest_in_a_groove)
{
    static const double angles[] = {5, 10, 20, 45, 75};
    int creased = 0, slid = 0;
    for (int round = 0; round < 30; round++) {
        int dim = 2 + round % 2;
        double angle = angles[round / 6] * M_PI / 180.0, lean = (0.25 + 0.5 * (round / 2 % 3)) * angle;
        struct contact_nodes contact_nodes;
        make_particles(&contact_nodes, dim, 0.5);
        for (int a = 1; a < CONTACT_NODES; a++) {
            contact_nodes.X[a * dim] = 0.02 * (a - 6);
            contact_nodes.X[a * dim + 1] = 0.2 + tan(angle) * 0.1;
        }
        FREED_BY(contact_free) struct contact contact = built(&contact_nodes, groove(dim, angle), 100.0);
        const double pull[3] = {13.0 * sin(lean), -13.0 * cos(lean), 0.0}, spring = 8.0;
        double u[NODES * 3] = {0.0};
        AT_MOST(settle(&contact, spring, pull, u), 1e-20);
        AT_MOST(contact_miss(&contact), 1e-9);
        for (int a = 0; a < CONTACT_NODES; a++) {
            double x = contact_nodes.X[a * dim], y = contact_nodes.X[a * dim + 1];
            /* What remains of pull and spring at the crease; and of it along the side that it leans to. */
            double push[2] = {pull[0] + spring * x, pull[1] + spring * y}, side = push[0] > 0.0 ? 1.0 : -1.0;
            double along = side * push[0] * cos(angle) + push[1] * sin(angle);
            double way = fmax(0.0, along) / spring;
            NEAR_TO(x + u[a * dim], side * way * cos(angle), 1e-8);
            NEAR_TO(y + u[a * dim + 1], way * sin(angle), 1e-8);
            NEAR_TO(0.5 * contact.pressure[a],
                    along > 0.0 ? side * push[0] * sin(angle) - push[1] * cos(angle)
                                : hypot(push[0], push[1]),
                    1e-6);
            creased += along <= 0.0;
            slid += along > 0.0;
        }
    }

    assert_true(creased > 100 && slid > 50);
}

/* Into a corner of three planes: a cube's, which all particles are pulled into along directions between its
 * normals. */
TEST(rest_in_a_corner)
{
    struct random random = {32};
    for (int round = 0; round < 10; round++) {
        struct contact_nodes contact_nodes;
        make_particles(&contact_nodes, 3, 0.5);
        for (int i = 3; i < CONTACT_NODES * 3; i++) {
            contact_nodes.X[i] = uniform(&random, 0.0, 0.5);
        }
        for (int i = 0; i < 3; i++) {
            contact_nodes.X[i] = 0.5; /* at the corner itself */
        }
        FREED_BY(contact_free)
        struct contact contact = built(&contact_nodes, make_shell(3, 6, 0.5, false), 100.0);
        double pull[3], u[NODES * 3] = {0.0};
        for (int i = 0; i < 3; i++) {
            pull[i] = uniform(&random, 5.0, 30.0);
        }
        AT_MOST(settle(&contact, 1.0, pull, u), 1e-20);
        AT_MOST(contact_miss(&contact), 1e-9);
        for (int a = 0; a < CONTACT_NODES; a++) {
            for (int i = 0; i < 3; i++) {
                double held = -0.5 * contact.pressure[a] * contact.normal[3 * a + i];
                NEAR_TO(contact_nodes.X[3 * a + i] + u[3 * a + i], 0.5, 1e-9);
                NEAR_TO(held, pull[i] - u[3 * a + i], 1e-7);
            }
        }
    }
}

RUN_TESTS(NULL, NULL)
