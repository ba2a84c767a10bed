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

enum status star_make(const struct label_cells *mesh, const bool *wanted, struct label_cells_star *star,
                      struct error *error)
{
    int corners = mesh->dim + 1;
    *star = (struct label_cells_star){0};
    RETURN_IF_ERROR(lists_by_row(mesh->cell_count, corners, mesh->cell, mesh->node_count, &star->ptr,
                                 &star->cell, error));
    RETURN_IF_ERROR(NEW_ARRAY(&star->label, mesh->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&star->labels, mesh->node_count, error));
    for (int64_t i = 0; i < mesh->cell_count * corners; i++) {
        if (wanted == NULL || wanted[i / corners]) {
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
static int64_t find_facets(const struct label_cells_keeping *keeping, int32_t *facet, int32_t *side)
{
    int dim = keeping->cells.dim;
    int64_t count = 0;
    for (int64_t c = 0; c < keeping->cells.count; c++) {
        for (int k = 0; k <= dim && keeping->wanted[c]; k++) {
            int32_t next = keeping->across[c * (dim + 1) + k];
            if (next >= 0 && keeping->wanted[next]) {
                continue;
            }
            if (facet != NULL) {
                cell_face(&keeping->cells, c, k, facet + count * dim);
                side[2 * count] = keeping->mesh->label[c];
                side[2 * count + 1] = next >= 0 ? keeping->mesh->label[next] : 0;
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

int64_t label_cells_flood(struct label_cells_keeping *keeping, int64_t first, int32_t number, int64_t node)
{
    int corners = keeping->cells.dim + 1;
    int64_t count = 0;
    keeping->stack[count++] = (int32_t)first;
    keeping->group[first] = number;
    for (int64_t i = 0; i < count; i++) {
        int64_t face = (int64_t)keeping->stack[i] * corners;
        for (int64_t end = face + corners; face < end; face++) {
            int32_t next = keeping->cells.node[face] != node ? keeping->across[face] : -1;
            if (next >= 0 && keeping->wanted[next] && keeping->group[next] < 0) {
                keeping->group[next] = number;
                keeping->stack[count++] = next;
            }
        }
    }
    return count;
}

/* Leave out connected bodies around a single point of the lattice, or all but the largest body. */
static void keep_bodies(struct label_cells_keeping *keeping, bool largest_only)
{
    struct label_cells *mesh = keeping->mesh;
    int32_t number = 0, largest = -1;
    double most = 0;
    for (int64_t c = 0; c < keeping->cells.count; c++) {
        double volume = 0;
        if (!keeping->wanted[c] || keeping->group[c] >= 0) {
            continue;
        }
        int64_t count = label_cells_flood(keeping, c, number, -1);
        bool speck = count <= (keeping->cells.dim == 3 ? 24 : 6);
        for (int64_t i = 0; i < count; i++) {
            volume += cell_volume(&keeping->cells, keeping->stack[i]);
            keeping->wanted[keeping->stack[i]] = !speck;
        }
        mesh->specks += speck;
        mesh->speck_volume += speck ? volume : 0;
        largest = volume > most ? number : largest;
        most = fmax(most, volume);
        number++;
    }
    for (int64_t c = 0; c < keeping->cells.count && largest_only; c++) {
        keeping->wanted[c] = keeping->wanted[c] && keeping->group[c] == largest;
    }
}

static void keeping_free(struct label_cells_keeping *keeping)
{
    FREE_ALL(keeping->across, keeping->group, keeping->stack, keeping->from, keeping->wanted, keeping->apart);
}

enum status label_cells_keep(const struct labels *labels, const struct label_cells_options *options,
                             const bool *between, struct label_cells *mesh, struct label_cells_kept *kept,
                             struct error *error)
{
    int dim = mesh->dim;
    int64_t count = mesh->cell_count;
    int32_t bodies = 0;
    FREED_BY(star_free) struct label_cells_star star = {0};
    FREED_BY(keeping_free)
    struct label_cells_keeping keeping = {.mesh = mesh, .between = between, .cells = label_cells_view(mesh)};
    *kept = (struct label_cells_kept){0};
    RETURN_IF_ERROR(NEW_ARRAY(&kept->volume, labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&keeping.across, count * (dim + 1), error));
    RETURN_IF_ERROR(NEW_ARRAY(&keeping.wanted, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&keeping.group, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&keeping.stack, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&keeping.from, count, error));
    RETURN_IF_ERROR(cells_across(&keeping.cells, keeping.across, error));
    RETURN_IF_ERROR(star_make(mesh, NULL, &star, error));
    for (int64_t c = 0; c < count; c++) {
        keeping.wanted[c] = options->keep[mesh->label[c]];
        keeping.group[c] = -1;
    }
    keep_bodies(&keeping, options->largest);
    memset(keeping.group, -1, (size_t)count * sizeof *keeping.group);
    label_cells_join(&keeping, &star);
    memset(keeping.group, -1, (size_t)count * sizeof *keeping.group);
    for (int64_t c = 0; c < count; c++) {
        if (keeping.wanted[c] && keeping.group[c] < 0) {
            label_cells_flood(&keeping, c, bodies++, -1);
        }
    }
    RETURN_IF_ERROR(label_cells_cut_apart(&keeping, &star, error));
    RETURN_IF_ERROR(label_cells_volume(labels, options, mesh, keeping.wanted, kept->volume, error));
    mesh->facet_count = find_facets(&keeping, NULL, NULL);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet, mesh->facet_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->side, mesh->facet_count * 2, error));
    find_facets(&keeping, mesh->facet, mesh->side);
    kept->wanted = array_take(&keeping.wanted);
    kept->apart = array_take(&keeping.apart);
    return STATUS_OK;
}

void label_cells_kept_free(struct label_cells_kept *kept)
{
    FREE_ALL(kept->wanted, kept->apart, kept->volume);
    *kept = (struct label_cells_kept){0};
}
