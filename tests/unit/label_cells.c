/* Cells from labels: what must hold for any shape. */
#include "approx/cells/cells.h"
#include "approx/labels/label_cells_private.h"

#include "label_cells_fixture.h"

/* The volume of each label within a share of that of its voxels. */
static void check_volumes(const struct labelled *made, double tolerance)
{
    double wanted[64] = {0}, found[64] = {0};
    const struct labels *labels = &made->labels;
    const double *voxel = made->shape.voxel;
    struct cells cells = label_cells_view(&made->mesh);
    for (int64_t v = 0; v < labels->size[0] * labels->size[1] * labels->size[2]; v++) {
        wanted[labels->label[v]] += voxel[0] * voxel[1] * voxel[2] * 1e-9;
    }
    for (int64_t c = 0; c < cells.count; c++) {
        found[made->mesh.label[c]] += cell_volume(&cells, c);
    }
    for (int l = 1; l < labels->count; l++) {
        assert_true(fabs(found[l] - wanted[l]) <= tolerance * wanted[l]);
    }
}

/* Whether the label is another one within a distance of a place, m, in one of 98 directions. */
static bool changes_within(const struct labels *labels, const double x[3], double reach)
{
    int32_t label = labels_at(labels, x);
    for (int step = 1; step <= 12; step++) {
        for (int i = 0; i < 125; i++) {
            double u[3] = {i % 5 - 2, i / 5 % 5 - 2, i / 25 - 2}, place[3];
            double norm = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
            for (int d = 0; d < 3 && norm > 0; d++) {
                place[d] = x[d] + reach * step / 12 * u[d] / norm;
            }
            if (norm > 0 && labels_at(labels, place) != label) {
                return true;
            }
        }
    }
    return false;
}

/* How many nodes of facets, and of faces between two labels, are farther than .6 voxels from where the label
 * changes. */
static int64_t count_astray(const struct labelled *made)
{
    const struct labels *labels = &made->labels;
    const struct label_cells *mesh = &made->mesh;
    struct cells cells = label_cells_view(mesh);
    FREED_BY(faces_free) struct faces faces = {0};
    int64_t count = 0;
    bool *seen = zeros(mesh->node_count, sizeof *seen);
    GOOD(faces_build(&cells, false, &faces, &error));
    for (int64_t f = 0; f < faces.count; f++) {
        const int32_t *cell = faces.cell + 2 * f;
        for (int k = 0; k < 3 && (cell[1] < 0 || mesh->label[cell[0]] != mesh->label[cell[1]]); k++) {
            int32_t node = faces.node[3 * f + k];
            count += !seen[node] &&
                     !changes_within(labels, mesh->x + 3 * (int64_t)node, 0.6 * labels_voxel(labels));
            seen[node] = true;
        }
    }
    return count;
}

/* Also layers that are too thin for the lattice. The surface of a sphere of 24 mm stays where it is, wherever
 * its labels meet beneath: voxels of 1 mm know it to half a voxel, and the volumes of labels move it by as
 * much. */
