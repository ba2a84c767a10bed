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

static enum status put_regions(const struct label_image *image, const struct label_cells *result,
                               struct stream *stream, struct error *error)
{
    FREED_BY(names_free) struct names names = {0};
    NEW_SCRATCH(int32_t, region, image->labels.count, error);
    NEW_SCRATCH(int32_t, of_cell, result->cell_count, error);
    for (int64_t c = 0; c < result->cell_count; c++) {
        region[result->label[c]] = 1;
    }
    for (int32_t l = 1; l < image->labels.count; l++) {
        if (region[l] != 0) {
            region[l] = (int32_t)names.count;
            RETURN_IF_ERROR(names_add(&names, image->table.names.name[l], error));
        }
    }
    for (int64_t c = 0; c < result->cell_count; c++) {
        of_cell[c] = region[result->label[c]];
    }
    return stream_put_groups(stream, GROUP_REGION, &names, result->cell_count, NULL, &of_cell, error);
}

/* Put a group A|B for each interface, with its items, once each: with these nodes. */
static enum status put_members(const struct label_image *image, enum group_kind kind, int64_t count,
                               struct member *member, int corners, const int32_t *node_of,
                               struct stream *stream, struct error *error)
{
    FREED_BY(names_free) struct names names = {0};
    int64_t kept = 0;
    NEW_SCRATCH(int32_t, node, count * corners, error);
    NEW_SCRATCH(int32_t, group, count, error);
    if (count > 0) {
        qsort(member, (size_t)count, sizeof *member, compare_members);
    }
    for (int64_t i = 0; i < count; i++) {
        const struct member *own = &member[i], *before = &member[i > 0 ? i - 1 : 0];
        if (i > 0 && compare_members(own, before) == 0) {
            continue;
        }
        if (i == 0 || own->inner != before->inner || own->outer != before->outer) {
            RETURN_IF_ERROR(names_print(&names, error, "%s|%s", image->table.names.name[own->inner],
                                        image->table.names.name[own->outer]));
        }
        memcpy(node + kept * corners, node_of != NULL ? node_of + (int64_t)own->item * corners : &own->item,
               (size_t)corners * sizeof *node);
        group[kept++] = (int32_t)names.count - 1;
    }
    return stream_put_groups(stream, kind, &names, kept, &node, &group, error);
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

enum status label_mesh_put(const struct label_image *image, const struct label_cells *result,
                           struct stream *stream, struct error *error)
{
    struct cells cells = label_cells_view(result);
    char attributes[64];
    int64_t count = 0;
    SCRATCH struct member *shared = NULL;
    NEW_SCRATCH(struct member, facet, result->facet_count, error);
    for (int32_t f = 0; f < (int32_t)result->facet_count; f++) {
        facet[f] = (struct member){result->side[2 * f], result->side[2 * f + 1], f};
    }
    RETURN_IF_ERROR(find_interfaces(&cells, result->label, &shared, &count, error));
    RETURN_IF_ERROR(stream_put(stream, "nodes.x", TYPE_F8, result->node_count, result->dim,
                               vector_attributes(result->dim, "m", attributes), result->x, false, error));
    RETURN_IF_ERROR(stream_put(stream, "cells", TYPE_I4, result->cell_count, result->dim + 1, "",
                               result->cell, false, error));
    RETURN_IF_ERROR(put_regions(image, result, stream, error));
    RETURN_IF_ERROR(put_members(image, GROUP_FACETS, result->facet_count, facet, result->dim, result->facet,
                                stream, error));
    return put_members(image, GROUP_NODES, count, shared, 1, NULL, stream, error);
}
