/* Cells made of label images, and what holds of all. */
#pragma once

#include "unit.h"

#include "approx/cells/cells.h"
#include "approx/cells/parts.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells.h"

#include "label_shapes.h"

static const double millimetre[3] = {1, 1, 1};
static bool all_kept[64]; /* but the outside */

static inline struct labels labels_of(const struct label_shape *shape)
{
    struct labels labels = {.label = shape->label, .count = shape->count, .dim = 3};
    for (int d = 0; d < 3; d++) {
        labels.size[d] = shape->size[d];
        labels.to_voxel[d][d] = 1e3 / shape->voxel[d];
        labels.to_voxel[d][3] = -shape->first[d] / shape->voxel[d];
    }
    return labels;
}

static inline int32_t count_bodies(const struct label_cells *mesh, int32_t *part)
{
    struct cells cells = label_cells_view(mesh);
    int32_t count = 0;
    GOOD(cells_parts(&cells, part, &count, &error));
    return count;
}

/* No node is shared by cells of two connected bodies. */
static inline void check_apart(const struct label_cells *mesh)
{
    int corners = mesh->dim + 1;
    int32_t *part = zeros(mesh->cell_count, sizeof *part);
    int32_t *of_node = zeros(mesh->node_count, sizeof *of_node);
    (void)count_bodies(mesh, part);
    for (int64_t i = 0; i < corners * mesh->cell_count; i++) {
        int32_t *body = &of_node[mesh->cell[i]];
        assert_true(*body == 0 || *body == part[i / corners] + 1);
        *body = part[i / corners] + 1;
    }
}

/* Positive, conforming, within the bounds of the angles, bodies apart; the facets are the boundary and look
 * outward: the flux of x through them is dim times the volume. */
static inline void check_cells(const struct label_cells *mesh)
{
    struct cells cells = label_cells_view(mesh);
    FREED_BY(faces_free) struct faces faces = {0};
    int dim = mesh->dim;
    double volume = 0, flux = 0;
    assert_true(mesh->cell_count > 0);
    GOOD(cells_check(&cells, &error));
    for (int64_t c = 0; c < cells.count; c++) {
        double angles[2];
        (void)cell_quality(&cells, c, angles);
        assert_true(angles[0] >= 8 && angles[1] <= 165);
        assert_true(cell_quality(&cells, c, NULL) >= POOR_QUALITY);
        volume += cell_volume(&cells, c);
    }
    GOOD(faces_build(&cells, true, &faces, &error));
    assert_int_equal(faces.count, mesh->facet_count);
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        const int32_t *node = mesh->facet + f * dim;
        double normal[3];
        face_area_vector(dim, mesh->x, node, normal);
        for (int d = 0; d < dim; d++) {
            for (int k = 0; k < dim; k++) {
                flux += normal[d] * mesh->x[(int64_t)node[k] * dim + d] / dim;
            }
        }
    }
    assert_true(fabs(flux / dim / volume - 1) < 1e-9);
    check_apart(mesh);
}

/* A shape of one-millimetre voxels, and cells of it. */
struct labelled {
    struct label_shape shape;
    struct labels labels;
    struct label_cells mesh;
};

static inline struct labelled label(const char *name, uint64_t seed)
{
    struct labelled made;
    assert_true(label_shape_make(name, seed, millimetre, &made.shape));
    made.labels = labels_of(&made.shape);
    made.mesh = (struct label_cells){0};
    memset(all_kept + 1, true, sizeof all_kept - 1);
    return made;
}

/* Cells of a shape, all labels kept, checked; those that there were are released. */
static inline void mesh_of(struct labelled *made, struct label_cells_options options)
{
    label_cells_free(&made->mesh);
    options.keep = all_kept;
    GOOD(label_cells_make(&made->labels, &options, &made->mesh, &error));
    check_cells(&made->mesh);
}

static inline struct labelled mesh_of_shape(const char *name, uint64_t seed, double spacing)
{
    struct labelled made = label(name, seed);
    mesh_of(&made, (struct label_cells_options){.spacing = spacing});
    return made;
}

static inline void labelled_free(struct labelled *made)
{
    label_cells_free(&made->mesh);
    free(made->shape.label);
}