TEST(smooth_shapes)
{
    static const struct {
        const char *name;
        double spacing, most; /* mm; of nodes on the boundary from the sphere, 0: there is none */
    } cases[] = {{"sphere", 3, .6}, {"sphere", 4, .6}, {"sphere", 6, .6}, {"sphere", 12, 0},
                 {"torus", 4, 0},   {"two", 4, 1},     {"two", 5, 1},     {"two", 6, 1},
                 {"four", 4, 1},    {"four", 5, 1},    {"four", 6, 1},    {"shell", 4, 1},
                 {"shell", 5, 1.3}, {"thin", 2, 0},    {"layer", 2, 0},   {"layer", 1.5, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        FREED_BY(labelled_free)
        struct labelled made = mesh_of_shape(cases[i].name, 1, 1e-3 * cases[i].spacing);
        if (strcmp(cases[i].name, "shell") != 0) {
            check_volumes(&made, 0.01);
            assert_int_equal(count_astray(&made), 0);
        }
        for (int64_t k = 0; k < made.mesh.facet_count * 3 && cases[i].most > 0; k++) {
            const double *x = made.mesh.x + 3 * (int64_t)made.mesh.facet[k];
            double r = sqrt(x[0] * x[0] + x[1] * x[1] + x[2] * x[2]);
            assert_true(fabs(r - 24e-3) < 1e-3 * cases[i].most);
        }
    }
}

/* Where gaps and necks are narrower than the spacing, nodes have others out of the way. */
TEST(random_blobs)
{
    for (uint64_t seed = 1; seed <= 20; seed++) {
        for (int h = 3; h <= 5; h += 2) {
            FREED_BY(labelled_free) struct labelled made = mesh_of_shape("blobs", seed, 1e-3 * h);
            check_volumes(&made, 0.01);
            assert_int_equal(count_astray(&made), 0);
            assert_int_equal(made.mesh.astray, 0);
        }
    }
}

/* Four labels and the outside meet where the line between quarters of a ball ends. */
TEST(five_labels_at_a_node)
{
    int most = 0;
    for (int h = 3; h <= 6; h++) {
        FREED_BY(labelled_free) struct labelled made = label("sphere", 1);
        const struct label_shape *shape = &made.shape;
        for (int64_t v = 0; v < shape->size[0] * shape->size[1] * shape->size[2]; v++) {
            int64_t i = v % shape->size[0], j = v / shape->size[0] % shape->size[1];
            if (shape->label[v] != 0) {
                shape->label[v] = (uint16_t)(1 + (2 * i > shape->size[0]) + 2 * (2 * j > shape->size[1]));
            }
        }
        made.labels.count = 5;
        mesh_of(&made, (struct label_cells_options){.spacing = 1e-3 * h});
        assert_int_equal(count_astray(&made), 0);
        struct label_body body = {.mesh = &made.mesh};
        GOOD(star_make(&body, &error));
        for (int64_t n = 0; n < made.mesh.node_count; n++) {
            most = body.star.labels[n] > most ? body.star.labels[n] : most;
        }
        star_free(&body.star);
    }
    assert_int_equal(most, 5);
}

/* Longest edge of the cells of a label, or 0, that touch its boundary, or do not. */
static double longest_edge(const struct label_cells *mesh, int32_t label, bool at_boundary)
{
    double longest = 0;
    bool *on = zeros(mesh->node_count, sizeof *on);
    for (int64_t i = 0; i < 3 * mesh->facet_count; i++) {
        on[mesh->facet[i]] = true;
    }
    for (int64_t c = 0; c < mesh->cell_count; c++) {
        const int32_t *node = mesh->cell + 4 * c;
        bool touches = on[node[0]] || on[node[1]] || on[node[2]] || on[node[3]];
        for (int k = 0; k < 6 && mesh->label[c] == label && touches == at_boundary; k++) {
            static const int pair[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
            const double *a = mesh->x + 3 * (int64_t)node[pair[k][0]];
            const double *b = mesh->x + 3 * (int64_t)node[pair[k][1]];
            longest = fmax(longest, sqrt(shape_square(a, b)));
        }
    }
    return longest;
}

TEST(finer_at_interfaces)
{
    bool fine[64] = {false, false, true};
    struct label_cells_options options = {.spacing = 6e-3, .finest = 1.5e-3};
    FREED_BY(labelled_free) struct labelled sphere = label("sphere", 1), thin = label("thin", 1);
    mesh_of(&sphere, options);
    check_volumes(&sphere, 1e-3);
    assert_int_equal(count_astray(&sphere), 0);
    assert_true(longest_edge(&sphere.mesh, 1, true) < 1.6 * 1.5e-3);
    assert_true(longest_edge(&sphere.mesh, 1, false) > 5.9e-3);

    /* At a thin layer only: it is kept, while the outside is coarse. */
    options.fine = fine;
    mesh_of(&thin, options);
    check_volumes(&thin, 0.01);
    assert_int_equal(count_astray(&thin), 0);
    assert_true(longest_edge(&thin.mesh, 1, true) > 5.9e-3);
    for (uint64_t seed = 1; seed <= 5; seed++) {
        FREED_BY(labelled_free) struct labelled blobs = label("blobs", seed);
        mesh_of(&blobs, options);
    }
}

/* Six tetrahedra about a cube of half edge `half`, m, and the sizes at its corners: `least` at the one where
 * x, y and z are largest, six times as much at the others. */
struct sized_cube {
    struct cells cells;
    double x[24], size[8];
    int32_t node[24];
};

static void sized_cube(double half, double least, struct sized_cube *cube)
{
    static const int32_t node[24] = {0, 1, 3, 7, 0, 3, 2, 7, 0, 2, 6, 7, 0, 6, 4, 7, 0, 4, 5, 7, 0, 5, 1, 7};
    memcpy(cube->node, node, sizeof node);
    for (int n = 0; n < 8; n++) {
        for (int d = 0; d < 3; d++) {
            cube->x[3 * n + d] = n >> d & 1 ? half : -half;
        }
        cube->size[n] = n == 7 ? least : 6 * least;
    }
    cube->cells = (struct cells){3, 8, cube->x, 6, cube->node};
}

TEST(by_sizes)
{
    struct sized_cube cube;
    FREED_BY(labelled_free) struct labelled plain = label("sphere", 1), made = label("sphere", 1);
    struct label_cells_options options = {.spacing = 8e-3};
    mesh_of(&plain, options);

    /* Sizes of about those there are, and larger ones, change nothing. */
    options.sized = &cube.cells;
    options.size = cube.size;
    for (double least = 7e-3; least < 1; least *= 5) {
        sized_cube(30e-3, least, &cube);
        mesh_of(&made, options);
        assert_int_equal(made.mesh.cell_count, plain.mesh.cell_count);
        assert_memory_equal(made.mesh.x, plain.mesh.x, (size_t)plain.mesh.node_count * 3 * sizeof(double));
        assert_true(made.mesh.unsized == 0);
    }

    /* Everywhere half: the lattice of half the spacing. */
    sized_cube(30e-3, 0.91 * 1e-3, &cube);
    for (int n = 0; n < 8; n++) {
        cube.size[n] = 0.91 * 4e-3;
    }
    mesh_of(&made, options);
    mesh_of(&plain, (struct label_cells_options){.spacing = 4e-3});
    assert_int_equal(made.mesh.node_count, plain.mesh.node_count);
    assert_int_equal(made.mesh.cell_count, plain.mesh.cell_count);

    /* Finer to one side: mean edges about the sizes there. */
    options.spacing = 6e-3;
    sized_cube(32e-3, 1.2e-3, &cube);
    for (int i = 0; i < 4; i++) {
        static const char *const names[] = {"sphere", "two", "four", "atlas"};
        FREED_BY(labelled_free) struct labelled other = label(names[i], 1);
        mesh_of(&other, options);
        double volume[2] = {0};
        int64_t count[2] = {0};
        struct cells cells = label_cells_view(&other.mesh);
        for (int64_t c = 0; c < cells.count; c++) {
            double middle[3];
            cell_centroid(&cells, c, middle);
            bool fine = middle[0] > 0 && middle[1] > 0 && middle[2] > 0;
            volume[fine] += cell_volume(&cells, c);
            count[fine]++;
        }
        assert_true(volume[0] / (double)count[0] > 3 * volume[1] / (double)count[1]);
    }

    /* Sizes over a part of the body. */
    options.spacing = 8e-3;
    sized_cube(10e-3, 2e-3, &cube);
    mesh_of(&made, options);
    assert_true(made.mesh.unsized > 0.5 && made.mesh.unsized < 1);
}

/* The shares sum to 1, their difference has the gradient it says, and far from the grid all is outside. */
TEST(shares)
{
    FREED_BY(labelled_free) struct labelled made = label("four", 1);
    const struct labels labels = made.labels;
    const double far[3] = {5, -3, 1e6}, step = 1e-6;
    uint64_t seed = 7;
    assert_int_equal(labels_at(&labels, far), 0);
    for (int i = 0; i < 200; i++) {
        struct label_mix mix;
        double sum = 0, gradient[3], ignored[3];
        double x[3] = {2.2e-3 * shape_random(&seed), 5e-3 * shape_random(&seed), 3e-3 * shape_random(&seed)};
        labels_mix(&labels, x, &mix);
        for (int l = 0; l < mix.count; l++) {
            sum += mix.share[l];
        }
        assert_true(fabs(sum - 1) < 1e-12);
        double value = labels_difference(&labels, x, 1, 2, gradient);
        assert_true(fabs(value - (label_share(&mix, 1) - label_share(&mix, 2))) < 1e-12);
        for (int d = 0; d < 3; d++) {
            double low[3] = {x[0], x[1], x[2]}, high[3] = {x[0], x[1], x[2]};
            low[d] -= step;
            high[d] += step;
            double slope = (labels_difference(&labels, high, 1, 2, ignored) -
                            labels_difference(&labels, low, 1, 2, ignored)) /
                           (2 * step);
            assert_true(fabs(slope - gradient[d]) < 1e-3 * 1e3);
        }
    }
}

RUN_TESTS(NULL, NULL)
