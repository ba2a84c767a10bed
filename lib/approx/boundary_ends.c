/* Where a held part of the boundary ends. */
#include "approx/boundary_private.h"

#include "base/memory.h"

#include <stdlib.h>

/* A face of the boundary at one of its nodes. */
struct face_at_node {
    int32_t node;
    int64_t face;
};

static int compare_faces_at_nodes(const void *left, const void *right)
{
    const struct face_at_node *a = left, *b = right;
    if (a->node != b->node) {
        return a->node < b->node ? -1 : 1;
    }
    return (a->face > b->face) - (a->face < b->face);
}

enum status boundary_find_ends(const struct face_table *table, enum boundary_end kind, const bool *held,
                               const bool *touched, bool *end, struct error *error)
{
    enum status status;
    int dim = table->dim;
    const int32_t *node = table->faces->node;
    struct face_at_node *at = NULL;
    int64_t count = 0;
    TRY(NEW_ARRAY(&at, table->faces->count * dim, error));
    for (int64_t f = 0; f < table->faces->count; f++) {
        for (int k = 0; k < dim && table->faces->cell[2 * f + 1] < 0; k++) {
            at[count++] = (struct face_at_node){node[f * dim + k], f};
        }
    }
    qsort(at, (size_t)count, sizeof *at, compare_faces_at_nodes);
    for (int64_t i = 0; i < count; i++) {
        for (int64_t k = i + 1; k < count && at[k].node == at[i].node; k++) {
            int64_t f = at[i].face, g = at[k].face;
            bool ends = (held[f] && !touched[g]) || (held[g] && !touched[f]);
            if (ends && boundary_share_edge(dim, node + f * dim, node + g * dim) &&
                boundary_same_side(table, node + f * dim, node + g * dim) == (kind == BOUNDARY_END_SMOOTH)) {
                end[at[i].node] = true;
            }
        }
    }
done:
    free(at);
    return status;
}
