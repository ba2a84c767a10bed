/* A small body for tests: a jittered lattice in a square or cube of 0.1 m, its cells, faces, supports, and
 * the tables of both integration schemes. */
#ifndef TESTS_BODY_FIXTURE_H
#define TESTS_BODY_FIXTURE_H

#include "cell_table.h"
#include "unit.h"

#include "approx/boundary.h"
#include "approx/cloud.h"
#include "approx/quadrature.h"
#include "approx/support.h"
#include "solid/smoothed_cells.h"

struct sample {
    int dim;
    bool smoothed;
    struct cloud cloud;
    struct cells cells;
    struct faces faces; /* conforming: all; else those of the boundary */
    struct support_options options;
    double *radius;
    struct point_grid grid;
    /* Points of the faces: those of the boundary face by face. */
    struct quadrature_rule face_rule;
    double *face_x, *face_phi;
    struct support_lists face_lists;
    struct neighbours face_neighbours;
    struct face_averages averages;
    const int32_t *face_reader; /* as in struct smoothed_cells_input */
    /* Integration points. */
    int64_t point_count;
    double *x, *weight, *barycentric, *phi, *dphi;
    int32_t *vertex;
    int64_t *ptr;
    int32_t *idx;
    /* Values at the nodes. */
    struct support_lists node_lists;
    double *node_phi;
};

static const double sample_size = 0.1;

static inline void *sample_array(int64_t count, size_t size)
{
    void *array = calloc((size_t)count, size);
    assert_non_null(array);
    return array;
}

static inline void sample_faces(struct sample *sample)
{
    struct error error;
    int dim = sample->dim;
    sample->face_rule = quadrature_face_rule(dim);
    GOOD(faces_build(&sample->cells, !sample->smoothed, &sample->faces, &error));
    int64_t count = face_row_point(&sample->faces, sample->faces.row_count);
    sample->face_x = sample_array(count * dim, sizeof(double));
    face_rows_points(&sample->faces, sample->cloud.x, sample->face_x);
    GOOD(support_build(&sample->options, &sample->grid, count, sample->face_x, "faces", &sample->face_lists,
                       &error));
    sample->face_neighbours = support_view(&sample->face_lists);
    sample->face_phi = sample_array(sample->face_lists.ptr[count], sizeof(double));
    GOOD(shape_table(&sample->options.mls, sample->cloud.x, sample->radius, &sample->face_neighbours,
                     sample->face_x, "faces", sample->face_phi, NULL, &error));
    GOOD(shape_average_faces(&sample->options.mls, sample->cloud.x, sample->radius, &sample->face_neighbours,
                             sample->face_x, "faces", &sample->faces, &sample->averages, &error));
}

/* One point for each cell, gradients smoothed over it; or the Gauss points of a rule of `per_cell` points. */
static inline void sample_points(struct sample *sample, int per_cell)
{
    struct error error;
    struct quadrature_rule rule;
    int dim = sample->dim;
    GOOD(quadrature_cell_rule(dim, per_cell, &rule, &error));
    sample->point_count = sample->cells.count * per_cell;
    sample->x = sample_array(sample->point_count * dim, sizeof(double));
    sample->weight = sample_array(sample->point_count, sizeof(double));
    sample->vertex = sample_array(sample->point_count * (dim + 1), sizeof(int32_t));
    sample->barycentric = sample_array(sample->point_count * (dim + 1), sizeof(double));
    for (int64_t c = 0; c < sample->cells.count; c++) {
        const int32_t *vertex = sample->cells.node + c * (dim + 1);
        quadrature_positions(&rule, dim, sample->cloud.x, vertex, sample->x + c * per_cell * dim);
        for (int g = 0; g < per_cell; g++) {
            int64_t q = c * per_cell + g;
            sample->weight[q] = rule.weight[g] * cell_volume(&sample->cells, c);
            for (int k = 0; k <= dim; k++) {
                sample->vertex[q * (dim + 1) + k] = vertex[k];
                sample->barycentric[q * (dim + 1) + k] = rule.barycentric[g * (dim + 1) + k];
            }
        }
    }
    if (sample->smoothed) {
        struct cell_table table = cell_table_make(&sample->cells, &sample->faces, &sample->averages);
        sample->ptr = table.ptr;
        sample->idx = table.idx;
        sample->phi = table.phi;
        sample->dphi = table.dphi;
    } else {
        struct support_lists lists;
        GOOD(support_build(&sample->options, &sample->grid, sample->point_count, sample->x, "points", &lists,
                           &error));
        struct neighbours neighbours = support_view(&lists);
        sample->phi = sample_array(lists.ptr[lists.count], sizeof(double));
        sample->dphi = sample_array(lists.ptr[lists.count] * dim, sizeof(double));
        GOOD(shape_table(&sample->options.mls, sample->cloud.x, sample->radius, &neighbours, sample->x,
                         "points", sample->phi, sample->dphi, &error));
        sample->ptr = lists.ptr;
        sample->idx = lists.idx;
        free(lists.widen);
    }
}

