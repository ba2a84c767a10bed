/* Small bodies for tests of the preconditioner: a box of smoothed cells on a jittered lattice, its tables and
 * its system as the tools make them. */
#pragma once

#include "tables_fixture.h"

struct lattice {
    struct cloud cloud;
    struct stream stream;
    struct assembly assembly; /* in view of the stream */
    struct solid_system system;
};

/* The base material of the hard cases, but for nu, on a box of 0.1 m with `n` nodes along each axis, `along`
 * times as many and as long along the first one. Without conditions. */
static inline void lattice_build(struct lattice *l, int dim, int64_t n, int along, double jitter,
                                 double poisson_ratio)
{
    struct error note;
    struct assembly *assembly = &l->assembly;
    struct material_list *list = &assembly->materials;
    struct cloud_options cloud = {.kind = CLOUD_JITTERED,
                                  .dim = dim,
                                  .count = {n * along, n, n},
                                  .high = {0.1 * along, 0.1, 0.1},
                                  .jitter = jitter,
                                  .seed = 1};
    *l = (struct lattice){.cloud = {0}};
    /* Wider supports need the penalties that back conditions, which are not here. */
    make_tables(&cloud, 0, 1.8, &l->cloud, &l->stream, assembly);
    list->count = 1;
    ARRAY(list->items, 1);
    ARRAY(list->of_point, assembly->point_count);
    ARRAY(list->of_cell, assembly->cells.count);
    ARRAY(list->section, 1);
    ARRAY(list->group, 1);
    list->items[0] = (struct material){.model = MATERIAL_NEO_HOOKEAN, .density = 1000.0};
    material_set_moduli(&list->items[0], 3000.0, poisson_ratio);
    GOOD(assembly_build(assembly, &l->system, &note, &error));
}

static inline void lattice_free(struct lattice *l)
{
    system_free(&l->system);
    material_list_free(&l->assembly.materials);
    stream_free(&l->stream);
    cloud_free(&l->cloud);
}

/* The boundary averages over a side of the box, numbered 2 * axis, + 1 at the high end. */
static inline struct boundary_averages lattice_averages(const struct lattice *l, int side)
{
    struct boundary_averages averages;
    int dim = l->cloud.dim;
    struct facet_set set = {0};
    for (int64_t f = 0; f < l->cloud.facet_count; f++) { /* facets stand in the order of their sides */
        if (l->cloud.facet_set[f] == side) {
            set.facet = set.count++ == 0 ? l->cloud.facets + f * dim : set.facet;
        }
    }
    GOOD(boundary_averages_build(&l->assembly.face_table, &set, &averages, &error));
    return averages;
}

/* Zeros for all parameters, for a test. */
static inline double *lattice_vector(const struct lattice *l)
{
    return zeros(l->system.node_count * l->cloud.dim, sizeof(double));
}
