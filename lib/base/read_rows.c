#include "base/read_rows.h"

#include "base/memory.h"

#include <string.h>

/* Numbers of rows for each process. */
struct row_lists {
    int64_t *first; /* count + 1 */
    int64_t *row;
};

static void free_lists(struct row_lists *lists)
{
    FREE_ALL(lists->first, lists->row);
}

/* For each process, list the rows read here that have an entry in its columns. */
static enum status list_rows(const struct read_rows *rows, int (*owner)(const void *, int64_t),
                             const void *context, struct row_lists *lists, struct error *error)
{
    int count = rows->ranks->count;
    SCRATCH int64_t *seen = NULL, *next = NULL; /* of each process: 1 + the last row that was listed */
    RETURN_IF_ERROR(NEW_ARRAY(&seen, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&next, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&lists->first, count + 1, error));
    for (int pass = 0; pass < 2; pass++) {
        memset(seen, 0, (size_t)count * sizeof *seen);
        for (int64_t f = 0; f < rows->row_count; f++) {
            for (int64_t i = rows->ptr[f]; i < rows->ptr[f + 1]; i++) {
                int to = owner(context, rows->idx[i]);
                if (seen[to] != f + 1) {
                    seen[to] = f + 1;
                    if (pass == 1) {
                        lists->row[next[to]] = f;
                    }
                    next[to]++;
                }
            }
        }
        if (pass == 0) {
            for (int r = 0; r < count; r++) {
                lists->first[r + 1] = lists->first[r] + next[r];
            }
            memcpy(next, lists->first, (size_t)count * sizeof *next);
            RETURN_IF_ERROR(NEW_ARRAY(&lists->row, lists->first[count], error));
        }
    }
    return STATUS_OK;
}

enum status read_rows_with(const struct read_rows *rows, int (*owner)(const void *context, int64_t column),
                           const void *context, bool *wanted, struct error *error)
{
    enum status status;
    struct row_lists sent = {0}, got = {0};
    TRY(list_rows(rows, owner, context, &sent, error));
    TRY(ranks_exchange_lists(rows->ranks, sent.row, sent.first, &got.row, &got.first, error));
    for (int64_t i = 0; i < got.first[rows->ranks->count]; i++) {
        wanted[got.row[i]] = true;
    }
done:
    free_lists(&sent);
    free_lists(&got);
    return status;
}

static int reader_of(const void *context, int64_t row)
{
    return ((const struct read_rows *)context)->reader[row];
}

static int64_t length_of(const struct read_rows *rows, int64_t row)
{
    return rows->ptr[row + 1] - rows->ptr[row];
}

/* Set fetched->ptr and allocate the rows; the halo lists the rows that other processes have. */
static enum status lay_out(const struct read_rows *rows, const bool *wanted, struct halo *halo,
                           struct sparse *fetched, struct error *error)
{
    int64_t at = 0;
    NEW_SCRATCH(double, length, rows->row_count, error);
    for (int64_t f = 0; f < rows->row_count; f++) {
        length[f] = (double)length_of(rows, f);
    }
    halo_exchange(halo, 1, length);
    for (int64_t f = 0; f < rows->row_count; f++) {
        length[f] = wanted[f] ? length[f] : 0.0;
        at += (int64_t)length[f];
    }
    RETURN_IF_ERROR(sparse_new(rows->row_count, rows->column_count, at, fetched, error));
    for (int64_t f = 0; f < rows->row_count; f++) {
        fetched->ptr[f + 1] = fetched->ptr[f] + (int64_t)length[f];
    }
    return STATUS_OK;
}

/* Copy entries of `size` bytes to their rows in `to`: own rows from `from`, and those of other processes. */
static enum status send_entries(const struct read_rows *rows, const bool *wanted, const struct halo *halo,
                                const struct sparse *fetched, size_t size, const char *from, char *to,
                                struct error *error)
{
    const struct ranks *ranks = rows->ranks;
    NEW_SCRATCH(int64_t, send_first, ranks->count + 1, error);
    NEW_SCRATCH(int64_t, first, ranks->count + 1, error);
    for (int r = 0; r < ranks->count; r++) {
        send_first[r + 1] = send_first[r];
        first[r + 1] = first[r];
        for (int64_t i = halo->send_first[r]; i < halo->send_first[r + 1]; i++) {
            send_first[r + 1] += length_of(rows, halo->send[i]);
        }
        for (int64_t i = halo->receive_first[r]; i < halo->receive_first[r + 1]; i++) {
            first[r + 1] += fetched->ptr[halo->receive[i] + 1] - fetched->ptr[halo->receive[i]];
        }
    }
    NEW_SCRATCH(char, sent, send_first[ranks->count] * (int64_t)size, error);
    NEW_SCRATCH(char, got, first[ranks->count] * (int64_t)size, error);
    char *at = sent;
    for (int64_t i = 0; i < halo->send_first[ranks->count]; i++) {
        size_t bytes = (size_t)length_of(rows, halo->send[i]) * size;
        memcpy(at, from + (size_t)rows->ptr[halo->send[i]] * size, bytes);
        at += bytes;
    }
    ranks->exchange(ranks, size, sent, send_first, got, first);
    at = got;
    for (int64_t i = 0; i < halo->receive_first[ranks->count]; i++) {
        int64_t row = halo->receive[i], begin = fetched->ptr[row];
        size_t bytes = (size_t)(fetched->ptr[row + 1] - begin) * size;
        memcpy(to + (size_t)begin * size, at, bytes);
        at += bytes;
    }
    for (int64_t f = 0; f < rows->row_count; f++) {
        if (wanted[f] && rows->reader[f] == ranks->rank) {
            memcpy(to + (size_t)fetched->ptr[f] * size, from + (size_t)rows->ptr[f] * size,
                   (size_t)length_of(rows, f) * size);
        }
    }
    return STATUS_OK;
}

enum status read_rows_fetch(const struct read_rows *rows, const bool *wanted, struct sparse *fetched,
                            struct error *error)
{
    FREED_BY(halo_free) struct halo halo = {0};
    *fetched = (struct sparse){0};
    RETURN_IF_ERROR(halo_build(rows->ranks, rows->row_count, wanted, 1, reader_of, rows, &halo, error));
    RETURN_IF_ERROR(lay_out(rows, wanted, &halo, fetched, error));
    RETURN_IF_ERROR(send_entries(rows, wanted, &halo, fetched, sizeof *rows->idx, (const char *)rows->idx,
                                 (char *)fetched->idx, error));
    return send_entries(rows, wanted, &halo, fetched, sizeof *rows->value, (const char *)rows->value,
                        (char *)fetched->value, error);
}
