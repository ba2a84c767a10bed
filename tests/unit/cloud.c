/* Analytic clouds: counts, places, positive cells that fill the box, outward facets. */
#include "unit.h"

#include "approx/cells/cells.h"
#include "approx/points/cloud.h"

static struct cloud_options options_of(enum cloud_kind kind, int dim)
{
    return (struct cloud_options){.kind = kind,
                                  .dim = dim,
                                  .count = {5, 4, 3},
                                  .low = {-1, 0, 2},
                                  .high = {3, 1, 2.5},
                                  .jitter = dim == 2 ? 0.5 : 0.16,
                                  .seed = 7,
                                  .ratio = 8};
}

static struct cloud make(const struct cloud_options *options)
{
    struct cloud cloud;
    GOOD(cloud_make(options, &cloud, &error));
    return cloud;
}

static double total_volume(const struct cloud *cloud)
{
    struct cells cells = {cloud->dim, cloud->node_count, cloud->x, cloud->cell_count, cloud->cells};
    double sum = 0;
    for (int64_t c = 0; c < cells.count; c++) {
        double volume = cell_volume(&cells, c);
        assert_true(volume > 0);
        sum += volume;
    }
    return sum;
}

static double box_volume(const struct cloud_options *options)
{
    double volume = 1;
    for (int a = 0; a < options->dim; a++) {
        volume *= options->high[a] - options->low[a];
    }
    return volume;
}

/* Jitter moves inner nodes by no more than it may, the boundary not at all, and depends on the seed only. */
TEST(jitter_is_bounded)
{
    struct cloud_options options = options_of(CLOUD_JITTERED, 2);
    options.count[0] = options.count[1] = 40;
    FREED_BY(cloud_free) struct cloud cloud = make(&options);
    FREED_BY(cloud_free) struct cloud again = make(&options);
    options.seed = 8;
    FREED_BY(cloud_free) struct cloud other = make(&options);
    options.kind = CLOUD_REGULAR;
    FREED_BY(cloud_free) struct cloud regular = make(&options);
    double most = 0;
    double moved = 0;
    for (int64_t n = 0; n < cloud.node_count; n++) {
        bool inner = n % 40 > 0 && n % 40 < 39 && n / 40 > 0 && n / 40 < 39;
        for (int a = 0; a < 2; a++) {
            double spacing = (options.high[a] - options.low[a]) / 39;
            double d = fabs(cloud.x[2 * n + a] - regular.x[2 * n + a]) / spacing;
            assert_true(inner || d == 0);
            most = fmax(most, d);
            moved += d;
        }
    }
    assert_true(most <= 0.5 * (1 + 1e-12) && most > 0.49);
    assert_true(fabs(moved / (2 * 38 * 38) - 0.25) < 0.02);
    assert_memory_equal(cloud.x, again.x, (size_t)cloud.node_count * 2 * sizeof *cloud.x);
    assert_memory_not_equal(cloud.x, other.x, (size_t)cloud.node_count * 2 * sizeof *cloud.x);
    assert_true(fabs(total_volume(&cloud) / box_volume(&options) - 1) <
                1e-13); /* valid at the largest jitter */
}

TEST(grading_has_its_ratio)
{
    struct cloud_options options = options_of(CLOUD_GRADED, 2);
    FREED_BY(cloud_free) struct cloud cloud = make(&options);
    const double *x = cloud.x;
    assert_true(x[0] == -1 && x[8] == 3);
    assert_true(fabs((x[8] - x[6]) / (x[2] - x[0]) - 8) < 1e-12);
    assert_true(fabs((x[4] - x[2]) / (x[2] - x[0]) - 2) < 1e-12);
}

TEST(functions_have_their_values)
{
    const double x[3] = {0.5, -2, 3};
    assert_true(fabs(cloud_function_value(FUNCTION_PAPER, 2, x) - (1 - 4.25) * exp(-4.25 / 2)) < 1e-16);
    assert_true(fabs(cloud_function_value(FUNCTION_PAPER, 3, x) - (1 - 13.25) * exp(-13.25 / 2)) < 1e-16);
    assert_true(cloud_function_value(FUNCTION_LINEAR, 2, x) == -4);
    assert_true(cloud_function_value(FUNCTION_LINEAR, 3, x) == 8);
    assert_true(cloud_function_value(FUNCTION_QUADRATIC, 2, x) == -4 + 0.25 + 2 + 12);
    assert_true(cloud_function_value(FUNCTION_QUADRATIC, 3, x) == 8 + 0.25 + 2 + 12 + 1.5 + 6 + 18);
}

RUN_TESTS(NULL, NULL)
