/* Cells from labels: the parts of a body. */
#include "solid/folds/folds.h"

#include "label_cells_fixture.h"

/* Nodes at which the cells of the body fall into parts without a common face. */
static int64_t count_hinges(const struct label_cells *mesh)
{
    struct cells cells = label_cells_view(mesh);
    int64_t hinges = 0;
    int32_t *across = zeros(cells.count * 4, sizeof *across);
    SCRATCH int32_t *part =
        calloc((size_t)cells.count * 4, sizeof *part); /* of each corner: the least cell reached */
    assert_true(across != NULL && part != NULL);
    GOOD(cells_across(&cells, across, &error));
    for (int64_t i = 0; i < cells.count * 4; i++) {
        part[i] = (int32_t)(i / 4);
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (int64_t i = 0; i < cells.count * 16; i++) {
            int64_t corner = i / 4, face = i / 16 * 4 + i % 4, next = across[face];
            for (int64_t k = 4 * next; next >= 0 && face != corner && k < 4 * next + 4; k++) {
                if (cells.node[k] == cells.node[corner] && part[k] < part[corner]) {
                    part[corner] = part[k];
                    changed = true;
                }
            }
        }
    }
    int32_t *least = zeros(cells.node_count, sizeof *least);
    for (int64_t i = 0; i < cells.count * 4; i++) {
        int32_t *of_node = &least[cells.node[i]];
        hinges += *of_node != 0 && *of_node != part[i] + 1 && part[i] == i / 4;
        *of_node = *of_node == 0 ? part[i] + 1 : *of_node;
    }
    return hinges;
}

/* Gaps narrower than the lattice are filled where parts of one body would hang together by nodes alone. */
TEST(parts_are_joined)
{
    int64_t hinges = 0;
    for (uint64_t seed = 1; seed <= 20; seed++) {
        FREED_BY(labelled_free) struct labelled made = label("blobs", seed);
        mesh_of(&made, (struct label_cells_options){.spacing = 5e-3, .largest = true});
        assert_int_equal(count_hinges(&made.mesh), made.mesh.hinges);
        hinges += made.mesh.hinges;
    }
    assert_true(hinges <= 2);
}

TEST(parts_that_hang_by_an_edge)
{
    int64_t cut = 0;
    for (int h = 2; h <= 6; h++) {
        FREED_BY(labelled_free) struct labelled made = mesh_of_shape("boxes", 1, 1e-3 * h);
        cut += made.mesh.pinched;
    }
    assert_true(cut > 0);
}

TEST(specks_and_the_largest_body)
{
    FREED_BY(labelled_free) struct labelled made = label("sphere", 1);
    const struct label_shape *shape = &made.shape;
    const struct label_cells *mesh = &made.mesh;
    /* A cube of 5 voxels about a point of the lattice, and one of 10. */
    for (int64_t v = 0; v < shape->size[0] * shape->size[1] * shape->size[2]; v++) {
        double x[3] = {shape->first[0] + (double)(v % shape->size[0]),
                       shape->first[1] + (double)(v / shape->size[0] % shape->size[1]),
                       shape->first[2] + (double)(v / shape->size[0] / shape->size[1])};
        bool speck = fabs(x[0] + 24) < 2.5 && fabs(x[1] + 24) < 2.5 && fabs(x[2] + 24) < 2.5;
        bool cube = fabs(x[0] - 24) < 5 && fabs(x[1] - 24) < 5 && fabs(x[2] - 24) < 5;
        shape->label[v] = speck || cube ? 1 : shape->label[v];
    }
    mesh_of(&made, (struct label_cells_options){.spacing = 6e-3});
    assert_int_equal(mesh->specks, 1);
    assert_true(mesh->speck_volume > 20e-9 && mesh->speck_volume < 200e-9);
    assert_int_equal(count_bodies(mesh, zeros(mesh->cell_count, sizeof(int32_t))), 2);
    mesh_of(&made, (struct label_cells_options){.spacing = 6e-3, .largest = true});
    assert_int_equal(count_bodies(mesh, zeros(mesh->cell_count, sizeof(int32_t))), 1);
    /* The sphere does not grow to make up for the cube. */
    struct cells cells = label_cells_view(mesh);
    double volume = 0;
    for (int64_t c = 0; c < cells.count; c++) {
        volume += cell_volume(&cells, c);
    }
    assert_true(fabs(volume / (4.0 / 3 * M_PI * pow(24e-3, 3)) - 1) < 0.01);
}

/* Walls of gaps and cavities narrower than the spacing do not pass through each other. */
TEST(walls_stay_apart)
{
    for (uint64_t seed = 1; seed <= 3; seed++) {
        FREED_BY(labelled_free) struct labelled made = mesh_of_shape("waves", seed, 5e-3);
        const struct label_cells *mesh = &made.mesh;
        assert_true(mesh->facet_count > 2000);
        struct fold_input input = {.cells = {3, mesh->node_count, mesh->x, mesh->cell_count, mesh->cell},
                                   .facet_count = mesh->facet_count,
                                   .facet = mesh->facet,
                                   .held = zeros(mesh->facet_count, sizeof *input.held)};
        FREED_BY(folds_free) struct folds folds = {0};
        GOOD(folds_build(&input, &folds, &error));
        assert_int_equal(folds.at_rest.kind, FOLD_NONE);
    }
}

RUN_TESTS(NULL, NULL)
