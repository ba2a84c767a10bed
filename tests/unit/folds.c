/* Folds: bodies that are bent, turned and stretched one-to-one have none; each kind is found where it is. */
#include "unit.h"

#include "approx/cells/cells.h"
#include "solid/folds/folds.h"

enum { MOST_NODES = 400, MOST_CELLS = 1600 };

/* A body of simplices, with its boundary. */
struct shape {
    int dim;
    int64_t nodes;
    double x[MOST_NODES * 3];
    int64_t cells;
    int32_t cell[MOST_CELLS * 4];
    int32_t facet[MOST_CELLS * 4 * 3];
    bool held[MOST_CELLS * 4];
    struct folds folds;
};

/* The body of a test, and its nodes as moved. */
static struct shape shape;
static double y[MOST_NODES * 3];

static void begin(int dim, int64_t nodes)
{
    folds_free(&shape.folds);
    shape = (struct shape){.dim = dim, .nodes = nodes};
}

static void add_cell(const int32_t *node)
{
    int corners = shape.dim + 1;
    int32_t *cell = shape.cell + shape.cells++ * corners;
    struct cells one = {.dim = shape.dim, .node_count = shape.nodes, .x = shape.x, .count = 1, .node = cell};
    memcpy(cell, node, (size_t)corners * sizeof *cell);
    if (cell_volume(&one, 0) < 0.0) {
        int32_t first = cell[0];
        cell[0] = cell[1];
        cell[1] = first;
    }
}

/* The body between quadrangles of the plane: triangles, or, for as many layers of nodes along z, tetrahedra.
 */
static void add_quadrangle(const int32_t corner[4], int64_t layer)
{
    for (int t = 0; t < 2; t++) {
        /* Prisms split alike on both sides of what they share: by ascending nodes. */
        int32_t low = corner[0], middle = corner[1 + t], high = corner[3], up = (int32_t)layer;
        if (shape.dim == 2) {
            add_cell((int32_t[]){low, middle, high});
            continue;
        }
        add_cell((int32_t[]){low, middle, high, high + up});
        add_cell((int32_t[]){low, middle, middle + up, high + up});
        add_cell((int32_t[]){low, low + up, middle + up, high + up});
    }
}

/* Boundary and folds; facets whose corners all have x[axis] = place are held (axis < 0: none). */
static void finish(int axis, double place)
{
    struct cells cells = {
        .dim = shape.dim, .node_count = shape.nodes, .x = shape.x, .count = shape.cells, .node = shape.cell};
    FREED_BY(faces_free) struct faces faces = {0};
    GOOD(cells_check(&cells, &error));
    GOOD(faces_build(&cells, true, &faces, &error));
    memcpy(shape.facet, faces.node, (size_t)(faces.count * shape.dim) * sizeof *faces.node);
    for (int64_t f = 0; f < faces.count; f++) {
        shape.held[f] = axis >= 0;
        for (int k = 0; k < shape.dim && axis >= 0; k++) {
            double at = shape.x[(int64_t)faces.node[f * shape.dim + k] * shape.dim + axis];
            shape.held[f] = shape.held[f] && fabs(at - place) < 1e-12;
        }
    }
    struct fold_input input = {.cells = {shape.dim, shape.nodes, shape.x, shape.cells, shape.cell},
                               .facet_count = faces.count,
                               .facet = shape.facet,
                               .held = shape.held};
    folds_free(&shape.folds);
    GOOD(folds_build(&input, &shape.folds, &error));
}

