/* Threads share rows and blocks of rows, and give the bits of one thread. */
#include "unit.h"

#include "base/envelope.h"
#include "base/sparse.h"

enum { ROWS = 60000, BLOCKS = 3, MOST_THREADS = 5 };

/* Row i of the matrix of chains, one in each block, row i being of block i % BLOCKS. */
static int64_t row_of_chains(int64_t i, int64_t *column, double *value)
{
    int64_t count = 0;
    for (int64_t k = i - BLOCKS; k <= i + BLOCKS; k += BLOCKS) {
        if (k >= 0 && k < ROWS) {
            column[count] = k;
            value[count++] = k == i ? 2.5 + 1e-5 * (double)i : -1.0;
        }
    }
    return count;
}

static void make_chains(struct envelope *factor)
{
    int64_t *ptr = zeros(ROWS + 1, sizeof *ptr), *column = zeros(3 * ROWS, sizeof *column);
    double *value = zeros(3 * ROWS, sizeof *value);
    for (int64_t i = 0; i < ROWS; i++) {
        ptr[i + 1] = ptr[i] + row_of_chains(i, column + ptr[i], value + ptr[i]);
    }
    GOOD(envelope_factorise(ROWS, ptr, column, value, 1e-10, 0.0, factor, &error));
}

TEST(blocks)
{
    double *alone = zeros(ROWS, sizeof *alone), *x = zeros(ROWS, sizeof *x), value[3];
    int before = omp_get_max_threads();
    int64_t column[3];
    for (int threads = 1; threads <= MOST_THREADS; threads++) {
        FREED_BY(envelope_free) struct envelope factor = {0};
        omp_set_num_threads(threads);
        make_chains(&factor);
        assert_int_equal(factor.block_count, BLOCKS);
        for (int64_t i = 0; i < ROWS; i++) {
            x[i] = 1.0 / (1.0 + (double)i);
        }
        envelope_solve(&factor, x);
        if (threads == 1) {
            memcpy(alone, x, ROWS * sizeof *x);
        }
        assert_memory_equal(x, alone, ROWS * sizeof *x);
    }
    omp_set_num_threads(before);
    for (int64_t i = 0; i < ROWS; i++) {
        double sum = 0.0;
        int64_t count = row_of_chains(i, column, value);
        for (int64_t k = 0; k < count; k++) {
            sum += value[k] * alone[column[k]];
        }
        AT_MOST(fabs(sum - 1.0 / (1.0 + (double)i)), 1e-14);
    }
}

/* Rows of all lengths, most entries in the first ones, some without any; twice, y = A x and y += A x. */
TEST(rows)
{
    struct sparse matrix;
    struct random random = {3};
    int before = omp_get_max_threads();
    int64_t entries = 0;
    for (int width = 1; width <= 4; width++) {
        double *x = zeros(100 * width, sizeof *x), *y = zeros(ROWS * width, sizeof *y);
        double *expected = zeros(ROWS * width, sizeof *expected);
        GOOD(sparse_new(ROWS, 100, 100 * ROWS, &matrix, &error));
        entries = 0;
        for (int64_t r = 0; r < ROWS; r++) {
            for (int64_t k = 0; k < (r < 1000 ? 100 : r % 3); k++) {
                matrix.idx[entries] = (int32_t)((r + 7 * k) % 100);
                matrix.value[entries++] = uniform(&random, -1.0, 1.0);
            }
            matrix.ptr[r + 1] = entries;
        }
        for (int64_t i = 0; i < 100 * width; i++) {
            x[i] = uniform(&random, -1.0, 1.0);
        }
        for (int64_t r = 0; r < ROWS; r++) {
            for (int64_t i = matrix.ptr[r]; i < matrix.ptr[r + 1]; i++) {
                for (int a = 0; a < width; a++) {
                    expected[r * width + a] += matrix.value[i] * x[matrix.idx[i] * width + a];
                }
            }
        }
        for (int threads = 1; threads <= MOST_THREADS; threads++) {
            omp_set_num_threads(threads);
            memset(y, 0, (size_t)(ROWS * width) * sizeof *y);
            sparse_add_rows(&matrix, 0, ROWS, width, x, y);
            assert_memory_equal(y, expected, (size_t)(ROWS * width) * sizeof *y);
        }
        sparse_free(&matrix);
    }
    omp_set_num_threads(before);
}

RUN_TESTS(NULL, NULL)
