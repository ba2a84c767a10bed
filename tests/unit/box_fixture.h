/* A jittered lattice over a square or cube of .1 m, with its cells. */
#pragma once

#include "approx_fixture.h"

#include "approx/cells/cells.h"
#include "approx/points/cloud.h"

static inline struct cloud box_cloud(int dim, int64_t per_axis, double jitter, double offset)
{
    struct cloud_options options = {.kind = CLOUD_JITTERED, .dim = dim, .jitter = jitter, .seed = 5};
    struct cloud cloud;
    for (int a = 0; a < dim; a++) {
        options.count[a] = per_axis;
        options.low[a] = offset;
        options.high[a] = offset + 0.1;
    }
    GOOD(cloud_make(&options, &cloud, &error));
    assert_true(cloud.cell_count > 0);
    return cloud;
}

static inline struct cells cells_of(const struct cloud *cloud)
{
    return (struct cells){.dim = cloud->dim,
                          .node_count = cloud->node_count,
                          .x = cloud->x,
                          .count = cloud->cell_count,
                          .node = cloud->cells};
}
