#include "approx/cells/cells.h"
#include "approx/labels/label_cells_private.h"
#include "base/dense.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

void label_cells_gradient(const struct label_cells *mesh, int64_t cell, int k, double gradient[3])
{
    int32_t face[3];
    struct cells cells = label_cells_view(mesh);
    cell_face(&cells, cell, k, face);
    face_area_vector(mesh->dim, mesh->x, face, gradient);
    for (int d = 0; d < mesh->dim; d++) {
        gradient[d] /= -mesh->dim;
    }
}

struct volumes {
    const struct shaping *shaping;
    double *wanted;   /* labels->count: volume of the voxels, m3; 0: not to be preserved */
    double *pressure; /* labels->count */
    double *matrix;   /* labels->count squared */
    bool *movable;    /* nodes: of interfaces that are near them */
    bool *free;       /* nodes: movable, and not stopped by their cells or the bound in the last sweep */
    double *place;    /* nodes: on their interface */
};

/* Gradients of the volumes of the labels at a node: one row for each label of its star. */
static void node_gradients(const struct volumes *volumes, int64_t node, double G[LABEL_CELLS_MOST_LABELS][3])
{
    const struct shaping *shaping = volumes->shaping;
    const struct label_cells_star *star = &shaping->star;
    const struct label_cells *mesh = shaping->mesh;
    int corners = mesh->dim + 1;
    memset(G, 0, LABEL_CELLS_MOST_LABELS * sizeof *G);
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        double gradient[3];
        int64_t cell = star->cell[i];
        int32_t label = mesh->label[cell];
        int k = 0, row = shaping->kept->wanted[cell] ? 0 : star->labels[node];
        while (k < corners - 1 && mesh->cell[cell * corners + k] != node) {
            k++;
        }
        while (row < star->labels[node] && star->label[node][row] != label) {
            row++;
        }
        label_cells_gradient(mesh, cell, k, gradient);
        for (int d = 0; d < corners - 1 && row < star->labels[node]; d++) {
            G[row][d] += gradient[d];
        }
    }
}

/* The inverse of the area of the interfaces at a node. With this weight equal pressures give equal steps. */
static double node_weight(int dim, double G[LABEL_CELLS_MOST_LABELS][3])
{
    double most = 0;
    for (int i = 0; i < LABEL_CELLS_MOST_LABELS; i++) {
        most = fmax(most, vector_length(dim, G[i]));
    }
    return most > 0 ? 1 / most : 0;
}

/* The least moves of the nodes on interfaces, weighted by area, that correct the volumes to first order are
 * linear combinations of the volumes' gradients. Find the factors; false if there is nothing to correct. */
static bool find_pressures(struct volumes *volumes)
{
    int32_t count = volumes->shaping->labels->count;
    const struct label_cells *mesh = volumes->shaping->mesh;
    const struct label_cells_star *star = &volumes->shaping->star;
    int dim = mesh->dim;
    struct cells cells = label_cells_view(mesh);
    double worst = 0, trace = 0;
    memcpy(volumes->pressure, volumes->wanted, (size_t)count * sizeof(double));
    memset(volumes->matrix, 0, (size_t)count * (size_t)count * sizeof(double));
    for (int64_t c = 0; c < cells.count; c++) {
        if (volumes->shaping->kept->wanted[c]) {
            volumes->pressure[mesh->label[c]] -= cell_volume(&cells, c);
        }
    }
    for (int32_t l = 0; l < count; l++) {
        volumes->pressure[l] = volumes->wanted[l] > 0 ? volumes->pressure[l] : 0;
        worst = fmax(worst, fabs(volumes->pressure[l]) - 1e-4 * volumes->wanted[l]);
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3];
        const uint16_t *label = star->label[n];
        if (!volumes->free[n]) {
            continue;
        }
        node_gradients(volumes, n, G);
        double weight = node_weight(dim, G);
        for (int i = 0; i < star->labels[n]; i++) {
            for (int j = 0; j < star->labels[n]; j++) {
                double *entry = &volumes->matrix[label[i] * count + label[j]];
                for (int d = 0; d < dim; d++) {
                    *entry += weight * G[i][d] * G[j][d];
                }
            }
        }
    }
    for (int32_t l = 0; l < count; l++) {
        trace += volumes->matrix[l * count + l];
    }
    for (int32_t l = 0; l < count; l++) {
        volumes->matrix[l * count + l] += 1e-9 * trace;
    }
    return worst > 0 && dense_factorise(count, volumes->matrix) &&
           (dense_solve(count, volumes->matrix, volumes->pressure), true);
}

