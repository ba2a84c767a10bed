#include "approx/labels/label_cells.h"

#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

void simplex_angles(const struct cells *cells, int64_t cell, double angles[2])
{
    int dim = cells->dim;
    double normal[4][3], length[4], least = 2, most = -2;
    angles[0] = 0;
    angles[1] = 180;
    if (!(cell_volume(cells, cell) > 0)) {
        return;
    }
    for (int k = 0; k <= dim; k++) {
        int32_t face[3];
        cell_face(cells, cell, k, face);
        face_area_vector(dim, cells->x, face, normal[k]);
        length[k] = vector_length(dim, normal[k]);
        for (int l = 0; l < k; l++) { /* the angle between faces is 180 degrees less that of their normals */
            double cosine = -vector_dot(dim, normal[k], normal[l]) / (length[k] * length[l]);
            least = fmin(least, cosine);
            most = fmax(most, cosine);
        }
    }
    if (least >= -1 && most <= 1) {
        angles[0] = acos(most) * 180 / M_PI;
        angles[1] = acos(least) * 180 / M_PI;
    }
}

static void body_free(struct label_body *body)
{
    FREE_ALL(body->between, body->wanted, body->across, body->group, body->stack, body->from, body->apart,
             body->volume, body->place, body->off);
    star_free(&body->star);
}

static enum status make(const struct labels *labels, const struct label_cells_options *options,
                        struct label_cells *mesh, struct error *error)
{
    FREED_BY(lattice_free) struct lattice lattice = {0};
    FREED_BY(body_free)
    struct label_body body = {
        .labels = labels, .options = options, .mesh = mesh, .voxel = labels_voxel(labels)};
    RETURN_IF_ERROR(lattice_make(labels, options, &lattice, error));
    RETURN_IF_ERROR(lattice_cut(&lattice, error));
    RETURN_IF_ERROR(lattice_cells(&lattice, mesh, &body.between, error));
    lattice_free(&lattice);
    RETURN_IF_ERROR(label_cells_keep(&body, error));
    if (mesh->facet_count == 0) {
        return fail(error, STATUS_INPUT, "spacing %g m: no lattice point lies in a label: smaller?",
                    options->spacing);
    }
    RETURN_IF_ERROR(label_cells_improve(&body, error));
    return label_cells_drop(body.wanted, mesh, error);
}

enum status label_cells_make(const struct labels *labels, const struct label_cells_options *options,
                             struct label_cells *mesh, struct error *error)
{
    *mesh = (struct label_cells){.dim = labels->dim};
    enum status status = make(labels, options, mesh, error);
    if (status != STATUS_OK) {
        label_cells_free(mesh);
    }
    return status;
}

void label_cells_free(struct label_cells *mesh)
{
    FREE_ALL(mesh->x, mesh->cell, mesh->label, mesh->facet, mesh->side);
    *mesh = (struct label_cells){0};
}
