/* Fields at points and their comparison: exact for linear fields on any cloud, node matching, statistics, and
 * NaN, which never passes. */
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

static struct nodal_field view(const struct scattered *cloud, const double *values)
{
    return (struct nodal_field){
        .cells = {.dim = cloud->dim, .node_count = cloud->count, .x = cloud->x}, .cols = 2, .values = values};
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

/* A cloud of nodes alone: within twice a node's spacing. */
TEST(outside_of_nodes)
{
    static const double x[] = {0, 0, 1, 0, 0, 1}, spacing[] = {1, 1, 1};
    static const double points[] = {0.5, 0.5, 2.9, 0, 0, -1.9, 3.1, 0, 0, -2.1, 0, 0};
    static const bool expected[] = {false, false, false, true, true, false};
    struct cells cells = {2, 3, x, 0, NULL};
    bool got[6];
    GOOD(field_outside(&cells, spacing, FIELD_MARGIN, 6, points, got, &error));
    assert_memory_equal(got, expected, sizeof got);
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

/* In order, in another order, with two nodes at one place, and moved by more than round-off. */
TEST(matching)
{
    FREED_BY(scattered_free) struct scattered cloud = scatter(2, 9, 1, &places[2], 0.3, 12);
    double *other = zeros(cloud.count * 2, sizeof *other);
    int32_t *match = zeros(cloud.count, sizeof *match);
    char seen[81] = {0};
    bool matched;
    memcpy(cloud.x + 2 * 40, cloud.x + 2 * 41, 2 * sizeof(double));
    for (int64_t n = 0; n < 81; n++) { /* 31 and 81 have no common factor */
        other[2 * (n * 31 % 81)] = cloud.x[2 * n] + 0.9e-10 * (n % 2 == 0 ? 1 : -1);
        other[2 * (n * 31 % 81) + 1] = cloud.x[2 * n + 1];
    }
    GOOD(field_match_nodes(2, 81, cloud.x, 81, cloud.x, match, &matched, &error));
    assert_true(matched);
    for (int32_t n = 0; n < 81; n++) {
        assert_int_equal(match[n], n);
    }
    GOOD(field_match_nodes(2, 81, cloud.x, 81, other, match, &matched, &error));
    assert_true(matched);
    for (int64_t n = 0; n < 81; n++) {
        assert_false(seen[match[n]]);
        seen[match[n]] = 1;
        AT_MOST(fabs(other[2 * match[n]] - cloud.x[2 * n]), 1e-10);
        AT_MOST(fabs(other[2 * match[n] + 1] - cloud.x[2 * n + 1]), 1e-10);
    }
    other[5] += 1e-8;
    GOOD(field_match_nodes(2, 81, cloud.x, 81, other, match, &matched, &error));
    assert_false(matched);
    GOOD(field_match_nodes(2, 81, cloud.x, 80, cloud.x, match, &matched, &error));
    assert_false(matched);
    memcpy(other, cloud.x, 81 * 2 * sizeof *other); /* the same places, but not equally often */
    memcpy(other, cloud.x + 2 * 40, 2 * sizeof *other);
    GOOD(field_match_nodes(2, 81, cloud.x, 81, other, match, &matched, &error));
    assert_false(matched);
}

TEST(statistics_of_differences)
{
    double difference[] = {3.0, 0.0, 4.0, 100.0, 4.0, 1.0};
    static const int64_t index[] = {0, 1, 2, 4, 5};
    struct field_statistics statistics;
    GOOD(field_statistics(5, index, difference, &statistics, &error));
    AT_MOST(fabs(statistics.average - 2.4), 1e-15);
    AT_MOST(fabs(statistics.rmse - sqrt(42.0 / 5.0)), 1e-15);
    assert_true(statistics.largest == 4.0 && statistics.largest_at == 2);
    assert_true(field_percentile(&statistics, 50) == 3.0);
    assert_true(field_percentile(&statistics, 100) == 4.0);
    assert_true(field_percentile(&statistics, 0) == 0.0);
    AT_MOST(fabs(field_percentile(&statistics, 12.5) - 0.5), 1e-15);
    field_statistics_free(&statistics);
    difference[4] = NAN;
    GOOD(field_statistics(5, index, difference, &statistics, &error));
    assert_true(isnan(statistics.average) && isnan(statistics.largest) && isnan(statistics.rmse));
    assert_true(isnan(field_percentile(&statistics, 50)));
    assert_int_equal(statistics.largest_at, 4);
    field_statistics_free(&statistics);
    GOOD(field_statistics(0, index, difference, &statistics, &error));
    assert_true(isnan(statistics.average) && isnan(statistics.largest) && isnan(statistics.rmse));
    field_statistics_free(&statistics);
    static const double field[] = {3.0, 4.0, NAN, 0.0};
    assert_true(field_largest(1, 2, field) == 5.0);
    assert_true(isnan(field_largest(2, 2, field)));
}

/* A field against itself, against itself on another cloud, and against one that differs at one node. */
TEST_IN_EACH_DIM(comparisons)
{
    FREED_BY(scattered_free) struct scattered coarse = scatter(dim, 5, 1, &places[0], 0.0, 3);
    FREED_BY(scattered_free)
    struct scattered fine = scatter(dim, dim == 2 ? 12 : 8, 1, &places[0], 0.2, 4);
    double *a = linear_field(dim, coarse.count, coarse.x), *b = linear_field(dim, fine.count, fine.x);
    struct nodal_field first = view(&coarse, a), second = view(&fine, b);
    struct field_comparison comparison;
    bool *chosen = zeros(coarse.count, sizeof *chosen);
    GOOD(field_compare(&first, &first, NULL, false, &comparison, &error));
    assert_true(comparison.coincide && comparison.count == coarse.count && comparison.outside == 0);
    for (int64_t n = 0; n < coarse.count; n++) {
        assert_true(comparison.difference[n] == 0.0);
    }
    field_comparison_free(&comparison);

    a[2 * 7] += 3.0;
    a[2 * 7 + 1] += 4.0;
    GOOD(field_compare(&first, &second, NULL, false, &comparison, &error));
    assert_false(comparison.coincide);
    for (int64_t n = 0; n < coarse.count; n++) {
        AT_MOST(fabs(comparison.difference[n] - (n == 7 ? 5.0 : 0.0)), 1e-11);
    }
    field_comparison_free(&comparison);

    coarse.x[9 * dim] += 10.0; /* outside, unless left out */
    FAILS(field_compare(&first, &second, NULL, false, &comparison, &error), STATUS_INPUT, "row 9");
    assert_int_equal(comparison.outside, 1);
    field_comparison_free(&comparison);
    GOOD(field_compare(&first, &second, NULL, true, &comparison, &error));
    assert_int_equal(comparison.count, coarse.count - 1);
    assert_true(isnan(comparison.difference[9]));
    field_comparison_free(&comparison);
    chosen[7] = chosen[8] = true;
    GOOD(field_compare(&first, &second, chosen, false, &comparison, &error));
    assert_int_equal(comparison.count, 2);
    assert_true(comparison.node[0] == 7 && comparison.node[1] == 8);
    assert_true(isnan(comparison.difference[0]));
    field_comparison_free(&comparison);
}

/* Of a piecewise linear field each cell's own line, also a little beyond the cells; far from them an error.
 */
TEST(linear_in_each_cell)
{
    static const double x[] = {0, 0, 1, 0, 1, 1, 0, 1}, values[] = {0, 1, 5, 3};
    static const int32_t node[] = {0, 1, 2, 0, 2, 3};
    static const double at[] = {0.5, 0.25, 0.25, 0.5, 1, 1, 1.1, 0.5}, far[] = {0.5, 0.5, 0.5, 2.3};
    static const double expected[] = {0.5 + 4 * 0.25, 2 * 0.25 + 3 * 0.5, 5, 1.1 + 4 * 0.5};
    struct cells cells = {2, 4, x, 2, node};
    double got[4];
    GOOD(field_linear(&cells, 1, values, 4, at, got, &error));
    for (int p = 0; p < 4; p++) {
        AT_MOST(fabs(got[p] - expected[p]), 1e-14);
    }
    FAILS(field_linear(&cells, 1, values, 2, far, got, &error), STATUS_INPUT, "node 1 at (0.5, 2.3)");
}

/* In a tetrahedron, and exactly the values at the nodes. */
TEST(linear_in_a_tetrahedron)
{
    static const double x[] = {0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, 2};
    static const int32_t node[] = {0, 1, 2, 3};
    static const double at[] = {0.5, 0.25, 0.75};
    struct cells cells = {3, 4, x, 1, node};
    double values[8], got[8];
    for (int n = 0; n < 4; n++) {
        values[2 * n] = linear(3, x + 3 * (size_t)n);
        values[2 * n + 1] = -7.0;
    }
    GOOD(field_linear(&cells, 2, values, 1, at, got, &error));
    AT_MOST(fabs(got[0] - linear(3, at)), 1e-14);
    AT_MOST(fabs(got[1] + 7.0), 1e-14);
    GOOD(field_linear(&cells, 2, values, 4, x, got, &error));
    for (int i = 0; i < 8; i++) {
        AT_MOST(fabs(got[i] - values[i]), 1e-15 * 10.0);
    }
}

/* A cloud that cannot be interpolated is not comparable: an error, not a verdict. */
TEST(not_comparable)
{
    static const double line[] = {0, 0, 1, 1, 2, 2, 3, 3, 4, 4}, point[] = {1.5, 1.5}, values[10] = {0.0};
    struct nodal_field a = {.cells = {.dim = 2, .node_count = 1, .x = point}, .cols = 2, .values = values};
    struct nodal_field b = {.cells = {.dim = 2, .node_count = 5, .x = line}, .cols = 2, .values = values};
    FREED_BY(field_comparison_free) struct field_comparison comparison = {0};
    FAILS(field_compare(&a, &b, NULL, false, &comparison, &error), STATUS_INPUT, "");
}

RUN_TESTS(NULL, NULL)
