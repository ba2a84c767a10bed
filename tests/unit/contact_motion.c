/* Contacts whose surface moves; contacts of points. */
#include "contact_fixture.h"

/* A motion with everything in it; its two curves are numbers 0 and 1. */
static struct rigid_motion some_motion(int dim, struct random *random)
{
    struct rigid_motion motion = {.moves = true, .angle = uniform(random, -3.0, 3.0), .rotation_curve = 1};
    for (int i = 0; i < 3; i++) {
        motion.translation[i] = uniform(random, -0.5, 0.5);
        motion.point[i] = uniform(random, -1.0, 1.0);
        motion.axis[i] = uniform(random, -2.0, 2.0);
    }
    GOOD(rigid_motion_check(&motion, dim, &error));
    return motion;
}

/* Known places, and the order: turned first, about an axis that does not move. */
TEST(motions)
{
    struct rigid_motion motion = {.moves = true,
                                  .translation = {1.0, 0.0, 5.0},
                                  .point = {0.0, 1.0, 7.0},
                                  .axis = {0.0, 0.0, -3.0},
                                  .angle = -M_PI / 2.0,
                                  .rotation_curve = 1};
    const double X[3] = {2.0, 1.0, 3.0};
    for (int dim = 2; dim <= 3; dim++) {
        double x[3], back[3], normal[3] = {1.0, 0.0, 0.0}, factor[2] = {0.5, 1.0};
        GOOD(rigid_motion_check(&motion, dim, &error));
        motion.angle = dim == 2 ? M_PI / 2.0 : -M_PI / 2.0; /* in 2D about +z, in 3D about -z */
        struct rigid_place place = rigid_place_at(&motion, factor);
        rigid_place_from_rest(&place, dim, X, x);
        rigid_place_to_rest(&place, dim, x, back);
        rigid_place_turn(&place, dim, normal);
        NEAR_TO(x[0], 0.5, 1e-15);
        NEAR_TO(x[1], 3.0, 1e-15);
        NEAR_TO(normal[1], 1.0, 1e-15);
        ALL_NEAR(dim, back, X, 1e-14);
        NEAR_TO(rigid_motion_path(&motion, dim, X), (dim == 2 ? 1.0 : sqrt(26.0)) + M_PI, 1e-14);
        motion = (struct rigid_motion){.moves = true,
                                       .translation = {1.0, 0.0, 5.0},
                                       .point = {0.0, 1.0, 7.0},
                                       .axis = {0.0, 0.0, -3.0},
                                       .rotation_curve = 1};
        motion.angle = -M_PI / 2.0;
    }
    motion.axis[2] = 0.0;
    FAILS_WITH(rigid_motion_check(&motion, 3, &error), STATUS_INPUT,
               "rigid surface: the axis of rotation has no length");
    motion.axis[2] = 1.0;
    motion.angle = (double)INFINITY;
    FAILS(rigid_motion_check(&motion, 3, &error), STATUS_INPUT, "");
}

/* A shell that moves, and contact nodes that move with it, are as a shell and contact nodes at rest: gaps,
 * pressures and energy the same, forces turned. Along the way contact nodes are skipped as they may be. */
TEST(moved_together)
{
    struct random random = {7};
    struct contact_nodes contact_nodes;
    int contacts = 0;
    for (int round = 0; round < 20; round++) {
        int dim = 2 + round % 2;
        make_contact_nodes(&contact_nodes, dim, 10.0, &random);
        FREED_BY(contact_free)
        struct contact rests = built(&contact_nodes, make_shell(dim, 12, 0.8, false), 7e3);
        FREED_BY(contact_free)
        struct contact moves = built(&contact_nodes, make_shell(dim, 12, 0.8, false), 7e3);
        moves.motion = some_motion(dim, &random);
        double u[NODES * 3], turned[NODES * 3];
        push_out(u, &random);
        for (int step = 0; step <= 20; step++) {
            double factor[2] = {0.05 * step, sin(0.05 * step)}, force[NODES * 3] = {0.0},
                   other[NODES * 3] = {0.0};
            struct rigid_place place = rigid_place_at(&moves.motion, factor);
            for (int n = 0; n < NODES; n++) {
                double x[3], moved[3];
                for (int i = 0; i < dim; i++) {
                    x[i] = contact_nodes.X[n * dim + i] + u[n * dim + i];
                }
                rigid_place_from_rest(&place, dim, x, moved);
                for (int i = 0; i < dim; i++) {
                    turned[n * dim + i] = moved[i] - contact_nodes.X[n * dim + i];
                }
            }
            contact_force(&rests, u, force);
            contact_move(&moves, factor);
            contact_force(&moves, turned, other);
            contact_accept(&rests);
            contact_accept(&moves);
            for (int n = 0; n < NODES; n++) {
                rigid_place_turn(&place, dim, force + n * dim);
            }
            ALL_NEAR(NODES * dim, other, force, 1e-7);
            NEAR_TO(contact_energy(&moves), contact_energy(&rests), 1e-8 * contact_energy(&rests));
            contacts += touching(&moves);
        }
    }
    assert_true(contacts > 400);
}

