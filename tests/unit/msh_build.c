/* From a mesh file's contents to cells, facets and sets; the contents are put together by hand. */
#include "unit.h"

#include "approx/cells/cells.h"
#include "io/mesh/msh.h"

enum {
    POINT = 15,
    LINE = 1,
    TRIANGLE = 2,
    QUADRANGLE = 3,
    TETRAHEDRON = 4,
    HEXAHEDRON = 5,
    PRISM = 6,
    PYRAMID = 7
};
enum { MOST = 1024 };

/* Room for a small msh. */
struct sketch {
    struct msh msh;
    double x[3 * MOST];
    int64_t node_tag[MOST], element_tag[MOST], node_ptr[MOST + 1], member_ptr[MOST + 1];
    int8_t element_type[MOST];
    int32_t node_idx[8 * MOST], member_idx[2 * MOST];
    struct msh_group groups[16];
};

static struct sketch *sketch_new(void)
{
    struct sketch *s = zeros(1, sizeof *s);
    s->msh = (struct msh){.x = s->x,
                          .node_tag = s->node_tag,
                          .element_tag = s->element_tag,
                          .element_type = s->element_type,
                          .node_ptr = s->node_ptr,
                          .node_idx = s->node_idx,
                          .member_ptr = s->member_ptr,
                          .member_idx = s->member_idx,
                          .groups = s->groups};
    return s;
}

static int32_t add_node(struct sketch *s, double x, double y, double z)
{
    int64_t n = s->msh.node_count++;
    s->node_tag[n] = 100 + n;
    memcpy(&s->x[3 * n], (double[3]){x, y, z}, 3 * sizeof(double));
    return (int32_t)n;
}

/* Groups are to be added in the order of (dim, tag). */
static int32_t add_group(struct sketch *s, int dim, int tag, const char *name)
{
    s->groups[s->msh.group_count] = (struct msh_group){dim, tag, (char *)(uintptr_t)name, 0, NULL};
    return s->msh.group_count++;
}

/* An element in one group, or in none: -1. */
static void add_element(struct sketch *s, int type, int32_t group, const int32_t node[])
{
    int64_t e = s->msh.element_count++;
    int count = msh_type(type).node_count;
    s->element_tag[e] = 1000 + e;
    s->element_type[e] = (int8_t)type;
    memcpy(&s->node_idx[s->node_ptr[e]], node, (size_t)count * sizeof *node);
    s->node_ptr[e + 1] = s->node_ptr[e] + count;
    s->member_ptr[e + 1] = s->member_ptr[e];
    if (group >= 0) {
        s->member_idx[s->member_ptr[e + 1]++] = group;
        s->groups[group].element_count++;
    }
}

#define ADD(s, type, group, ...) add_element((s), (type), (group), (const int32_t[]){__VA_ARGS__})

static struct mesh build(const struct sketch *s, const char *wanted)
{
    struct mesh mesh;
    GOOD(mesh_build(&mesh, &s->msh, &(struct mesh_options){.unit = 1, .regions = wanted}, &error));
    return mesh;
}

static void expect_failure(struct sketch *s, const char *wanted, const char *message)
{
    struct mesh mesh;
    FAILS(mesh_build(&mesh, &s->msh, &(struct mesh_options){.unit = 1, .regions = wanted}, &error),
          STATUS_INPUT, message);
    assert_null(mesh.x);
}

static struct cells cells_of(const struct mesh *mesh)
{
    return (struct cells){mesh->dim, mesh->node_count, mesh->x, mesh->cell_count, mesh->cells};
}

static double total_volume(const struct mesh *mesh)
{
    struct cells cells = cells_of(mesh);
    double sum = 0;
    for (int64_t c = 0; c < cells.count; c++) {
        assert_true(cell_volume(&cells, c) > 0);
        sum += cell_volume(&cells, c);
    }
    return sum;
}

static int64_t boundary_count(const struct mesh *mesh)
{
    struct cells cells = cells_of(mesh);
    FREED_BY(faces_free) struct faces faces = {0};
    GOOD(faces_build(&cells, true, &faces, &error));
    return faces.count;
}

/* Unit square of two triangles in group 'body', corners 0 to 3. */
static struct sketch *square(void)
{
    struct sketch *s = sketch_new();
    add_node(s, 0, 0, 0);
    add_node(s, 1, 0, 0);
    add_node(s, 1, 1, 0);
    add_node(s, 0, 1, 0);
    int32_t body = add_group(s, 2, 1, "body");
    ADD(s, TRIANGLE, body, 0, 1, 2);
    ADD(s, TRIANGLE, body, 0, 2, 3);
    return s;
}

/* ---- splitting ---- */

static uint32_t next_random(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return *state >> 8;
}

