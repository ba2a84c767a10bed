/* What supports reach through the cells: convex bodies, gaps, touching bodies, corners and fissures. */
#include "approx_fixture.h"

#include "approx/visibility/visibility.h"
#include "base/vector.h"

/* A body of unit squares or cubes, each of 2 triangles or 6 tetrahedra. Nodes of the same place and sheet are
 * one. */
enum { MOST_NODES = 4000, MOST_CELLS = 16000 };
struct voxels {
    int dim;
    int64_t node_count, cell_count;
    double x[MOST_NODES * 3];
    int key[MOST_NODES][4]; /* place, and sheet */
    int32_t cell[MOST_CELLS * 4];
    struct cells cells;
};
static struct voxels body;

/* The sheet that a corner at (i, j, k) of a cube with its lowest corner at `cube` belongs to. */
typedef int sheet_function(const int *cube, int i, int j, int k);
typedef bool solid_function(const int *cube);

static int32_t node_at(int i, int j, int k, int sheet)
{
    for (int64_t n = body.node_count; n-- > 0;) {
        const int *key = body.key[n];
        if (key[0] == i && key[1] == j && key[2] == k && key[3] == sheet) {
            return (int32_t)n;
        }
    }
    assert_true(body.node_count < MOST_NODES);
    memcpy(body.key[body.node_count], (int[4]){i, j, k, sheet}, sizeof body.key[0]);
    const int place[3] = {i, j, k};
    for (int a = 0; a < body.dim; a++) {
        body.x[body.node_count * body.dim + a] = place[a];
    }
    return (int32_t)body.node_count++;
}

static void add_cube(const int *cube, sheet_function *sheet)
{
    static const int order2[2][2] = {{0, 1}, {1, 0}};
    static const int order3[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}};
    int corners = body.dim + 1;
    for (int s = 0; s < (body.dim == 2 ? 2 : 6); s++) {
        const int *order = body.dim == 2 ? order2[s] : order3[s];
        int at[3] = {cube[0], cube[1], cube[2]};
        int32_t *v = body.cell + body.cell_count++ * corners;
        assert_true(body.cell_count < MOST_CELLS);
        for (int k = 0; k < corners; k++) {
            v[k] = node_at(at[0], at[1], at[2], sheet(cube, at[0], at[1], at[2]));
            if (k < body.dim) {
                at[order[k]]++;
            }
        }
        if (s >= (body.dim == 2 ? 1 : 3)) { /* odd permutations turn the simplex */
            int32_t swap = v[0];
            v[0] = v[1];
            v[1] = swap;
        }
    }
}

static void build(int dim, const int *size, solid_function *solid, sheet_function *sheet)
{
    body = (struct voxels){.dim = dim};
    for (int k = 0; k < (dim == 3 ? size[2] : 1); k++) {
        for (int j = 0; j < size[1]; j++) {
            for (int i = 0; i < size[0]; i++) {
                const int cube[3] = {i, j, k};
                if (solid(cube)) {
                    add_cube(cube, sheet);
                }
            }
        }
    }
    body.cells = (struct cells){
        .dim = dim, .node_count = body.node_count, .x = body.x, .count = body.cell_count, .node = body.cell};
    GOOD(cells_check(&body.cells, &error));
}

static int one_sheet(const int *cube, int i, int j, int k)
{
    (void)cube, (void)i, (void)j, (void)k;
    return 0;
}

static bool all_solid(const int *cube)
{
    (void)cube;
    return true;
}

/* Supports and what they find at points in cells, some of them off the middle. */
struct found {
    double radius[MOST_NODES];
    struct visibility space;
    int64_t count;
    double *x;
    int32_t *cell;
    struct support_options options;
    struct neighbours lists, nodes;
};
static struct found found;

static void find(double radius, bool widen)
{
    int dim = body.dim;
    found = (struct found){.count = body.cell_count, .options = support_defaults(dim)};
    found.options.widen = widen;
    found.x = calloc((size_t)(found.count * dim), sizeof *found.x);
    found.cell = calloc((size_t)found.count, sizeof *found.cell);
    assert_non_null(found.x);
    assert_non_null(found.cell);
    for (int64_t n = 0; n < body.node_count; n++) {
        found.radius[n] = radius;
    }
    for (int64_t c = 0; c < found.count; c++) {
        static const double share[4] = {0.11, 0.23, 0.31, 0.35};
        found.cell[c] = (int32_t)c;
        for (int k = 0; k <= dim; k++) {
            for (int a = 0; a < dim; a++) {
                double part = k < dim ? share[k] : dim == 2 ? 0.66 : 0.35;
                found.x[c * dim + a] += part * body.x[(int64_t)body.cell[c * (dim + 1) + k] * dim + a];
            }
        }
    }
    GOOD(visibility_build(&body.cells, BALLS(found.radius), found.options.visibility, found.options.side,
                          &found.space, &error));
    struct visibility_places inside = {.cell = found.cell, .points_per_row = 1};
    GOOD(support_build(&found.options, &found.space, &inside, found.count, found.x, "points", &found.lists,
                       &error));
    inside = (struct visibility_places){.nodes = true};
    GOOD(support_build(&found.options, &found.space, &inside, body.node_count, body.x, "nodes", &found.nodes,
                       &error));
}

