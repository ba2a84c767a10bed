#include "solid/operator_entries.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum status entries_make(const struct operator_rows *rows, struct entries *entries, struct error *error)
{
    enum status status;
    int64_t most = 0;
    for (int64_t r = 0; r < rows->row_count; r++) {
        int64_t count = rows->ptr[r + 1] - rows->ptr[r];
        most = count > most ? count : most;
    }
    *entries = (struct entries){0};
    TRY(NEW_ARRAY(&entries->entry, most * OPERATOR_SLICE, error));
    TRY(NEW_ARRAY(&entries->node, most * OPERATOR_SLICE, error));
    TRY(NEW_ARRAY(&entries->mask, rows->node_count, error));
    TRY(NEW_ARRAY(&entries->place, rows->node_count, error));
done:
    return status;
}

void entries_free(struct entries *entries)
{
    free(entries->entry);
    free(entries->node);
    free(entries->mask);
    free(entries->place);
    *entries = (struct entries){0};
}

static int count_rows(int32_t mask)
{
    return (mask & 1) + (mask >> 1 & 1) + (mask >> 2 & 1) + (mask >> 3 & 1);
}

/* The nodes of the rows; how many. */
static int64_t find_nodes(const struct operator_rows *rows, const int64_t *row, int count,
                          struct entries *entries)
{
    int64_t nodes = 0;
    for (int r = 0; r < count; r++) {
        for (int64_t i = rows->ptr[row[r]]; i < rows->ptr[row[r] + 1]; i++) {
            if (entries->mask[rows->idx[i]] == 0) {
                entries->node[nodes++] = rows->idx[i];
            }
            entries->mask[rows->idx[i]] |= 1 << r;
        }
    }
    return nodes;
}

/* Whether the rows in a mask have all less than that many. */
static bool have_room(int32_t mask, const int64_t count[OPERATOR_SLICE], int64_t most)
{
    for (int r = 0; r < OPERATOR_SLICE; r++) {
        if ((mask >> r & 1) != 0 && count[r] == most) {
            return false;
        }
    }
    return true;
}

/* Share the nodes of enough rows, but for those that fit where the rows' own entries have zeros. */
static void share_nodes(const struct operator_rows *rows, int64_t nodes, struct entries *entries)
{
    int64_t own[OPERATOR_SLICE] = {0}, most = 0;
    for (int64_t n = 0; n < nodes; n++) {
        int32_t mask = entries->mask[entries->node[n]];
        for (int r = 0; r < OPERATOR_SLICE && count_rows(mask) < rows->least_sharing; r++) {
            own[r] += mask >> r & 1;
            most = own[r] > most ? own[r] : most;
        }
    }
    entries->shared = 0;
    for (int64_t n = 0; n < nodes; n++) {
        int32_t node = entries->node[n], mask = entries->mask[node];
        entries->place[node] = -1;
        if (count_rows(mask) < rows->least_sharing) {
            continue;
        }
        if (count_rows(mask) < OPERATOR_SLICE && have_room(mask, own, most)) {
            for (int r = 0; r < OPERATOR_SLICE; r++) {
                own[r] += mask >> r & 1;
            }
            continue;
        }
        entries->place[node] = (int32_t)entries->shared;
        for (int r = 0; r < OPERATOR_SLICE; r++) {
            entries->entry[entries->shared].node[r] = node;
            entries->entry[entries->shared].pair[r] = -1;
        }
        entries->shared++;
    }
}

void entries_list(const struct operator_rows *rows, int64_t first, int count, struct entries *entries)
{
    const int64_t *row = rows->row + first;
    int64_t nodes = find_nodes(rows, row, count, entries);
    share_nodes(rows, nodes, entries);
    struct entry *own = entries->entry + entries->shared;
    entries->own = 0;
    for (int r = 0; r < count; r++) {
        int64_t at = 0;
        for (int64_t i = rows->ptr[row[r]]; i < rows->ptr[row[r] + 1]; i++) {
            int32_t node = rows->idx[i];
            if (entries->place[node] >= 0) {
                entries->entry[entries->place[node]].pair[r] = i;
                continue;
            }
            if (at == entries->own) { /* rows at their end take any node: this one */
                for (int k = 0; k < OPERATOR_SLICE; k++) {
                    own[at].node[k] = node;
                    own[at].pair[k] = -1;
                }
                entries->own++;
            }
            own[at].node[r] = node;
            own[at++].pair[r] = i;
        }
    }
    for (int64_t n = 0; n < nodes; n++) {
        entries->mask[entries->node[n]] = 0;
    }
}
