/* A small body for tests: a jittered lattice in a square or cube of 0.1 m, and its tables by either
 * integration scheme. */
#pragma once

#include "cell_table.h"
#include "tables_fixture.h"

#include "solid/body/smoothed_cells.h"

struct sample {
    int dim;
    bool smoothed;
    struct cloud cloud;
    struct stream stream;
    struct assembly assembly; /* in view of the stream; a copy's face_table is not to be used */
    /* Gradients at the integration points; of smoothed cells those that the averages over faces make. */
    struct cell_table of_cells;
    struct neighbours lists;
    const double *dphi;
};

static const double sample_size = 0.1;

/* The jittered lattice of a sample. */
static inline struct cloud sample_cloud(int dim, int64_t per_axis)
{
    struct cloud made;
    struct cloud_options cloud = {.kind = CLOUD_JITTERED,
                                  .dim = dim,
                                  .count = {per_axis, per_axis, per_axis},
                                  .high = {sample_size, sample_size, sample_size},
                                  .jitter = dim == 2 ? 0.3 : 0.1,
                                  .seed = 7};
    GOOD(cloud_make(&cloud, &made, &error));
    assert_true(made.cell_count > 0);
    return made;
}

/* Of a cloud, which becomes the sample's; factor: support radius by local spacing. */
static inline struct sample sample_of(int dim, bool smoothed, struct cloud cloud, double factor)
{
    struct sample sample = {.dim = dim, .smoothed = smoothed, .cloud = cloud};
    struct assembly *assembly = &sample.assembly;
    make_tables_of(&sample.cloud, smoothed ? 0 : dim + 1, factor, &sample.stream, assembly);
    if (smoothed) {
        const struct cell_sources sources = {&assembly->lists, &assembly->node_lists, assembly->phi,
                                             assembly->node_phi};
        sample.of_cells = cell_table_make(&assembly->cells, &assembly->faces, &sources);
    }
    sample.lists = smoothed ? (struct neighbours){.count = assembly->point_count,
                                                  .ptr = sample.of_cells.ptr,
                                                  .idx = sample.of_cells.idx}
                            : assembly->lists;
    sample.dphi = smoothed ? sample.of_cells.dphi : assembly->dphi;
    return sample;
}

static inline struct sample make_wide_sample(int dim, bool smoothed, int64_t per_axis, double factor)
{
    return sample_of(dim, smoothed, sample_cloud(dim, per_axis), factor);
}

static inline struct sample make_sample(int dim, bool smoothed, int64_t per_axis)
{
    return make_wide_sample(dim, smoothed, per_axis, 1.8);
}

static inline void sample_free(struct sample *sample)
{
    cell_table_free(&sample->of_cells);
    stream_free(&sample->stream);
    cloud_free(&sample->cloud);
}

/* The body of these materials; material[points]; by_cells: of smoothed cells, else of the gradients. Change
 * what else is to be different. */
static inline struct body_input sample_input(const struct sample *sample, bool by_cells,
                                             const struct material *materials, int64_t material_count,
                                             const int32_t *material)
{
    const struct assembly *assembly = &sample->assembly;
    return (struct body_input){.cells = assembly->cells,
                               .faces = by_cells ? &assembly->faces : NULL,
                               .point_count = assembly->point_count,
                               .x = assembly->x,
                               .weight = assembly->weight,
                               .cell = assembly->point_cell,
                               .lists = by_cells ? &assembly->lists : &sample->lists,
                               .node_lists = &assembly->node_lists,
                               .dphi = sample->dphi,
                               .phi = assembly->phi,
                               .node_phi = assembly->node_phi,
                               .materials = materials,
                               .material = material,
                               .material_count = material_count};
}

/* Shape functions on the faces of the boundary. */
static inline struct face_table sample_face_table(const struct sample *sample)
{
    return (struct face_table){.dim = sample->dim,
                               .node_count = sample->cloud.node_count,
                               .x = sample->cloud.x,
                               .faces = &sample->assembly.faces,
                               .per_face = FACE_POINTS(sample->dim),
                               .lists = &sample->assembly.boundary_lists,
                               .phi = sample->assembly.boundary_phi};
}

/* Facets of one side of the box, of all for -1: they stand in the order of their sides. */
static inline struct facet_set facets_of_side(const struct sample *sample, int side)
{
    struct facet_set set = {0};
    for (int64_t f = 0; f < sample->cloud.facet_count; f++) {
        if (side < 0 || sample->cloud.facet_set[f] == side) {
            set.facet = set.count++ == 0 ? sample->cloud.facets + f * sample->dim : set.facet;
        }
    }
    assert_true(set.count > 0);
    return set;
}