/* Points in pairs on edges of a line of nodes: multipliers are at the nodes, and an augmentation makes them
 * the mean of what points beneath them press. Where all press the next one closes the gap of a wall that
 * yields. */
TEST(multipliers_of_nodes)
{
    enum { AVERAGES = CONTACT_NODES / 2 + 1 };
    struct contact_nodes points;
    double place[CONTACT_NODES * 2], u[NODES * 3] = {0.0}, force[NODES * 3] = {0.0};
    double area[AVERAGES], normal[AVERAGES * 2] = {0.0}, share[AVERAGES * 4];
    int32_t node[AVERAGES];
    int64_t sample_ptr[AVERAGES + 1] = {0}, sample_point[AVERAGES * 4];
    struct boundary_averages averages = {.count = AVERAGES,
                                         .node = node,
                                         .area = area,
                                         .normal = normal,
                                         .sample_ptr = sample_ptr,
                                         .sample_point = sample_point,
                                         .sample_share = share};
    make_particles(&points, 2, 0.5);
    points.averages.position = place;
    for (int p = 0; p < CONTACT_NODES; p++) { /* each edge is 1 long, its points at 1/4 and 3/4 */
        points.X[2 * p] = place[2 * p] = p / 2 + 0.25 + 0.5 * (p % 2);
        points.X[2 * p + 1] = place[2 * p + 1] = 0.0;
        points.normal[2 * p + 1] = 1.0;
        u[2 * p + 1] = 0.1;
    }
    for (int a = 0; a < AVERAGES; a++) {
        int64_t at = sample_ptr[a];
        node[a] = CONTACT_NODES + a;
        area[a] = 0.0;
        points.X[2 * node[a]] = a;
        points.X[2 * node[a] + 1] = 0.0;
        normal[2 * a + 1] = 1.0;
        for (int p = 2 * a - 2; p < 2 * a + 2; p++) {
            if (p >= 0 && p < CONTACT_NODES) {
                sample_point[at] = p;
                share[at] = 0.5 * (1.0 - fabs(place[2 * p] - a));
                area[a] += share[at++];
            }
        }
        for (int64_t s = sample_ptr[a]; s < at; s++) {
            share[s] /= area[a];
        }
        sample_ptr[a + 1] = at;
    }
    static const double corners[] = {10, 0.05, -10, 0.05};
    struct rigid_surface wall;
    FREED_BY(contact_free) struct contact contact = {0};
    GOOD(rigid_build(2, 1, corners, true, &wall, &error));
    GOOD(contact_build(&points.averages, &averages, points.X, 2, &wall, 100.0, &contact, &error));
    contact_force(&contact, u, force);
    NEAR_TO(contact_miss(&contact), 0.05, 1e-15);
    contact_augment(&contact);
    for (int a = 0; a < AVERAGES; a++) {
        NEAR_TO(contact.multiplier[2 * a], 0.0, 1e-13);
        NEAR_TO(contact.multiplier[2 * a + 1], -5.0, 1e-13);
        NEAR_TO(contact_node(&contact, a).gap, -0.05, 1e-15);
        NEAR_TO(contact_node(&contact, a).pressed, 1.0, 1e-15);
    }
    for (int p = 0; p < CONTACT_NODES; p++) { /* the hat functions sum to 1; both sides of the wall count */
        NEAR_TO(contact.held[2 * p + 1], -5.0, 1e-13);
        u[2 * p + 1] = p < 6 ? 0.05 : p == 6 ? 0.07 : 0.2 * (p > 8);
    }
    memset(force, 0, sizeof force);
    contact_force(&contact, u, force);
    NEAR_TO(contact.pressure[0], 5.0, 1e-13);
    NEAR_TO(contact.pressure[6], 7.0, 1e-13);
    NEAR_TO(contact.pressure[7], 0.0, 1e-13);
    NEAR_TO(force[1], -2.5, 1e-13);
    contact_augment(&contact);
    NEAR_TO(contact.multiplier[1], -5.0, 1e-13);
    /* Node 3: points 4 to 7 with shares 1/8, 3/8, 3/8, 1/8 press 5, 5, 7, 0, where 5 was held. */
    NEAR_TO(contact.multiplier[7], -5.0 - 0.375 * 2.0 + 0.125 * 5.0, 1e-13);
}

RUN_TESTS(NULL, NULL)
