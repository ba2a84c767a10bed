/* Cell lists against brute force; supports: caps and ties, widening; clouds too poor for them (more in
 * pipelines/hard/21-supports.sh). */
#include "approx_fixture.h"

#include "base/lists.h"
#include "base/vector.h"

/* Radii over three decades, two nodes at one place. */
TEST_IN_EACH_DIM(grid_against_brute_force)
{
    static const double factors[] = {1.0, 1.1, 2.5, 8.0};
    struct random random = {1};
    enum { NODES = 400, POINTS = 150 };
    double x[NODES * 3], radius[NODES], point[3];
    for (int kind = 0; kind < 2; kind++) { /* constant radii, graded radii */
        for (int i = 0; i < NODES * dim; i++) {
            x[i] = uniform(&random, 5.0, 6.0);
        }
        memcpy(x + dim, x, (size_t)dim * sizeof *x);
        for (int n = 0; n < NODES; n++) {
            radius[n] = kind == 0 ? 0.15 : 0.001 * pow(500.0, uniform(&random, 0.0, 1.0));
        }
        FREED_BY(point_grid_free) struct point_grid grid = {0};
        struct index_list list = {0};
        GOOD(point_grid_build(&grid, dim, NODES, x, radius, &error));
        for (int p = 0; p < POINTS; p++) {
            for (int a = 0; a < dim; a++) { /* within, at nodes, outside */
                point[a] = p < 20 ? x[p * dim + a] : uniform(&random, 4.0, 7.0);
            }
            double factor = factors[p % 4];
            list.count = 0;
            GOOD(point_grid_query(&grid, point, factor, &list, &error));
            int64_t at = 0;
            for (int n = 0; n < NODES; n++) {
                if (vector_distance(dim, x + n * dim, point) < radius[n] * factor) {
                    assert_true(at < list.count);
                    assert_int_equal(list.index[at], n);
                    at++;
                }
            }
            assert_int_equal(at, list.count);
        }
        free(list.index);
    }
}

/* Lists of points in rows, which share their search in groups, and of points all over the place, where radii
 * are constant or graded. */
TEST_IN_EACH_DIM(lists_against_brute_force)
{
    enum { POINTS = 700 };
    struct random random = {1};
    for (int kind = 0; kind < 4; kind++) { /* graded: kind & 1; all over the place: kind & 2 */
        FREED_BY(scattered_free)
        struct scattered cloud = scatter(dim, dim == 2 ? 20 : 8, POINTS, &places[2], 0.4, 17);
        struct support_options options = support_defaults(dim);
        FREED_BY(visibility_free) struct visibility space = {0};
        FREED_BY(support_free) struct neighbours lists = {0};
        double *radius = zeros(cloud.count, sizeof *radius);
        options.widen = false;
        for (int64_t n = 0; n < cloud.count; n++) {
            radius[n] = cloud.spacing * ((kind & 1) ? 0.2 * pow(20.0, uniform(&random, 0.0, 1.0)) : 2.1);
        }
        for (int64_t p = 0; p < POINTS && (kind & 2) == 0; p++) {
            for (int a = 0; a < dim; a++) {
                int64_t step = a == 0 ? p % 70 : p / 70;
                cloud.points[p * dim + a] =
                    1.0 + cloud.spacing * ((double)step / 7.0 + 0.01 * uniform(&random, 0.0, 1.0));
            }
        }
        const struct cells none = {.dim = dim, .node_count = cloud.count, .x = cloud.x};
        GOOD(visibility_build(&none, BALLS(radius), options.visibility, options.side, &space, &error));
        GOOD(support_build(&options, &space, NULL, POINTS, cloud.points, "points.x", &lists, &error));
        int64_t fewest = cloud.count, most = 0;
        for (int64_t p = 0; p < POINTS; p++) {
            int64_t at = lists.ptr[p];
            for (int64_t n = 0; n < cloud.count; n++) {
                if (vector_distance(dim, cloud.x + n * dim, cloud.points + p * dim) < radius[n]) {
                    assert_true(at < lists.ptr[p + 1]);
                    assert_int_equal(lists.idx[at], n);
                    at++;
                }
            }
            assert_int_equal(at, lists.ptr[p + 1]);
            fewest = at - lists.ptr[p] < fewest ? at - lists.ptr[p] : fewest;
            most = at - lists.ptr[p] > most ? at - lists.ptr[p] : most;
        }
        assert_int_equal(lists.fewest, fewest);
        assert_int_equal(lists.most, most);
    }
}

/* Queries append; nodes all at one place, or on a line, need no special care; wrong radii are refused. */
TEST(grid_odd_clouds)
{
    double x[6] = {1.0, 2.0, 1.0, 2.0, 1.0, 2.0}, radius[3] = {0.5, 1e9, 1e-9}, at[2] = {1.1, 2.0};
    struct point_grid grid;
    struct index_list list = {0};
    GOOD(point_grid_build(&grid, 2, 3, x, radius, &error));
    GOOD(point_grid_query(&grid, at, 1.0, &list, &error));
    GOOD(point_grid_query(&grid, x, 1.0, &list, &error));
    static const int32_t expected[] = {0, 1, 0, 1, 2};
    assert_int_equal(list.count, 5);
    assert_memory_equal(list.index, expected, sizeof expected);
    point_grid_free(&grid);
    free(list.index);
    static const double wrong[] = {0.0, -1.0, NAN, INFINITY};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        radius[1] = wrong[i];
        FAILS(point_grid_build(&grid, 2, 3, x, radius, &error), STATUS_INPUT, "row 1");
        point_grid_free(&grid);
    }
}

