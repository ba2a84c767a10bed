/* An operator and its transpose from one table: the same bits for any number of stripes, and those of sums
 * over the rows of the transpose. */
#include "unit.h"

#include "base/processor.h"
#include "solid/body/kernel.h"
#include "solid/operators/row_operator.h"

enum { ROWS = 300, COLUMNS = 90, STRIDE = 4 };

/* Rows whose columns lie near each other, not ascending, of 0 to 11 entries, now and then all over the place.
 */
static void make_table(struct sparse *table)
{
    struct random random = {5};
    GOOD(sparse_new(ROWS, COLUMNS, ROWS * 12, table, &error));
    for (int64_t r = 0; r < ROWS; r++) {
        int64_t count = r % 12, at = table->ptr[r], step = r % 17 == 0 ? 7 : 1;
        for (int64_t k = 0; k < count; k++) {
            table->idx[at + k] = (int32_t)((r * COLUMNS / ROWS + (count - k) * step) % COLUMNS);
            table->value[at + k] = uniform(&random, -1.0, 1.0);
        }
        table->ptr[r + 1] = at + count;
    }
}

/* Component 0 of each column's sum as row_operator.h states it, the multiplications fused where the processor
 * can. */
static void expect(const struct sparse *transposed, const double *x, double *y)
{
    bool fused = strcmp(processor_best_set(), "default") != 0;
    for (int64_t c = 0; c < COLUMNS; c++) {
        y[c] = 0.0;
        for (int64_t k = transposed->ptr[c]; k < transposed->ptr[c + 1]; k++) {
            double value = transposed->value[k], at = x[transposed->idx[k] * STRIDE];
            y[c] = fused ? fma(value, at, y[c]) : y[c] + value * at;
        }
    }
}

TEST(columns_are_summed_in_order)
{
    FREED_BY(sparse_free) struct sparse table = {0}, transposed = {0};
    double x[ROWS * STRIDE], y[COLUMNS * STRIDE], expected[COLUMNS];
    struct random random = {7};
    for (int i = 0; i < ROWS * STRIDE; i++) {
        x[i] = uniform(&random, -1.0, 1.0);
    }
    make_table(&table);
    GOOD(sparse_transpose(&table, &transposed, &error));
    expect(&transposed, x, expected);
    for (int threads = 1; threads < 2 * COLUMNS; threads = 2 * threads + 1) {
        FREED_BY(row_operator_free) struct row_operator rows = {0};
        make_table(&rows.matrix);
        GOOD(row_operator_finish(&rows, 0, COLUMNS, threads, &error));
        assert_int_equal(rows.stripe_count, threads);
        for (int s = 0; s < threads; s++) {
            force_apply_transposed(3, &rows, s, x, y);
        }
        for (int64_t c = 0; c < COLUMNS; c++) {
            assert_memory_equal(&y[c * STRIDE], &expected[c], sizeof *y);
        }
    }
}

RUN_TESTS(NULL, NULL)
