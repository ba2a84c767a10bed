#include "approx/cells.h"
#include "approx/raster.h"
#include "approx/stuffing.h"
#include "base/memory.h"
#include "base/vector.h"

/* The grid of the labels without the axis across a slice. */
struct grid {
    int64_t size[3];
    int axis[3]; /* of the labels' grid */
};

static struct grid grid_of(const struct labels *labels)
{
    struct grid grid = {.size = {1, 1, 1}};
    int count = 0;
    for (int d = 0; d < 3; d++) {
        if (labels->dim == 3 || labels->size[d] > 1) {
            grid.axis[count] = d;
            grid.size[count++] = labels->size[d];
        }
    }
    return grid;
}

/* 1 where the map from the world to the grid keeps orientation, -1 where it mirrors. */
static int sign_of(const struct labels *labels, const struct grid *grid)
{
    double edge[3][3] = {{0}}, origin[3] = {0}, voxel[2][3];
    int dim = labels->dim;
    for (int d = 0; d < dim; d++) {
        double unit[3] = {0};
        unit[d] = 1;
        labels_to_voxel(labels, origin, voxel[0]);
        labels_to_voxel(labels, unit, voxel[1]);
        for (int e = 0; e < dim; e++) {
            edge[d][e] = voxel[1][grid->axis[e]] - voxel[0][grid->axis[e]];
        }
    }
    if (dim == 2) {
        edge[2][2] = 1;
    }
    return determinant3(edge[0], edge[1], edge[2]) > 0 ? 1 : -1;
}

/* Whether a cell of the label lies at a voxel or at one that touches it; of a label that is not kept, whether
 * no cell does, or the grid ends there. */
static bool is_near(const struct grid *grid, const struct stuffing *stuffing, const int32_t *owner,
                    int64_t voxel, int32_t label, bool kept)
{
    const int64_t *n = grid->size;
    const int64_t at[3] = {voxel % n[0], voxel / n[0] % n[1], voxel / n[0] / n[1]};
    for (int k = 0; k < (n[2] > 1 ? 27 : 9); k++) {
        const int64_t next[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1,
                                 at[2] + (n[2] > 1 ? k / 9 - 1 : 0)};
        bool within = true;
        for (int d = 0; d < 3; d++) {
            within = within && next[d] >= 0 && next[d] < n[d];
        }
        int32_t cell = within ? owner[(next[2] * n[1] + next[1]) * n[0] + next[0]] : -1;
        if (kept ? cell >= 0 && stuffing->label[cell] == label : cell < 0) {
            return true;
        }
    }
    return false;
}

enum status stuffing_lost(const struct labels *labels, const bool *keep, const struct stuffing *stuffing,
                          int64_t *lost, struct error *error)
{
    struct grid grid = grid_of(labels);
    int64_t voxels = grid.size[0] * grid.size[1] * grid.size[2], doubly;
    int dim = labels->dim;
    SCRATCH double *x = NULL;
    SCRATCH int32_t *owner = NULL;
    struct cells cells = {dim, stuffing->node_count, NULL, stuffing->cell_count, stuffing->cell};
    for (int32_t l = 0; l < labels->count; l++) {
        lost[l] = 0;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&x, stuffing->node_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&owner, voxels, error));
    for (int64_t n = 0; n < stuffing->node_count; n++) {
        double voxel[3];
        labels_to_voxel(labels, stuffing->x + n * dim, voxel);
        for (int d = 0; d < dim; d++) {
            x[n * dim + d] = voxel[grid.axis[d]];
        }
    }
    cells.x = x;
    raster_cells(&cells, sign_of(labels, &grid), grid.size, owner, &doubly);
    for (int64_t v = 0; v < voxels; v++) {
        int32_t label = labels->label[v], there = owner[v] >= 0 ? stuffing->label[owner[v]] : -1;
        if (there != (keep[label] ? label : -1)) {
            lost[label] += !is_near(&grid, stuffing, owner, v, label, keep[label]);
        }
    }
    return STATUS_OK;
}
