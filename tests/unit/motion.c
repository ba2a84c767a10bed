/* The motion between the nodes, its inverse, and which cell each point of a grid lies in. */
#include "box_fixture.h"

#include "approx/field/field_compare.h"
#include "approx/field/motion.h"
#include "approx/cells/cells.h"
#include "base/vector.h"

/* A jittered cloud in the unit square or cube, and a field on it. */
struct body {
    struct cloud cloud;
    struct cells cells;
    double *u;
};

typedef void (*field_function)(int dim, const double *x, double *u);

static void linear_field(int dim, const double *x, double *u)
{
    for (int i = 0; i < dim; i++) {
        u[i] = 0.05 * (i + 1) + 0.3 * x[(i + 1) % dim] - 0.1 * x[i];
    }
}

static void quadratic_field(int dim, const double *x, double *u)
{
    for (int i = 0; i < dim; i++) {
        u[i] = 0.1 * x[i] * x[(i + 1) % dim] - 0.08 * x[i] * x[i] + 0.05 * x[(i + 1) % dim];
    }
}

static void smooth_field(int dim, const double *x, double *u)
{
    for (int i = 0; i < dim; i++) {
        u[i] = 0.06 * sin(3 * x[(i + 1) % dim] + i) * cos(2 * x[i]);
    }
}

static void make_body(int dim, int64_t along, field_function field, struct body *body)
{
    body->cloud = sized_cloud(dim, along, dim == 2 ? 0.2 : 0.12, 0.0, 1.0);
    body->cells = cells_of(&body->cloud);
    body->u = calloc((size_t)(body->cells.node_count * dim), sizeof *body->u);
    assert_non_null(body->u);
    for (int64_t n = 0; n < body->cells.node_count; n++) {
        field(dim, body->cells.x + n * dim, body->u + n * dim);
    }
}

static void drop_body(struct body *body)
{
    cloud_free(&body->cloud);
    free(body->u);
}

/* Barycentric coordinates of sample s of a cell: inside, on faces, at corners. */
static void sample_place(const struct cells *cells, int64_t cell, int s, double *X)
{
    static const double weights[6][4] = {{1, 1, 1, 1}, {5, 1, 2, 3}, {1, 0, 0, 0},
                                         {0, 2, 1, 0}, {1, 7, 0, 2}, {1, 2, 0, 9}};
    double sum = 0;
    for (int i = 0; i < cells->dim; i++) {
        X[i] = 0;
    }
    for (int a = 0; a <= cells->dim; a++) {
        sum += weights[s][a];
    }
    for (int a = 0; a <= cells->dim; a++) {
        const double *node = cells->x + cells->node[cell * (cells->dim + 1) + a] * cells->dim;
        add_scaled(cells->dim, weights[s][a] / sum, node, X);
    }
}

/* Largest distance of the moved places from those of the field; and of the inverses, found in the same cell,
 * from X. */
static double largest_error(const struct motion *motion, field_function field, double *inverse_error)
{
    int dim = motion->cells.dim;
    double most = 0;
    *inverse_error = 0;
    for (int64_t c = 0; c < motion->cells.count; c++) {
        for (int s = 0; s < 6; s++) {
            double X[3], u[3], moved[3], exact[3], back[3], residual;
            sample_place(&motion->cells, c, s, X);
            field(dim, X, u);
            motion_place(motion, c, X, moved);
            for (int i = 0; i < dim; i++) {
                exact[i] = X[i] + u[i];
            }
            most = fmax(most, vector_distance(dim, moved, exact));
            assert_true(motion_inverse(motion, c, moved, 1e-12, back, &residual));
            assert_true(residual <= 1e-12);
            *inverse_error = fmax(*inverse_error, vector_distance(dim, back, X));
        }
    }
    return most;
}

static void check_polynomial(int dim, bool linear, field_function field, double tolerance)
{
    struct body body;
    FREED_BY(motion_free) struct motion motion = {0};
    double inverse_error;
    make_body(dim, dim == 2 ? 9 : 6, field, &body);
    GOOD(motion_build(&(struct nodal_field){.cells = body.cells, .values = body.u}, linear, &motion, &error));
    assert_true(largest_error(&motion, field, &inverse_error) <= tolerance);
    assert_true(inverse_error <= 1e-10);
    drop_body(&body);
}

TEST_IN_EACH_DIM(polynomials_are_exact)
{
    check_polynomial(dim, false, linear_field, 1e-11);
    check_polynomial(dim, true, linear_field, 1e-11);
    check_polynomial(dim, false, quadratic_field, 1e-7); /* to the regularisation of the modified basis */
}

