/* Processes that compute one body together, each its own rows of the large tables ("ranks", as MPI calls
 * them). All run the same program on the same input in the same order, and hold whole vectors of the nodes;
 * what each has computed of a vector they give each other, and then each sums over all of it, in the order in
 * which one process does. So all have the same bits, as one process has, whatever their number.
 *
 * How they talk is the caller's (tools/mpi): the library knows no MPI. NULL in the place of a struct ranks is
 * one process: nothing is sent, nothing is copied. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct ranks {
    int count, rank; /* this process is rank 0 .. count - 1 */
    /* items[first[count]], of `size` bytes each: those from first[r] to before first[r + 1] are what process
     * r has; afterwards all have all. NULL: each has one. */
    void (*gather)(const struct ranks *ranks, void *items, size_t size, const int64_t *first);
    /* send[send_first[r]] to before send[send_first[r + 1]] goes to process r, and what comes from it to
     * receive[receive_first[r]] and behind. Processes that have nothing for each other do not wait. */
    void (*exchange)(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                     void *receive, const int64_t *receive_first);
    /* The same in two halves, between which the process goes on computing, and calls no other of these. */
    void (*begin)(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                  void *receive, const int64_t *receive_first);
    void (*finish)(const struct ranks *ranks);
    /* x[count] to process `to`; and from process `from`. */
    void (*send)(const struct ranks *ranks, int to, const double *x, int64_t count);
    void (*receive)(const struct ranks *ranks, int from, double *x, int64_t count);
    /* The largest of the values that the processes have. */
    int64_t (*most)(const struct ranks *ranks, int64_t value);
    void *context;
};

int ranks_count(const struct ranks *ranks); /* 1 for NULL */
int ranks_rank(const struct ranks *ranks);  /* 0 for NULL */

/* The same as the members; of one process nothing, and the value. */
void ranks_gather(const struct ranks *ranks, void *items, size_t size, const int64_t *first);
int64_t ranks_most(const struct ranks *ranks, int64_t value);

/* What the first process that failed has to say, to all: its status and message, or STATUS_OK. All call this
 * together, and go on or fail alike; of one process it is its own status. */
MUST_CHECK enum status ranks_agree(const struct ranks *ranks, enum status status, struct error *error);

/* each[count]: the values that the processes have, in their order; to be freed. */
MUST_CHECK enum status ranks_list(const struct ranks *ranks, int64_t value, int64_t **each,
                                  struct error *error);

/* What goes to each process, send[send_first[r]] to before send[send_first[r + 1]], and what comes from each:
 * (*receive)[(*receive_first)[count]], (*receive_first)[count + 1], to be freed, also on failure. All
 * processes call this together; `ranks` is not NULL. */
MUST_CHECK enum status ranks_exchange_lists(const struct ranks *ranks, const int64_t *send,
                                            const int64_t *send_first, int64_t **receive,
                                            int64_t **receive_first, struct error *error);

/* Cut a list of items into stretches of about the same work, one for each process: first[count + 1], to be
 * freed. work[items] is not negative; NULL: all alike. */
MUST_CHECK enum status ranks_share(const struct ranks *ranks, int64_t items, const double *work,
                                   int64_t **first, struct error *error);

/* Which stretch an item is in. */
int ranks_owner(const struct ranks *ranks, const int64_t *first, int64_t item);

/* Rows of a table, as stretches that are short enough to be a thread's work. */
struct row_range {
    int64_t begin, end;
};
struct row_ranges {
    int64_t count;
    struct row_range *items;
};
enum { ROW_RANGE_MOST = 256 };

/* The rows from `begin` to before `end` that are wanted (wanted[end]; NULL: all). */
MUST_CHECK enum status row_ranges_of(int64_t begin, int64_t end, const bool *wanted,
                                     struct row_ranges *ranges, struct error *error);
void row_ranges_free(struct row_ranges *ranges);

/* Items of a vector that other processes compute and this one needs, and the other way about. */
struct halo {
    const struct ranks *ranks;
    int64_t *send_first, *receive_first; /* count + 1 */
    int64_t *send, *receive;             /* the items */
    double *sent, *received;             /* scratch */
};

/* The items of 0 .. items - 1 that are wanted here and belong to others: `owner` tells to whom. Vectors have
 * at most `width` numbers for each item. All processes call this together. */
MUST_CHECK enum status halo_build(const struct ranks *ranks, int64_t items, const bool *wanted, int width,
                                  int (*owner)(const void *context, int64_t item), const void *context,
                                  struct halo *halo, struct error *error);
void halo_free(struct halo *halo);

/* x[item * width] and behind it, for the items of others: in two halves, between which other items of x may
 * change; and at once. */
void halo_begin(const struct halo *halo, int width, const double *x);
void halo_finish(const struct halo *halo, int width, double *x);
void halo_exchange(const struct halo *halo, int width, double *x);
