/* Sides, and the quality of cells. */
#include "unit.h"

#include "approx/cells/parts.h"
#include "approx/cells/quality.h"

/* A corner of the unit cube: V = 1/6, surface (3 + sqrt 3) / 2, R = sqrt 3 / 2. A flat one has none. */
TEST(quality_is_the_ratio_of_radii)
{
    double corner[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const int32_t node[] = {0, 1, 2, 3};
    struct cells cells = {3, 4, corner, 1, node};
    double r = 3 * (1.0 / 6) / ((3 + sqrt(3)) / 2);
    assert_true(fabs(cell_quality(&cells, 0) - 3 * r / (sqrt(3) / 2)) < 1e-12);
    corner[11] = 0;
    assert_true(cell_quality(&cells, 0) == 0);
    corner[9] = NAN;
    assert_true(cell_quality(&cells, 0) == 0);
}

/* Two squares of two triangles each that touch in a node only, and a third one apart, the largest. */
static const double islands_x[] = {0, 0, 1, 0, 1, 1, 0, 1, 2, 1, 2, 2, 1, 2, 5, 0, 7, 0, 7, 2, 5, 2};
static const int32_t islands[] = {0, 1, 2, 0, 2, 3, 2, 4, 5, 2, 5, 6, 7, 8, 9, 7, 9, 10};
static const struct cells islands_cells = {2, 11, islands_x, 6, islands};

TEST(sides_end_at_sharp_turns)
{
    FREED_BY(faces_free) struct faces boundary = {0};
    int32_t part[12];
    int32_t count;
    GOOD(faces_build(&islands_cells, true, &boundary, &error));
    assert_int_equal(boundary.count, 12);
    GOOD(boundary_sides(islands_x, &boundary, 180, part, &count, &error));
    /* at the shared node four edges meet: the two small squares are not joined there */
    assert_int_equal(count, 3);
    GOOD(boundary_sides(islands_x, &boundary, 89, part, &count, &error));
    assert_int_equal(count, 12);
    GOOD(boundary_sides(islands_x, &boundary, 90, part, &count, &error));
    assert_int_equal(count, 3);
}

RUN_TESTS(NULL, NULL)
