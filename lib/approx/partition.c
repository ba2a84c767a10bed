#include "approx/partition.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>

enum status cell_stars_build(const struct cells *cells, struct cell_stars *stars, struct error *error)
{
    *stars = (struct cell_stars){0};
    enum status status = lists_by_row(cells->count, cells->dim + 1, cells->node, cells->node_count,
                                      &stars->ptr, &stars->cell, error);
    if (status != STATUS_OK) {
        cell_stars_free(stars);
    }
    return status;
}

void cell_stars_free(struct cell_stars *stars)
{
    free(stars->ptr);
    free(stars->cell);
    *stars = (struct cell_stars){0};
}

int32_t partition_cell_owner(const struct cells *cells, int64_t cell, const int32_t *owner)
{
    const int32_t *node = cells->node + cell * (cells->dim + 1);
    int32_t best = -1;
    int most = 0;
    for (int k = 0; k <= cells->dim; k++) {
        int count = 0;
        for (int l = 0; l <= cells->dim; l++) {
            count += owner[node[l]] == owner[node[k]];
        }
        if (count > most) {
            most = count;
            best = owner[node[k]];
        }
    }
    return best;
}

enum status partition_own_cells(const struct partition *partition, int64_t **own_ptr, int32_t **own_cell,
                                struct error *error)
{
    enum status status;
    const struct cells *cells = partition->cells;
    int32_t *part = NULL;
    *own_ptr = NULL;
    *own_cell = NULL;
    TRY(NEW_ARRAY(&part, cells->count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        part[c] = partition_cell_owner(cells, c, partition->owner);
    }
    TRY(lists_by_row(cells->count, 1, part, partition->parts, own_ptr, own_cell, error));
done:
    free(part);
    if (status != STATUS_OK) {
        free(*own_ptr);
        free(*own_cell);
        *own_ptr = NULL;
        *own_cell = NULL;
    }
    return status;
}
