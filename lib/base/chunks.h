/* How threads share a long loop: in chunks. How many there are and where they begin depends on the length of
 * the loop alone, so that a sum of the chunks' sums, added in their order, has the same bits for any number
 * of threads. A loop that is not worth a second thread is one chunk: a plain sum. */
#pragma once

#include <stdint.h>

enum { CHUNKS_MOST = 64 };

struct chunks {
    int64_t items; /* of the loop */
    int64_t count; /* of chunks, 1 to CHUNKS_MOST */
    int threads;   /* worth using, at least 1 */
};

/* Cut a loop over so many items, of which `worthwhile` are worth the while of a thread: waking one costs some
 * ten microseconds. */
struct chunks chunks_of(int64_t items, int64_t worthwhile);

/* The same of a loop whose items know nothing of each other, so that it may be cut anywhere: a chunk for each
 * thread. `work` is that of all items, of which `worthwhile` is worth the while of a thread. */
struct chunks chunks_for_threads(int64_t items, int64_t work, int64_t worthwhile);

/* First item of a chunk; that of chunk `count` is `items`. */
int64_t chunks_begin(const struct chunks *chunks, int64_t chunk);
