/* Which rows of a block go together: pairs_order. Sets of nodes are bits, numbered within the block. */
#include "solid/pairs.h"

#include "base/memory.h"
#include "solid/pairs_entries.h"

#include <stdlib.h>
#include <string.h>

/* Rows that are looked at for the next of a group: the rest is farther along the curve. */
enum { WINDOW = 64 };

struct block_sets {
    int32_t *local_of; /* node_count: number of each node in the block, or -1 */
    int32_t *node;     /* those numbered: local_count */
    int64_t local_count, words;
    uint64_t *bits; /* PAIRS_MAX_ROWS sets of `words` */
    int64_t capacity;
};

static int64_t count_bits(uint64_t x)
{
    x -= x >> 1 & 0x5555555555555555;
    x = (x & 0x3333333333333333) + (x >> 2 & 0x3333333333333333);
    x = (x + (x >> 4)) & 0x0f0f0f0f0f0f0f0f;
    return (int64_t)(x * 0x0101010101010101 >> 56);
}

/* The nodes of each row of a block. */
static enum status find_sets(const struct pairs_rows *rows, int64_t block, struct block_sets *sets,
                             struct error *error)
{
    int64_t first = rows->first_row[block], count = rows->first_row[block + 1] - first;
    sets->local_count = 0;
    for (int64_t r = first; r < first + count; r++) {
        for (int64_t i = rows->ptr[rows->row[r]]; i < rows->ptr[rows->row[r] + 1]; i++) {
            if (sets->local_of[rows->idx[i]] < 0) {
                sets->node[sets->local_count] = rows->idx[i];
                sets->local_of[rows->idx[i]] = (int32_t)sets->local_count++;
            }
        }
    }
    sets->words = sets->local_count / 64 + 1;
    if (sets->words > sets->capacity) {
        sets->capacity = 2 * sets->words;
        free(sets->bits);
        enum status status = NEW_ARRAY(&sets->bits, PAIRS_MAX_ROWS * sets->capacity, error);
        if (status != STATUS_OK) {
            return status;
        }
    }
    memset(sets->bits, 0, (size_t)(count * sets->words) * sizeof *sets->bits);
    for (int64_t r = 0; r < count; r++) {
        int64_t row = rows->row[first + r];
        for (int64_t i = rows->ptr[row]; i < rows->ptr[row + 1]; i++) {
            int32_t local = sets->local_of[rows->idx[i]];
            sets->bits[r * sets->words + local / 64] |= (uint64_t)1 << local % 64;
        }
    }
    for (int64_t i = 0; i < sets->local_count; i++) {
        sets->local_of[sets->node[i]] = -1;
    }
    return STATUS_OK;
}

/* Of the rows left, order[first .. count], that which adds the fewest nodes to a set. */
static int64_t nearest_row(const struct block_sets *sets, const uint64_t *set, const int64_t *order,
                           int64_t first, int64_t count)
{
    int64_t best = first, fewest = INT64_MAX;
    for (int64_t i = first; i < count && i < first + WINDOW; i++) {
        const uint64_t *bits = sets->bits + order[i] * sets->words;
        int64_t added = 0;
        for (int64_t w = 0; w < sets->words; w++) {
            added += count_bits(bits[w] & ~set[w]);
        }
        if (added < fewest) {
            fewest = added;
            best = i;
        }
    }
    return best;
}

/* order[count]: the rows of a block, in fours that share most nodes. */
static void form_groups(const struct block_sets *sets, int64_t count, uint64_t *set, int64_t *order)
{
    for (int64_t r = 0; r < count; r++) {
        order[r] = r;
    }
    for (int64_t r = 0; r < count / PAIRS_GROUP * PAIRS_GROUP; r++) {
        int64_t at = r;
        if (r % PAIRS_GROUP == 0) {
            memset(set, 0, (size_t)sets->words * sizeof *set);
        } else {
            at = nearest_row(sets, set, order, r, count);
        }
        int64_t next = order[at];
        memmove(order + r + 1, order + r, (size_t)(at - r) * sizeof *order);
        order[r] = next;
        for (int64_t w = 0; w < sets->words; w++) {
            set[w] |= sets->bits[next * sets->words + w];
        }
    }
}

/* A group and what it is sorted by. */
struct row_group {
    int64_t key, first, row[PAIRS_GROUP];
};

static int compare_groups(const void *left, const void *right)
{
    const struct row_group *a = left, *b = right;
    if (a->key != b->key) {
        return a->key < b->key ? -1 : 1;
    }
    return (a->first > b->first) - (a->first < b->first);
}

/* Groups of a block that are worked on alike one after the other; a last one that is short stays last. */
static void sort_groups(const struct pairs_rows *rows, const int32_t *corners, int64_t block,
                        struct entries *entries)
{
    struct row_group groups[PAIRS_MAX_ROWS / PAIRS_GROUP];
    int64_t first = rows->first_row[block], count = (rows->first_row[block + 1] - first) / PAIRS_GROUP;
    for (int64_t g = 0; g < count; g++) {
        int64_t at = first + g * PAIRS_GROUP, most_corners = 0;
        for (int r = 0; corners != NULL && r < PAIRS_GROUP; r++) {
            int64_t own = corners[rows->row[at + r]];
            most_corners = own > most_corners ? own : most_corners;
        }
        entries_list(rows, at, PAIRS_GROUP, entries);
        groups[g].key = most_corners << 40 | entries->shared << 20 | entries->own;
        groups[g].first = at;
        memcpy(groups[g].row, rows->row + at, sizeof groups[g].row);
    }
    qsort(groups, (size_t)count, sizeof *groups, compare_groups);
    for (int64_t g = 0; g < count; g++) {
        memcpy(rows->row + first + g * PAIRS_GROUP, groups[g].row, sizeof groups[g].row);
    }
}

enum status pairs_order(const struct pairs_rows *rows, const int32_t *corners, struct error *error)
{
    enum status status;
    struct block_sets sets = {0};
    struct entries entries = {0};
    uint64_t *set = NULL;
    TRY(NEW_ARRAY(&sets.local_of, rows->node_count, error));
    TRY(NEW_ARRAY(&sets.node, rows->node_count, error));
    TRY(NEW_ARRAY(&set, rows->node_count / 64 + 1, error));
    TRY(entries_make(rows, &entries, error));
    memset(sets.local_of, -1, (size_t)rows->node_count * sizeof *sets.local_of);
    for (int64_t b = 0; b < rows->block_count; b++) {
        int64_t order[PAIRS_MAX_ROWS], ordered[PAIRS_MAX_ROWS];
        int64_t *row = rows->row + rows->first_row[b], count = rows->first_row[b + 1] - rows->first_row[b];
        TRY(find_sets(rows, b, &sets, error));
        form_groups(&sets, count, set, order);
        for (int64_t r = 0; r < count; r++) {
            ordered[r] = row[order[r]];
        }
        memcpy(row, ordered, (size_t)count * sizeof *row);
        sort_groups(rows, corners, b, &entries);
    }
done:
    entries_free(&entries);
    free(sets.local_of);
    free(sets.node);
    free(sets.bits);
    free(set);
    return status;
}