/* Half the spacing: an eighth of the error, a quarter without gradients. */
TEST(orders)
{
    for (int linear = 0; linear < 2; linear++) {
        double errors[2], ignored;
        for (int fine = 0; fine < 2; fine++) {
            struct body body;
            FREED_BY(motion_free) struct motion motion = {0};
            make_body(2, fine ? 41 : 21, smooth_field, &body);
            GOOD(motion_build(&(struct nodal_field){.cells = body.cells, .values = body.u}, linear, &motion,
                              &error));
            errors[fine] = largest_error(&motion, smooth_field, &ignored);
            drop_body(&body);
        }
        double order = log2(errors[0] / errors[1]);
        assert_true(linear ? order > 1.7 : order > 2.7);
        assert_true(linear ? errors[1] < 3e-4 : errors[1] < 1e-5);
    }
}

/* Places beside the cell that the search begins in are found through its faces. */
TEST(walks)
{
    struct body body;
    FREED_BY(motion_free) struct motion motion = {0};
    make_body(3, 6, smooth_field, &body);
    GOOD(motion_build(&(struct nodal_field){.cells = body.cells, .values = body.u}, false, &motion, &error));
    for (int64_t c = 0; c < body.cells.count; c++) {
        for (int a = 0; a <= 3; a++) {
            int64_t start = motion.across[4 * c + a];
            double X[3], moved[3], back[3], residual;
            if (start >= 0) {
                sample_place(&body.cells, c, 0, X);
                motion_place(&motion, c, X, moved);
                assert_true(motion_inverse(&motion, start, moved, 1e-12, back, &residual));
                assert_true(vector_distance(3, back, X) <= 1e-10);
            }
        }
    }
    drop_body(&body);
}

/* Whether grid point y lies in a cell. */
static bool holds(const struct cells *cells, int64_t cell, const double *y)
{
    double coordinate[4], least = INFINITY;
    cell_barycentric(cells, cell, y, coordinate);
    for (int a = 0; a <= cells->dim; a++) {
        least = fmin(least, coordinate[a]);
    }
    return least > -1e-9;
}

TEST_IN_EACH_DIM(owners)
{
    static const int64_t sizes[2][3] = {{37, 29, 1}, {13, 11, 17}};
    struct body body;
    make_body(dim, 5, linear_field, &body);
    const int64_t *size = sizes[dim - 2];
    int64_t count = size[0] * size[1] * size[2], doubly, found = 0;
    int32_t *owner = zeros(count, sizeof *owner), *again = zeros(count, sizeof *again);
    for (int64_t i = 0; i < body.cells.node_count * dim; i++) {
        /* Beyond the grid on two sides; nodes at the corners of the lattice fall on grid points. */
        body.cloud.x[i] = body.cloud.x[i] * 12 - 2;
    }
    omp_set_num_threads(1);
    raster_cells(&body.cells, 1, size, owner, &doubly);
    assert_int_equal(doubly, 0);
    omp_set_num_threads(3);
    raster_cells(&body.cells, 1, size, again, &doubly);
    assert_memory_equal(owner, again, (size_t)count * sizeof *owner);
    for (int64_t v = 0; v < count; v++) {
        const double y[3] = {(double)(v % size[0]), (double)(v / size[0] % size[1]),
                             (double)(v / size[0] / size[1])};
        int64_t lowest = 0;
        while (lowest < body.cells.count && !holds(&body.cells, lowest, y)) {
            lowest++;
        }
        assert_int_equal(owner[v], lowest < body.cells.count ? lowest : -1);
        found += owner[v] >= 0;
    }
    assert_true(found > (dim == 2 ? 100 : 1000));
    /* Seen in a mirror all cells are turned over. */
    raster_cells(&body.cells, -1, size, owner, &doubly);
    for (int64_t v = 0; v < count; v++) {
        assert_int_equal(owner[v], -1);
    }
    drop_body(&body);
}

TEST(two_parts_at_one_place)
{
    static const double x[] = {0, 0, 10, 0, 0, 10, 1.5, 1.5, 8.5, 1.5, 1.5, 8.5};
    static const int32_t node[] = {0, 1, 2, 3, 4, 5};
    static const int64_t size[3] = {12, 12, 1};
    struct cells cells = {2, 6, x, 2, node};
    int32_t owner[144];
    int64_t doubly;
    raster_cells(&cells, 1, size, owner, &doubly);
    assert_int_equal(owner[2 + 12 * 2], 0);
    assert_int_equal(doubly, 6 + 5 + 4 + 3 + 2 + 1);
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
