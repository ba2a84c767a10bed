/* Fault 25: whichever allocation fails, lib/approx reports it with STATUS_SYSTEM and leaves nothing
 * allocated. See failing_allocator.h. */
#include "approx/adaptive/adaptive.h"
#include "approx/cells/face_edges.h"
#include "approx/points/cloud.h"
#include "approx/field/field_compare.h"
#include "approx/error/field_error.h"
#include "approx/error/size_field.h"
#include "approx/support/support_space.h"
#include "approx/visibility/edge_paths.h"

#include <gsl/gsl_errno.h>

#include "failing_allocator.h"

#ifdef FAILING_ALLOCATOR

/* From a cloud to the values at the points of its faces. */
static enum status try_table(struct error *error)
{
    struct cloud_options wanted = {
        .kind = CLOUD_JITTERED, .dim = 2, .count = {5, 5}, .high = {1.0, 1.0}, .jitter = 0.2};
    struct support_options options = support_defaults(2);
    FREED_BY(cloud_free) struct cloud cloud = {0};
    FREED_BY(faces_free) struct faces faces = {0};
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(support_free) struct support_lists lists = {0};
    double spacing[25], radius[25], points[400];
    SCRATCH double *phi = NULL;
    RETURN_IF_ERROR(cloud_make(&wanted, &cloud, error));
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    RETURN_IF_ERROR(cells_node_spacing(&cells, spacing, error));
    RETURN_IF_ERROR(support_radii(&options, cells.node_count, spacing, radius, error));
    RETURN_IF_ERROR(faces_build(&cells, false, &faces, error));
    face_points(&faces, cloud.x, points);
    RETURN_IF_ERROR(point_grid_build(&grid, 2, cells.node_count, cloud.x, radius, error));
    RETURN_IF_ERROR(support_build(&options, &grid, NULL, NULL, face_point_count(&faces), points, "points",
                                  &lists, error));
    RETURN_IF_ERROR(NEW_ARRAY(&phi, lists.ptr[lists.count], error));
    struct neighbours view = support_view(&lists);
    return shape_table(&options.mls, cloud.x, radius, &view, points, "points", phi, NULL, error);
}

/* Around the corner of an L: the lists at its nodes, and their values. */
static enum status try_reach(struct error *error)
{
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct support_options options = support_defaults(2);
    FREED_BY(cloud_free) struct cloud cloud = {0};
    FREED_BY(point_grid_free) struct point_grid grid = {0};
    FREED_BY(visibility_free) struct visibility visibility = {0};
    FREED_BY(support_free) struct support_lists lists = {0};
    struct visibility_places places = {0}; /* to be found */
    FREED_BY(edge_paths_free) struct edge_paths paths = {0};
    double radius[49];
    SCRATCH double *phi = NULL;
    int64_t kept = 0;
    bool reached;
    RETURN_IF_ERROR(cloud_make(&wanted, &cloud, error));
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
    RETURN_IF_ERROR(point_grid_build(&grid, 2, cells.node_count, cloud.x, radius, error));
    RETURN_IF_ERROR(visibility_build(&cells, &grid, &visibility, error));
    RETURN_IF_ERROR(support_build(&options, &grid, &visibility, &places, cells.node_count, cloud.x, "nodes",
                                  &lists, error));
    RETURN_IF_ERROR(NEW_ARRAY(&phi, lists.ptr[lists.count], error));
    struct neighbours view = support_view(&lists);
    RETURN_IF_ERROR(shape_table(&options.mls, cloud.x, radius, &view, cloud.x, "nodes", phi, NULL, error));
    RETURN_IF_ERROR(edge_paths_build(&cells, cells.node_count, 2, cloud.x, 1.0, &paths, error));
    edge_paths_begin(&paths, 0);
    for (int32_t n = 0; n < cells.node_count; n++) {
        RETURN_IF_ERROR(edge_paths_reach(&paths, n, &reached, error));
    }
    return lists.around_count > 0 ? STATUS_OK : STATUS_INPUT;
}

