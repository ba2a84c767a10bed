/* A small body for tests: a jittered lattice in a square or cube of 0.1 m, and its tables by either
 * integration scheme. */
#pragma once

#include "cell_table.h"
#include "tables_fixture.h"

#include "approx/cells/quadrature.h"
#include "solid/body/smoothed_cells.h"

struct sample {
    int dim;
    bool smoothed;
    struct cloud cloud;
    struct stream stream;
    struct assembly assembly; /* in view of the stream; a copy's face_table is not to be used */
    /* Gradients at the integration points; of smoothed cells those that the averages over faces make. */
    struct cell_table of_cells;
    const int64_t *ptr;
    const int32_t *idx;
    const double *dphi;
    int32_t *vertex; /* of the cell of each point, and its barycentric coordinates there */
    double *barycentric;
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
    struct quadrature_rule rule;
    struct sample sample = {.dim = dim, .smoothed = smoothed, .cloud = cloud};
    int per_cell = smoothed ? 1 : dim + 1, corners = dim + 1;
    struct assembly *assembly = &sample.assembly;
    make_tables_of(&sample.cloud, smoothed ? 0 : per_cell, factor, &sample.stream, assembly);
    GOOD(quadrature_cell_rule(dim, per_cell, &rule, &error));
    ARRAY(sample.vertex, assembly->point_count * corners);
    ARRAY(sample.barycentric, assembly->point_count * corners);
    for (int64_t i = 0; i < assembly->point_count * corners; i++) {
        sample.vertex[i] = assembly->cells.node[i / corners / per_cell * corners + i % corners];
        sample.barycentric[i] = rule.barycentric[i % (per_cell * corners)];
    }
    if (smoothed) {
        const struct cell_sources sources = {&assembly->lists, &assembly->node_lists, assembly->phi,
                                             assembly->node_phi};
        sample.of_cells = cell_table_make(&assembly->cells, &assembly->faces, &sources);
    }
    sample.ptr = smoothed ? sample.of_cells.ptr : assembly->lists.ptr;
    sample.idx = smoothed ? sample.of_cells.idx : assembly->lists.idx;
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
    free(sample->vertex);
    free(sample->barycentric);
    stream_free(&sample->stream);
    cloud_free(&sample->cloud);
}

/* What a body of smoothed cells is made of. */
static inline struct smoothed_cells_input sample_smoothed(const struct sample *sample)
{
    const struct assembly *assembly = &sample->assembly;
    return (struct smoothed_cells_input){.x = sample->cloud.x,
                                         .cell_node = assembly->cells.node,
                                         .faces = &assembly->faces,
                                         .edge_ptr = assembly->lists.ptr,
                                         .edge_idx = assembly->lists.idx,
                                         .edge_phi = assembly->phi,
                                         .node_ptr = assembly->node_lists.ptr,
                                         .node_idx = assembly->node_lists.idx,
                                         .node_phi = assembly->node_phi};
}

/* The body of these materials; material[points]. Change what else is to be different. */
static inline struct body_input sample_input(const struct sample *sample, const struct material *materials,
                                             int64_t material_count, const int32_t *material)
{
    return (struct body_input){.dim = sample->dim,
                               .node_count = sample->cloud.node_count,
                               .point_count = sample->assembly.point_count,
                               .node_x = sample->cloud.x,
                               .x = sample->assembly.x,
                               .weight = sample->assembly.weight,
                               .ptr = sample->ptr,
                               .idx = sample->idx,
                               .dphi = sample->dphi,
                               .materials = materials,
                               .material = material,
                               .material_count = material_count,
                               .vertex = sample->vertex,
                               .barycentric = sample->barycentric};
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
