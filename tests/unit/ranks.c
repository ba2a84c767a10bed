/* How processes share rows: stretches of about the same work. That a run has the bytes of one process,
 * whatever their number, is tested in mpi.bats. */
#include "unit.h"

#include "base/ranks.h"

/* Stretches are of about the same work, cover all items in turn, and say whose an item is. */
TEST(shares)
{
    struct ranks ranks = {.count = 3};
    const double work[8] = {4.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 4.0};
    int64_t *first;
    GOOD(ranks_share(&ranks, 8, work, &first, &error));
    assert_int_equal(first[0], 0);
    assert_int_equal(first[3], 8);
    assert_true(first[1] >= 1 && first[1] <= 3 && first[2] == 7);
    for (int64_t i = 0; i < 8; i++) {
        int owner = ranks_owner(&ranks, first, i);
        assert_true(first[owner] <= i && i < first[owner + 1]);
    }
    free(first);
    GOOD(ranks_share(&ranks, 1, NULL, &first, &error)); /* fewer items than processes */
    assert_int_equal(first[3], 1);
    assert_int_equal(first[ranks_owner(&ranks, first, 0)], 0);
    free(first);
    GOOD(ranks_share(NULL, 5, NULL, &first, &error));
    assert_int_equal(first[1], 5);
    free(first);
    assert_int_equal(ranks_most(NULL, 3), 3);
}

TEST(rows_in_stretches)
{
    struct row_ranges ranges;
    const bool wanted[9] = {true, true, false, true, false, false, true, true, true};
    GOOD(row_ranges_of(1, 8, wanted, &ranges, &error));
    assert_int_equal(ranges.count, 3);
    assert_true(ranges.items[0].begin == 1 && ranges.items[0].end == 2);
    assert_true(ranges.items[2].begin == 6 && ranges.items[2].end == 8);
    row_ranges_free(&ranges);
    GOOD(row_ranges_of(0, 2 * ROW_RANGE_MOST + 1, NULL, &ranges, &error));
    assert_int_equal(ranges.count, 3);
    assert_true(ranges.items[2].begin == 2 * ROW_RANGE_MOST && ranges.items[2].end == 2 * ROW_RANGE_MOST + 1);
    row_ranges_free(&ranges);
}

/* A process alone agrees with itself. */
TEST(agreement)
{
    FAILS(ranks_agree(NULL, (fail)(&error, STATUS_VERDICT, "alone"), &error), STATUS_VERDICT, "");
}

RUN_TESTS(NULL, NULL)
