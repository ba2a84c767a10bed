/* Whether boundary averages resolve where a contact presses. */
#include "contact_fixture.h"

#include "solid/contact_patch.h"

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
    int32_t facet[2 * CONTACT_NODES];
    double x[2 * NODES] = {0.0};
    make_particles(&contact_nodes, 2, 0.5);
    make_samples(&contact_nodes);
    for (int32_t a = 0; a < CONTACT_NODES; a++) {
        x[2 * a] = 0.1 * a - 0.55;
        x[2 * a + 1] = -0.52;
        facet[2 * a] = a + 1;
        facet[2 * a + 1] = a;
    }
    struct facet_set set = {CONTACT_NODES - 1, facet};
    struct contact contact = built(&contact_nodes, make_shell(2, 4, 0.5, false), 1.0);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct contact_patch patch;
        struct error error;
        for (int a = 0; a < CONTACT_NODES; a++) {
            contact.pressure[a] = cases[i].presses[a] - '0';
        }
        GOOD(contact_patch_find(&contact, &set, NODES, x, &patch, &error));
        assert_int_equal(patch.pressing, cases[i].pressing);
        assert_int_equal(patch.node, cases[i].node);
        NEAR_TO(patch.thin, cases[i].thin, 1e-15);
    }
    contact_free(&contact);
}

/* The corner of a square 0.1 below the line of the nodes: the body is below, its facets' normals up. */
TEST(inside)
{
    struct contact_nodes contact_nodes;
    struct contact_patch patch;
    struct error error;
    double x[2 * NODES] = {-2.0, -0.4, 2.0, -0.4, 2.0, -0.6, -2.0, -0.6};
    static const int32_t up[] = {1, 0}, down[] = {0, 1};
    make_particles(&contact_nodes, 2, 0.5);
    make_samples(&contact_nodes);
    struct contact contact =
        built(&contact_nodes, make_shell(2, 4, 0.5, false), 1.0); /* corners at (0, +-.5), (+-.5, 0) */
    GOOD(contact_patch_find(&contact, &(struct facet_set){1, up}, NODES, x, &patch, &error));
    NEAR_TO(patch.inside, 0.1, 1e-12);
    NEAR_TO(patch.place[1], -0.5, 1e-12);
    GOOD(contact_patch_find(&contact, &(struct facet_set){1, down}, NODES, x + 4, &patch, &error));
    NEAR_TO(patch.inside, 0.0, 0.0);
    contact_free(&contact);
}

RUN_TESTS(NULL, NULL)
