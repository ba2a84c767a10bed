/* Whether boundary averages resolve where a contact presses. */
#include "contact_fixture.h"

#include "solid/contact/contact_patch.h"

/* Places at rest, one sample for each contact node: the point of the same number. */
static double place[CONTACT_NODES * 3];
static int64_t sample_ptr[CONTACT_NODES + 1], sample_point[CONTACT_NODES];
static double sample_share[CONTACT_NODES];

static void make_samples(struct contact_nodes *contact_nodes)
{
    for (int a = 0; a < CONTACT_NODES; a++) {
        sample_ptr[a + 1] = a + 1;
        sample_point[a] = a;
        sample_share[a] = 1.0;
    }
    memcpy(place, contact_nodes->X, sizeof place);
    contact_nodes->averages.position = place;
    contact_nodes->averages.sample_ptr = sample_ptr;
    contact_nodes->averages.sample_point = sample_point;
    contact_nodes->averages.sample_share = sample_share;
}

/* Nodes on a line, each with a contact node, that press in turn. */
TEST(across)
{
    static const struct {
        const char *presses;
        int64_t pressing;
        int32_t node;
        double thin;
    } cases[] = {{"000000000000", 0, -1, 0.0}, {"000010000000", 1, 4, 1.0},  {"000011000000", 2, 4, 1.0},
                 {"000111000000", 3, -1, 0.0}, {"110000000000", 2, -1, 0.0}, {"011100000300", 4, 9, 0.5},
                 {"111111111111", 12, -1, 0.0}};
    struct contact_nodes contact_nodes;
    static const int32_t node[] = {13, 14, 15}; /* a cell far away */
    double x[2 * NODES] = {0.0};
    struct cells cells = {2, NODES, x, 1, node};
    int32_t facet[2 * CONTACT_NODES];
    make_particles(&contact_nodes, 2, 0.5);
    make_samples(&contact_nodes);
    for (int32_t a = 0; a < CONTACT_NODES; a++) {
        x[2 * a] = 0.1 * a - 0.55;
        x[2 * a + 1] = -0.52;
        facet[2 * a] = a + 1;
        facet[2 * a + 1] = a;
    }
    x[26] = x[30] = 5.0;
    x[28] = x[31] = 6.0;
    struct facet_set set = {CONTACT_NODES - 1, facet};
    FREED_BY(contact_free) struct contact contact = built(&contact_nodes, make_shell(2, 4, 0.5, false), 1.0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct contact_patch patch;
        for (int a = 0; a < CONTACT_NODES; a++) {
            contact.pressure[a] = cases[i].presses[a] - '0';
        }
        GOOD(contact_patch_find(&contact, &set, &cells, &patch, &error));
        assert_int_equal(patch.pressing, cases[i].pressing);
        assert_int_equal(patch.node, cases[i].node);
        NEAR_TO(patch.thin, cases[i].thin, 1e-15);
    }
}

/* A square with corners at (0, +-.5) and (+-.5, 0), and bodies from y = low to high whose upper side is in
 * contact: how far its corners are inside of them. */
TEST(inside)
{
    static const struct {
        double low, high, inside, corner;
    } bodies[] = {
        {-0.6, -0.4, 0.1, -0.5}, {-0.9, -0.6, 0.0, 0.0}, {-2.0, -0.4, 0.1, -0.5}, {-2.0, 2.0, 2.5, -0.5}};
    static const int32_t node[] = {0, 1, 2, 0, 2, 3}, up[] = {2, 3};
    struct contact_nodes contact_nodes;
    make_particles(&contact_nodes, 2, 0.5);
    make_samples(&contact_nodes);
    FREED_BY(contact_free) struct contact contact = built(&contact_nodes, make_shell(2, 4, 0.5, false), 1.0);
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++) {
        struct contact_patch patch;
        double low = bodies[i].low, high = bodies[i].high;
        double x[2 * NODES] = {-2.0, low, 2.0, low, 2.0, high, -2.0, high};
        struct cells cells = {2, NODES, x, 2, node};
        GOOD(contact_patch_find(&contact, &(struct facet_set){1, up}, &cells, &patch, &error));
        NEAR_TO(patch.inside, bodies[i].inside, 1e-12);
        NEAR_TO(patch.place[1], bodies[i].corner, 1e-12);
    }
}

RUN_TESTS(NULL, NULL)
