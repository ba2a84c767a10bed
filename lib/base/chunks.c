#include "base/chunks.h"

#include <omp.h>

struct chunks chunks_of(int64_t items, int64_t worthwhile)
{
    int64_t count = items / worthwhile, available = omp_get_max_threads();
    count = count > 1 ? count : 1;
    count = count < CHUNKS_MOST ? count : CHUNKS_MOST;
    return (struct chunks){items, count, (int)(count < available ? count : available)};
}

struct chunks chunks_for_threads(int64_t items, int64_t work, int64_t worthwhile)
{
    int threads = chunks_of(work, worthwhile).threads;
    return (struct chunks){items, threads, threads};
}

int64_t chunks_begin(const struct chunks *chunks, int64_t chunk)
{
    int64_t length = chunks->items / chunks->count, longer = chunks->items % chunks->count;
    return chunk * length + (chunk < longer ? chunk : longer);
}
