#include "approx/cells/raster.h"
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"

#include <math.h>

/* Mean edge of the lattice's tetrahedra, two edges along axes and four half diagonals, by the edge of a cube,
 * as cells_node_spacing computes it. */
static double mean_edge(void)
{
    return (1 + sqrt(3)) / 3;
}

int size_level(double spacing, double size)
{
    return (int)fmin(fmax(round(log2(mean_edge() * spacing / size)), 0), OCTREE_MOST_LEVELS);
}

/* The size at a place in a cell, linear between its nodes. */
static double size_at(const struct cells *cells, const double *size, int64_t cell, const double at[3])
{
    const int32_t *node = cells->node + 4 * cell;
    double share[4], value = 0, least = INFINITY, most = 0;
    cell_barycentric(cells, cell, at, share);
    for (int k = 0; k < 4; k++) {
        value += share[k] * size[node[k]];
        least = fmin(least, size[node[k]]);
        most = fmax(most, size[node[k]]);
    }
    return fmin(fmax(value, least), most);
}

enum status sizes_wish(const struct labels *labels, const struct label_cells_options *options, int levels,
                       const int64_t count[3], const double low[3], double edge, uint8_t *wish,
                       double *unsized, struct error *error)
{
    struct cells scaled = *options->sized;
    int64_t total = count[0] * count[1] * count[2], doubly = 0, within = 0, beyond = 0;
    NEW_SCRATCH(double, x, 3 * scaled.node_count, error);
    NEW_SCRATCH(int32_t, owner, total, error);
    for (int64_t i = 0; i < 3 * scaled.node_count; i++) {
        x[i] = (options->sized->x[i] - low[i % 3]) / edge - 0.5;
    }
    scaled.x = x;
    raster_cells(&scaled, 1, count, owner, &doubly);
#pragma omp parallel for schedule(static) reduction(+ : within, beyond)
    for (int64_t c = 0; c < total; c++) {
        const int64_t cube[3] = {c % count[0], c / count[0] % count[1], c / count[0] / count[1]};
        const double at[3] = {(double)cube[0], (double)cube[1], (double)cube[2]};
        const double centre[3] = {low[0] + edge * (at[0] + 0.5), low[1] + edge * (at[1] + 0.5),
                                  low[2] + edge * (at[2] + 0.5)};
        bool inside = options->keep[labels_at(labels, centre)];
        within += inside;
        beyond += inside && owner[c] < 0;
        if (owner[c] >= 0) {
            int level = size_level(options->spacing, size_at(&scaled, options->size, owner[c], at));
            uint8_t wanted = OCTREE_WISH(level < levels - 1 ? level : levels - 1, false);
            wish[c] = wanted > wish[c] ? wanted : wish[c];
        }
    }
    if (within > 0 && beyond == within) {
        return fail(error, STATUS_INPUT,
                    "the sizes lie elsewhere: none of their cells reaches into the body");
    }
    *unsized = within > 0 ? (double)beyond / (double)within : 0;
    return STATUS_OK;
}
