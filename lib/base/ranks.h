/* Processes ("ranks" of MPI) that compute one body together. Each holds its own rows of the large tables, and
 * whole nodal vectors. All run the same program on the same input in the same order. They exchange the parts
 * of a vector that each has computed; then each sums over the whole vector in the order of a single process.
 * So the results have the same bits for any number of processes.
 *
 * The caller supplies the communication (tools/mpi); the library does not depend on MPI. NULL in place of a
 * struct ranks means a single process: nothing is sent or copied. */
#pragma once

#include "base/status.h"

#include <stdbool.h>
#include <stdint.h>

struct ranks {
    int count, rank; /* this process is rank 0 .. count - 1 */
    /* All-gather of items[first[count]], of `size` bytes each. Process r contributes items first[r] to before
     * first[r + 1]; with first == NULL, each process contributes one. */
    void (*gather)(const struct ranks *ranks, void *items, size_t size, const int64_t *first);
    /* send[send_first[r]] to before send[send_first[r + 1]] goes to process r; what process r sends is stored
     * from receive[receive_first[r]] on. Processes that exchange nothing do not wait for each other. */
    void (*exchange)(const struct ranks *ranks, size_t size, const void *send, const int64_t *send_first,
                     void *receive, const int64_t *receive_first);
    /* The maximum of `value` over all processes. */
    int64_t (*most)(const struct ranks *ranks, int64_t value);
    void *context;
};

int ranks_count(const struct ranks *ranks); /* 1 for NULL */
int ranks_rank(const struct ranks *ranks);  /* 0 for NULL */

/* Call the members; for a single process gather does nothing, and most returns the value. */
void ranks_gather(const struct ranks *ranks, void *items, size_t size, const int64_t *first);
int64_t ranks_most(const struct ranks *ranks, int64_t value);

/* Collective. Returns on all processes the status and message of the first process that failed, or STATUS_OK,
 * so that all go on or fail together. A single process gets its own status. */
MUST_CHECK enum status ranks_agree(const struct ranks *ranks, enum status status, struct error *error);

/* Divide a list of items into one range of about the same work for each process: (*first)[count + 1], to be
 * freed. work[items] >= 0; NULL: the same for all. */
MUST_CHECK enum status ranks_share(const struct ranks *ranks, int64_t items, const double *work,
                                   int64_t **first, struct error *error);

/* The process whose range an item is in. */
int ranks_owner(const struct ranks *ranks, const int64_t *first, int64_t item);

/* Ranges of rows of a table, each of at most ROW_RANGE_MOST rows: work for one thread. */
struct row_range {
    int64_t begin, end;
};
struct row_ranges {
    int64_t count;
    struct row_range *items;
};
enum { ROW_RANGE_MOST = 256 };

/* The rows r of [begin, end) with wanted[r] (NULL: all), as ranges. */
MUST_CHECK enum status row_ranges_of(int64_t begin, int64_t end, const bool *wanted,
                                     struct row_ranges *ranges, struct error *error);
void row_ranges_free(struct row_ranges *ranges);

/* Halo exchange: the items of a vector that this process needs from others, and those that others need from
 * it. */
struct halo {
    const struct ranks *ranks;
    int64_t *send_first, *receive_first; /* count + 1 */
    int32_t *send, *receive;             /* the items */
    double *sent, *received;             /* scratch */
};

/* Set up the exchange of the items i with wanted[i], 0 <= i < items, that belong to other processes;
 * owner(context, i) is the process that item i belongs to. Vectors have at most `width` numbers per item.
 * Collective. */
MUST_CHECK enum status halo_build(const struct ranks *ranks, int64_t items, const bool *wanted, int width,
                                  int (*owner)(const void *context, int64_t item), const void *context,
                                  struct halo *halo, struct error *error);
void halo_free(struct halo *halo);

/* Receive the `width` numbers from x[item * width] on of the items of other processes. */
void halo_exchange(const struct halo *halo, int width, double *x);