/* 0 .. count - 1 in random order. */
static void shuffle(int32_t number[], int count, uint32_t seed)
{
    for (int i = 0; i < count; i++) {
        int j = (int)(next_random(&seed) % (uint32_t)(i + 1));
        number[i] = number[j];
        number[j] = i;
    }
}

/* A 3 x 3 x 3 grid of hexahedra whose nodes are numbered at random and whose sides are facets. */
static struct sketch *random_grid(uint32_t seed)
{
    static const int corner[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                     {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
    static const int ring[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    struct sketch *s = sketch_new();
    int32_t number[64];
    shuffle(number, 64, seed);
    s->msh.node_count = 64;
    for (int i = 0; i < 64; i++) {
        s->node_tag[number[i]] = number[i] + 1;
        memcpy(&s->x[3 * number[i]], (double[3]){i % 4, i / 4 % 4, i / 16}, 3 * sizeof(double));
    }
    static const char *const names[6] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
    for (int side = 0; side < 6; side++) {
        int32_t group = add_group(s, 2, side + 1, names[side]);
        for (int cell = 0; cell < 9; cell++) {
            int32_t node[4];
            for (int k = 0; k < 4; k++) {
                int at[3];
                at[side / 2] = side % 2 == 0 ? 0 : 3;
                at[(side / 2 + 1) % 3] = cell % 3 + ring[k][0];
                at[(side / 2 + 2) % 3] = cell / 3 + ring[k][1];
                node[k] = number[at[0] + 4 * at[1] + 16 * at[2]];
            }
            add_element(s, QUADRANGLE, group, node);
        }
    }
    int32_t body = add_group(s, 3, 1, "body");
    for (int cell = 0; cell < 27; cell++) {
        int32_t node[8];
        for (int k = 0; k < 8; k++) {
            node[k] = number[cell % 3 + corner[k][0] + 4 * (cell / 3 % 3 + corner[k][1]) +
                             16 * (cell / 9 + corner[k][2])];
        }
        add_element(s, HEXAHEDRON, body, node);
    }
    return s;
}

TEST(hexahedra_conform)
{
    for (uint32_t seed = 1; seed <= 50; seed++) {
        struct sketch *s = random_grid(seed);
        FREED_BY(mesh_free) struct mesh mesh = build(s, NULL);
        double sum[6][3] = {{0}};
        assert_int_equal(mesh.cell_count, 6 * 27);
        assert_true(fabs(total_volume(&mesh) - 27) < 1e-12);
        assert_int_equal(boundary_count(&mesh), 2 * 6 * 9);
        assert_int_equal(mesh.facet_count, 2 * 6 * 9);
        assert_int_equal(mesh.notes.count, 0);
        for (int64_t f = 0; f < mesh.facet_count; f++) {
            double vector[3];
            face_area_vector(3, mesh.x, &mesh.facets[3 * f], vector);
            for (int a = 0; a < 3; a++) {
                sum[mesh.facet_set[f]][a] += vector[a];
            }
        }
        for (int side = 0; side < 6; side++) {
            for (int a = 0; a < 3; a++) {
                double outward = side % 2 == 0 ? -9 : 9;
                assert_true(fabs(sum[side][a] - (a == side / 2 ? outward : 0)) < 1e-12);
            }
        }
    }
}

/* A cube of six pyramids, a cube of two prisms on it, a pyramid on that, and a tetrahedron on one of its
 * sides. */
TEST(mixed_cells_conform)
{
    static const double at[15][3] = {{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {0, 0, 2},
                                     {2, 0, 2}, {2, 2, 2}, {0, 2, 2}, {1, 1, 1}, {0, 0, 4},
                                     {2, 0, 4}, {2, 2, 4}, {0, 2, 4}, {1, 1, 6}, {1, -2, 5}};
    static const int32_t pyramids[7][5] = {{0, 1, 2, 3, 8},    {4, 7, 6, 5, 8}, {0, 4, 5, 1, 8},
                                           {1, 5, 6, 2, 8},    {2, 6, 7, 3, 8}, {3, 7, 4, 0, 8},
                                           {9, 10, 11, 12, 13}};
    static const int32_t prisms[2][6] = {{4, 5, 9, 7, 6, 12}, {5, 10, 9, 6, 11, 12}};
    for (uint32_t seed = 1; seed <= 200; seed++) {
        struct sketch *s = sketch_new();
        int32_t n[15];
        int32_t node[8];
        shuffle(n, 15, seed);
        s->msh.node_count = 15;
        for (int i = 0; i < 15; i++) {
            memcpy(&s->x[3 * n[i]], at[i], sizeof at[i]);
        }
        for (int i = 0; i < 7; i++) {
            for (int k = 0; k < 5; k++) {
                node[k] = n[pyramids[i][k]];
            }
            add_element(s, PYRAMID, -1, node);
        }
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 6; k++) {
                node[k] = n[prisms[i][k]];
            }
            add_element(s, PRISM, -1, node);
        }
        ADD(s, TETRAHEDRON, -1, n[9], n[10], n[13], n[14]);
        FREED_BY(mesh_free) struct mesh mesh = build(s, NULL);
        assert_int_equal(mesh.cell_count, 7 * 2 + 2 * 3 + 1);
        assert_true(fabs(total_volume(&mesh) - (8 + 8 + 8.0 / 3 + 10.0 / 6)) < 1e-12);
        assert_int_equal(boundary_count(&mesh), 2 * 5 + 2 * 2 + 4 + (4 - 1) + 3);
        assert_int_equal(mesh.regions.count, 1);
        assert_string_equal(mesh.regions.name[0], "body");
    }
}

TEST(quadrangles_of_any_shape)
{
    for (int first = 0; first < 4; first++) { /* an arrowhead: only one of its diagonals is inside */
        struct sketch *s = sketch_new();
        static const double at[4][2] = {{0, 0}, {4, 0}, {1, 1}, {0, 4}};
        for (int k = 0; k < 4; k++) {
            add_node(s, at[(k + first) % 4][0], at[(k + first) % 4][1], 7);
        }
        ADD(s, QUADRANGLE, -1, 3, 2, 1, 0); /* and clockwise */
        FREED_BY(mesh_free) struct mesh mesh = build(s, NULL);
        assert_int_equal(mesh.cell_count, 2);
        assert_true(fabs(total_volume(&mesh) - 4) < 1e-14);
    }
}

/* ---- orientation, facets, sets ---- */

TEST(cells_are_turned_and_facets_look_outward)
{
    for (int turned = 0; turned < 2; turned++) {
        struct sketch *s = sketch_new();
        add_node(s, 0, 0, 0);
        add_node(s, 2, 0, 0);
        add_node(s, 0, 1, 0);
        add_node(s, 2, 1, 0);
        int32_t side = add_group(s, 1, 4, "side");
        int32_t left = add_group(s, 1, 9, "left");
        int32_t body = add_group(s, 2, 1, "body");
        if (turned) {
            ADD(s, TRIANGLE, body, 0, 2, 1);
            ADD(s, TRIANGLE, body, 1, 2, 3);
        } else {
            ADD(s, TRIANGLE, body, 0, 1, 2);
            ADD(s, TRIANGLE, body, 1, 2, 3);
        }
        ADD(s, LINE, left, 0, 2);
        ADD(s, LINE, side, 2, 0);
        ADD(s, LINE, side, 3, 1);
        ADD(s, LINE, side, 1, 3); /* twice in the file */
        FREED_BY(mesh_free) struct mesh mesh = build(s, NULL);
        assert_true(fabs(total_volume(&mesh) - 2) < 1e-14);
        assert_int_equal(mesh.facet_count, 3);
        assert_memory_equal(mesh.facets, ((int32_t[]){2, 0, 1, 3, 2, 0}), 6 * sizeof(int32_t));
        assert_memory_equal(mesh.facet_set, ((int32_t[]){0, 0, 1}), 3 * sizeof(int32_t));
        assert_string_equal(mesh.facet_sets.name[0], "side");
        assert_string_equal(mesh.facet_sets.name[1], "left");
    }
}

/* ---- faults ---- */

TEST(cells_that_are_none)
{
    struct sketch *s = square();
    int32_t node = add_node(s, 0.5, 1e-14, 0);
    ADD(s, TRIANGLE, 0, 0, 1, node);
    expect_failure(s, NULL, "element 1002 has no area");
    s = square();
    ADD(s, TRIANGLE, 0, 0, 0, 1);
    expect_failure(s, NULL, "element 1002 has no area");
    s = square();
    s->x[3 * 3] =
        2; /* the fourth corner goes beyond the diagonal: the second triangle folds onto the first */
    s->x[3 * 3 + 1] = 0.5;
    expect_failure(s, NULL, "elements 1000 and 1001 overlap: one is inverted");
    s = square();
    int32_t other = add_group(s, 2, 2, "other");
    ADD(s, TRIANGLE, other, 0, 1, add_node(s, 0.9, 0.1, 0));
    expect_failure(s, NULL, "elements 1000 ('body') and 1002 ('other') overlap");
    s = sketch_new();
    for (int i = 0; i < 4; i++) {
        add_node(s, i == 3 ? 0.3 : i == 1, i == 3 ? 0.3 : i == 2, i == 3 ? 1e-13 : 0);
    }
    ADD(s, TETRAHEDRON, -1, 0, 1, 2, 3);
    expect_failure(s, NULL, "element 1000 has no volume");
}

RUN_TESTS(NULL, NULL)
