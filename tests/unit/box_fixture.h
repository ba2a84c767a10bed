/* A jittered lattice over a square or cube, .1 m or of that size, with its cells. */
#pragma once

#include "approx_fixture.h"

#include "approx/cells/cells.h"
#include "approx/points/cloud.h"

static inline struct cloud sized_cloud(int dim, int64_t per_axis, double jitter, double offset, double size)
{
    struct cloud_options options = {
        .kind = jitter > 0.0 ? CLOUD_JITTERED : CLOUD_REGULAR, .dim = dim, .jitter = jitter, .seed = 5};
    struct cloud cloud;
    for (int a = 0; a < dim; a++) {
        options.count[a] = per_axis;
        options.low[a] = offset;
        options.high[a] = offset + size;
    }
    GOOD(cloud_make(&options, &cloud, &error));
    assert_true(cloud.cell_count > 0);
    return cloud;
}

static inline struct cloud box_cloud(int dim, int64_t per_axis, double jitter, double offset)
{
    return sized_cloud(dim, per_axis, jitter, offset, 0.1);
}

static inline struct cells cells_of(const struct cloud *cloud)
{
    return (struct cells){.dim = cloud->dim,
                          .node_count = cloud->node_count,
                          .x = cloud->x,
                          .count = cloud->cell_count,
                          .node = cloud->cells};
}
