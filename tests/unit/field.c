/* What is outside of a body. */
#include "approx_fixture.h"

#include "approx/field/field_compare.h"

/* Beyond a side, beyond a corner (an edge, in 3D), in a notch between cells; within 0 and within a margin. */
TEST(outside_of_cells)
{
    static const double x2[] = {0, 0, 1, 0, 1, 1, 0, 1, 2, 0, 2, 1}, spacing[] = {1, 1, 1, 1, 1, 1};
    static const int32_t triangle[] = {0, 1, 2, 0, 2, 3, 1, 4, 5};
    static const double points2[] = {0.5, 0.5,   1,   0.5,  1.2,  0.6,  -0.19,
                                     0.5, -0.21, 0.5, 2.14, 1.14, 2.15, 1.15};
    static const bool in2[] = {false, false, true, true, true, true, true};
    static const bool near2[] = {false, false, false, false, true, false, true};
    static const double x3[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const int32_t tetrahedron[] = {0, 1, 2, 3};
    static const double points3[] = {0.2,   0.2,   0.2,   0.5,  0.5,   0,     0.5,   0.2,   -0.19,
                                     0.5,   -0.14, -0.14, 0.5,  -0.15, -0.15, -0.11, -0.11, -0.11,
                                     -0.12, -0.12, -0.12, 0.44, 0.44,  0.44,  0.46,  0.46,  0.46};
    static const bool in3[] = {false, false, true, true, true, true, true, true, true};
    static const bool near3[] = {false, false, false, false, true, false, true, false, true};
    struct cells cells2 = {2, 6, x2, 3, triangle}, cells3 = {3, 4, x3, 1, tetrahedron};
    bool got[9];
    GOOD(field_outside(&cells2, spacing, 0.0, 7, points2, got, &error));
    assert_memory_equal(got, in2, sizeof in2);
    GOOD(field_outside(&cells2, spacing, 0.2, 7, points2, got, &error));
    assert_memory_equal(got, near2, sizeof near2);
    GOOD(field_outside(&cells3, spacing, 0.0, 9, points3, got, &error));
    assert_memory_equal(got, in3, sizeof in3);
    GOOD(field_outside(&cells3, spacing, 0.2, 9, points3, got, &error));
    assert_memory_equal(got, near3, sizeof near3);
}

RUN_TESTS(NULL, NULL)
