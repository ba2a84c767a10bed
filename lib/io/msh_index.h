/* Finding nodes and elements by their tags. */
#ifndef IO_MSH_INDEX_H
#define IO_MSH_INDEX_H

#include "base/status.h"
#include "io/msh_cursor.h"

#include <stdint.h>

/* The place of each tag in the order of the file. */
struct msh_index {
    int64_t count;
    int64_t *tag;   /* count, ascending */
    int64_t *place; /* count: place of tag[i]; NULL when the file is ascending: place i */
};

/* Index the tags; one that stands twice is an error, which says what the cursor's records are. */
MUST_CHECK enum status msh_index_make(struct msh_index *index, int64_t count, const int64_t tags[],
                                      struct msh_cursor *cursor);
void msh_index_free(struct msh_index *index);

/* Place of `tag`, or -1. */
int64_t msh_index_find(const struct msh_index *index, int64_t tag);

#endif
