/* Fault 25: whichever allocation fails, lib/approx reports it with STATUS_SYSTEM and leaves nothing
 * allocated. See failing_allocator.h. */
#include "approx/adaptive.h"
#include "approx/cloud.h"
#include "approx/field_compare.h"
#include "approx/field_error.h"
#include "approx/quadrature.h"
#include "approx/size_field.h"
#include "approx/support_space.h"
#include "approx/ways.h"
#include "base/memory.h"

#include <gsl/gsl_errno.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

/* From a cloud to its averages over faces. */
static enum status try_table(struct error *error)
{
    enum status status;
    struct cloud_options wanted = {
        .kind = CLOUD_JITTERED, .dim = 2, .count = {5, 5}, .high = {1.0, 1.0}, .jitter = 0.2};
    struct support_options options = support_defaults(2);
    struct cloud cloud = {0};
    struct faces faces = {0};
    struct point_grid grid = {0};
    struct support_lists lists = {0};
    struct face_averages table = {0};
    double spacing[25], radius[25], points[400], *phi = NULL;
    TRY(cloud_make(&wanted, &cloud, error));
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    TRY(cells_node_spacing(&cells, spacing, error));
    TRY(support_radii(&options, cells.node_count, spacing, radius, error));
    TRY(faces_build(&cells, false, &faces, error));
    face_rows_points(&faces, cloud.x, points);
    TRY(point_grid_build(&grid, 2, cells.node_count, cloud.x, radius, error));
    TRY(support_build(&options, &grid, 2 * faces.count, points, "points", &lists, error));
    TRY(NEW_ARRAY(&phi, lists.ptr[lists.count], error));
    struct neighbours view = support_view(&lists);
    TRY(shape_table(&options.mls, cloud.x, radius, &view, points, "points", phi, NULL, error));
    TRY(shape_average_faces(&options.mls, cloud.x, radius, &view, points, "points", &faces, &table, error));
done:
    face_averages_free(&table);
    support_free(&lists);
    point_grid_free(&grid);
    faces_free(&faces);
    cloud_free(&cloud);
    free(phi);
    return status;
}

/* Around the corner of an L: the lists at its nodes, and their values. */
static enum status try_reach(struct error *error)
{
    enum status status;
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct support_options options = support_defaults(2);
    struct cloud cloud = {0};
    struct point_grid grid = {0};
    struct reach reach = {0};
    struct support_lists lists = {0};
    struct reach_places places = {0}; /* to be found */
    struct ways ways = {0};
    double radius[49], *phi = NULL;
    int64_t kept = 0;
    bool reached;
    TRY(cloud_make(&wanted, &cloud, error));
    for (int64_t c = 0; c < cloud.cell_count; c++) {
        double middle[2];
        struct cells all = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
        cell_centroid(&all, c, middle);
        if (middle[0] < 0.5 || middle[1] < 0.5) {
            memmove(cloud.cells + 3 * kept++, cloud.cells + 3 * c, 3 * sizeof *cloud.cells);
        }
    }
    for (int n = 0; n < 49; n++) {
        radius[n] = 0.5;
    }
    struct cells cells = {2, cloud.node_count, cloud.x, kept, cloud.cells};
    TRY(point_grid_build(&grid, 2, cells.node_count, cloud.x, radius, error));
    TRY(reach_build(&cells, &grid, &reach, error));
    TRY(support_build_within(&options, &grid, &reach, &places, cells.node_count, cloud.x, "nodes", &lists,
                             error));
    TRY(NEW_ARRAY(&phi, lists.ptr[lists.count], error));
    struct neighbours view = support_view(&lists);
    TRY(shape_table(&options.mls, cloud.x, radius, &view, cloud.x, "nodes", phi, NULL, error));
    TRY(ways_build(&cells, cells.node_count, 2, cloud.x, 1.0, &ways, error));
    ways_begin(&ways, 0);
    for (int32_t n = 0; n < cells.node_count; n++) {
        TRY(ways_reach(&ways, n, &reached, error));
    }
    status = lists.around_count > 0 ? STATUS_OK : STATUS_INPUT;
done:
    ways_free(&ways);
    support_free(&lists);
    reach_free(&reach);
    point_grid_free(&grid);
    cloud_free(&cloud);
    free(phi);
    return status;
}

