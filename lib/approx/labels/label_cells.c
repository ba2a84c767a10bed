#include "approx/labels/label_cells.h"

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
    const struct label_body *body;
    double *pressure; /* labels->count */
    double *matrix;   /* labels->count squared */
    bool *movable;    /* nodes: of interfaces that are near them */
    bool *free;       /* nodes: movable, and not stopped by their cells or the bound in the last sweep */
};

/* Gradients of the volumes of the labels at a node: one row for each label of its star. Returns the inverse
 * of the area of the interfaces there: with this weight equal pressures give equal steps. */
static double node_gradients(const struct label_body *body, int64_t node,
                             double G[LABEL_CELLS_MOST_LABELS][3])
{
    const struct label_cells_star *star = &body->star;
    const struct label_cells *mesh = body->mesh;
    int corners = mesh->dim + 1;
    double most = 0;
    memset(G, 0, LABEL_CELLS_MOST_LABELS * sizeof *G);
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        double gradient[3];
        int64_t cell = star->cell[i];
        int k = 0, row = body->wanted[cell] ? 0 : star->labels[node];
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
    struct cells cells = label_cells_view(volumes->body->mesh);
    int32_t count = volumes->body->labels->count;
    double worst = 0;
    memcpy(missing, volumes->body->volume, (size_t)count * sizeof *missing);
    for (int64_t c = 0; c < cells.count; c++) {
        int32_t label = volumes->body->mesh->label[c];
        missing[label] -= volumes->body->wanted[c] ? cell_volume(&cells, c) : 0;
    }
    for (int32_t l = 0; l < count; l++) {
        missing[l] = volumes->body->volume[l] > 0 ? missing[l] : 0;
        worst = fmax(worst, fabs(missing[l]) - 1e-4 * volumes->body->volume[l]);
    }
    return worst > 0;
}

/* The least moves of the nodes on interfaces, weighted by area, that correct the volumes to first order are
 * linear combinations of the volumes' gradients. Find the factors; false if there is nothing to correct. */
static bool find_pressures(const struct volumes *volumes)
{
    int32_t count = volumes->body->labels->count;
    const struct label_cells_star *star = &volumes->body->star;
    double trace = 0;
    memset(volumes->matrix, 0, (size_t)count * (size_t)count * sizeof(double));
    for (int64_t n = 0; n < volumes->body->mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3];
        double weight = volumes->free[n] ? node_gradients(volumes->body, n, G) : 0;
        for (int i = 0; i < star->labels[n] && weight > 0; i++) {
            for (int j = 0; j < star->labels[n]; j++) {
                volumes->matrix[star->label[n][i] * count + star->label[n][j]] +=
                    weight * vector_dot(volumes->body->mesh->dim, G[i], G[j]);
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
    const struct label_body *body = volumes->body;
    const struct label_cells_star *star = &body->star;
    int dim = body->mesh->dim;
    for (int64_t n = 0; n < body->mesh->node_count; n++) {
        double G[LABEL_CELLS_MOST_LABELS][3], target[3] = {0}, before[3] = {0};
        const double *place = body->place + n * dim, *x = body->mesh->x + n * dim;
        double weight = volumes->movable[n] ? node_gradients(body, n, G) : 0;
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
        double share = LABEL_CELLS_NEAR * body->voxel / vector_distance(dim, target, place);
        if (share < 1) {
            vector_between(dim, place, target, share, target);
        }
        star_move(body, n, target, LABEL_CELLS_GOOD, false);
        volumes->free[n] = vector_distance(dim, x, before) >= wanted / 2;
    }
}

static void volumes_free(struct volumes *volumes)
{
    FREE_ALL(volumes->pressure, volumes->matrix, volumes->movable, volumes->free);
}

/* Correct the volumes of labels by small moves of interfaces. Nodes with apart[] do not move. */
static enum status label_cells_volumes(const struct label_body *body, struct error *error)
{
    const struct labels *labels = body->labels;
    int64_t nodes = body->mesh->node_count;
    FREED_BY(volumes_free) struct volumes volumes = {.body = body};
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.pressure, labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.matrix, (int64_t)labels->count * labels->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.movable, nodes, error));
    RETURN_IF_ERROR(NEW_ARRAY(&volumes.free, nodes, error));
    for (int64_t n = 0; n < nodes; n++) {
        volumes.free[n] = volumes.movable[n] =
            body->star.labels[n] >= 2 && !body->apart[n] && body->off[n] <= LABEL_CELLS_NEAR * body->voxel;
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && find_pressures(&volumes); sweep++) {
        correct_volumes(&volumes);
    }
    return STATUS_OK;
}