static void lose(void)
{
    visibility_free(&found.space);
    support_free(&found.lists);
    support_free(&found.nodes);
    free(found.x);
    free(found.cell);
}

static bool same_lists(const struct neighbours *a, const struct neighbours *b)
{
    size_t pairs = (size_t)a->ptr[a->count];
    return a->count == b->count && memcmp(a->ptr, b->ptr, (size_t)(a->count + 1) * sizeof *a->ptr) == 0 &&
           memcmp(a->idx, b->idx, pairs * sizeof *a->idx) == 0 &&
           memcmp(a->widen, b->widen, (size_t)a->count * sizeof *a->widen) == 0;
}

/* Convex bodies: nothing changes, also where supports are widened. */
TEST_IN_EACH_DIM(convex)
{
    for (int wide = 0; wide < 2; wide++) {
        FREED_BY(visibility_free) struct visibility space = {0};
        struct neighbours plain;
        build(dim, (int[3]){7, 6, 5}, all_solid, one_sheet);
        find(wide ? 2.3 : 0.9, true);
        const struct cells none = {.dim = dim, .node_count = body.node_count, .x = body.x};
        GOOD(visibility_build(&none, BALLS(found.radius), found.options.visibility, found.options.side,
                              &space, &error));
        assert_true(wide || found.lists.widened > 0);
        GOOD(support_build(&found.options, &space, NULL, found.count, found.x, "points", &plain, &error));
        assert_true(same_lists(&plain, &found.lists));
        support_free(&plain);
        GOOD(support_build(&found.options, &space, NULL, body.node_count, body.x, "nodes", &plain, &error));
        assert_true(same_lists(&plain, &found.nodes));
        support_free(&plain);
        lose();
    }
}

/* Points whose cells are not given are found in them. */
static bool of_l(const int *cube)
{
    return cube[0] < 4 || cube[1] < 4;
}

/* Two bodies: with a gap between, or face on face; those of the first have x <= 4. */
static int64_t second_from;
static bool but_gap(const int *cube)
{
    return cube[0] < 4 || cube[0] >= second_from;
}
static int sheet_of_side(const int *cube, int i, int j, int k)
{
    (void)i, (void)j, (void)k;
    return cube[0] >= second_from;
}

static void check_apart(const struct neighbours *lists, const double *x)
{
    for (int64_t p = 0; p < lists->count; p++) {
        int own = 0;
        if (x == body.x) {
            own = body.key[p][3];
        } else {
            own = x[p * body.dim] > 4.0;
        }
        assert_true(lists->ptr[p + 1] > lists->ptr[p]);
        for (int64_t i = lists->ptr[p]; i < lists->ptr[p + 1]; i++) {
            assert_int_equal(body.key[lists->idx[i]][3], own);
        }
    }
}

TEST_IN_EACH_DIM(apart)
{
    for (second_from = 4; second_from <= 5; second_from++) {
        build(dim, (int[3]){9, 5, 3}, but_gap, sheet_of_side);
        for (int64_t n = 0; n < body.node_count && second_from == 5; n++) { /* a gap of .05 */
            body.x[n * dim] -= body.key[n][3] * 0.95;
        }
        find(2.1, true);
        check_apart(&found.lists, found.x);
        check_apart(&found.nodes, body.x);
        lose();
        find(0.9, true); /* widened: not across either */
        assert_true(found.lists.widened > 0);
        check_apart(&found.lists, found.x);
        check_apart(&found.nodes, body.x);
        lose();
    }
}

/* Two lobes that share the nodes of an edge (2D: a node) at x = y = 4. */
static bool of_lobes(const int *cube)
{
    return (cube[0] < 4) == (cube[1] < 4);
}

TEST_IN_EACH_DIM(lobes)
{
    build(dim, (int[3]){8, 8, 3}, of_lobes, one_sheet);
    find(2.1, true);
    bool shared_sees_both = false;
    for (int nodes = 0; nodes < 2; nodes++) {
        const struct neighbours *lists = nodes ? &found.nodes : &found.lists;
        const double *x = nodes ? body.x : found.x;
        for (int64_t p = 0; p < lists->count; p++) {
            bool of_first = x[p * dim] + x[p * dim + 1] < 8.0, both = false;
            bool shared = x[p * dim] == 4.0 && x[p * dim + 1] == 4.0;
            for (int64_t i = lists->ptr[p]; i < lists->ptr[p + 1]; i++) {
                const int *key = body.key[lists->idx[i]];
                both = both || (key[0] + key[1] < 8) != of_first;
                if (!shared && (key[0] != 4 || key[1] != 4)) {
                    assert_true((key[0] + key[1] < 8) == of_first);
                }
            }
            shared_sees_both = shared_sees_both || (shared && both);
        }
    }
    assert_true(shared_sees_both);
    lose();
}

