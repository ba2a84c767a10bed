/* The regions of a stream's cells: their names, and which nodes belong to each. */
#ifndef TOOLS_REGIONS_H
#define TOOLS_REGIONS_H

#include "stages/views.h"

struct regions {
    int64_t node_count;
    struct names names;
    bool *member; /* node_count * names.count: a node is of the region of every cell at it */
};

/* None where the stream has no cells or no cells.region; to be freed also on failure. */
MUST_CHECK enum status regions_read(const struct stream *stream, const struct cells *cells,
                                    struct regions *regions, struct error *error);
void regions_free(struct regions *regions);

/* *chosen[node_count], allocated: the nodes of the region `name`, an error that lists the regions if there is
 * none; NULL (all nodes) without a name. */
MUST_CHECK enum status regions_choose(const struct regions *regions, const char *name, bool **chosen,
                                      struct error *error);

#endif
