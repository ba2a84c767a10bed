/* Values between voxels: the nearest, at the border, and none outside (more: warp.bats, sample.bats). */
#include "unit.h"

#include "io/image/image.h"

static struct image image;

/* Two components: one of degree 1 along each axis, one of degree 2. */
static void polynomials(const double x[3], double value[2])
{
    value[0] = 1 + 2 * x[0] - 3 * x[1] + x[2] + 0.5 * x[0] * x[1] * x[2];
    value[1] = x[0] * x[0] - x[1] * x[1] * x[2] + 2 * x[2] * x[2] * x[0];
}

static int make(void **state)
{
    struct error error;
    (void)state;
    const size_t size[3] = {7, 6, 5};
    if (image_new(&image, size, 2, &error) != STATUS_OK) {
        return 1;
    }
    for (size_t v = 0; v < image_voxels(&image); v++) {
        const double x[3] = {(double)(v % 7), (double)(v / 7 % 6), (double)(v / 42)};
        polynomials(x, image.values + 2 * v);
    }
    return 0;
}

static int drop(void **state)
{
    (void)state;
    image_free(&image);
    return 0;
}

TEST(borders)
{
    static const double within[][3] = {{-0.5, 0, 0}, {6.5, 5, 4}, {3, -0.4, 4.5}, {0, 5.5, 0}};
    static const double outside[][3] = {{-0.51, 0, 0}, {6.51, 5, 4}, {3, 3, 4.6},
                                        {0, -7, 0},    {NAN, 1, 1},  {1, INFINITY, 1}};
    for (int method = 0; method < IMAGE_METHOD_COUNT; method++) {
        double value[2] = {-1, -1}, corner[2];
        for (size_t i = 0; i < sizeof within / sizeof *within; i++) {
            assert_true(image_sample(&image, (enum image_method)method, within[i], value));
        }
        for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
            assert_false(image_sample(&image, (enum image_method)method, outside[i], value));
        }
        /* The outermost value goes on to the border. */
        assert_true(image_sample(&image, (enum image_method)method, (double[3]){-0.4, -0.4, -0.4}, value));
        polynomials((double[3]){0, 0, 0}, corner);
        assert_true(method == IMAGE_CUBIC || fabs(value[0] - corner[0]) <= 1e-12);
    }
    double value[2], nearest[2];
    assert_true(image_sample(&image, IMAGE_NEAREST, (double[3]){2.45, 2.55, 1.45}, value));
    polynomials((double[3]){2, 3, 1}, nearest);
    assert_true(value[0] == nearest[0] && value[1] == nearest[1]);
}

/* What is not a number spreads to what is interpolated from it, and no farther. */
TEST(not_a_number)
{
    double value[2], before = image.values[2 * (3 + 7 * (2 + 6 * 2))];
    image.values[2 * (3 + 7 * (2 + 6 * 2))] = NAN;
    assert_true(image_sample(&image, IMAGE_LINEAR, (double[3]){2, 2, 2}, value));
    assert_true(isfinite(value[0]));
    assert_true(image_sample(&image, IMAGE_LINEAR, (double[3]){2.5, 2, 2}, value));
    assert_true(isnan(value[0]) && isfinite(value[1]));
    image.values[2 * (3 + 7 * (2 + 6 * 2))] = before;
}

RUN_TESTS(make, drop)
