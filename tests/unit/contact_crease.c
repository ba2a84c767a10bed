/* Contact in creases that are concave as the body sees them, of two and of three planes: forces do not jump
 * where the closest facet changes. */
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

RUN_TESTS(NULL, NULL)
