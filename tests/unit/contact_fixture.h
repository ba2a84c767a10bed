/* What the tests of contacts share: contact nodes made up of a few nodes, particles, and closed or open
 * shells. */
#pragma once

#include "unit.h"

#include "solid/contact/contact.h"

enum { CONTACT_NODES = 12, NODES = 20, EACH = 4 };

/* Contact nodes made up of a few nodes each, with random weights of sum 1; some negative, as quadratic bases
 * give. */
struct contact_nodes {
    int dim;
    double X[NODES * 3], area[CONTACT_NODES], phi[CONTACT_NODES * EACH];
    double normal[CONTACT_NODES * 3]; /* zero: contact nodes are where their mean is */
    int32_t node[CONTACT_NODES], idx[CONTACT_NODES * EACH];
    int64_t ptr[CONTACT_NODES + 1];
    struct boundary_averages averages;
};

/* Let the averages be those arrays. */
static inline void refer_to_averages(struct contact_nodes *contact_nodes)
{
    contact_nodes->averages = (struct boundary_averages){.count = CONTACT_NODES,
                                                         .node = contact_nodes->node,
                                                         .area = contact_nodes->area,
                                                         .normal = contact_nodes->normal,
                                                         .ptr = contact_nodes->ptr,
                                                         .idx = contact_nodes->idx,
                                                         .phi = contact_nodes->phi};
}

static inline void make_contact_nodes(struct contact_nodes *contact_nodes, int dim, double area,
                                      struct random *random)
{
    *contact_nodes = (struct contact_nodes){.dim = dim};
    for (int i = 0; i < NODES * dim; i++) {
        contact_nodes->X[i] = uniform(random, -0.6, 0.6);
    }
    for (int a = 0; a < CONTACT_NODES; a++) {
        double sum = 0.0;
        contact_nodes->area[a] = area * uniform(random, 0.5, 1.0);
        contact_nodes->node[a] = a;
        contact_nodes->ptr[a + 1] = (a + 1) * EACH;
        for (int i = a * EACH; i < (a + 1) * EACH; i++) { /* the first one outweighs the others */
            contact_nodes->idx[i] = (a + (i - a * EACH) * 2) % NODES;
            contact_nodes->phi[i] = i == a * EACH ? 1.0 : uniform(random, -0.1, 0.5);
            sum += contact_nodes->phi[i];
        }
        for (int i = a * EACH; i < (a + 1) * EACH; i++) {
            contact_nodes->phi[i] /= sum;
        }
    }
    refer_to_averages(contact_nodes);
}

/* Contact nodes that are each one node, where X says. */
static inline void make_particles(struct contact_nodes *contact_nodes, int dim, double area)
{
    *contact_nodes = (struct contact_nodes){.dim = dim};
    for (int a = 0; a < CONTACT_NODES; a++) {
        contact_nodes->area[a] = area;
        contact_nodes->node[a] = contact_nodes->idx[a] = a;
        contact_nodes->ptr[a + 1] = a + 1;
        contact_nodes->phi[a] = 1.0;
    }
    refer_to_averages(contact_nodes);
}

/* A polygon of that many sides about the origin, or a cube with its faces in two triangles; the body is
 * inside. `open`: one side is left out. */
static inline struct rigid_surface make_shell(int dim, int sides, double radius, bool open)
{
    struct rigid_surface surface;
    double corners[24 * 9];
    int64_t count = 0;
    if (dim == 2) {
        for (int i = 0; i < sides - open; i++, count++) {
            for (int k = 0; k < 2; k++) {
                corners[4 * i + 2 * k] = radius * cos(2.0 * M_PI * (i + k) / sides);
                corners[4 * i + 2 * k + 1] = radius * sin(2.0 * M_PI * (i + k) / sides);
            }
        }
    } else {
        static const int order[2][6] = {{0, 2, 1, 0, 3, 2}, {0, 1, 2, 0, 2, 3}};
        for (int face = 0; face < 6 - open; face++) {
            for (int i = 0; i < 6; i++) {
                int k = order[face % 2][i], axis = face / 2;
                double *corner = corners + (count * 3 + i) * 3;
                corner[axis] = face % 2 ? radius : -radius;
                corner[(axis + 1) % 3] = k == 1 || k == 2 ? radius : -radius;
                corner[(axis + 2) % 3] = k >= 2 ? radius : -radius;
            }
            count += 2;
        }
    }
    GOOD(rigid_build(dim, count, corners, true, &surface, &error));
    return surface;
}

static inline struct contact built(const struct contact_nodes *contact_nodes, struct rigid_surface surface,
                                   double stiffness)
{
    struct contact contact;
    GOOD(contact_build(&contact_nodes->averages, NULL, contact_nodes->X, contact_nodes->dim, &surface,
                       stiffness, &contact, &error));
    assert_null(surface.vertex);
    return contact;
}

static inline double position(const struct contact_nodes *contact_nodes, const double *u, int a, int axis)
{
    double x = 0.0;
    for (int64_t i = contact_nodes->ptr[a]; i < contact_nodes->ptr[a + 1]; i++) {
        int at = contact_nodes->idx[i] * contact_nodes->dim + axis;
        x += contact_nodes->phi[i] * (contact_nodes->X[at] + u[at]);
    }
    return x;
}

/* Displacements that bring about half of the contact nodes into contact. */
static inline void push_out(double *u, struct random *random)
{
    for (int i = 0; i < NODES * 3; i++) {
        u[i] = uniform(random, -1.0, 1.0);
    }
}

static inline int touching(const struct contact *contact)
{
    int count = 0;
    for (int64_t a = 0; a < contact->count; a++) {
        count += contact->pressure[a] > 0.0;
    }
    return count;
}
