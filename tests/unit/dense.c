/* Cholesky factors, dense and within a profile: the same bits as entry by entry, whatever the threads, and
 * solutions. */
#include "unit.h"

#include "base/dense.h"
#include "base/profile.h"

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

/* A profile of `count` rows of blocks, dense for reach 0, else of up to so many blocks. */
static struct profile profile_of(int64_t count, int64_t numbers, int64_t reach)
{
    struct profile profile;
    GOOD(profile_begin(count, numbers, &profile, &error));
    for (int64_t row = 0; row < count; row++) {
        profile.first[row] = reach == 0 || row < reach ? 0 : row - (row * 7 + 3) % reach;
    }
    GOOD(profile_lay_out(&profile, &error));
    return profile;
}

/* For one row, one panel and several, for rows that are left over, and for dense and narrow profiles. */
TEST(same_bits)
{
    static const int64_t counts[] = {1, 2, 7, 16, 43, 86}, reaches[] = {0, 3, 11};
    int before = omp_get_max_threads();
    for (int k = 0; k < 18; k++) {
        int64_t n = counts[k / 3] * 6;
        struct profile profile = profile_of(counts[k / 3], 6, reaches[k % 3]);
        double *value = zeros(profile.size, sizeof *value), *expected = matrix_of(n), x[516], y[516];
        for (int64_t i = 0; i < n * n; i++) {
            bool inside = i % n / 6 >= profile.first[i / n / 6];
            expected[i] = inside ? expected[i] : 0.0;
        }
        double *matrix = memcpy(zeros(n * n, sizeof *matrix), expected, (size_t)(n * n) * sizeof *matrix);
        factorise_plainly(n, expected);
        for (int threads = 1; threads <= 3; threads++) {
            for (int64_t i = 0; i < n; i++) {
                for (int64_t j = profile.first[i / 6] * 6; j <= i; j++) {
                    *profile_entry(&profile, i, j, value) = matrix[i * n + j];
                }
                x[i] = y[i] = (double)(i % 7) - 3.0;
            }
            omp_set_num_threads(threads);
            assert_true(profile_factorise(&profile, value));
            profile_solve(&profile, value, x);
            dense_solve(n, expected, y);
            for (int64_t i = 0; i < n; i++) {
                AT_MOST(fabs(x[i] - y[i]), 1e-14);
                for (int64_t j = profile.first[i / 6] * 6; j <= i; j++) {
                    assert_true(*profile_entry(&profile, i, j, value) == expected[i * n + j]);
                }
            }
        }
        value[profile.size - 1] = -1e9;
        assert_false(profile_factorise(&profile, value));
        profile_free(&profile);
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
