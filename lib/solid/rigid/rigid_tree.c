/* A tree of boxes over the facets of a rigid surface, halved recursively along the longest side. */
#include "base/lists.h"
#include "base/memory.h"
#include "solid/rigid/rigid_private.h"

#include <stdlib.h>

enum { LEAF_FACETS = 4 };

static struct box facet_box(const struct rigid_surface *surface, int64_t f)
{
    int dim = surface->dim;
    struct box box = box_of(dim, 0, NULL);
    for (int k = 0; k < dim; k++) {
        box_add(&box, 1, surface->vertex + (int64_t)surface->facet[f * dim + k] * dim);
    }
    return box;
}

/* The branch of the facets placed[first] to before placed[end], with all branches below it. Halves differ by
 * at most one facet, so the depth is at most the number of bits of the facet count. */
static void grow(struct rigid_surface *surface, struct placed *placed, int64_t first, int64_t end)
{
    int64_t at = surface->branch_count++;
    struct rigid_branch *branch = &surface->branch[at];
    struct box box = box_of(surface->dim, 0, NULL);
    int longest = 0;
    for (int64_t i = first; i < end; i++) {
        struct box facet = facet_box(surface, placed[i].item);
        box_add(&box, 1, facet.low);
        box_add(&box, 1, facet.high);
    }
    for (int a = 0; a < surface->dim; a++) {
        branch->low[a] = box.low[a];
        branch->high[a] = box.high[a];
        longest = box.high[a] - box.low[a] > box.high[longest] - box.low[longest] ? a : longest;
    }
    branch->first = first;
    branch->end = end;
    if (end - first > LEAF_FACETS) {
        int64_t middle = first + (end - first) / 2;
        for (int64_t i = first; i < end; i++) {
            struct box facet = facet_box(surface, placed[i].item);
            placed[i].place = 0.5 * (facet.low[longest] + facet.high[longest]);
        }
        qsort(placed + first, (size_t)(end - first), sizeof *placed, compare_placed);
        grow(surface, placed, first, middle);
        surface->branch[at].second = surface->branch_count;
        grow(surface, placed, middle, end);
    }
}

enum status rigid_grow_tree(struct rigid_surface *surface, struct error *error)
{
    int64_t count = surface->facet_count;
    NEW_SCRATCH(struct placed, placed, count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&surface->branch, 2 * count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->in_order, count, error));
    for (int64_t f = 0; f < count; f++) {
        placed[f].item = f;
    }
    grow(surface, placed, 0, count);
    for (int64_t i = 0; i < count; i++) {
        surface->in_order[i] = (int32_t)placed[i].item;
    }
    return STATUS_OK;
}
