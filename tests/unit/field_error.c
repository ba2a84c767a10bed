/* The discretisation error of a field: extrapolation, recovery of gradients, means over a body; and the sizes
 * of a graded mesh that follow. */
#include "box_fixture.h"

#include "approx/error/field_error.h"

static struct cloud lattice(int dim, int n, double jitter)
{
    return sized_cloud(dim, n, jitter, 0.0, 1.0);
}

static double *array_of(int64_t count, double value)
{
    double *array = zeros(count, sizeof *array);
    for (int64_t i = 0; i < count; i++) {
        array[i] = value;
    }
    return array;
}

/* An error c h^p on spacings h, 2 h, 4 h is found again, and its order. */
TEST(extrapolation)
{
    for (double p = 1.0; p <= 2.0; p += 0.25) {
        double fine = pow(2.0, p) - 1.0, coarse = pow(4.0, p) - pow(2.0, p); /* differences, c h^p = 1 */
        AT_MOST(fabs(fine * field_error_share(2.0, p) - 1.0), 1e-14);
        AT_MOST(fabs(field_error_order(fine, coarse, 2.0, FIELD_ERROR_LEAST_ORDER) - p), 1e-14);
    }
    AT_MOST(fabs(field_error_share(3.0, 2.0) - 0.125), 1e-15);
    assert_true(field_error_order(1.0, 8.0, 2.0, FIELD_ERROR_LEAST_ORDER) == FIELD_ERROR_MOST_ORDER);
    assert_true(field_error_order(1.0, 1.5, 2.0, FIELD_ERROR_LEAST_ORDER) == FIELD_ERROR_LEAST_ORDER);
    assert_true(field_error_order(0.0, 1.0, 2.0, FIELD_ERROR_LEAST_ORDER) == FIELD_ERROR_MOST_ORDER);
    assert_true(field_error_order(1.0, NAN, 2.0, FIELD_ERROR_LEAST_ORDER) == FIELD_ERROR_MOST_ORDER);
}

/* A mean over the body is no mean over its nodes, which a graded cloud has in one corner. */
TEST_IN_EACH_DIM(mean_over_body)
{
    struct cloud_options wanted = {
        .kind = CLOUD_GRADED, .dim = dim, .count = {7, 7, 7}, .high = {1.0, 1.0, 1.0}, .ratio = 10.0};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    GOOD(cloud_make(&wanted, &cloud, &error));
    struct cells cells = cells_of(&cloud);
    double *value = array_of(cells.node_count, 0.0);
    for (int64_t n = 0; n < cells.node_count; n++) {
        value[n] = 3.0 + cells.x[n * dim]; /* 3.5 in the mean over the body */
    }
    AT_MOST(fabs(field_error_mean(&cells, value) - 3.5), 1e-13);
    for (int64_t n = 0; n < cells.node_count; n++) {
        value[n] = cells.x[n * dim] > 0.9 ? NAN : 2.0;
    }
    AT_MOST(fabs(field_error_mean(&cells, value) - 2.0), 1e-13);
    for (int64_t n = 0; n < cells.node_count; n++) {
        value[n] = NAN;
    }
    assert_true(isnan(field_error_mean(&cells, value)));
}

/* Gradients of a linear field are recovered, also where its slope jumps between two regions. */
TEST_IN_EACH_DIM(linear_fields_have_no_error)
{
    FREED_BY(cloud_free) struct cloud cloud = lattice(dim, 7, 0.0);
    struct cells cells = cells_of(&cloud);
    double *values = array_of(cells.node_count * 2, -7.0), *squared = array_of(cells.count, -1.0);
    int32_t *region = zeros(cells.count, sizeof *region);
    for (int64_t q = 0; q < cells.count; q++) {
        double middle[3];
        cell_centroid(&cells, q, middle);
        region[q] = middle[0] > 0.5;
    }
    for (int64_t n = 0; n < cells.node_count; n++) {
        double x = cells.x[n * dim];
        values[2 * n] = x > 0.5 ? 4.0 * x - 1.5 : x;
        values[2 * n + 1] = 1.0 - 2.0 * cells.x[n * dim + 1];
    }
    GOOD(field_error_recovered(&cells, region, 2, 2, values, squared, &error));
    double largest = 0.0;
    for (int64_t q = 0; q < cells.count; q++) {
        assert_true(squared[q] >= 0.0);
        largest = fmax(largest, squared[q]);
    }
    AT_MOST(largest, 1e-26);
    GOOD(field_error_recovered(&cells, NULL, 0, 2, values, squared, &error));
    for (int64_t q = 0; q < cells.count; q++) {
        double middle[3];
        cell_centroid(&cells, q, middle);
        bool near = fabs(middle[0] - 0.5) < 1.0 / 6.0;
        assert_true(near ? squared[q] > 1e-6 : squared[q] < 1e-26);
    }
    values[5] = NAN;
    FAILS(field_error_recovered(&cells, NULL, 0, 2, values, squared, &error), STATUS_INPUT, "row 2");
}

