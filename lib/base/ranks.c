#include "base/ranks.h"

#include "base/lists.h"
#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

int ranks_count(const struct ranks *ranks)
{
    return ranks != NULL ? ranks->count : 1;
}

int ranks_rank(const struct ranks *ranks)
{
    return ranks != NULL ? ranks->rank : 0;
}

void ranks_gather(const struct ranks *ranks, void *items, size_t size, const int64_t *first)
{
    if (ranks != NULL) {
        ranks->gather(ranks, items, size, first);
    }
}

int64_t ranks_most(const struct ranks *ranks, int64_t value)
{
    return ranks != NULL ? ranks->most(ranks, value) : value;
}

enum status ranks_agree(const struct ranks *ranks, enum status status, struct error *error)
{
    enum { NUMBERS = sizeof *error / sizeof(int64_t) };
    _Static_assert(NUMBERS * sizeof(int64_t) == sizeof *error, "a message is sent as numbers");
    int64_t first = status != STATUS_OK ? ranks_rank(ranks) : ranks_count(ranks), text[NUMBERS];
    if (ranks == NULL) {
        return status;
    }
    first = -ranks->most(ranks, -first);
    if (first == ranks->count) {
        return STATUS_OK;
    }
    memcpy(text, error, sizeof *error);
    for (int i = 0; i < NUMBERS; i++) {
        text[i] = ranks->most(ranks, first == ranks->rank ? text[i] : INT64_MIN);
    }
    memcpy(error, text, sizeof *error);
    return (enum status)ranks->most(ranks, first == ranks->rank ? (int64_t)status : 0);
}

enum status ranks_share(const struct ranks *ranks, int64_t items, const double *work, int64_t **first,
                        struct error *error)
{
    int count = ranks_count(ranks);
    double all = 0.0, sum = 0.0;
    int64_t item = 0;
    RETURN_IF_ERROR(NEW_ARRAY(first, count + 1, error));
    for (int64_t i = 0; i < items; i++) {
        all += work != NULL ? work[i] : 1.0;
    }
    for (int r = 1; r < count; r++) {
        for (; item < items && sum < all * r / count; item++) {
            sum += work != NULL ? work[item] : 1.0;
        }
        (*first)[r] = item;
    }
    (*first)[count] = items;
    return STATUS_OK;
}

int ranks_owner(const struct ranks *ranks, const int64_t *first, int64_t item)
{
    return (int)first_from(first, 1, ranks_count(ranks), item + 1) - 1;
}

enum status row_ranges_of(int64_t begin, int64_t end, const bool *wanted, struct row_ranges *ranges,
                          struct error *error)
{
    int64_t room = 0;
    *ranges = (struct row_ranges){0};
    for (int64_t r = begin; r < end; r++) {
        struct row_range *last = ranges->count > 0 ? &ranges->items[ranges->count - 1] : NULL;
        if (wanted != NULL && !wanted[r]) {
            continue;
        }
        if (last != NULL && last->end == r && r - last->begin < ROW_RANGE_MOST) {
            last->end++;
            continue;
        }
        RETURN_IF_ERROR(GROW_ARRAY(&ranges->items, ranges->count + 1, &room, error));
        ranges->items[ranges->count++] = (struct row_range){r, r + 1};
    }
    return STATUS_OK;
}

void row_ranges_free(struct row_ranges *ranges)
{
    free(ranges->items);
    *ranges = (struct row_ranges){0};
}

/* Exchange lists of any length: send[send_first[r]] to before send[send_first[r + 1]] goes to process r; what
 * it sends begins at (*receive)[(*receive_first)[r]]. */
static enum status exchange_lists(const struct ranks *ranks, const int32_t *send, const int64_t *send_first,
                                  int32_t **receive, int64_t **receive_first, struct error *error)
{
    int count = ranks->count;
    NEW_SCRATCH(int64_t, each, count, error);
    NEW_SCRATCH(int64_t, many, count, error);
    NEW_SCRATCH(int64_t, in_turn, count + 1, error);
    RETURN_IF_ERROR(NEW_ARRAY(receive_first, count + 1, error));
    for (int r = 0; r < count; r++) {
        in_turn[r + 1] = r + 1;
        each[r] = send_first[r + 1] - send_first[r];
    }
    ranks->exchange(ranks, sizeof *each, each, in_turn, many, in_turn);
    for (int r = 0; r < count; r++) {
        (*receive_first)[r + 1] = (*receive_first)[r] + many[r];
    }
    RETURN_IF_ERROR(NEW_ARRAY(receive, (*receive_first)[count], error));
    ranks->exchange(ranks, sizeof *send, send, send_first, *receive, *receive_first);
    return STATUS_OK;
}

enum status halo_build(const struct ranks *ranks, int64_t items, const bool *wanted, int width,
                       int (*owner)(const void *context, int64_t item), const void *context,
                       struct halo *halo, struct error *error)
{
    *halo = (struct halo){.ranks = ranks};
    if (ranks == NULL) {
        return STATUS_OK;
    }
    NEW_SCRATCH(int32_t, from, items, error);
    for (int64_t i = 0; i < items; i++) {
        int other = wanted[i] ? owner(context, i) : ranks->rank;
        from[i] = other != ranks->rank ? other : -1;
    }
    RETURN_IF_ERROR(lists_by_row(items, 1, from, ranks->count, &halo->receive_first, &halo->receive, error));
    RETURN_IF_ERROR(
        exchange_lists(ranks, halo->receive, halo->receive_first, &halo->send, &halo->send_first, error));
    RETURN_IF_ERROR(NEW_ARRAY(&halo->sent, halo->send_first[ranks->count] * width, error));
    return NEW_ARRAY(&halo->received, halo->receive_first[ranks->count] * width, error);
}

void halo_free(struct halo *halo)
{
    FREE_ALL(halo->send_first, halo->receive_first, halo->send, halo->receive, halo->sent, halo->received);
    *halo = (struct halo){0};
}

void halo_exchange(const struct halo *halo, int width, double *x)
{
    const struct ranks *ranks = halo->ranks;
    size_t size = (size_t)width * sizeof *x;
    if (ranks == NULL) {
        return;
    }
    for (int64_t i = 0; i < halo->send_first[ranks->count]; i++) {
        memcpy(halo->sent + i * width, x + (int64_t)halo->send[i] * width, size);
    }
    ranks->exchange(ranks, size, halo->sent, halo->send_first, halo->received, halo->receive_first);
    for (int64_t i = 0; i < halo->receive_first[ranks->count]; i++) {
        memcpy(x + (int64_t)halo->receive[i] * width, halo->received + i * width, size);
    }
}
