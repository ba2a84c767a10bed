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
    double *pressure; /* labels->count */
    double *matrix;   /* labels->count squared */
    bool *movable;    /* nodes: of interfaces that are near them */
    bool *free;       /* nodes: movable, and not stopped by their cells or the bound in the last sweep */
};

/* Gradients of the volumes of the labels at a node: one row for each label of its star. Returns the inverse
 * of the area of the interfaces there: with this weight equal pressures give equal steps. */
static double node_gradients(const struct shaping *shaping, int64_t node,
                             double G[LABEL_CELLS_MOST_LABELS][3])
{
    const struct label_cells_star *star = &shaping->star;
    const struct label_cells *mesh = shaping->mesh;
    int corners = mesh->dim + 1;
    double most = 0;
    memset(G, 0, LABEL_CELLS_MOST_LABELS * sizeof *G);
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        double gradient[3];
        int64_t cell = star->cell[i];
        int k = 0, row = shaping->kept->wanted[cell] ? 0 : star->labels[node];
        while (row < star->labels[node] && star->label[node][row] != mesh->label[cell]) {
            row++;
        }
        while (mesh->cell[cell * corners + k] != node) {
            k++;
        }
        label_cells_gradient(mesh, cell, k, gradient);
        for (int d = 0; d < mesh->dim && row < star->labels[node]; d++) {
            G[row][d] += gradient[d];
        }
    }
    for (int i = 0; i < star->labels[node]; i++) {
        most = fmax(most, vector_length(mesh->dim, G[i]));
    }
    return most > 0 ? 1 / most : 0;
}

/* The volumes that labels lack, m3; false if no more than 1e-4 of any. */
static bool find_missing(const struct volumes *volumes, double *missing)
{
    struct cells cells = label_cells_view(volumes->shaping->mesh);
    int32_t count = volumes->shaping->labels->count;
    double worst = 0;
    memcpy(missing, volumes->shaping->kept->volume, (size_t)count * sizeof *missing);
    for (int64_t c = 0; c < cells.count; c++) {
        int32_t label = volumes->shaping->mesh->label[c];
        missing[label] -= volumes->shaping->kept->wanted[c] ? cell_volume(&cells, c) : 0;
    }
    for (int32_t l = 0; l < count; l++) {
        missing[l] = volumes->shaping->kept->volume[l] > 0 ? missing[l] : 0;
        worst = fmax(worst, fabs(missing[l]) - 1e-4 * volumes->shaping->kept->volume[l]);
    }
    return worst > 0;
}

/* The least moves of the nodes on interfaces, weighted by area, that correct the volumes to first order are
 * linear combinations of the volumes' gradients. Find the factors; false if there is nothing to correct. */
static bool find_pressures(const struct volumes *volumes)
{
    int32_t count = volumes->shaping->labels->count;
    const struct label_cells_star *star = &volumes->shaping->star;
    double trace = 0;
    memset(volumes->matrix, 0, (size_t)count * (size_t)count * sizeof(double));
    for (int64_t n = 0; n < volumes->shaping->mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3];
        double weight = volumes->free[n] ? node_gradients(volumes->shaping, n, G) : 0;
        for (int i = 0; i < star->labels[n] && weight > 0; i++) {
            for (int j = 0; j < star->labels[n]; j++) {
                volumes->matrix[star->label[n][i] * count + star->label[n][j]] +=
                    weight * vector_dot(volumes->shaping->mesh->dim, G[i], G[j]);
            }
        }
    }
    for (int32_t l = 0; l < count; l++) {
        trace += volumes->matrix[l * count + l];
    }
    for (int32_t l = 0; l < count; l++) {
        volumes->matrix[l * count + l] += 1e-9 * trace;
    }
    return find_missing(volumes, volumes->pressure) && dense_factorise(count, volumes->matrix) &&
           (dense_solve(count, volumes->matrix, volumes->pressure), true);
}

static void correct_volumes(const struct volumes *volumes)
{
    const struct shaping *shaping = volumes->shaping;
    const struct label_cells_star *star = &shaping->star;
    int dim = shaping->mesh->dim;
    for (int64_t n = 0; n < shaping->mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3], target[3] = {0}, before[3] = {0};
        const double *place = shaping->place + n * dim, *x = shaping->mesh->x + n * dim;
        double weight = volumes->movable[n] ? node_gradients(shaping, n, G) : 0;
        if (!(weight > 0)) {
            continue;
        }
        for (int d = 0; d < dim; d++) {
            before[d] = target[d] = x[d];
            for (int i = 0; i < star->labels[n]; i++) {
                target[d] += weight * volumes->pressure[star->label[n][i]] * G[i][d];
            }
        }
        double wanted = vector_distance(dim, target, before);
        double share = LABEL_CELLS_NEAR * shaping->voxel / vector_distance(dim, target, place);
        if (share < 1) {
            vector_between(dim, place, target, share, target);
        }
        star_move(shaping, n, target, LABEL_CELLS_GOOD, false);
        volumes->free[n] = vector_distance(dim, x, before) >= wanted / 2;
    }
}

