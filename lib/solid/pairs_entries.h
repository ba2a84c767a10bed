/* The entries that a group of rows has in a table of pairs; private to pairs. */
#ifndef SOLID_PAIRS_ENTRIES_H
#define SOLID_PAIRS_ENTRIES_H

#include "solid/pairs.h"

/* The node of each row, and the caller's pair, or -1 for zeros. */
struct entry {
    int32_t node[PAIRS_GROUP];
    int64_t pair[PAIRS_GROUP];
};

/* Those of one group at a time. */
struct entries {
    int64_t shared, own;
    struct entry *entry; /* shared, and own behind them */
    int32_t *node;       /* scratch: the group's nodes, */
    int32_t *mask;       /* node_count: which of its rows have each, zero between groups, */
    int32_t *place;      /* node_count: and the shared entry of each, or -1 */
};

MUST_CHECK enum status entries_make(const struct pairs_rows *rows, struct entries *entries,
                                    struct error *error);
void entries_free(struct entries *entries);

/* List the entries of `count` rows, those at the places from first on. */
void entries_list(const struct pairs_rows *rows, int64_t first, int count, struct entries *entries);

#endif
