/* Where a held part of the boundary ends. */
#include "approx/boundary_private.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>

enum status boundary_find_ends(const struct face_table *table, enum boundary_end kind, const bool *held,
                               const bool *touched, bool *end, struct error *error)
{
    enum status status;
    int dim = table->dim;
    const int32_t *node = table->faces->node;
    int64_t count = table->faces->count, *ptr = NULL;
    int32_t *row = NULL, *at = NULL; /* faces of the boundary at each node */
    TRY(NEW_ARRAY(&row, count * dim, error));
    for (int64_t i = 0; i < count * dim; i++) {
        row[i] = table->faces->cell[2 * (i / dim) + 1] < 0 ? node[i] : -1;
    }
    TRY(lists_by_row(count, dim, row, table->node_count, &ptr, &at, error));
    for (int64_t n = 0; n < table->node_count; n++) {
        for (int64_t i = ptr[n]; i < ptr[n + 1]; i++) {
            for (int64_t k = i + 1; k < ptr[n + 1]; k++) {
                const int32_t *f = node + (int64_t)at[i] * dim, *g = node + (int64_t)at[k] * dim;
                bool ends = (held[at[i]] && !touched[at[k]]) || (held[at[k]] && !touched[at[i]]);
                if (ends && boundary_share_edge(dim, f, g) &&
                    boundary_same_side(table, f, g) == (kind == BOUNDARY_END_SMOOTH)) {
                    end[n] = true;
                }
            }
        }
    }
done:
    free(row);
    free(ptr);
    free(at);
    return status;
}
