#include "io/msh_index.h"

#include "base/memory.h"

#include <stdbool.h>
#include <stdlib.h>

struct tag_place {
    int64_t tag, place;
};

static int compare_tags(const void *left, const void *right)
{
    const struct tag_place *a = left;
    const struct tag_place *b = right;
    return (a->tag > b->tag) - (a->tag < b->tag);
}

static enum status index_sort(struct msh_index *index, const int64_t tags[], struct error *error)
{
    enum status status = STATUS_OK;
    struct tag_place *pairs = NULL;
    TRY(NEW_ARRAY(&pairs, index->count, error));
    TRY(NEW_ARRAY(&index->place, index->count, error));
    for (int64_t i = 0; i < index->count; i++) {
        pairs[i] = (struct tag_place){tags[i], i};
    }
    qsort(pairs, (size_t)index->count, sizeof *pairs, compare_tags);
    for (int64_t i = 0; i < index->count; i++) {
        index->tag[i] = pairs[i].tag;
        index->place[i] = pairs[i].place;
    }
done:
    free(pairs);
    return status;
}

enum status msh_index_make(struct msh_index *index, int64_t count, const int64_t tags[],
                           struct msh_cursor *cursor)
{
    enum status status = STATUS_OK;
    bool ascending = true;
    index->count = count;
    TRY(NEW_ARRAY(&index->tag, count, cursor->error));
    for (int64_t i = 0; i < count; i++) {
        index->tag[i] = tags[i];
        ascending = ascending && (i == 0 || tags[i] > tags[i - 1]);
    }
    if (!ascending) {
        TRY(index_sort(index, tags, cursor->error));
    }
    for (int64_t i = 1; i < count; i++) {
        if (index->tag[i] == index->tag[i - 1]) {
            cursor->record = 0;
            status =
                msh_cursor_fail(cursor, "%s tag %lld stands twice", cursor->kind, (long long)index->tag[i]);
            goto done;
        }
    }
done:
    return status;
}

int64_t msh_index_find(const struct msh_index *index, int64_t tag)
{
    int64_t low = 0;
    int64_t high = index->count - 1;
    if (high < 0 || tag < index->tag[0] || tag > index->tag[high]) {
        return -1;
    }
    if (index->tag[high] - index->tag[0] == high) { /* no gaps */
        low = high = tag - index->tag[0];
    }
    while (low < high) {
        int64_t middle = low + (high - low) / 2;
        if (index->tag[middle] < tag) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    if (index->tag[low] != tag) {
        return -1;
    }
    return index->place != NULL ? index->place[low] : low;
}

void msh_index_free(struct msh_index *index)
{
    free(index->tag);
    free(index->place);
    *index = (struct msh_index){0};
}