/* An interface across a square: the lists of its nodes, and of points whose cells are to be found. */
static enum status try_sides(struct error *error)
{
    enum status status;
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct support_options options = support_defaults(2);
    struct reach_places nodes = {.nodes = true};
    struct support_space space = {0};
    struct support_lists of_nodes = {0}, found = {0};
    struct cloud cloud = {0};
    double radius[49];
    int32_t side[72] = {[10] = 1, [11] = 1, [20] = 1, [21] = 1};
    TRY(cloud_make(&wanted, &cloud, error));
    for (int n = 0; n < 49; n++) {
        radius[n] = 0.4;
    }
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    options.side = side;
    TRY(support_space_build(&options, &cells, radius, &space, error));
    TRY(support_space_lists(&options, &space, &nodes, 49, cloud.x, "nodes", &of_nodes, error));
    TRY(support_space_lists(&options, &space, NULL, 49, cloud.x, "nodes", &found, error));
    status = found.around_count > 0 ? STATUS_OK : STATUS_INPUT;
done:
    support_free(&of_nodes);
    support_free(&found);
    support_space_free(&space);
    cloud_free(&cloud);
    return status;
}

/* Adaptive points with a subdivision or two. */
static enum status try_adaptive(struct error *error)
{
    enum status status;
    struct cloud_options wanted = {
        .kind = CLOUD_JITTERED, .dim = 2, .count = {3, 3}, .high = {1.0, 1.0}, .jitter = 0.2};
    struct adaptive_options options = adaptive_defaults(2);
    struct adaptive_points points = {0};
    struct cloud cloud = {0};
    double radius[9];
    TRY(cloud_make(&wanted, &cloud, error));
    for (int n = 0; n < 9; n++) {
        radius[n] = 1.5;
    }
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    TRY(adaptive_points_build(&options, &cells, radius, &points, error));
done:
    adaptive_points_free(&points);
    cloud_free(&cloud);
    return status;
}

/* Two fields on clouds that differ: spacings, matching, interpolation, statistics. */
static enum status try_compare(struct error *error)
{
    enum status status;
    static const double values[49];
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct cloud first = {0}, second = {0};
    struct field_comparison comparison = {0};
    struct field_statistics statistics = {0};
    TRY(cloud_make(&wanted, &first, error));
    wanted.kind = CLOUD_JITTERED;
    wanted.jitter = 0.2;
    TRY(cloud_make(&wanted, &second, error));
    struct nodal_field a = {.cells = {2, 49, first.x, 0, NULL}, .cols = 1, .values = values};
    struct nodal_field b = {.cells = {2, 49, second.x, 0, NULL}, .cols = 1, .values = values};
    TRY(field_compare(&a, &b, NULL, false, &comparison, error));
    TRY(field_statistics(comparison.count, comparison.node, comparison.difference, &statistics, error));
done:
    field_statistics_free(&statistics);
    field_comparison_free(&comparison);
    cloud_free(&first);
    cloud_free(&second);
    return status;
}

/* The error of a field's gradient and the sizes of a finer mesh. */
static enum status try_sizes(struct error *error)
{
    enum status status;
    static const double values[49] = {[24] = 1.0};
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct size_field_request request = {.share = 0.5, .most_nodes = 1000.0, .sag = 0.1};
    struct cloud cloud = {0};
    struct size_field field = {0};
    double squared[72];
    TRY(cloud_make(&wanted, &cloud, error));
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    TRY(field_error_recovered(&cells, NULL, 0, 1, values, squared, error));
    TRY(size_field_build(&cells, squared, &request, &field, error));
done:
    size_field_free(&field);
    cloud_free(&cloud);
    return status;
}

/* One thread, and a first run unwatched: what OpenMP allocates for itself is not ours to test. */
TEST(tables)
{
    GOOD(try_table(&error));
    fail_each(try_table, 30);
}

TEST(around_corners)
{
    GOOD(try_reach(&error));
    fail_each(try_reach, 30);
}

TEST(sides)
{
    GOOD(try_sides(&error));
    fail_each(try_sides, 60);
}

TEST(adaptive)
{
    GOOD(try_adaptive(&error));
    fail_each(try_adaptive, 30);
}

TEST(comparisons)
{
    GOOD(try_compare(&error));
    fail_each(try_compare, 30);
}

TEST(sizes)
{
    GOOD(try_sizes(&error));
    fail_each(try_sizes, 10);
}

static int as_the_tools_do(void **state)
{
    gsl_set_error_handler_off();
    return one_thread(state);
}

RUN_TESTS(as_the_tools_do, NULL)

#else
RUN_TESTS(NULL, NULL)
#endif
