/* Supports that stop at interfaces: whose nodes the lists hold, and fields with a kink. */
#include "approx_fixture.h"

#include "approx/points/cloud.h"
#include "approx/field/field.h"
#include "approx/support/support.h"
#include "base/vector.h"

/* A lattice over the unit square or cube, its cells on the sides x < .5 and x > .5 of an interface. */
struct halves {
    struct cloud cloud;
    struct cells cells;
    int32_t *side;
    double *radius;
};

static struct halves make_halves(int dim, const struct support_options *options)
{
    struct cloud_options wanted = {
        .kind = CLOUD_REGULAR, .dim = dim, .count = {9, dim == 2 ? 9 : 5, 5}, .high = {1.0, 1.0, 1.0}};
    struct halves halves = {0};
    GOOD(cloud_make(&wanted, &halves.cloud, &error));
    struct cloud *cloud = &halves.cloud;
    halves.cells = (struct cells){dim, cloud->node_count, cloud->x, cloud->cell_count, cloud->cells};
    halves.side = calloc((size_t)halves.cells.count, sizeof *halves.side);
    halves.radius = calloc((size_t)halves.cells.node_count, sizeof *halves.radius);
    double *spacing = zeros(halves.cells.node_count, sizeof *spacing);
    assert_true(halves.side != NULL && halves.radius != NULL && spacing != NULL);
    for (int64_t c = 0; c < halves.cells.count; c++) {
        double middle[3];
        cell_centroid(&halves.cells, c, middle);
        halves.side[c] = middle[0] > 0.5;
    }
    GOOD(cells_node_spacing(&halves.cells, NULL, spacing, &error));
    GOOD(support_radii(options, halves.cells.node_count, spacing, halves.radius, &error));
    return halves;
}

static void halves_free(struct halves *halves)
{
    cloud_free(&halves->cloud);
    free(halves->side);
    free(halves->radius);
}

/* Points scattered over the body, every third on the interface. */
static double *scatter_points(int dim, int64_t count)
{
    double *x = calloc((size_t)(count * dim), sizeof *x);
    struct random random = {.state = 1};
    assert_non_null(x);
    for (int64_t i = 0; i < count * dim; i++) {
        x[i] = i % (3 * dim) == 0 ? 0.5 : uniform(&random, 0.0, 1.0);
    }
    return x;
}

/* A field under which lengths along x become 1 - 1.5 x of what they were: the body is turned over from x =
 * 2/3 on. The determinant is that of the outermost points within each cell. */
TEST_IN_EACH_DIM(field_turns_cells_over)
{
    struct support_options options = support_defaults(dim);
    options.mls.basis = BASIS_QUADRATIC;
    options.factor = 2.8;
    struct halves halves = make_halves(dim, &options);
    const struct cells *cells = &halves.cells;
    FREED_BY(visibility_free) struct visibility space = {0};
    SCRATCH double *u = NULL, *least = NULL;
    SCRATCH int32_t *cell = NULL;
    ARRAY(u, cells->node_count * dim);
    ARRAY(least, cells->count);
    ARRAY(cell, cells->count);
    for (int64_t n = 0; n < cells->node_count; n++) {
        u[n * dim] = -0.75 * cells->x[n * dim] * cells->x[n * dim];
    }
    for (int64_t c = 0; c < cells->count; c++) {
        cell[c] = (int32_t)(cells->count - 1 - c);
    }
    GOOD(visibility_build(cells, BALLS(halves.radius), options.visibility, options.side, &space, &error));
    GOOD(field_least_determinants(&(struct field_shapes){{.radius = halves.radius}, options, options.mls},
                                  &space, cells->count, cell, u, least, &error));
    for (int64_t c = 0; c < cells->count; c++) {
        double sum = 0.0, most = 0.0;
        for (int k = 0; k <= dim; k++) {
            double x = cells->x[cells->node[cell[c] * (dim + 1) + k] * dim];
            sum += x;
            most = fmax(most, x);
        }
        NEAR_TO(least[c], 1.0 - 1.5 * (sum + (5 - dim) * most) / 6.0, 1e-9);
    }
    u[0] = (double)NAN;
    GOOD(field_least_determinants(&(struct field_shapes){{.radius = halves.radius}, options, options.mls},
                                  &space, cells->count, cell, u, least, &error));
    assert_true(isnan(least[cells->count - 1]) && !isnan(least[0]));
    halves_free(&halves);
}

/* Each list holds nodes of its side only, those of the interface among them, and all that are within reach
 * there: the body is convex on either side. */
TEST_IN_EACH_DIM(lists_stop_at_the_interface)
{
    enum { COUNT = 300 };
    struct support_options options = support_defaults(dim);
    options.widen = false;
    FREED_BY(halves_free) struct halves halves = make_halves(dim, &options);
    FREED_BY(visibility_free) struct visibility space = {0};
    FREED_BY(support_free) struct neighbours lists = {0};
    SCRATCH double *x = scatter_points(dim, COUNT);
    int64_t crossing = 0;
    options.side = halves.side;
    GOOD(visibility_build(&halves.cells, BALLS(halves.radius), options.visibility, options.side, &space,
                          &error));
    GOOD(support_build(&options, &space, NULL, COUNT, x, "points", &lists, &error));
    for (int64_t p = 0; p < COUNT; p++) {
        int64_t at = lists.ptr[p];
        for (int32_t n = 0; n < halves.cells.node_count; n++) {
            bool near = vector_distance(dim, x + p * dim, halves.cells.x + n * dim) < halves.radius[n];
            double node = halves.cells.x[(int64_t)n * dim];
            bool same = x[p * dim] <= 0.5 ? node <= 0.5 : node >= 0.5;
            bool listed = at < lists.ptr[p + 1] && lists.idx[at] == n;
            assert_int_equal(listed, near && same);
            crossing += near && !same;
            at += listed;
        }
        assert_int_equal(at, lists.ptr[p + 1]);
    }
    assert_true(crossing > 100);
}

