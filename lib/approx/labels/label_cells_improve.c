#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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
    FREED_BY(shaping_free) struct shaping shaping = {
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
