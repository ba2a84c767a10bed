/* The entries that a slice of rows has in a sparse operator; private to sparse_operator. */
#ifndef SOLID_OPERATOR_ENTRIES_H
#define SOLID_OPERATOR_ENTRIES_H

#include "solid/sparse_operator.h"

/* The node of each row, and the caller's pair, or -1 for zeros. */
struct entry {
    int32_t node[OPERATOR_SLICE];
    int64_t pair[OPERATOR_SLICE];
};

/* Those of one slice at a time. */
struct entries {
    int64_t shared, own;
    struct entry *entry; /* shared, and own behind them */
    int32_t *node;       /* scratch: the slice's nodes, */
    int32_t *mask;       /* node_count: which of its rows have each, zero between slices, */
    int32_t *place;      /* node_count: and the shared entry of each, or -1 */
};

MUST_CHECK enum status entries_make(const struct operator_rows *rows, struct entries *entries,
                                    struct error *error);
void entries_free(struct entries *entries);

/* List the entries of `count` rows, those at the places from first on. */
void entries_list(const struct operator_rows *rows, int64_t first, int count, struct entries *entries);

#endif