/* What is known of the points' cells changes nothing, nor that points are nodes. */
TEST_IN_EACH_DIM(places_tell_the_side)
{
    struct support_options options = support_defaults(dim);
    FREED_BY(halves_free) struct halves halves = make_halves(dim, &options);
    FREED_BY(visibility_free) struct visibility space = {0};
    struct neighbours found, given;
    int64_t nodes = halves.cells.node_count, cells = halves.cells.count;
    double *middle = zeros(cells * dim, sizeof *middle);
    int32_t *cell = zeros(cells, sizeof *cell);
    assert_true(middle != NULL && cell != NULL);
    options.side = halves.side;
    GOOD(visibility_build(&halves.cells, BALLS(halves.radius), options.visibility, options.side, &space,
                          &error));
    struct visibility_places at_nodes = {.nodes = true}, in_cells = {.cell = cell, .points_per_row = 1};
    for (int64_t c = 0; c < cells; c++) {
        cell_centroid(&halves.cells, c, middle + c * dim);
        cell[c] = (int32_t)c;
    }
    for (int kind = 0; kind < 2; kind++) {
        int64_t count = kind == 0 ? nodes : cells;
        const double *x = kind == 0 ? halves.cells.x : middle;
        const struct visibility_places *known = kind == 0 ? &at_nodes : &in_cells;
        GOOD(support_build(&options, &space, NULL, count, x, "points", &found, &error));
        GOOD(support_build(&options, &space, known, count, x, "points", &given, &error));
        assert_memory_equal(found.ptr, given.ptr, (size_t)(count + 1) * sizeof *found.ptr);
        assert_memory_equal(found.idx, given.idx, (size_t)found.ptr[count] * sizeof *found.idx);
        assert_memory_equal(found.widen, given.widen, (size_t)count * sizeof *found.widen);
        support_free(&found);
        support_free(&given);
    }
}

/* A field that is linear on either side, with a kink at the interface, is exact; across it, it is not. */
TEST_IN_EACH_DIM(kinks_are_exact)
{
    enum { COUNT = 300 };
    struct support_options options = support_defaults(dim);
    FREED_BY(halves_free) struct halves halves = make_halves(dim, &options);
    double *x = scatter_points(dim, COUNT), got[COUNT], worst[2] = {0.0, 0.0};
    double *field = zeros(halves.cells.node_count, sizeof *field);
    for (int64_t n = 0; n < halves.cells.node_count; n++) {
        const double *at = halves.cells.x + n * dim;
        field[n] = fabs(at[0] - 0.5) + 0.3 * at[dim - 1];
    }
    for (int stops = 0; stops < 2; stops++) {
        FREED_BY(field_table_free) struct field_table table = {0};
        options.side = stops ? halves.side : NULL;
        GOOD(field_table_build(&(struct field_shapes){{.radius = halves.radius}, options, options.mls},
                               &halves.cells, NULL, COUNT, x, "points", &table, &error));
        field_evaluate(COUNT, table.lists.ptr, table.lists.idx, table.phi, 1, field, got);
        for (int64_t p = 0; p < COUNT; p++) {
            double exact = fabs(x[p * dim] - 0.5) + 0.3 * x[p * dim + dim - 1];
            worst[stops] = worse(worst[stops], got[p] - exact);
        }
    }
    AT_MOST(worst[1], 1e-12);
    assert_true(worst[0] > 1e-2);
    free(x);
}

/* A region within the rest, and one that is a single cell. */
TEST(inclusions)
{
    struct support_options options = support_defaults(2);
    FREED_BY(halves_free) struct halves halves = make_halves(2, &options);
    struct visibility_places at_nodes = {.nodes = true};
    for (int single = 0; single < 2; single++) {
        FREED_BY(visibility_free) struct visibility space = {0};
        FREED_BY(support_free) struct neighbours lists = {0};
        for (int64_t c = 0; c < halves.cells.count; c++) {
            double middle[2];
            cell_centroid(&halves.cells, c, middle);
            halves.side[c] = single ? c == 40 : fabs(middle[0] - 0.5) < 0.13 && fabs(middle[1] - 0.5) < 0.13;
        }
        options.side = halves.side;
        GOOD(visibility_build(&halves.cells, BALLS(halves.radius), options.visibility, options.side, &space,
                              &error));
        GOOD(support_build(&options, &space, &at_nodes, halves.cells.node_count, halves.cells.x, "nodes",
                           &lists, &error));
        assert_true(lists.fewest >= 3);
    }
}

/* A point without a good support is named by its number among all. */
TEST(failures_name_the_row)
{
    struct support_options options = support_defaults(2);
    FREED_BY(halves_free) struct halves halves = make_halves(2, &options);
    FREED_BY(visibility_free) struct visibility space = {0};
    struct neighbours lists;
    static const double x[] = {0.2, 0.2, 0.8, 0.8, NAN, 0.8, 0.7, 0.7};
    options.side = halves.side;
    GOOD(visibility_build(&halves.cells, BALLS(halves.radius), options.visibility, options.side, &space,
                          &error));
    FAILS_WITH(support_build(&options, &space, NULL, 4, x, "points.x", &lists, &error), STATUS_INPUT,
               "points.x: row 2: not a finite coordinate");
    options.least = 1000;
    static const double inside[] = {0.8, 0.8, 0.2, 0.2};
    FAILS(support_build(&options, &space, NULL, 2, inside, "points.x", &lists, &error), STATUS_VERDICT,
          "points.x: row 0 at (0.8, 0.8): no good support");
}

RUN_TESTS(NULL, NULL)
