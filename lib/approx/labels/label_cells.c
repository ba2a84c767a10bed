#include "approx/labels/label_cells.h"

#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>

/* Cosines between inward normals of faces: the angle between two faces is 180 degrees less that of the
 * normals. */
void simplex_angles(int dim, const double *const x[], double angles[2])
{
    double edge[3][3] = {{0}}, normal[4][3] = {{0}};
    double least = 2, most = -2, size;
    for (int k = 0; k < dim; k++) {
        vector_subtract(dim, x[k + 1], x[0], edge[k]);
    }
    if (dim == 2) {
        size = edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
        normal[1][0] = edge[1][1];
        normal[1][1] = -edge[1][0];
        normal[2][0] = -edge[0][1];
        normal[2][1] = edge[0][0];
    } else {
        vector_cross(edge[1], edge[2], normal[1]);
        vector_cross(edge[2], edge[0], normal[2]);
        vector_cross(edge[0], edge[1], normal[3]);
        size = vector_dot(3, edge[0], normal[1]);
    }
    angles[0] = 0;
    angles[1] = 180;
    if (!(size > 0)) {
        return;
    }
    for (int k = 1; k <= dim; k++) {
        for (int d = 0; d < dim; d++) {
            normal[0][d] -= normal[k][d];
        }
    }
    double length[4];
    for (int k = 0; k <= dim; k++) {
        length[k] = sqrt(vector_dot(dim, normal[k], normal[k]));
    }
    for (int k = 0; k <= dim; k++) {
        for (int l = k + 1; l <= dim; l++) {
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

void label_cells_begin(const struct label_cells_options *options, const char *step)
{
    if (options->begin != NULL) {
        options->begin(options->context, step);
    }
}

static enum status make(const struct labels *labels, const struct label_cells_options *options,
                        struct label_cells *mesh, struct error *error)
{
    FREED_BY(lattice_free) struct lattice lattice = {0};
    FREED_BY(label_cells_kept_free) struct label_cells_kept kept = {0};
    SCRATCH bool *between = NULL;
    label_cells_begin(options, "cutting the lattice");
    RETURN_IF_ERROR(lattice_make(labels, options, &lattice, error));
    RETURN_IF_ERROR(lattice_cut(&lattice, error));
    RETURN_IF_ERROR(lattice_cells(&lattice, mesh, &between, error));
    lattice_free(&lattice);
    RETURN_IF_ERROR(label_cells_keep(labels, options, between, mesh, &kept, error));
    if (mesh->facet_count == 0) {
        return fail(error, STATUS_INPUT, "spacing %g m: no lattice point lies in a label: smaller?",
                    options->spacing);
    }
    RETURN_IF_ERROR(label_cells_improve(labels, options, &kept, mesh, error));
    return label_cells_drop(kept.wanted, mesh, error);
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
