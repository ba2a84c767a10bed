#include "voxels/label_image.h"

#include "base/lists.h"

#include <stdlib.h>
#include <string.h>

/* An item, a facet or node, of the interface of two labels. */
struct member {
    int32_t inner, outer, item;
};

static int compare_members(const void *left, const void *right)
{
    return compare_numbers(3, left, right);
}

static bool same_group(const struct member *a, const struct member *b)
{
    return a->inner == b->inner && a->outer == b->outer;
}

static enum status make_regions(const struct label_image *image, const struct label_cells *result,
                                struct mesh *mesh, struct error *error)
{
    NEW_SCRATCH(int32_t, region, image->labels.count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->cell_region, result->cell_count, error));
    for (int64_t c = 0; c < result->cell_count; c++) {
        region[result->label[c]] = 1;
    }
    for (int32_t l = 1; l < image->labels.count; l++) {
        if (region[l] != 0) {
            region[l] = (int32_t)mesh->regions.count;
            RETURN_IF_ERROR(names_add(&mesh->regions, image->table.names.name[l], error));
        }
    }
    for (int64_t c = 0; c < result->cell_count; c++) {
        mesh->cell_region[c] = region[result->label[c]];
    }
    return STATUS_OK;
}

static enum status make_facets(const struct label_image *image, const struct label_cells *result,
                               struct mesh *mesh, struct error *error)
{
    int dim = result->dim;
    NEW_SCRATCH(struct member, member, result->facet_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facets, result->facet_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet_set, result->facet_count, error));
    for (int32_t f = 0; f < (int32_t)result->facet_count; f++) {
        member[f] = (struct member){result->side[2 * f], result->side[2 * f + 1], f};
    }
    qsort(member, (size_t)result->facet_count, sizeof *member, compare_members);
    for (int64_t f = 0; f < result->facet_count; f++) {
        if (f == 0 || !same_group(&member[f], &member[f - 1])) {
            RETURN_IF_ERROR(names_print(&mesh->facet_sets, error, "%s|%s",
                                        image->table.names.name[member[f].inner],
                                        image->table.names.name[member[f].outer]));
        }
        mesh->facet_set[f] = (int32_t)mesh->facet_sets.count - 1;
        memcpy(mesh->facets + f * dim, result->facet + (int64_t)member[f].item * dim,
               (size_t)dim * sizeof *mesh->facets);
    }
    mesh->facet_count = result->facet_count;
    return STATUS_OK;
}

/* List the nodes of faces between two regions, once for each face. */
static enum status find_interfaces(const struct cells *cells, const int32_t *label, struct member **member,
                                   int64_t *count, struct error *error)
{
    int corners = cells->dim + 1;
    int64_t room = 0;
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        int64_t c = i / corners;
        for (int k = 0; k < corners && across[i] >= 0 && label[across[i]] > label[c]; k++) {
            if (k != i % corners) {
                RETURN_IF_ERROR(GROW_ARRAY(member, *count + 1, &room, error));
                (*member)[(*count)++] =
                    (struct member){label[c], label[across[i]], cells->node[c * corners + k]};
            }
        }
    }
    return STATUS_OK;
}

static enum status make_sets(const struct label_image *image, const struct label_cells *result,
                             struct mesh *mesh, struct error *error)
{
    struct cells cells = label_cells_view(result);
    int64_t kept = 0, count = 0;
    SCRATCH struct member *member = NULL;
    RETURN_IF_ERROR(find_interfaces(&cells, result->label, &member, &count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->set_idx, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->set_ptr, count + 1, error));
    if (count > 0) {
        qsort(member, (size_t)count, sizeof *member, compare_members);
    }
    for (int64_t i = 0; i < count; i++) {
        if (i > 0 && compare_members(&member[i], &member[i - 1]) == 0) {
            continue;
        }
        if (i == 0 || !same_group(&member[i], &member[i - 1])) {
            mesh->set_ptr[mesh->node_sets.count] = kept;
            RETURN_IF_ERROR(names_print(&mesh->node_sets, error, "%s|%s",
                                        image->table.names.name[member[i].inner],
                                        image->table.names.name[member[i].outer]));
        }
        mesh->set_idx[kept++] = member[i].item;
    }
    mesh->set_ptr[mesh->node_sets.count] = kept;
    return STATUS_OK;
}

enum status label_mesh_make(const struct label_image *image, struct label_cells *result, struct mesh *mesh,
                            struct error *error)
{
    *mesh =
        (struct mesh){.dim = result->dim, .node_count = result->node_count, .cell_count = result->cell_count};
    RETURN_IF_ERROR(make_regions(image, result, mesh, error));
    RETURN_IF_ERROR(make_facets(image, result, mesh, error));
    RETURN_IF_ERROR(make_sets(image, result, mesh, error));
    mesh->x = array_take(&result->x);
    mesh->cells = array_take(&result->cell);
    return STATUS_OK;
}
