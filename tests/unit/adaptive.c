/* Adaptive integration: the points fill the body, integrate what the rule integrates, come deep only where
 * the products of gradients demand it, and converge to brute subdivision. */
#include "box_fixture.h"

#include "approx/adaptive/adaptive.h"
#include "base/vector.h"

/* A jittered box with its cells, radii of generous supports, and the options to integrate over it. */
struct body {
    struct cloud cloud;
    struct cells cells;
    double *radius;
    struct adaptive_options options;
};

static struct body body_of(int dim, int64_t per_axis)
{
    struct body body = {.options = adaptive_defaults(dim),
                        .cloud = box_cloud(dim, per_axis, dim == 2 ? 0.3 : 0.12, 1.0)};
    body.cells = cells_of(&body.cloud);
    double *spacing = zeros(body.cells.node_count, sizeof *spacing);
    body.radius = calloc((size_t)body.cells.node_count, sizeof *body.radius);
    GOOD(cells_node_spacing(&body.cells, NULL, spacing, &error));
    body.options.support.factor = 2.4; /* smooth: where supports are widened, gradients jump */
    GOOD(support_radii(&body.options.support, body.cells.node_count, spacing, body.radius, &error));
    return body;
}

static void body_free(struct body *body)
{
    cloud_free(&body->cloud);
    free(body->radius);
}

static struct adaptive_points integrate(const struct body *body, double tolerance, int levels)
{
    struct adaptive_options options = body->options;
    struct adaptive_points points;
    options.tolerance = tolerance;
    options.levels = levels;
    GOOD(adaptive_points_build(&options, &body->cells, BALLS(body->radius), &points, &error));
    return points;
}

/* Each cell's weights sum to its volume, its points lie in it and in its order; quadratics come out exact. */
TEST_IN_EACH_DIM(fill_and_exactness)
{
    FREED_BY(body_free) struct body body = body_of(dim, dim == 2 ? 6 : 3);
    FREED_BY(adaptive_points_free)
    struct adaptive_points points = integrate(&body, dim == 2 ? 1e-3 : 2e-2, 4);
    double quadratic = 0.0, total = 0.0;
    int64_t at = 0;
    for (int64_t c = 0; c < body.cells.count; c++) {
        double volume = 0.0, first[3] = {0}, centroid[3];
        for (; at < points.count && points.cell[at] == c; at++) {
            const double *x = points.x + at * dim;
            assert_true(points.weight[at] > 0.0);
            volume += points.weight[at];
            total += points.weight[at];
            quadratic += points.weight[at] * ((x[0] - 1.0) * (x[1] - 1.0) + pow(x[dim - 1] - 1.0, 2.0));
            add_scaled(dim, points.weight[at], x, first);
        }
        double exact = cell_volume(&body.cells, c);
        AT_MOST(fabs(volume / exact - 1.0), 1e-13);
        cell_centroid(&body.cells, c, centroid);
        for (int a = 0; a < dim; a++) {
            AT_MOST(fabs(first[a] / exact - centroid[a]), 1e-13);
        }
    }
    assert_int_equal(at, points.count);
    AT_MOST(fabs(total / pow(0.1, dim) - 1.0), 1e-12);
    /* integrals of x y and z^2 over the box [0, .1]^dim */
    double exact = pow(0.1, dim) * (0.05 * 0.05 + 0.01 / 3.0);
    AT_MOST(fabs(quadratic / exact - 1.0), 1e-12);
}

/* K_ij = sum_q w_q grad phi_i . grad phi_j of all nodes, dense, times the size to the power 2 - dim. */
static double *stiffness(const struct body *body, int64_t count, const double *x, const double *weight)
{
    int dim = body->cells.dim;
    int64_t n = body->cells.node_count;
    double *K = zeros(n * n, sizeof *K);
    FREED_BY(visibility_free) struct visibility space = {0};
    FREED_BY(support_free) struct neighbours found = {0};
    GOOD(visibility_build(&body->cells, BALLS(body->radius), body->options.support.visibility,
                          body->options.support.side, &space, &error));
    GOOD(support_build(&body->options.support, &space, NULL, count, x, "points.x", &found, &error));
    double *phi = zeros(found.ptr[count], sizeof *phi);
    double *dphi = zeros(found.ptr[count] * dim, sizeof *dphi);
    struct neighbours view = found;
    GOOD(shape_table(&body->options.support.mls, body->cells.x, BALLS(body->radius), &view, x, "points.x",
                     phi, dphi, &error));
    for (int64_t p = 0; p < count; p++) {
        for (int64_t i = found.ptr[p]; i < found.ptr[p + 1]; i++) {
            for (int64_t k = found.ptr[p]; k < found.ptr[p + 1]; k++) {
                double sum = 0.0;
                for (int a = 0; a < dim; a++) {
                    sum += dphi[i * dim + a] * dphi[k * dim + a];
                }
                K[found.idx[i] * n + found.idx[k]] += weight[p] * sum * pow(0.1, 2 - dim);
            }
        }
    }
    return K;
}