/* An interface across a square: the lists of its nodes, and of points whose cells are to be found. */
static enum status try_sides(struct error *error)
{
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct support_options options = support_defaults(2);
    struct visibility_places nodes = {.nodes = true};
    FREED_BY(support_space_free) struct support_space space = {0};
    FREED_BY(support_free) struct support_lists of_nodes = {0}, found = {0};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    double radius[49];
    int32_t side[72] = {[10] = 1, [11] = 1, [20] = 1, [21] = 1};
    RETURN_IF_ERROR(cloud_make(&wanted, &cloud, error));
    for (int n = 0; n < 49; n++) {
        radius[n] = 0.4;
    }
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    options.side = side;
    RETURN_IF_ERROR(support_space_build(&options, &cells, radius, &space, error));
    RETURN_IF_ERROR(support_space_lists(&options, &space, &nodes, 49, cloud.x, "nodes", &of_nodes, error));
    RETURN_IF_ERROR(support_space_lists(&options, &space, NULL, 49, cloud.x, "nodes", &found, error));
    return found.around_count > 0 ? STATUS_OK : STATUS_INPUT;
}

/* Adaptive points with a subdivision or two. */
static enum status try_adaptive(struct error *error)
{
    struct cloud_options wanted = {
        .kind = CLOUD_JITTERED, .dim = 2, .count = {3, 3}, .high = {1.0, 1.0}, .jitter = 0.2};
    struct adaptive_options options = adaptive_defaults(2);
    FREED_BY(adaptive_points_free) struct adaptive_points points = {0};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    double radius[9];
    RETURN_IF_ERROR(cloud_make(&wanted, &cloud, error));
    for (int n = 0; n < 9; n++) {
        radius[n] = 1.5;
    }
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    return adaptive_points_build(&options, &cells, radius, &points, error);
}

/* Two fields on clouds that differ: spacings, matching, interpolation, statistics. */
static enum status try_compare(struct error *error)
{
    static const double values[49];
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    FREED_BY(cloud_free) struct cloud first = {0}, second = {0};
    FREED_BY(field_comparison_free) struct field_comparison comparison = {0};
    FREED_BY(field_statistics_free) struct field_statistics statistics = {0};
    RETURN_IF_ERROR(cloud_make(&wanted, &first, error));
    wanted.kind = CLOUD_JITTERED;
    wanted.jitter = 0.2;
    RETURN_IF_ERROR(cloud_make(&wanted, &second, error));
    struct nodal_field a = {.cells = {2, 49, first.x, 0, NULL}, .cols = 1, .values = values};
    struct nodal_field b = {.cells = {2, 49, second.x, 0, NULL}, .cols = 1, .values = values};
    RETURN_IF_ERROR(field_compare(&a, &b, NULL, false, &comparison, error));
    return field_statistics(comparison.count, comparison.node, comparison.difference, &statistics, error);
}

/* The error of a field's gradient and the sizes of a finer mesh. */
static enum status try_sizes(struct error *error)
{
    static const double values[49] = {[24] = 1.0};
    struct cloud_options wanted = {.kind = CLOUD_REGULAR, .dim = 2, .count = {7, 7}, .high = {1.0, 1.0}};
    struct size_field_request request = {.share = 0.5, .most_nodes = 1000.0, .sag = 0.1};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    FREED_BY(size_field_free) struct size_field field = {0};
    double squared[72];
    RETURN_IF_ERROR(cloud_make(&wanted, &cloud, error));
    struct cells cells = {2, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    RETURN_IF_ERROR(field_error_recovered(&cells, NULL, 0, 1, values, squared, error));
    return size_field_build(&cells, squared, &request, &field, error);
}

TEST(tables)
{
    fail_each(try_table, 30);
}

TEST(around_corners)
{
    fail_each(try_reach, 30);
}

TEST(sides)
{
    fail_each(try_sides, 60);
}

TEST(adaptive)
{
    fail_each(try_adaptive, 30);
}

TEST(comparisons)
{
    fail_each(try_compare, 30);
}

TEST(sizes)
{
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
