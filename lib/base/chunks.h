/* Division of a long loop into chunks for threads. The number of chunks and their limits depend only on the
 * length of the loop. So the sum of the chunks' partial sums, added in their order, has the same bits for any
 * number of threads. A loop too short for a second thread is one chunk. */
#pragma once

#include <stdint.h>

enum { CHUNKS_MOST = 64 };

struct chunks {
    int64_t items; /* of the loop */
    int64_t count; /* of chunks, 1 to CHUNKS_MOST */
    int threads;   /* worth using, at least 1 */
};

/* Divide a loop over `items`. There is at most one thread for every `worthwhile` items, as waking a thread
 * costs some ten microseconds. */
struct chunks chunks_of(int64_t items, int64_t worthwhile);

/* Divide a loop whose items are independent, so that its chunks may depend on the number of threads: one
 * chunk per thread. `work` is the work of all items; there is at most one thread for every `worthwhile` of
 * it. */
struct chunks chunks_for_threads(int64_t items, int64_t work, int64_t worthwhile);

/* First item of a chunk; that of chunk `count` is `items`. */
int64_t chunks_begin(const struct chunks *chunks, int64_t chunk);