static void volumes_free(struct volumes *volumes)
{
    FREE_ALL(volumes->pressure, volumes->matrix, volumes->movable, volumes->free);
}

/* Correct the volumes of labels by small moves of interfaces. Nodes with apart[] do not move. */
static enum status label_cells_volumes(const struct shaping *shaping, struct error *error)
{
    const struct labels *labels = shaping->labels;
    int64_t nodes = shaping->mesh->node_count;
    FREED_BY(volumes_free) struct volumes volumes = {.shaping = shaping};
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.pressure, labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.matrix, (int64_t)labels->count * labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.movable, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.free, nodes, error));
    for (int64_t n = 0; n < nodes; n++) {
        volumes.free[n] = volumes.movable[n] = shaping->star.labels[n] >= 2 && !shaping->kept->apart[n] &&
                                               shaping->off[n] <= LABEL_CELLS_NEAR * shaping->voxel;
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && find_pressures(&volumes); sweep++) {
        correct_volumes(&volumes);
    }
    return STATUS_OK;
}

/* Find the places of the nodes on interfaces, and how far they are off: where all their labels meet
 * (meeting), else the nearest on the surface of the body or an interface. A node at its place stays. */
static void find_places(struct shaping *shaping, bool meeting)
{
    struct label_cells *mesh = shaping->mesh;
    int64_t astray = 0;
    double farthest = 0, reach = LABEL_CELLS_REACH * shaping->voxel;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : astray) reduction(max : farthest)
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double *off = shaping->off + n, *place = shaping->place + n * mesh->dim;
        size_t size = (size_t)mesh->dim * sizeof *place;
        *off = 0;
        if (shaping->star.labels[n] >= 2 && memcmp(place, mesh->x + n * mesh->dim, size) != 0) {
            memcpy(place, mesh->x + n * mesh->dim, size);
            *off = node_place(shaping, n, meeting, reach, place);
        }
        astray += *off > LABEL_CELLS_MOST_ASTRAY * shaping->voxel;
        farthest = *off < INFINITY ? fmax(farthest, *off) : farthest;
    }
    mesh->astray = astray;
    mesh->farthest = farthest;
}

/* Move the nodes that are farther than `far`, m, off their places there, as far as cells keep a score of
 * `least`; around: with the nodes around them. */
static void fit(struct shaping *shaping, double far, double least, bool around)
{
    int dim = shaping->mesh->dim;
    for (int64_t n = 0; n < shaping->mesh->node_count; n++) {
        const double *place = shaping->place + n * dim;
        if (shaping->off[n] <= far || shaping->off[n] == INFINITY ||
            star_move(shaping, n, place, least, around) || around) {
            continue;
        }
        /* Where labels meet cannot be reached: to the nearest place. */
        double nearest[3] = {0};
        memcpy(nearest, shaping->mesh->x + n * dim, (size_t)dim * sizeof *place);
        if (node_place(shaping, n, false, LABEL_CELLS_REACH * shaping->voxel, nearest) < INFINITY) {
            star_move(shaping, n, nearest, least, around);
        }
    }
}

static void shaping_free(struct shaping *shaping)
{
    FREE_ALL(shaping->place, shaping->off);
    star_free(&shaping->star);
}

enum status label_cells_improve(const struct labels *labels, const struct label_cells_options *options,
                                const struct label_cells_kept *kept, struct label_cells *mesh,
                                struct error *error)
{
    double voxel = labels_voxel(labels);
    FREED_BY(shaping_free)
    struct shaping shaping = {
        .labels = labels, .keep = options->keep, .kept = kept, .mesh = mesh, .voxel = voxel};
    RETURN_IF_ERROR(star_make(mesh, kept->wanted, &shaping.star, error));
    RETURN_IF_ERROR(NEW_ARRAY(&shaping.place, mesh->node_count * mesh->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&shaping.off, mesh->node_count, error));
    for (int64_t i = 0; i < mesh->node_count * mesh->dim; i++) {
        shaping.place[i] = NAN;
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS; sweep++) {
        label_cells_begin(options, "moving nodes onto interfaces");
        find_places(&shaping, true);
        fit(&shaping, 0.01 * voxel, LABEL_CELLS_GOOD, false);
        label_cells_repair(&shaping, LABEL_CELLS_GOOD);
    }
    label_cells_begin(options, "moving nodes that are far from interfaces");
    find_places(&shaping, false);
    fit(&shaping, LABEL_CELLS_NEAR * voxel, 1.0, true);
    label_cells_begin(options, "correcting volumes");
    find_places(&shaping, true);
    RETURN_IF_ERROR(label_cells_volumes(&shaping, error));
    label_cells_repair(&shaping, 1.0);
    find_places(&shaping, false);
    return STATUS_OK;
}
