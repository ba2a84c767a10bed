/* Chunks cover a loop, alike for any number of threads. */
#include "unit.h"

#include "base/chunks.h"

/* Each item lies in one chunk, and chunks differ by one item at most. */
static void check_cover(const struct chunks *chunks, int64_t items)
{
    int64_t least = items / chunks->count;
    assert_int_equal(chunks_begin(chunks, 0), 0);
    assert_int_equal(chunks_begin(chunks, chunks->count), items);
    for (int64_t c = 0; c < chunks->count; c++) {
        int64_t length = chunks_begin(chunks, c + 1) - chunks_begin(chunks, c);
        assert_true(length == least || length == least + 1);
    }
}

TEST(cover)
{
    static const int64_t lengths[] = {0, 1, 99, 199, 200, 301, 6400, 6499, 100000, INT64_MAX / 2};
    int before = omp_get_max_threads();
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++) {
        int64_t first = 0;
        for (int threads = 1; threads <= 3; threads++) {
            omp_set_num_threads(threads);
            struct chunks chunks = chunks_of(lengths[i], 100);
            check_cover(&chunks, lengths[i]);
            assert_in_range(chunks.count, 1, CHUNKS_MOST);
            assert_in_range(chunks.threads, 1, threads);
            assert_true(chunks.threads <= chunks.count);
            first = threads == 1 ? chunks.count : first;
            assert_int_equal(chunks.count, first);
        }
    }
    omp_set_num_threads(before);
}

/* Loops that may be cut anywhere are cut for the threads that their work is worth. */
TEST(for_threads)
{
    int before = omp_get_max_threads();
    omp_set_num_threads(3);
    for (int64_t work = 100; work <= 1000; work += 100) {
        struct chunks chunks = chunks_for_threads(7, work, 100);
        check_cover(&chunks, 7);
        assert_int_equal(chunks.count, work < 300 ? work / 100 : 3);
        assert_int_equal(chunks.threads, chunks.count);
    }
    omp_set_num_threads(before);
}

/* What is not worth a second thread is one chunk; what is, is worth two. */
TEST(worthwhile)
{
    assert_int_equal(chunks_of(199, 100).count, 1);
    assert_int_equal(chunks_of(200, 100).count, 2);
    assert_int_equal(chunks_of(1000000, 100).count, CHUNKS_MOST);
}

RUN_TESTS(NULL, NULL)