/* Find the places of the nodes on interfaces, and how far they are off: where all their labels meet
 * (meeting), else the nearest on the surface of the body or an interface. A node at its place stays. */
static void find_places(struct label_body *body, bool meeting)
{
    struct label_cells *mesh = body->mesh;
    int64_t astray = 0;
    double farthest = 0, reach = LABEL_CELLS_REACH * body->voxel;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : astray) reduction(max : farthest)
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double *off = body->off + n, *place = body->place + n * mesh->dim;
        size_t size = (size_t)mesh->dim * sizeof *place;
        *off = 0;
        if (body->star.labels[n] >= 2 && memcmp(place, mesh->x + n * mesh->dim, size) != 0) {
            memcpy(place, mesh->x + n * mesh->dim, size);
            *off = node_place(body, n, meeting, reach, place);
        }
        astray += *off > LABEL_CELLS_MOST_ASTRAY * body->voxel;
        farthest = *off < INFINITY ? fmax(farthest, *off) : farthest;
    }
    mesh->astray = astray;
    mesh->farthest = farthest;
}

/* Move the nodes that are farther than `far`, m, off their places there, as far as cells keep a score of
 * `least`; around: with the nodes around them. */
static void fit(struct label_body *body, double far, double least, bool around)
{
    int dim = body->mesh->dim;
    for (int64_t n = 0; n < body->mesh->node_count; n++) {
        const double *place = body->place + n * dim;
        if (body->off[n] <= far || body->off[n] == INFINITY || star_move(body, n, place, least, around) ||
            around) {
            continue;
        }
        /* Where labels meet cannot be reached: to the nearest place. */
        double nearest[3] = {0};
        memcpy(nearest, body->mesh->x + n * dim, (size_t)dim * sizeof *place);
        if (node_place(body, n, false, LABEL_CELLS_REACH * body->voxel, nearest) < INFINITY) {
            star_move(body, n, nearest, least, around);
        }
    }
}

static void begin(const struct label_cells_options *options, const char *step)
{
    if (options->begin != NULL) {
        options->begin(step);
    }
}

/* Move nodes where labels meet onto the interfaces; improve poor cells; and correct the volumes of labels. */
static enum status improve(struct label_body *body, struct error *error)
{
    int64_t count = body->mesh->node_count * body->mesh->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&body->place, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&body->off, body->mesh->node_count, error));
    for (int64_t i = 0; i < count; i++) {
        body->place[i] = NAN;
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS; sweep++) {
        begin(body->options, "moving nodes onto interfaces");
        find_places(body, true);
        fit(body, 0.01 * body->voxel, LABEL_CELLS_GOOD, false);
        label_cells_repair(body, LABEL_CELLS_GOOD);
    }
    begin(body->options, "moving nodes that are far from interfaces");
    find_places(body, false);
    fit(body, LABEL_CELLS_NEAR * body->voxel, 1.0, true);
    begin(body->options, "correcting volumes");
    find_places(body, true);
    RETURN_IF_ERROR(label_cells_volumes(body, error));
    label_cells_repair(body, 1.0);
    find_places(body, false);
    return STATUS_OK;
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
    begin(options, "cutting the lattice");
    RETURN_IF_ERROR(lattice_make(labels, options, &lattice, error));
    RETURN_IF_ERROR(lattice_cut(&lattice, error));
    RETURN_IF_ERROR(lattice_cells(&lattice, mesh, &body.between, error));
    lattice_free(&lattice);
    RETURN_IF_ERROR(label_cells_keep(&body, error));
    if (mesh->facet_count == 0) {
        return fail(error, STATUS_INPUT, "spacing %g m: no lattice point lies in a label: smaller?",
                    options->spacing);
    }
    RETURN_IF_ERROR(improve(&body, error));
    return label_cells_drop(body.wanted, mesh, error);
}

enum status label_cells_make(const struct labels *labels, const struct label_cells_options *options,
                             struct label_cells *mesh, struct error *error)
{
    *mesh = (struct label_cells){.dim = labels->dim};
    enum status status = make(labels, options, mesh, error);
    begin(options, NULL);
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