/* Of a quadratic field the recovered error is about the true one of the interpolant, and halves with the
 * cells.
 */
TEST_IN_EACH_DIM(quadratic_fields_converge)
{
    double total[2];
    for (int i = 0; i < 2; i++) {
        FREED_BY(cloud_free) struct cloud cloud = lattice(dim, i == 0 ? 9 : 17, 0.0);
        struct cells cells = cells_of(&cloud);
        double *values = array_of(cells.node_count, 0.0), *squared = array_of(cells.count, 0.0);
        for (int64_t n = 0; n < cells.node_count; n++) {
            values[n] = cells.x[n * dim] * cells.x[n * dim];
        }
        GOOD(field_error_recovered(&cells, NULL, 0, 1, values, squared, &error));
        total[i] = 0.0;
        for (int64_t q = 0; q < cells.count; q++) {
            total[i] += squared[q];
        }
        /* The gradient 2 x is off by up to h in a cell: h^2 / 3 in the mean square. */
        double h = i == 0 ? 1.0 / 8 : 1.0 / 16, exact = h * h / 3.0;
        AT_MOST(fabs(log(total[i] / exact)), log(1.5));
    }
    AT_MOST(fabs(total[0] / total[1] - 4.0), 0.6);
}

/* Equal errors: all cells become smaller alike, by the root of the share, and so many more. */
TEST_IN_EACH_DIM(equal_errors_keep_a_mesh_even)
{
    FREED_BY(cloud_free) struct cloud cloud = lattice(dim, 6, 0.0);
    struct cells cells = cells_of(&cloud);
    struct size_field_request request = {.share = 0.25, .most_nodes = 1e9};
    struct size_field field;
    double *squared = array_of(cells.count, 3.0), *spacing = array_of(cells.node_count, 0.0);
    GOOD(cells_node_spacing(&cells, NULL, spacing, &error));
    GOOD(size_field_build(&cells, squared, &request, &field, &error));
    for (int64_t n = 0; n < cells.node_count; n++) {
        AT_MOST(fabs(field.size[n] / spacing[n] - 0.5), 0.2);
    }
    double more = field.nodes / (double)cells.node_count;
    AT_MOST(fabs(more / pow(2.0, dim) - 1.0), 0.1);
    assert_true(field.nodes == field.unbound);
    size_field_free(&field);

    /* No more nodes than there may be: all sizes larger by one factor. */
    request.most_nodes = (double)cells.node_count;
    GOOD(size_field_build(&cells, squared, &request, &field, &error));
    AT_MOST(fabs(field.nodes - request.most_nodes), 0.0);
    assert_true(field.unbound > field.nodes);
    size_field_free(&field);

    /* Without errors cells become larger, but not at the boundary. */
    request = (struct size_field_request){.share = 1.0, .most_nodes = 1e9};
    memset(squared, 0, (size_t)cells.count * sizeof *squared);
    GOOD(size_field_build(&cells, squared, &request, &field, &error));
    for (int64_t n = 0; n < cells.node_count; n++) {
        bool inside = true;
        for (int a = 0; a < dim; a++) {
            inside = inside && cells.x[n * dim + a] > 1e-9 && cells.x[n * dim + a] < 1.0 - 1e-9;
        }
        assert_true(inside ? field.size[n] > spacing[n] : field.size[n] <= spacing[n]);
    }
    size_field_free(&field);
}

/* Bad cells around one node: sizes are least there, change along no edge by more than the gradation, and keep
 * their bounds. */