static inline void sample_nodes(struct sample *sample)
{
    struct error error;
    GOOD(support_build(&sample->options, &sample->grid, sample->cloud.node_count, sample->cloud.x, "nodes",
                       &sample->node_lists, &error));
    struct neighbours neighbours = support_view(&sample->node_lists);
    sample->node_phi = sample_array(sample->node_lists.ptr[sample->cloud.node_count], sizeof(double));
    GOOD(shape_table(&sample->options.mls, sample->cloud.x, sample->radius, &neighbours, sample->cloud.x,
                     "nodes", sample->node_phi, NULL, &error));
}

/* What a body of smoothed cells is made of. */
static inline struct smoothed_cells_input sample_smoothed(const struct sample *sample)
{
    return (struct smoothed_cells_input){.x = sample->cloud.x,
                                         .cell_node = sample->cells.node,
                                         .faces = &sample->faces,
                                         .face_ptr = sample->averages.ptr,
                                         .face_idx = sample->averages.idx,
                                         .face_phi = sample->averages.phi,
                                         .face_reader = sample->face_reader,
                                         .node_ptr = sample->node_lists.ptr,
                                         .node_idx = sample->node_lists.idx,
                                         .node_phi = sample->node_phi};
}

/* factor: support radius over local spacing. */
static inline struct sample make_wide_sample(int dim, bool smoothed, int64_t per_axis, double factor)
{
    struct error error;
    struct sample sample = {.dim = dim, .smoothed = smoothed};
    struct cloud_options cloud = {.kind = CLOUD_JITTERED,
                                  .dim = dim,
                                  .count = {per_axis, per_axis, per_axis},
                                  .high = {sample_size, sample_size, sample_size},
                                  .jitter = dim == 2 ? 0.3 : 0.1,
                                  .seed = 7};
    GOOD(cloud_make(&cloud, &sample.cloud, &error));
    assert_true(sample.cloud.cell_count > 0);
    sample.cells = (struct cells){dim, sample.cloud.node_count, sample.cloud.x, sample.cloud.cell_count,
                                  sample.cloud.cells};
    double *spacing = sample_array(sample.cloud.node_count, sizeof *spacing);
    sample.options = support_defaults(dim);
    sample.options.factor = factor;
    sample.radius = sample_array(sample.cloud.node_count, sizeof(double));
    GOOD(cells_node_spacing(&sample.cells, spacing, &error));
    GOOD(support_radii(&sample.options, sample.cloud.node_count, spacing, sample.radius, &error));
    GOOD(point_grid_build(&sample.grid, dim, sample.cloud.node_count, sample.cloud.x, sample.radius, &error));
    free(spacing);
    sample_faces(&sample);
    sample_points(&sample, smoothed ? 1 : dim == 2 ? 3 : 4);
    sample_nodes(&sample);
    return sample;
}

static inline struct sample make_sample(int dim, bool smoothed, int64_t per_axis)
{
    return make_wide_sample(dim, smoothed, per_axis, 1.8);
}

static inline void sample_free(struct sample *sample)
{
    free(sample->radius);
    free(sample->face_x);
    free(sample->face_phi);
    face_averages_free(&sample->averages);
    free(sample->x);
    free(sample->weight);
    free(sample->vertex);
    free(sample->barycentric);
    free(sample->phi);
    free(sample->dphi);
    free(sample->ptr);
    free(sample->idx);
    free(sample->node_phi);
    support_free(&sample->node_lists);
    support_free(&sample->face_lists);
    point_grid_free(&sample->grid);
    faces_free(&sample->faces);
    cloud_free(&sample->cloud);
}

#endif
