/* Thin parts of a body: plates of one and more cells, a step between them, and bodies that are not thin. */
#include "approx_fixture.h"

#include "approx/cells/thin.h"

enum { MOST_NODES = 400, MOST_CELLS = 1200 };

struct shape {
    int dim;
    int64_t nodes, cells;
    double x[MOST_NODES * 3];
    int32_t cell[MOST_CELLS * 4];
};

/* n[dim] squares or cubes of these edges, two triangles or six tetrahedra (Kuhn 1960) each. */
static void make_grid(struct shape *shape, int dim, const int *n, const double *edge)
{
    static const int orders[6][3] = {{0, 1, 2}, {1, 0, 2}, {0, 2, 1}, {2, 0, 1}, {1, 2, 0}, {2, 1, 0}};
    int64_t stride[3] = {1, n[0] + 1, (n[0] + 1) * (n[1] + 1)};
    int deep = dim == 3 ? n[2] : 1;
    *shape = (struct shape){.dim = dim, .nodes = stride[2] * (dim == 3 ? deep + 1 : 1)};
    for (int64_t k = 0; k < shape->nodes; k++) {
        for (int a = 0; a < dim; a++) {
            int64_t along = a == 0 ? k % stride[1] : a == 1 ? k % stride[2] / stride[1] : k / stride[2];
            shape->x[k * dim + a] = edge[a] * (double)along;
        }
    }
    for (int64_t c = 0; c < (int64_t)n[0] * n[1] * deep; c++) {
        int64_t first = c % n[0] + c / n[0] % n[1] * stride[1] + c / ((int64_t)n[0] * n[1]) * stride[2];
        for (int o = 0; o < (dim == 3 ? 6 : 2); o++) {
            int32_t *node = shape->cell + shape->cells++ * (dim + 1);
            int64_t at = first;
            node[0] = (int32_t)at;
            for (int k = 0; k < dim; k++) {
                at += stride[orders[o][k]];
                node[k + 1] = (int32_t)at;
            }
            struct cells one = {dim, shape->nodes, shape->x, 1, node};
            if (cell_volume(&one, 0) < 0.0) {
                int32_t swap = node[0];
                node[0] = node[1];
                node[1] = swap;
            }
        }
    }
}

static struct thin_report thin(const struct shape *shape, double bound)
{
    struct cells cells = {shape->dim, shape->nodes, shape->x, shape->cells, shape->cell};
    struct thin_report report;
    GOOD(cells_check(&cells, &error));
    GOOD(cells_find_thin(&cells, bound, &report, &error));
    return report;
}

/* e of cells of these variances by the thickness squared: along the part, in the worst direction, and across.
 */
static void expect(const struct thin_report *report, double along, double across)
{
    NEAR_TO(report->excess[0], 6.0 * (along - across), 1e-12);
    NEAR_TO(report->excess[1], 6.0 * (2.0 * along - across), 1e-12);
}

/* The long sides of a plate are thin, its narrow ones are not; more cells across do not help. */
TEST(plates)
{
    static struct shape shape;
    make_grid(&shape, 2, (int[]){8, 1}, (double[]){1.0, 0.5});
    struct thin_report report = thin(&shape, 0.1);
    assert_true(fabs(report.share - 16.0 / 17.0) < 1e-12 && report.thickness == 0.5);
    expect(&report, 4.0 / 18.0, 1.0 / 18.0); /* right triangles: squared legs over 18 */
    make_grid(&shape, 2, (int[]){8, 4}, (double[]){1.0, 0.125});
    report = thin(&shape, 0.1);
    assert_true(fabs(report.share - 16.0 / 17.0) < 1e-12);
    expect(&report, 4.0 / 18.0, 1.0 / 18.0 / 16.0);
    make_grid(&shape, 2, (int[]){8, 4}, (double[]){0.25, 0.25});
    assert_true(thin(&shape, 0.1).share == 0.0);
    make_grid(&shape, 3, (int[]){5, 4, 1}, (double[]){1.0, 1.0, 0.25});
    report = thin(&shape, 0.1);
    assert_true(fabs(report.share - 40.0 / (40.0 + 2.0 * 5.0 * 0.25 + 2.0 * 4.0 * 0.25)) < 1e-12);
    assert_true(report.excess[0] > 6.0 * 15.0 / 24.0 && report.thickness == 0.25);
    make_grid(&shape, 3, (int[]){3, 3, 3}, (double[]){1.0, 1.0, 1.0});
    assert_true(thin(&shape, 0.1).share == 0.0);
}

/* A wedge is thin towards its edge only. */
TEST(wedge)
{
    static struct shape shape;
    make_grid(&shape, 2, (int[]){8, 2}, (double[]){1.0, 1.0});
    for (int64_t k = 0; k < shape.nodes; k++) {
        shape.x[2 * k + 1] *= 0.25 * (shape.x[2 * k] + 0.2); /* thick by half of that */
    }
    struct thin_report report = thin(&shape, 0.1);
    assert_true(report.place[0] == 0.5 && fabs(report.thickness - 0.35) < 0.05);
    assert_true(report.share > 0.3 && report.share < 0.7);
}

RUN_TESTS(NULL, NULL)
