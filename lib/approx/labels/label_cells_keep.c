#include "approx/cells/cells.h"
#include "approx/labels/label_cells_private.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- stars ---- */

static void add_label(struct label_cells_star *star, int64_t node, int32_t label)
{
    int count = star->labels[node];
    for (int i = 0; i < count; i++) {
        if (star->label[node][i] == label) {
            return;
        }
    }
    if (count < LABEL_CELLS_MOST_LABELS) {
        star->label[node][count] = (uint16_t)label;
        star->labels[node]++;
    }
}

enum status star_make(struct label_body *body, struct error *error)
{
    const struct label_cells *mesh = body->mesh;
    struct label_cells_star *star = &body->star;
    int corners = mesh->dim + 1;
    star_free(star);
    RETURN_IF_ERROR(lists_by_row(mesh->cell_count, corners, mesh->cell, mesh->node_count, &star->ptr,
                                 &star->cell, error));
    RETURN_IF_ERROR(NEW_ARRAY(&star->label, mesh->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&star->labels, mesh->node_count, error));
    for (int64_t i = 0; i < mesh->cell_count * corners; i++) {
        if (body->wanted == NULL || body->wanted[i / corners]) {
            add_label(star, mesh->cell[i], mesh->label[i / corners]);
        }
    }
    for (int64_t i = 0; i < mesh->facet_count * mesh->dim; i++) {
        add_label(star, mesh->facet[i], mesh->side[2 * (i / mesh->dim) + 1]);
    }
    return STATUS_OK;
}

void star_free(struct label_cells_star *star)
{
    FREE_ALL(star->ptr, star->cell, star->label, star->labels);
    *star = (struct label_cells_star){0};
}

/* ---- the boundary ---- */

/* Count the boundary facets of the wanted cells; store them if the arrays exist. */
static int64_t find_facets(const struct label_body *body, int32_t *facet, int32_t *side)
{
    int dim = body->mesh->dim;
    int64_t count = 0;
    struct cells cells = label_cells_view(body->mesh);
    for (int64_t c = 0; c < cells.count; c++) {
        for (int k = 0; k <= dim && body->wanted[c]; k++) {
            int32_t next = body->across[c * (dim + 1) + k];
            if (next >= 0 && body->wanted[next]) {
                continue;
            }
            if (facet != NULL) {
                cell_face(&cells, c, k, facet + count * dim);
                side[2 * count] = body->mesh->label[c];
                side[2 * count + 1] = next >= 0 ? body->mesh->label[next] : 0;
            }
            count++;
        }
    }
    return count;
}

enum status label_cells_compact(struct label_cells *mesh, struct error *error)
{
    int dim = mesh->dim, corners = dim + 1;
    int64_t slots = mesh->cell_count * corners, nodes = 0;
    NEW_SCRATCH(int32_t, number, mesh->node_count, error);
    for (int64_t i = 0; i < slots; i++) {
        number[mesh->cell[i]] = 1;
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        if (number[n] != 0) {
            memmove(mesh->x + nodes * dim, mesh->x + n * dim, (size_t)dim * sizeof *mesh->x);
            number[n] = (int32_t)nodes++;
        }
    }
    mesh->node_count = nodes;
    for (int64_t i = 0; i < slots; i++) {
        mesh->cell[i] = number[mesh->cell[i]];
    }
    for (int64_t i = 0; i < mesh->facet_count * dim; i++) {
        mesh->facet[i] = number[mesh->facet[i]];
    }
    return STATUS_OK;
}

enum status label_cells_drop(const bool *wanted, struct label_cells *mesh, struct error *error)
{
    int corners = mesh->dim + 1;
    int64_t cells = 0;
    for (int64_t c = 0; c < mesh->cell_count; c++) {
        if (wanted[c]) {
            memmove(mesh->cell + cells * corners, mesh->cell + c * corners,
                    (size_t)corners * sizeof *mesh->cell);
            mesh->label[cells++] = mesh->label[c];
        }
    }
    mesh->cell_count = cells;
    return label_cells_compact(mesh, error);
}

int64_t label_cells_flood(struct label_body *body, int64_t first, int32_t number, int64_t node)
{
    int corners = body->mesh->dim + 1;
    int64_t count = 0;
    body->stack[count++] = (int32_t)first;
    body->group[first] = number;
    for (int64_t i = 0; i < count; i++) {
        int64_t face = (int64_t)body->stack[i] * corners;
        for (int64_t end = face + corners; face < end; face++) {
            int32_t next = body->mesh->cell[face] != node ? body->across[face] : -1;
            if (next >= 0 && body->wanted[next] && body->group[next] < 0) {
                body->group[next] = number;
                body->stack[count++] = next;
            }
        }
    }
    return count;
}

/* ---- voxels and cells ---- */

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

/* Set body->volume: that of the voxels that hang together with the cells of a label, and of those of others
 * in them that do not hang together with theirs: specks and cavities that the lattice does not see. Voxels
 * nearer to bodies that are left out count for these, and become outside if options->largest. */
static enum status set_volumes(struct label_body *body, struct error *error)
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

/* ---- bodies ---- */

/* Leave out connected bodies around a single point of the lattice, or all but the largest body. */
static void keep_bodies(struct label_body *body)
{
    struct label_cells *mesh = body->mesh;
    struct cells cells = label_cells_view(mesh);
    int32_t number = 0, largest = -1;
    double most = 0;
    for (int64_t c = 0; c < body->mesh->cell_count; c++) {
        double volume = 0;
        if (!body->wanted[c] || body->group[c] >= 0) {
            continue;
        }
        int64_t count = label_cells_flood(body, c, number, -1);
        bool speck = count <= (body->mesh->dim == 3 ? 24 : 6);
        for (int64_t i = 0; i < count; i++) {
            volume += cell_volume(&cells, body->stack[i]);
            body->wanted[body->stack[i]] = !speck;
        }
        mesh->specks += speck;
        mesh->speck_volume += speck ? volume : 0;
        largest = volume > most ? number : largest;
        most = fmax(most, volume);
        number++;
    }
    for (int64_t c = 0; c < mesh->cell_count && body->options->largest; c++) {
        body->wanted[c] = body->wanted[c] && body->group[c] == largest;
    }
}

enum status label_cells_keep(struct label_body *body, struct error *error)
{
    struct label_cells *mesh = body->mesh;
    struct cells cells = label_cells_view(mesh);
    int64_t count = mesh->cell_count;
    int32_t bodies = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&body->volume, body->labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->across, count * (mesh->dim + 1), error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->wanted, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->group, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->stack, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->from, count, error));
    RETURN_IF_ERROR(cells_across(&cells, body->across, error));
    for (int64_t c = 0; c < count; c++) {
        body->wanted[c] = body->options->keep[mesh->label[c]];
        body->group[c] = -1;
    }
    RETURN_IF_ERROR(star_make(body, error));
    keep_bodies(body);
    memset(body->group, -1, (size_t)count * sizeof *body->group);
    label_cells_join(body);
    memset(body->group, -1, (size_t)count * sizeof *body->group);
    for (int64_t c = 0; c < count; c++) {
        if (body->wanted[c] && body->group[c] < 0) {
            label_cells_flood(body, c, bodies++, -1);
        }
    }
    RETURN_IF_ERROR(label_cells_cut_apart(body, error));
    RETURN_IF_ERROR(set_volumes(body, error));
    mesh->facet_count = find_facets(body, NULL, NULL);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet, mesh->facet_count * mesh->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->side, mesh->facet_count * 2, error));
    find_facets(body, mesh->facet, mesh->side);
    return star_make(body, error);
}
