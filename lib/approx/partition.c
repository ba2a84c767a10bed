#include "approx/partition.h"

#include "base/memory.h"

#include <stdlib.h>

enum status cell_stars_build(const struct cells *cells, struct cell_stars *stars, struct error *error)
{
    enum status status;
    int vertices = cells->dim + 1;
    *stars = (struct cell_stars){0};
    TRY(NEW_ARRAY(&stars->ptr, cells->node_count + 2, error));
    TRY(NEW_ARRAY(&stars->cell, cells->count * vertices, error));
    for (int64_t i = 0; i < cells->count * vertices; i++) {
        stars->ptr[cells->node[i] + 2]++;
    }
    for (int64_t n = 1; n <= cells->node_count; n++) {
        stars->ptr[n + 1] += stars->ptr[n];
    }
    for (int64_t i = 0; i < cells->count * vertices; i++) {
        stars->cell[stars->ptr[cells->node[i] + 1]++] = (int32_t)(i / vertices);
    }
    return STATUS_OK;
done:
    cell_stars_free(stars);
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
    *own_ptr = NULL;
    *own_cell = NULL;
    TRY(NEW_ARRAY(own_ptr, partition->parts + 2, error));
    TRY(NEW_ARRAY(own_cell, cells->count, error));
    for (int64_t c = 0; c < cells->count; c++) {
        (*own_ptr)[partition_cell_owner(cells, c, partition->owner) + 2]++;
    }
    for (int32_t k = 1; k <= partition->parts; k++) {
        (*own_ptr)[k + 1] += (*own_ptr)[k];
    }
    for (int64_t c = 0; c < cells->count; c++) {
        (*own_cell)[(*own_ptr)[partition_cell_owner(cells, c, partition->owner) + 1]++] = (int32_t)c;
    }
    return STATUS_OK;
done:
    free(*own_ptr);
    free(*own_cell);
    *own_ptr = NULL;
    *own_cell = NULL;
    return status;
}
