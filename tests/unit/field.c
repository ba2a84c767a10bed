/* Fields at points: exact for linear fields on any cloud and in each cell; what is outside of a body. */
#include "approx_fixture.h"

#include "approx/field/field_compare.h"

static double linear(int dim, const double *x)
{
    return 1.0 + 2.0 * x[0] - 3.0 * x[1] + (dim == 3 ? 0.5 * x[2] : 0.0);
}

/* values[count * 2]: a linear field and a constant. */
static double *linear_field(int dim, int64_t count, const double *x)
{
    double *values = zeros(count * 2, sizeof *values);
    for (int64_t n = 0; n < count; n++) {
        values[2 * n] = linear(dim, x + n * dim);
        values[2 * n + 1] = -7.0;
    }
    return values;
}

TEST_IN_EACH_DIM(linear_fields_are_exact)
{
    for (int p = 0; p < PLACE_COUNT; p++) {
        FREED_BY(scattered_free)
        struct scattered cloud = scatter(dim, dim == 2 ? 10 : 6, 80, &places[p], 0.3, 3);
        struct support_options options = support_defaults(dim);
        struct cells cells = {.dim = dim, .node_count = cloud.count, .x = cloud.x};
        FREED_BY(field_table_free) struct field_table table = {0};
        double *spacing = zeros(cloud.count, sizeof *spacing);
        double *values = linear_field(dim, cloud.count, cloud.x);
        double *expected = linear_field(dim, 80, cloud.points), got[160];
        GOOD(field_spacing(&cells, spacing, &error));
        GOOD(support_radii(&options, cells.node_count, spacing, spacing, &error));
        GOOD(
            field_table_build(&options, NULL, &cells, spacing, 80, cloud.points, "points.x", &table, &error));
        field_evaluate(80, table.lists.ptr, table.lists.idx, table.phi, 2, values, got);
        for (int i = 0; i < 160; i++) {
            AT_MOST(fabs(got[i] - expected[i]), 1e-11 * (places[p].size + 10.0));
        }
    }
}

/* Nodes of cells have the cells' spacing, others that of the nearest nodes. */
TEST(spacing_with_and_without_cells)
{
    static const double x[] = {0, 0, 1, 0, 1, 1, 0, 1, 3, 0};
    static const int32_t node[] = {0, 1, 2, 0, 2, 3};
    struct cells cells = {2, 5, x, 2, node}, bare = {2, 5, x, 0, NULL};
    double spacing[5], nearest[5], alone[5];
    GOOD(field_spacing(&cells, spacing, &error));
    GOOD(nodes_spacing(2, 5, x, nearest, &error));
    GOOD(field_spacing(&bare, alone, &error));
    assert_memory_equal(alone, nearest, sizeof nearest);
    AT_MOST(fabs(spacing[1] - 1.0), 1e-15);
    assert_true(spacing[4] == nearest[4]);
}

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
