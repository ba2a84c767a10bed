#include "approx/cells/cells.h"
#include "approx/labels/label_cells_private.h"
#include "base/lists.h"
#include "base/memory.h"

#include <math.h>
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
    RETURN_IF_ERROR(label_cells_volume(body, error));
    mesh->facet_count = find_facets(body, NULL, NULL);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet, mesh->facet_count * mesh->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->side, mesh->facet_count * 2, error));
    find_facets(body, mesh->facet, mesh->side);
    return star_make(body, error);
}