TEST_IN_EACH_DIM(spacing_against_brute_force)
{
    FREED_BY(scattered_free)
    struct scattered cloud = scatter(dim, dim == 2 ? 15 : 6, 1, &places[2], 0.4, 2);
    double *spacing = zeros(cloud.count, sizeof *spacing);
    double *distance = zeros(cloud.count, sizeof *distance);
    cloud.x[0] -= 3.0 * cloud.size; /* one node far from the others */
    GOOD(nodes_spacing(dim, cloud.count, cloud.x, spacing, &error));
    for (int64_t n = 0; n < cloud.count; n++) {
        double mean = 0.0;
        for (int64_t i = 0; i < cloud.count; i++) {
            distance[i] = vector_distance(dim, cloud.x + n * dim, cloud.x + i * dim);
        }
        qsort(distance, (size_t)cloud.count, sizeof *distance, compare_double);
        for (int k = 1; k <= 2 * dim; k++) {
            mean += distance[k] / (2 * dim);
        }
        AT_MOST(fabs(spacing[n] / mean - 1.0), 1e-12);
    }
}

/* At most so many nearest neighbours: of equally distant ones the lower indices stay. */
TEST(nearest_with_ties)
{
    double x[25 * 2];
    for (int n = 0; n < 25; n++) {
        x[2 * n] = n % 5;
        x[2 * n + 1] = n / 5;
    }
    static const double point[] = {2.0, 2.0};
    static const int32_t expected[][9] = {
        {12}, {7, 11, 12, 13}, {7, 11, 12, 13, 17}, {6, 7, 8, 11, 12, 13, 17}};
    static const int64_t most[] = {1, 4, 5, 7};
    for (int i = 0; i < 4; i++) {
        struct support_options options = {.radius = 2.1, .most = most[i], .mls = mls_default(2)};
        FREED_BY(visibility_free) struct visibility space = {0};
        FREED_BY(support_free) struct neighbours lists = {0};
        const struct cells none = {.dim = 2, .node_count = 25, .x = x};
        double radius[25];
        GOOD(support_radii(&options, 25, NULL, radius, &error));
        GOOD(visibility_build(&none, BALLS(radius), options.visibility, options.side, &space, &error));
        GOOD(support_build(&options, &space, NULL, 1, point, "points.x", &lists, &error));
        assert_int_equal(lists.ptr[1], most[i]);
        assert_memory_equal(lists.idx, expected[i], (size_t)most[i] * sizeof(int32_t));
    }
}

TEST(least_neighbours)
{
    FREED_BY(scattered_free) struct scattered cloud = scatter(2, 12, 200, &places[0], 0.3, 4);
    struct support_options options = support_defaults(2);
    options.least = 15;
    FREED_BY(table_free) struct table table = {0};
    GOOD(tabulate(&options, cloud.count, cloud.x, 200, cloud.points, &table, &error));
    int64_t widened = 0;
    double widest = 1.0;
    for (int64_t p = 0; p < 200; p++) {
        assert_true(table.lists.ptr[p + 1] - table.lists.ptr[p] >= 15);
        assert_true(table.lists.widen[p] >= 1.0);
        widened += table.lists.widen[p] > 1.0;
        widest = fmax(widest, table.lists.widen[p]);
        for (int64_t i = table.lists.ptr[p] + 1; i < table.lists.ptr[p + 1]; i++) {
            assert_true(table.lists.idx[i] > table.lists.idx[i - 1]);
        }
    }
    assert_true(widened > 0);
    assert_int_equal(widened, table.lists.widened);
    assert_true(widest == table.lists.widest);
}

/* So many nodes at one place that they have no spacing. */
TEST(coincident)
{
    double x[34 * 2];
    struct support_options options = support_defaults(2);
    FREED_BY(table_free) struct table table = {0};
    for (int n = 0; n < 34; n++) {
        x[2 * n] = n < 25 ? n % 5 : 2.0;
        x[2 * n + 1] = n < 25 ? n / 5 : 2.0;
    }
    FAILS(tabulate(&options, 34, x, 34, x, &table, &error), STATUS_INPUT, "nodes.x: row 12");
}

/* Fewer nodes than any basis needs, down to one. */
TEST_IN_EACH_DIM(few)
{
    for (int64_t count = 1; count <= dim + 1; count++) {
        double x[4 * 3] = {0.0};
        struct support_options options = support_defaults(dim);
        FREED_BY(table_free) struct table table = {0};
        struct error error;
        for (int64_t n = 1; n < count; n++) {
            x[n * dim + n - 1] = 1.0;
        }
        enum status status = tabulate(&options, count, x, 1, x, &table, &error);
        assert_int_equal(status, count == 1 ? STATUS_INPUT : count <= dim ? STATUS_VERDICT : STATUS_OK);
        if (status == STATUS_OK) {
            AT_MOST(table_defects(&table, dim, x, x, 1.0).gradient_position, 1e-10);
        }
    }
}

RUN_TESTS(NULL, NULL)