static double apart(int64_t n, const double *A, const double *B)
{
    double sum = 0.0, norm = 0.0;
    for (int64_t i = 0; i < n * n; i++) {
        sum += (A[i] - B[i]) * (A[i] - B[i]);
        norm += B[i] * B[i];
    }
    return sqrt(sum / norm);
}

/* All cells `levels` times subdivided: a tolerance that nothing meets. */
static struct adaptive_points brute(const struct body *body, int levels)
{
    struct adaptive_points points = integrate(body, 1e-300, levels);
    int64_t children = body->cells.dim == 2 ? 4 : 8, expected = body->cells.count * body->options.rule_points;
    for (int level = 0; level < levels; level++) {
        expected *= children;
    }
    assert_int_equal(points.count, expected);
    assert_int_equal(points.unresolved, body->cells.count);
    return points;
}

/* The whole body's K is within the tolerance of that of brute subdivision, with fewer points the looser. */
TEST_IN_EACH_DIM(convergence)
{
    FREED_BY(body_free) struct body body = body_of(dim, dim == 2 ? 6 : 3);
    int64_t n = body.cells.node_count, before = 0;
    int deepest = dim == 2 ? 3 : 2;
    FREED_BY(adaptive_points_free) struct adaptive_points finest = brute(&body, deepest);
    double *reference = stiffness(&body, finest.count, finest.x, finest.weight);
    double error_before = INFINITY;
    for (double tolerance = 0.3; tolerance > (dim == 2 ? 1e-3 : 1e-2); tolerance *= 0.2) {
        FREED_BY(adaptive_points_free)
        struct adaptive_points points = integrate(&body, tolerance, deepest);
        double *K = stiffness(&body, points.count, points.x, points.weight);
        double error = apart(n, K, reference);
        AT_MOST(error, tolerance);
        assert_true(error <= error_before);
        assert_true(points.count >= before && points.count < finest.count / 2);
        assert_int_equal(points.unresolved, 0);
        before = points.count;
        error_before = error;
    }
}

/* A loose tolerance leaves the rule as it is on a fine cloud; one node whose support ends within its cells
 * calls for more there. */
TEST(depth_where_needed)
{
    FREED_BY(body_free) struct body body = body_of(2, 8);
    FREED_BY(adaptive_points_free) struct adaptive_points loose = integrate(&body, 2.0, 5);
    assert_int_equal(loose.count, body.cells.count * 3);
    FREED_BY(adaptive_points_free) struct adaptive_points before = integrate(&body, 0.15, 4);
    /* A weak node in the middle whose small support bends the gradients of its neighbours' cells only. */
    int64_t middle = 8 * 4 + 4;
    body.radius[middle] *= 0.2;
    FREED_BY(adaptive_points_free) struct adaptive_points after = integrate(&body, 0.15, 4);
    double near = 0.0, far = 0.0;
    int64_t near_count = 0, far_count = 0;
    for (int64_t p = 0; p < after.count; p++) {
        double level = log(cell_volume(&body.cells, after.cell[p]) / (3 * after.weight[p])) / log(4);
        double distance = hypot(after.x[2 * p] - body.cells.x[2 * middle],
                                after.x[2 * p + 1] - body.cells.x[2 * middle + 1]);
        if (distance < 0.1 / 7) {
            near += level;
            near_count++;
        } else if (distance > 0.3 / 7) {
            far += level;
            far_count++;
        }
    }
    assert_true(after.count > before.count);
    assert_true(near / (double)near_count > 2.0 * far / (double)far_count);
}

RUN_TESTS(NULL, NULL)
