/* Tables of shape functions on a lattice of nodes in a box, made by the stages as the tools make them. */
#pragma once

#include "unit.h"

#include "approx/points/cloud.h"
#include "solid/assembly/assembly.h"
#include "stages/stages.h"

/* Tables on nodes with cells, in a stream, and what an assembly takes of both, in view. gauss_points of each
 * cell; 0: smoothed cells. factor: support radius by the local spacing. */
static inline void make_tables_of(const struct cloud *cloud, int gauss_points, double factor,
                                  struct stream *stream, struct assembly *assembly)
{
    int64_t unresolved;
    struct ipoints_options points = {.smoothed = gauss_points == 0, .gauss_points = gauss_points};
    struct support_options support = support_defaults(cloud->dim);
    struct support_report report;
    support.factor = factor;
    *assembly = (struct assembly){0};
    stream_init(stream);
    GOOD(stream_put(stream, "nodes.x", TYPE_F8, cloud->node_count, cloud->dim, "", cloud->x, false, &error));
    GOOD(stream_put(stream, "cells", TYPE_I4, cloud->cell_count, cloud->dim + 1, "", cloud->cells, false,
                    &error));
    GOOD(stage_ipoints(stream, &points, &unresolved, &error));
    GOOD(stage_support(stream, &support, &report, &error));
    GOOD(stage_shapefn(stream, &support.mls, &error));
    GOOD(stage_tables(stream, assembly, &error));
}

/* The same on nodes that are made. */
static inline void make_tables(const struct cloud_options *options, int gauss_points, double factor,
                               struct cloud *cloud, struct stream *stream, struct assembly *assembly)
{
    GOOD(cloud_make(options, cloud, &error));
    assert_true(cloud->cell_count > 0);
    make_tables_of(cloud, gauss_points, factor, stream, assembly);
}
