#include "solid/system/sliding.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

void sliding_free(struct sliding *sliding)
{
    FREE_ALL(sliding->row, sliding->facet);
    *sliding = (struct sliding){0};
}

enum status sliding_add_row(struct sliding *sliding, int64_t row, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&sliding->row, sliding->row_count + 1, &sliding->row_room, error));
    sliding->row[sliding->row_count++] = row;
    return STATUS_OK;
}

enum status sliding_add_facet(struct sliding *sliding, int dim, const int32_t *node, struct error *error)
{
    RETURN_IF_ERROR(GROW_ARRAY(&sliding->facet, sliding->facet_count + 1, &sliding->facet_room, error));
    memcpy(sliding->facet[sliding->facet_count++], node, (size_t)dim * sizeof *node);
    return STATUS_OK;
}
