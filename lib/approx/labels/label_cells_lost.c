#include "approx/cells/cells.h"
#include "approx/cells/raster.h"
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

/* Whether a cell of the label contains a voxel or one that touches it. For a label that is not kept: whether
 * one of these voxels is in no cell, or beyond the grid. */
static bool is_near(const struct labels *labels, const struct label_cells *mesh, const int32_t *owner,
                    int64_t voxel, int32_t label, bool kept)
{
    const int64_t *n = labels->size;
    const int64_t at[3] = {voxel % n[0], voxel / n[0] % n[1], voxel / n[0] / n[1]};
    for (int k = 0; k < (n[2] > 1 ? 27 : 9); k++) {
        const int64_t next[3] = {at[0] + k % 3 - 1, at[1] + k / 3 % 3 - 1,
                                 at[2] + (n[2] > 1 ? k / 9 - 1 : 0)};
        bool within = true;
        for (int d = 0; d < 3; d++) {
            within = within && next[d] >= 0 && next[d] < n[d];
        }
        int32_t cell = within ? owner[(next[2] * n[1] + next[1]) * n[0] + next[0]] : -1;
        if (kept ? cell >= 0 && mesh->label[cell] == label : cell < 0) {
            return true;
        }
    }
    return false;
}

/* owner[voxels]: the cell that contains the voxel's centre, or -1. */
static enum status own_voxels(const struct labels *labels, const struct label_cells *mesh, int32_t *owner,
                              struct error *error)
{
    int dim = labels->dim;
    int64_t doubly;
    NEW_SCRATCH(double, x, mesh->node_count * dim, error);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double voxel[3];
        labels_to_voxel(labels, mesh->x + n * dim, voxel);
        memcpy(x + n * dim, voxel, (size_t)dim * sizeof *x);
    }
    struct cells cells = {dim, mesh->node_count, x, mesh->cell_count, mesh->cell};
    raster_cells(&cells, mesh->cell_count > 0 && cell_volume(&cells, 0) < 0 ? -1 : 1, labels->size, owner,
                 &doubly);
    return STATUS_OK;
}

enum status label_cells_lost(const struct labels *labels, const bool *keep, const struct label_cells *mesh,
                             int64_t *lost, struct error *error)
{
    int64_t voxels = labels->size[0] * labels->size[1] * labels->size[2];
    for (int32_t l = 0; l < labels->count; l++) {
        lost[l] = 0;
    }
    NEW_SCRATCH(int32_t, owner, voxels, error);
    RETURN_IF_ERROR(own_voxels(labels, mesh, owner, error));
    for (int64_t v = 0; v < voxels; v++) {
        int32_t label = labels->label[v], there = owner[v] >= 0 ? mesh->label[owner[v]] : -1;
        if (there != (keep[label] ? label : -1)) {
            lost[label] += !is_near(labels, mesh, owner, v, label, keep[label]);
        }
    }
    return STATUS_OK;
}

/* ---- voxels that hang together with cells ---- */

/* Voxels of each label, those that are not kept together, and the bodies that they hang together with: 0
 * none, 1 one that is kept, 2 one that is left out; negative until they pass that on. */
struct hanging {
    const struct labels *labels;
    const bool *keep;
    int8_t *body;
    int64_t *fresh, count, room;
};

static bool are_same(const struct hanging *hanging, int64_t a, int64_t b)
{
    int32_t first = hanging->labels->label[a], second = hanging->labels->label[b];
    return first == second || !(hanging->keep[first] || hanging->keep[second]);
}

/* The body of a voxel is that of the voxels of its label beside it that have none. */
static enum status pass_on(struct hanging *hanging, int64_t voxel, struct error *error)
{
    const int64_t *n = hanging->labels->size;
    const int64_t at[3] = {voxel % n[0], voxel / n[0] % n[1], voxel / n[0] / n[1]};
    const int64_t step[3] = {1, n[0], n[0] * n[1]};
    for (int k = 0; k < 6; k++) {
        int64_t place = at[k / 2] + (k % 2 ? 1 : -1), next = voxel + (k % 2 ? 1 : -1) * step[k / 2];
        if (place >= 0 && place < n[k / 2] && hanging->body[next] == 0 && are_same(hanging, voxel, next)) {
            RETURN_IF_ERROR(GROW_ARRAY(&hanging->fresh, hanging->count + 1, &hanging->room, error));
            hanging->fresh[hanging->count++] = next;
            hanging->body[next] = (int8_t)-abs(hanging->body[voxel]);
        }
    }
    return STATUS_OK;
}

static void hanging_free(struct hanging *hanging)
{
    FREE_ALL(hanging->body, hanging->fresh);
}

enum status label_cells_volume(struct label_body *body, struct error *error)
{
    const struct labels *labels = body->labels;
    const struct label_cells *mesh = body->mesh;
    int64_t voxels = labels->size[0] * labels->size[1] * labels->size[2];
    double voxel = labels_voxel_volume(labels);
    const bool *keep = body->options->keep;
    FREED_BY(hanging_free) struct hanging hanging = {.labels = labels, .keep = keep};
    NEW_SCRATCH(int32_t, owner, voxels, error);
    RETURN_IF_ERROR(NEW_ARRAY(&hanging.body, voxels, error));
    RETURN_IF_ERROR(own_voxels(labels, mesh, owner, error));
    for (int64_t v = 0; v < voxels; v++) {
        int32_t label = labels->label[v], there = owner[v] >= 0 ? mesh->label[owner[v]] : 0;
        bool inside = owner[v] >= 0 && body->wanted[owner[v]];
        owner[v] = inside ? there : -1;
        if (keep[label] ? there == label : !inside) {
            hanging.body[v] = inside || !keep[label] ? 1 : 2;
        }
    }
    for (int64_t v = 0; v < voxels; v++) {
        if (hanging.body[v] > 0) {
            RETURN_IF_ERROR(pass_on(&hanging, v, error));
        }
    }
    for (int64_t i = 0; i < hanging.count; i++) {
        RETURN_IF_ERROR(pass_on(&hanging, hanging.fresh[i], error));
    }
    for (int64_t v = 0; v < voxels; v++) {
        int32_t label = abs(hanging.body[v]) == 1 ? labels->label[v] : owner[v];
        if (label >= 0 && keep[label]) {
            body->volume[label] += voxel;
        }
        if (body->options->largest && abs(hanging.body[v]) == 2) {
            labels->label[v] = 0;
        }
    }
    return STATUS_OK;
}