/* The shortest way from p to q around an edge through (cx, cy) along z, in 3D straight when unrolled. */
static double way_around(int dim, const double *p, const double *q, double cx, double cy)
{
    double flat = hypot(p[0] - cx, p[1] - cy) + hypot(q[0] - cx, q[1] - cy);
    return dim == 2 ? flat : hypot(flat, p[2] - q[2]);
}

/* Whether the straight way from p to q passes the corner (4, 4) of the L on the empty side. */
static bool hidden_in_l(const double *p, const double *q)
{
    double turn = (q[0] - p[0]) * (4.0 - p[1]) - (q[1] - p[1]) * (4.0 - p[0]);
    bool opposite = p[0] <= 4.0 && q[1] <= 4.0 && p[1] > 4.0 && q[0] > 4.0;
    if (p[1] <= 4.0 && q[0] <= 4.0 && p[0] > 4.0 && q[1] > 4.0) {
        opposite = true;
        turn = -turn;
    }
    return opposite && turn < -1e-9;
}

/* Around the corner of an L nodes are neighbours that are visible, or nearly so; none by a detour of more
 * than 5 %. */
TEST_IN_EACH_DIM(around_corner)
{
    int64_t hidden = 0, around = 0;
    double radius = dim == 2 ? 3.2 : 2.2;
    build(dim, (int[3]){8, 8, 5}, of_l, one_sheet);
    find(radius, false);
    for (int64_t p = 0; p < found.count; p++) {
        const double *x = found.x + p * dim;
        int64_t at = found.lists.ptr[p];
        for (int32_t n = 0; n < body.node_count; n++) {
            const double *node = body.x + n * dim;
            double straight = vector_distance(dim, x, node);
            bool listed = at < found.lists.ptr[p + 1] && found.lists.idx[at] == n;
            if (!hidden_in_l(x, node)) {
                assert_true(listed == (straight < radius));
            } else if (listed) {
                AT_MOST(way_around(dim, x, node, 4.0, 4.0), 1.05 * straight);
                around++;
            } else {
                hidden += straight < radius;
            }
            at += listed;
        }
    }
    assert_true(hidden > 30 && around > 0);
    lose();
}

/* A ball of voxels, cut from above (z > 0, in 2D y > 0) by a fissure of no width at x = 0, here at 5. */
static bool of_ball(const int *cube)
{
    double sum = 0.0;
    for (int a = 0; a < body.dim; a++) {
        sum += pow(cube[a] + 0.5 - 5.0, 2);
    }
    return sum < 20.0;
}
static int sheet_of_fissure(const int *cube, int i, int j, int k)
{
    return i == 5 && (body.dim == 2 ? j : k) > 5 ? 1 + (cube[0] >= 5) : 0;
}

static bool reaches(struct edge_paths *paths, int32_t from, int64_t place)
{
    bool reached;
    edge_paths_begin(paths, from);
    GOOD(edge_paths_reach(paths, place, &reached, &error));
    return reached;
}

/* Places, here the nodes themselves, are within reach round a corner and a fissure's end, not across a gap or
 * from one face to the other. */
TEST_IN_EACH_DIM(paths)
{
    struct edge_paths paths;
    build(dim, (int[3]){8, 8, 4}, of_l, one_sheet);
    GOOD(edge_paths_build(&body.cells, body.node_count, dim, body.x, 1.0, &paths, &error));
    for (int32_t n = 0; n < body.node_count; n += 5) {
        for (int64_t p = 0; p < body.node_count; p++) {
            assert_true(reaches(&paths, n, p));
        }
    }
    edge_paths_free(&paths);
    second_from = 5;
    build(dim, (int[3]){9, 5, 3}, but_gap, sheet_of_side);
    GOOD(edge_paths_build(&body.cells, body.node_count, dim, body.x, 1.0, &paths, &error));
    for (int32_t n = 0; n < body.node_count; n += 5) {
        for (int64_t p = 0; p < body.node_count; p++) {
            assert_int_equal(reaches(&paths, n, p), body.key[n][3] == body.key[p][3]);
        }
    }
    edge_paths_free(&paths);
    build(dim, (int[3]){10, 10, 10}, of_ball, sheet_of_fissure);
    GOOD(edge_paths_build(&body.cells, body.node_count, dim, body.x, 1.0, &paths, &error));
    int other = dim == 3 ? 5 : 0;
    int32_t low_left = node_at(4, dim == 3 ? other : 6, dim == 3 ? 6 : 0, 0);
    int32_t low_right = node_at(6, dim == 3 ? other : 6, dim == 3 ? 6 : 0, 0);
    int32_t high_left = node_at(4, dim == 3 ? other : 8, dim == 3 ? 8 : 0, 0);
    int32_t high_right = node_at(6, dim == 3 ? other : 8, dim == 3 ? 8 : 0, 0);
    assert_true(reaches(&paths, low_left, low_right));
    assert_true(reaches(&paths, low_left, high_left));
    assert_false(reaches(&paths, high_left, high_right));
    assert_false(reaches(&paths, high_right, high_left));
    edge_paths_free(&paths);
}

RUN_TESTS(NULL, NULL)