/* n x m quadrangles over [0, 1] x [0, 1], and in 3D two layers over [0, .2]; held at y = 0. */
static void make_grid(int dim, int n, int m)
{
    begin(dim, 0);
    int64_t layer = (n + 1) * (m + 1);
    shape.nodes = layer * (dim - 1);
    for (int64_t k = 0; k < shape.nodes; k++) {
        double *x = shape.x + k * dim;
        x[0] = (double)(k % layer % (n + 1)) / n;
        x[1] = (double)(k % layer / (n + 1)) / m;
        if (dim == 3) {
            x[2] = 0.2 * (double)(k / layer);
        }
    }
    for (int32_t j = 0; j < m; j++) {
        for (int32_t i = 0; i < n; i++) {
            int32_t a = j * (n + 1) + i;
            add_quadrangle((int32_t[]){a, a + 1, a + n + 1, a + n + 2}, layer);
        }
    }
    finish(1, 0.0);
}

/* A sector of a disc of that angle, of triangles around its middle; in 3D a wedge. */
static void make_fan(int dim, int n, double angle)
{
    begin(dim, 0);
    int64_t layer = n + 2;
    shape.nodes = layer * (dim - 1);
    for (int64_t k = 0; k < shape.nodes; k++) {
        double *x = shape.x + k * dim, turned = angle * (double)(k % layer - 1) / n;
        x[0] = k % layer > 0 ? cos(turned) : 0.0;
        x[1] = k % layer > 0 ? sin(turned) : 0.0;
        if (dim == 3) {
            x[2] = 0.2 * (double)(k / layer);
        }
    }
    for (int32_t i = 1; i <= n; i++) {
        int32_t up = (int32_t)layer;
        if (dim == 2) {
            add_cell((int32_t[]){0, i, i + 1});
        } else {
            add_cell((int32_t[]){0, i, i + 1, i + 1 + up});
            add_cell((int32_t[]){0, i, i + up, i + 1 + up});
            add_cell((int32_t[]){0, up, i + up, i + 1 + up});
        }
    }
    finish(-1, 0.0);
}

static struct fold found(void)
{
    double u[MOST_NODES * 3];
    bool stopped[MOST_NODES] = {false};
    for (int64_t i = 0; i < shape.nodes * shape.dim; i++) {
        u[i] = y[i] - shape.x[i];
    }
    return folds_find(&shape.folds, u, stopped);
}

/* Turned by an angle in the plane x y, in 3D also tilted, stretched, and moved. */
static void turn(double angle, double stretch)
{
    int dim = shape.dim;
    for (int64_t k = 0; k < shape.nodes; k++) {
        const double *x = shape.x + k * dim;
        double *at = y + k * dim, along = stretch * x[0], up = x[1] / stretch, deep = dim == 3 ? x[2] : 0.0;
        at[0] = 3.0 + cos(angle) * along - sin(angle) * up;
        at[1] = sin(angle) * along + cos(angle) * up;
        if (dim == 3) {
            double level = at[1];
            at[1] = cos(2.0 * angle) * level - sin(2.0 * angle) * deep;
            at[2] = sin(2.0 * angle) * level + cos(2.0 * angle) * deep;
        }
    }
}

/* Bent along x to an arc of that angle whose inner radius is .5, with a drift along the last axis (3D) that
 * keeps nothing apart. */
static void bend(double angle)
{
    for (int64_t k = 0; k < shape.nodes; k++) {
        const double *x = shape.x + k * shape.dim;
        double *at = y + k * shape.dim, r = 0.5 + 0.2 * (1.0 - x[1]);
        at[0] = r * sin(angle * x[0]);
        at[1] = -r * cos(angle * x[0]);
        if (shape.dim == 3) {
            at[2] = x[2];
        }
    }
}

TEST_IN_EACH_DIM(one_to_one)
{
    make_grid(dim, 32, 2);
    for (int i = 0; i < 10; i++) {
        turn(0.7 * i, pow(1.7, i - 5));
        assert_int_equal(found().kind, FOLD_NONE);
        bend(0.62 * (i + 1)); /* up to 355 degrees */
        assert_int_equal(found().kind, FOLD_NONE);
    }
}

