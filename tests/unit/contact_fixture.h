/* What the tests of contacts share: hats made up of a few nodes, particles, and closed or open shells. */
#ifndef TESTS_CONTACT_FIXTURE_H
#define TESTS_CONTACT_FIXTURE_H

#include "solid_fixture.h"

#include "solid/contact.h"

enum { HATS = 12, NODES = 20, EACH = 4 };

/* Hats made up of a few nodes each, with random weights of sum 1; some negative, as quadratic bases give. */
struct hats {
    int dim;
    double X[NODES * 3], area[HATS], phi[HATS * EACH];
    double normal[HATS * 3]; /* zero: hats are where their mean is */
    int32_t node[HATS], idx[HATS * EACH];
    int64_t ptr[HATS + 1];
    struct boundary_averages averages;
};

static inline void make_hats(struct hats *hats, int dim, double area, struct random *random)
{
    *hats = (struct hats){.dim = dim};
    for (int i = 0; i < NODES * dim; i++) {
        hats->X[i] = uniform(random, -0.6, 0.6);
    }
    for (int a = 0; a < HATS; a++) {
        double sum = 0.0;
        hats->area[a] = area * uniform(random, 0.5, 1.0);
        hats->node[a] = a;
        hats->ptr[a + 1] = (a + 1) * EACH;
        for (int i = a * EACH; i < (a + 1) * EACH; i++) { /* the first one outweighs the others */
            hats->idx[i] = (a + (i - a * EACH) * 2) % NODES;
            hats->phi[i] = i == a * EACH ? 1.0 : uniform(random, -0.1, 0.5);
            sum += hats->phi[i];
        }
        for (int i = a * EACH; i < (a + 1) * EACH; i++) {
            hats->phi[i] /= sum;
        }
    }
    hats->averages = (struct boundary_averages){.count = HATS,
                                                .node = hats->node,
                                                .area = hats->area,
                                                .normal = hats->normal,
                                                .ptr = hats->ptr,
                                                .idx = hats->idx,
                                                .phi = hats->phi};
}

/* Hats that are each one node, where X says. */
static inline void make_particles(struct hats *hats, int dim, double area)
{
    *hats = (struct hats){.dim = dim};
    for (int a = 0; a < HATS; a++) {
        hats->area[a] = area;
        hats->node[a] = hats->idx[a] = a;
        hats->ptr[a + 1] = a + 1;
        hats->phi[a] = 1.0;
    }
    hats->averages = (struct boundary_averages){.count = HATS,
                                                .node = hats->node,
                                                .area = hats->area,
                                                .normal = hats->normal,
                                                .ptr = hats->ptr,
                                                .idx = hats->idx,
                                                .phi = hats->phi};
}

/* A polygon of that many sides about the origin, or a cube with its faces in two triangles; the body is
 * inside. `open`: one side is left out. */
static inline struct rigid_surface make_shell(int dim, int sides, double radius, bool open)
{
    struct rigid_surface surface;
    struct error error;
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

static inline struct contact built(const struct hats *hats, struct rigid_surface surface, double stiffness)
{
    struct contact contact;
    struct error error;
    GOOD(contact_build(&hats->averages, hats->X, hats->dim, &surface, stiffness, &contact, &error));
    assert_null(surface.vertex);
    return contact;
}

static inline double position(const struct hats *hats, const double *u, int a, int axis)
{
    double x = 0.0;
    for (int64_t i = hats->ptr[a]; i < hats->ptr[a + 1]; i++) {
        int at = hats->idx[i] * hats->dim + axis;
        x += hats->phi[i] * (hats->X[at] + u[at]);
    }
    return x;
}

/* Displacements that bring about half of the hats into contact. */
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

#endif
