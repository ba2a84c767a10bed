/* Cells made of label images, and what holds of all. */
#pragma once

#include "unit.h"

#include "approx/cells/cells.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells.h"

#include "label_shapes.h"

static const double millimetre[3] = {1, 1, 1};
static const bool all_kept[64] = {
    false, true, true, true, true, true, true, true, true, true, true, true, true, true, true, true,
    true,  true, true, true, true, true, true, true, true, true, true, true, true, true, true, true,
    true,  true, true, true, true, true, true, true, true, true, true, true, true, true, true, true,
    true,  true, true, true, true, true, true, true, true, true, true, true, true, true, true, true};

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

static inline struct label_cells make(const struct labels *labels, const struct label_cells_options *options)
{
    struct label_cells mesh;
    GOOD(label_cells_make(labels, options, &mesh, &error));
    return mesh;
}

/* Positive, conforming, within the bounds of the angles; the facets are the boundary and look outward: the
 * flux of x through them is dim times the volume. */
static inline void check_cells(const struct label_cells *mesh)
{
    struct cells cells = label_cells_view(mesh);
    FREED_BY(faces_free) struct faces faces = {0};
    int dim = mesh->dim;
    double volume = 0, flux = 0;
    assert_true(mesh->cell_count > 0);
    GOOD(cells_check(&cells, &error));
    for (int64_t c = 0; c < cells.count; c++) {
        const double *x[4];
        double angles[2];
        for (int k = 0; k <= dim; k++) {
            x[k] = cells.x + (int64_t)cells.node[c * (dim + 1) + k] * dim;
        }
        simplex_angles(dim, x, angles);
        assert_true(angles[0] >= 8 && angles[1] <= 165);
        assert_true(cell_quality(&cells, c) >= POOR_QUALITY);
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
}

/* Cells of a shape of one-millimetre voxels, all labels kept, at a spacing in mm, checked. *labels is a view
 * of *shape, whose label[] is to be freed. */
static inline struct label_cells make_of_shape(const char *name, uint64_t seed, double spacing,
                                               struct label_shape *shape, struct labels *labels)
{
    assert_true(label_shape_make(name, seed, millimetre, shape));
    *labels = labels_of(shape);
    struct label_cells_options options = {.spacing = 1e-3 * spacing, .keep = all_kept};
    struct label_cells mesh = make(labels, &options);
    check_cells(&mesh);
    return mesh;
}