/* Bent until the ends pass through each other. */
TEST_IN_EACH_DIM(crossing)
{
    make_grid(dim, 32, 2);
    for (int i = 0; i < 2; i++) {
        /* In 3D the ends lie against each other exactly: lifted a little, edges go through facets. */
        bend(6.5);
        for (int64_t k = 0; k < shape.nodes && dim == 3; k++) {
            y[k * 3 + 2] += (i == 0 ? 0.03 : 0.5) * shape.x[k * 3];
        }
        struct fold fold = found();
        assert_int_equal(fold.kind, dim == 3 && i == 1 ? FOLD_NONE : FOLD_CROSSING);
        if (fold.kind == FOLD_CROSSING) {
            assert_true(fold.facet[0] >= 0 && fold.facet[1] > fold.facet[0]);
            assert_true(fold.place[0] < 0.1 || fold.place[0] > 0.9);
        }
    }
}

/* A ring whose ends meet beside each other: one through the other by less than a twentieth of a facet is
 * round-off of what holds averages; by more it is a crossing. */
TEST_IN_EACH_DIM(barely_through)
{
    static const double depth[] = {1e-9, 3e-3, 8e-3};
    make_grid(dim, 32, 2);
    for (int i = 0; i < 3; i++) {
        bend(2.0 * M_PI + depth[i] / 0.55); /* facets of 0.1 at the ends, edges of 0.1 */
        for (int64_t k = 0; k < shape.nodes; k++) {
            double *at = y + k * dim, along = shape.x[k * dim], r = hypot(at[0], at[1]);
            at[0] *= 1.0 + 0.05 * along / r;
            at[1] *= 1.0 + 0.05 * along / r;
            if (dim == 3) {
                at[2] += 0.03 * along;
            }
        }
        assert_int_equal(found().kind, i < 2 ? FOLD_NONE : FOLD_CROSSING);
    }
}

/* A wedge whose sides pass through each other at its edge, all cells right way round. */
TEST_IN_EACH_DIM(crease)
{
    make_fan(dim, 12, 5.0);
    int64_t layer = 14;
    for (double angle = 6.0; angle < 6.6; angle += 0.1) {
        memcpy(y, shape.x, sizeof y);
        for (int64_t k = 0; k < shape.nodes; k++) {
            if (k % layer > 0) { /* a spiral: only at the middle do the sides meet */
                double part = (double)(k % layer - 1) / 12.0;
                y[k * dim] = (1.0 + part) * cos(angle * part);
                y[k * dim + 1] = (1.0 + part) * sin(angle * part);
            }
        }
        struct fold fold = found();
        assert_int_equal(fold.kind, angle < 2.0 * M_PI + 0.05 ? FOLD_NONE : FOLD_CREASE);
        if (fold.kind == FOLD_CREASE) {
            assert_int_equal(fold.count, 1);
            assert_true(fold.facet[0] >= 0 && fold.facet[1] == -1);
        }
    }
}

/* A node beyond the far side of its cells: those and only those that are inverted, the first one with its
 * place. */
TEST_IN_EACH_DIM(inverted)
{
    make_grid(dim, 5, 5);
    int corners = dim + 1;
    for (int side = 0; side < 3; side++) {
        memcpy(y, shape.x, sizeof y);
        for (int64_t k = 14; k < shape.nodes; k += 36) { /* at (.4, .4), all layers; neighbours at (.6, .4) */
            y[k * dim] += side == 0 ? 0.19 : side == 1 ? 0.21 : 0.3;
        }
        struct fold fold = found();
        assert_int_equal(fold.kind, side < 2 ? FOLD_NONE : FOLD_CELL);
        if (side == 2) {
            struct cells cells = {
                .dim = dim, .node_count = shape.nodes, .x = y, .count = shape.cells, .node = shape.cell};
            int64_t count = 0, first = -1;
            for (int64_t c = 0; c < shape.cells; c++) {
                if (cell_volume(&cells, c) <= 0.0) {
                    first = count++ == 0 ? c : first;
                }
            }
            assert_true(fold.count > 0 && fold.count <= count);
            assert_true(fold.cell >= first);
            first = fold.cell;
            for (int i = 0; i < dim; i++) {
                double mean = 0.0;
                for (int k = 0; k < corners; k++) {
                    mean += shape.x[shape.cell[first * corners + k] * dim + i] / corners;
                }
                NEAR_TO(fold.place[i], mean, 1e-15);
            }
        }
    }
    y[0] = (double)NAN;
    assert_int_equal(found().kind, FOLD_CELL);
}

