/* Dense Cholesky factors: the same bits as entry by entry, whatever the threads, and solutions. */
#include "unit.h"

#include "base/dense.h"

/* A symmetric positive definite matrix without pattern. */
static double *matrix_of(int64_t n)
{
    struct random random = {(uint64_t)n + 5};
    double *matrix = array_new(n * n, sizeof *matrix);
    assert_non_null(matrix);
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k <= i; k++) {
            matrix[i * n + k] = matrix[k * n + i] = uniform(&random, -1.0, 1.0) + (i == k ? (double)n : 0.0);
        }
    }
    return matrix;
}

/* L by rows, and L^T above it; each entry is reduced by one column after the other. */
static void factorise_plainly(int64_t n, double *matrix)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k <= i; k++) {
            double sum = matrix[i * n + k];
            for (int64_t c = 0; c < k; c++) {
                double product = matrix[i * n + c] * matrix[k * n + c];
                sum -= product;
            }
            matrix[i * n + k] = matrix[k * n + i] = i == k ? sqrt(sum) : sum / matrix[k * n + k];
        }
    }
}

/* For one row, one panel and several, and for rows that are left over. */
TEST(same_bits)
{
    static const int64_t sizes[] = {1, 2, 7, 63, 64, 65, 131, 192, 300, 517};
    int before = omp_get_max_threads();
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        int64_t n = sizes[s];
        size_t bytes = (size_t)(n * n) * sizeof(double);
        double *expected = matrix_of(n);
        factorise_plainly(n, expected);
        for (int threads = 1; threads <= 3; threads++) {
            double *matrix = matrix_of(n);
            omp_set_num_threads(threads);
            assert_true(dense_factorise(n, matrix));
            assert_memory_equal(matrix, expected, bytes);
            free(matrix);
        }
        free(expected);
    }
    omp_set_num_threads(before);
}

TEST(solves)
{
    enum { SIZE = 150 };
    double *matrix = matrix_of(SIZE), *factor = matrix_of(SIZE), x[SIZE], residual[SIZE];
    assert_true(dense_factorise(SIZE, factor));
    for (int64_t i = 0; i < SIZE; i++) {
        x[i] = residual[i] = (double)(i % 7) - 3.0;
    }
    dense_solve(SIZE, factor, x);
    for (int64_t i = 0; i < SIZE * SIZE; i++) {
        residual[i / SIZE] -= matrix[i] * x[i % SIZE];
    }
    for (int64_t i = 0; i < SIZE; i++) {
        AT_MOST(fabs(residual[i]), 1e-12);
    }
    free(matrix);
    free(factor);
}

/* Also where the pivot that is not positive is behind the first panel. */
TEST(indefinite_matrices_are_refused)
{
    static const int64_t sizes[] = {1, 40, 100};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        int64_t n = sizes[s];
        double *matrix = matrix_of(n);
        matrix[n * n - 1] = -1.0;
        assert_false(dense_factorise(n, matrix));
        free(matrix);
    }
}

RUN_TESTS(NULL, NULL)