TEST_IN_EACH_DIM(bad_cells)
{
    FREED_BY(cloud_free) struct cloud cloud = lattice(dim, 9, 0.0);
    struct cells cells = cells_of(&cloud);
    struct size_field_request request = {.share = 0.5, .most_nodes = 1e9};
    struct size_field field;
    double *squared = array_of(cells.count, 1e-6), least;
    int64_t bad = dim == 2 ? 4 * 9 + 4 : (4 * 9 + 4) * 9 + 4; /* in the middle */
    for (int64_t i = 0; i < cells.count * (dim + 1); i++) {
        if (cells.node[i] == bad) {
            squared[i / (dim + 1)] = 1.0;
        }
    }
    for (int pass = 0; pass < 2; pass++) {
        GOOD(size_field_build(&cells, squared, &request, &field, &error));
        least = INFINITY;
        for (int64_t n = 0; n < cells.node_count; n++) {
            least = fmin(least, field.size[n]);
            for (int a = 0; a < dim; a++) { /* inner nodes stay, those of the boundary go outward */
                double x = cells.x[n * dim + a], way = field.outer[n * dim + a] - x;
                assert_true(x < 1e-9 ? way <= 0.0 : x > 1.0 - 1e-9 ? way >= 0.0 : fabs(way) < 1e-9);
            }
        }
        AT_MOST(field.size[bad], least * (1.0 + 1e-12));
        for (int64_t q = 0; q < cells.count; q++) {
            const int32_t *node = cells.node + q * (dim + 1);
            for (int k = 1; k <= dim; k++) {
                double length = 0.0;
                for (int a = 0; a < dim; a++) {
                    length = hypot(length, cells.x[node[k] * dim + a] - cells.x[node[0] * dim + a]);
                }
                AT_MOST(fabs(field.size[node[k]] - field.size[node[0]]),
                        SIZE_FIELD_GRADATION * length * (1.0 + 1e-6));
            }
        }
        size_field_free(&field);
        if (pass == 0) {
            assert_true(least < 0.9 / 8);
            request.least = 1.2 * least;
        } else {
            AT_MOST(fabs(least / request.least - 1.0), 1e-12);
        }
    }
}

/* A ring of radii 1 and 2: facets no farther than asked off the circles; a square's corners are no curves. */
TEST(facets_near_their_curve)
{
    FREED_BY(cloud_free) struct cloud ring = lattice(2, 13, 0.0), square = lattice(2, 13, 0.0);
    struct size_field_request request = {.share = 1.0, .most_nodes = 1e9};
    FREED_BY(size_field_free) struct size_field bent = {0}, straight = {0}, limited = {0};
    for (int64_t n = 0; n < ring.node_count; n++) {
        double r = 2.0 - ring.x[2 * n], angle = 2.0 * ring.x[2 * n + 1];
        ring.x[2 * n] = r * cos(angle);
        ring.x[2 * n + 1] = r * sin(angle);
    }
    struct cells cells = cells_of(&ring), flat = cells_of(&square);
    for (int64_t q = 0; q < cells.count; q++) {
        if (cell_volume(&cells, q) < 0.0) {
            int32_t node = ring.cells[3 * q];
            ring.cells[3 * q] = ring.cells[3 * q + 1];
            ring.cells[3 * q + 1] = node;
        }
    }
    double *squared = array_of(cells.count, 1.0);
    request.sag = 1e-4;
    GOOD(size_field_build(&cells, squared, &request, &bent, &error));
    for (int64_t n = 0; n < cells.node_count; n++) {
        double x = cells.x[2 * n], y = cells.x[2 * n + 1], r = hypot(x, y), angle = atan2(y, x);
        bool on_circle = fabs(r - 1.0) < 1e-9 || fabs(r - 2.0) < 1e-9;
        if (on_circle && angle > 0.1 && angle < 1.9) {
            double exact = sqrt(8.0 * 1e-4 * r);
            AT_MOST(fabs(bent.size[n] / exact - 1.0), 0.05);
        }
    }
    GOOD(size_field_build(&flat, squared, &request, &straight, &error));
    request.sag = 0.0;
    GOOD(size_field_build(&flat, squared, &request, &limited, &error));
    assert_memory_equal(straight.size, limited.size, (size_t)flat.node_count * sizeof(double));
}

TEST(nodes_of_no_cell)
{
    static const double x[] = {0, 0, 1, 0, 0, 1, 5, 5}, squared[] = {1.0};
    static const int32_t node[] = {0, 1, 2};
    struct cells cells = {2, 4, x, 1, node};
    struct size_field_request request = {.share = 1.0, .most_nodes = 100.0};
    FREED_BY(size_field_free) struct size_field field = {0};
    FAILS(size_field_build(&cells, squared, &request, &field, &error), STATUS_INPUT, "node 3");
}

RUN_TESTS(NULL, NULL)