/* A unit square whose node beneath the middle of its upper side, at that depth, is moved up. */
static void make_node_beneath(double depth)
{
    static const double x[] = {0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.5};
    begin(2, 5);
    memcpy(shape.x, x, sizeof x);
    shape.x[9] = 1.0 - depth;
    add_cell((int32_t[]){0, 1, 4});
    add_cell((int32_t[]){1, 3, 4});
    add_cell((int32_t[]){3, 2, 4});
    add_cell((int32_t[]){2, 0, 4});
    finish(-1, 0.0);
}

/* A flat cell that turns over is listed, and no fold where it is marked; others are folds. */
TEST(flat)
{
    static const struct {
        double depth, up;
        int64_t listed;
    } cases[] = {{0.05, 0.1, 0}, {0.05, 0.3, 1}, {0.19, 0.4, 1}, {0.21, 0.4, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int32_t cell[4] = {-1};
        bool deep = cases[i].up > cases[i].depth + 0.1;
        make_node_beneath(cases[i].depth);
        memcpy(y, shape.x, sizeof y);
        y[9] += cases[i].up;
        assert_int_equal(found().kind, deep ? FOLD_CELL : FOLD_NONE);
        assert_int_equal(folds_list_flat(&shape.folds, cell), cases[i].listed);
        if (cases[i].listed > 0) {
            assert_int_equal(cell[0], 2);
            shape.folds.oriented[2] = true;
            assert_int_equal(found().kind, FOLD_NONE);
        }
    }
}

/* A grid, and a smaller one that is `away` from its middle along x: another body. */
static void make_two(int dim, double away)
{
    make_grid(dim, 4, 4);
    int64_t nodes = shape.nodes, cells = shape.cells;
    int corners = dim + 1;
    for (int64_t k = 0; k < nodes; k++) {
        for (int a = 0; a < dim; a++) {
            shape.x[(nodes + k) * dim + a] = 0.3 + 0.4 * shape.x[k * dim + a] + (a == 0 ? away : 0.0);
        }
        if (dim == 3) {
            shape.x[(nodes + k) * 3 + 2] = 0.05 + 0.5 * shape.x[k * 3 + 2];
        }
    }
    for (int64_t i = 0; i < cells * corners; i++) {
        shape.cell[cells * corners + i] = shape.cell[i] + (int32_t)nodes;
    }
    shape.nodes *= 2;
    shape.cells *= 2;
    finish(-1, 0.0);
}

/* A body whose sides are nearly closed, or through each other, at rest: that is known from the start, and not
 * told again. */
TEST_IN_EACH_DIM(crease_at_rest)
{
    make_fan(dim, 12, 6.0);
    assert_int_equal(shape.folds.at_rest.kind, FOLD_NONE);
    make_fan(dim, 12, 6.5);
    assert_int_equal(shape.folds.at_rest.kind, FOLD_CREASE);
    double u[MOST_NODES * 3] = {0};
    bool stopped[MOST_NODES] = {false};
    assert_int_equal(folds_find(&shape.folds, u, stopped).kind, FOLD_NONE);
}

/* A ring turned inside out: no cell is inverted and nothing crosses. */
TEST(everted)
{
    enum { SECTORS = 24 };
    begin(2, 2 * SECTORS);
    for (int32_t k = 0; k < 2 * SECTORS; k++) {
        double angle = 2.0 * M_PI * k / SECTORS, r = k < SECTORS ? 0.5 : 1.0;
        shape.x[2 * k] = r * cos(angle);
        shape.x[2 * k + 1] = r * sin(angle);
    }
    for (int32_t k = 0; k < SECTORS; k++) {
        int32_t next = (k + 1) % SECTORS;
        add_quadrangle((int32_t[]){k, next, k + SECTORS, next + SECTORS}, 0);
    }
    finish(-1, 0.0);
    turn(3.0, 1.2);
    assert_int_equal(found().kind, FOLD_NONE);
    for (int64_t k = 0; k < shape.nodes; k++) {
        double r = hypot(shape.x[2 * k], shape.x[2 * k + 1]);
        y[2 * k] = (1.5 - r) / r * shape.x[2 * k];
        y[2 * k + 1] = (r - 1.5) / r * shape.x[2 * k + 1];
    }
    struct fold fold = found();
    assert_int_equal(fold.kind, FOLD_EVERTED);
    assert_int_equal(fold.count, SECTORS); /* the outer facets */
}

/* Bodies that interpenetrate: at rest, and when one is moved; a boundary crosses only where one is not wholly
 * within. */
TEST_IN_EACH_DIM(another_body)
{
    double u[MOST_NODES * 3];
    make_two(dim, 0.013);
    assert_int_equal(shape.folds.at_rest.kind, FOLD_WITHIN);
    assert_true(shape.folds.at_rest.cell >= shape.cells / 2);
    assert_true(fabs(shape.folds.at_rest.place[0] - 0.513) < 0.2);
    make_two(dim, 0.413);
    assert_int_equal(shape.folds.at_rest.kind, FOLD_CROSSING);
    make_two(dim, 0.713);
    assert_int_equal(shape.folds.at_rest.kind, FOLD_NONE);
    for (int i = 0; i < 3; i++) {
        static const double by[] = {-0.011, -0.3, -0.7};
        static const enum fold_kind expected[] = {FOLD_NONE, FOLD_CROSSING, FOLD_WITHIN};
        memcpy(y, shape.x, sizeof y);
        for (int64_t k = shape.nodes / 2; k < shape.nodes; k++) {
            y[k * dim] += by[i];
        }
        struct fold fold = found();
        if (fold.kind == FOLD_NONE) {
            for (int64_t k = 0; k < shape.nodes * dim; k++) {
                u[k] = y[k] - shape.x[k];
            }
            GOOD(folds_find_overlaps(&shape.folds, u, &fold, &error));
        }
        assert_int_equal(fold.kind, expected[i]);
    }
}

/* A strip that is bent to a ring and goes on over its begin, exactly: boundaries lie on each other and do not
 * cross. */
TEST_IN_EACH_DIM(over_itself)
{
    double u[MOST_NODES * 3];
    struct fold fold;
    make_grid(dim, 16, 2);
    for (int turns = 12; turns <= 18; turns += 2) { /* as many pieces make a whole turn */
        memcpy(y, shape.x, sizeof y);
        for (int64_t k = 0; k < shape.nodes; k++) {
            double angle = 32.0 * acos(-1.0) / turns * shape.x[k * dim], r = 1.3 - 0.3 * shape.x[k * dim + 1];
            y[k * dim] = r * cos(angle);
            y[k * dim + 1] = r * sin(angle);
        }
        for (int64_t i = 0; i < shape.nodes * dim; i++) {
            u[i] = y[i] - shape.x[i];
        }
        assert_int_equal(found().kind, FOLD_NONE);
        GOOD(folds_find_overlaps(&shape.folds, u, &fold, &error));
        assert_int_equal(fold.kind, turns < 16 ? FOLD_WITHIN : FOLD_NONE);
        assert_int_equal(fold.count > 0, turns < 16);
    }
}

static int end(void **state)
{
    (void)state;
    folds_free(&shape.folds);
    return 0;
}

RUN_TESTS(NULL, end)