static void correct_volumes(struct volumes *volumes)
{
    struct label_cells *mesh = volumes->shaping->mesh;
    const struct label_cells_star *star = &volumes->shaping->star;
    int dim = mesh->dim;
    double most = LABEL_CELLS_NEAR * labels_voxel(volumes->shaping->labels);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3], target[3] = {0}, before[3] = {0}, length = 0, wanted;
        const double *place = volumes->place + n * dim, *x = mesh->x + n * dim;
        if (!volumes->movable[n]) {
            continue;
        }
        node_gradients(volumes, n, G);
        double weight = node_weight(dim, G);
        for (int d = 0; d < dim; d++) {
            before[d] = target[d] = x[d];
            for (int i = 0; i < star->labels[n]; i++) {
                target[d] += weight * volumes->pressure[star->label[n][i]] * G[i][d];
            }
            length += (target[d] - place[d]) * (target[d] - place[d]);
        }
        wanted = vector_distance(dim, target, before);
        length = sqrt(length);
        for (int d = 0; d < dim && length > most; d++) {
            target[d] = place[d] + (target[d] - place[d]) * most / length;
        }
        star_move(volumes->shaping, n, target);
        volumes->free[n] = vector_distance(dim, x, before) >= wanted / 2;
    }
}

/* Volumes of the labels by their voxels. */
static void voxel_volumes(const struct labels *labels, const bool *keep, double *volume)
{
    for (int64_t i = 0; i < labels->size[0] * labels->size[1] * labels->size[2]; i++) {
        volume[labels->label[i]] += keep[labels->label[i]] ? 1 : 0;
    }
    for (int32_t l = 0; l < labels->count; l++) {
        volume[l] *= labels_voxel_volume(labels);
    }
}

enum status label_cells_volumes(const struct shaping *shaping, const struct label_cells_options *options,
                                struct error *error)
{
    enum status status;
    const struct labels *labels = shaping->labels;
    const struct label_cells *mesh = shaping->mesh;
    double *voxels = NULL;
    struct volumes volumes = {.shaping = shaping};
    TRY(NEW_ARRAY(&voxels, labels->count, error));
    TRY(NEW_ARRAY(&volumes.wanted, labels->count, error));
    TRY(NEW_ARRAY(&volumes.pressure, labels->count, error));
    TRY(NEW_ARRAY(&volumes.matrix, (int64_t)labels->count * labels->count, error));
    TRY(NEW_ARRAY(&volumes.movable, mesh->node_count, error));
    TRY(NEW_ARRAY(&volumes.free, mesh->node_count, error));
    TRY(NEW_ARRAY(&volumes.place, mesh->node_count * mesh->dim, error));
    memcpy(volumes.place, mesh->x, (size_t)(mesh->node_count * mesh->dim) * sizeof(double));
#pragma omp parallel for schedule(dynamic, 64)
    for (int64_t n = 0; n < mesh->node_count; n++) {
        const double *x = mesh->x + n * mesh->dim;
        double *place = volumes.place + n * mesh->dim;
        volumes.free[n] = volumes.movable[n] =
            shaping->star.labels[n] >= 2 && !shaping->kept->apart[n] && node_project(shaping, n, place) &&
            vector_distance(mesh->dim, place, x) <= LABEL_CELLS_NEAR * labels_voxel(labels);
    }
    voxel_volumes(labels, options->keep, voxels);
    for (int32_t l = 0; l < labels->count; l++) {
        volumes.wanted[l] = fmax(voxels[l] - shaping->kept->dropped[l], 0);
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && find_pressures(&volumes); sweep++) {
        correct_volumes(&volumes);
    }
done:
    FREE_ALL(voxels, volumes.wanted, volumes.pressure, volumes.matrix, volumes.movable, volumes.free,
             volumes.place);
    return status;
}
