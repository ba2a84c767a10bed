#include "approx/cells/cells.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells with a lower score are improved; a node of an interface is moved as long as the cells at it keep this
 * score, or their own if it is lower. In the end, nodes that are far from their interface are moved towards
 * it as long as the bounds hold: a score of 1. */
static const double least_score = 1.25;

static double label_cells_score(const struct label_cells *mesh, int64_t cell)
{
    int dim = mesh->dim;
    const double *x[4];
    double angles[2];
    struct cells cells = label_cells_view(mesh);
    cell_corners(&cells, cell, x);
    simplex_angles(dim, x, angles);
    if (angles[0] > 0) {
        double of_angles =
            fmin(angles[0] / LABEL_CELLS_LEAST_ANGLE, (180 - angles[1]) / (180 - LABEL_CELLS_MOST_ANGLE));
        return fmin(of_angles, cell_quality(&cells, cell) / POOR_QUALITY);
    }
    /* Inverted: its volume over the product of its edges at one corner. */
    double product = 1;
    for (int k = 1; k <= dim; k++) {
        product *= vector_distance(dim, x[k], x[0]);
    }
    double volume = cell_volume(&cells, cell);
    return volume < 0 ? volume / product : 0;
}

double shaping_score(const struct shaping *shaping, int64_t cell)
{
    struct cells cells = label_cells_view(shaping->mesh);
    if (!shaping->kept->wanted[cell] && cell_volume(&cells, cell) > 0) {
        return INFINITY;
    }
    return label_cells_score(shaping->mesh, cell);
}

double star_score(const struct shaping *shaping, int64_t node, double least)
{
    const struct label_cells_star *star = &shaping->star;
    double poorest = INFINITY;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1] && poorest >= least; i++) {
        poorest = fmin(poorest, shaping_score(shaping, star->cell[i]));
    }
    return poorest;
}

void star_move(const struct shaping *shaping, int64_t node, const double target[])
{
    int dim = shaping->mesh->dim;
    double *x = shaping->mesh->x + node * dim, before[3] = {0};
    double score = fmin(star_score(shaping, node, -INFINITY), least_score);
    memcpy(before, x, (size_t)dim * sizeof *x);
    double share = 1;
    for (int halving = 0; halving < 4; halving++, share /= 2) {
        vector_between(dim, before, target, share, x);
        if (star_score(shaping, node, score) >= score) {
            return;
        }
    }
    memcpy(x, before, (size_t)dim * sizeof *x);
}

/* ---- onto the interfaces ---- */

/* The number of kept labels among those that meet at a node. */
static int kept_labels(const struct shaping *shaping, int64_t node)
{
    int count = 0;
    for (int i = 0; i < shaping->star.labels[node]; i++) {
        count += shaping->keep[shaping->star.label[node][i]];
    }
    return count;
}

/* target[node_count * dim]: the place where all labels of each node on an interface meet; where there is
 * none, the surface of the body or an interface of two of them; where there is none either, its own. */
static void find_places(const struct shaping *shaping, bool meeting, double *target)
{
    const struct label_cells_star *star = &shaping->star;
    int dim = shaping->mesh->dim;
    memcpy(target, shaping->mesh->x, (size_t)(shaping->mesh->node_count * dim) * sizeof *target);
#pragma omp parallel for schedule(dynamic, 64)
    for (int64_t n = 0; n < shaping->mesh->node_count; n++) {
        double *x = target + n * dim;
        if (star->labels[n] >= 2 &&
            !(meeting && interface_project(shaping->labels, star->labels[n], star->label[n], x))) {
            (void)node_project(shaping, n, x);
        }
    }
}

/* Move the nodes on interfaces to their places: where labels meet, and if that cannot be reached, to the
 * surface or the interface. */
static void fit(const struct shaping *shaping, double *target)
{
    const struct label_cells *mesh = shaping->mesh;
    for (int meeting = 1; meeting >= 0; meeting--) {
        find_places(shaping, meeting == 1, target);
        for (int64_t n = 0; n < mesh->node_count; n++) {
            if (vector_distance(mesh->dim, target + n * mesh->dim, mesh->x + n * mesh->dim) >
                0.01 * labels_voxel(shaping->labels)) {
                star_move(shaping, n, target + n * mesh->dim);
            }
        }
    }
}

/* The distance of a node from its interfaces, m: on the boundary from the surface of the body; elsewhere from
 * the place where the label there ends at another one of the node, or at a gap that cells fill. */
static double distance(const struct shaping *shaping, int64_t node)
{
    const struct labels *labels = shaping->labels;
    const struct label_cells_star *star = &shaping->star;
    const bool *keep = shaping->keep;
    const double *x = shaping->mesh->x + node * labels->dim;
    if (kept_labels(shaping, node) < star->labels[node]) {
        const struct interface_beyond body = {-1, keep, true}, outside = {-1, keep, false};
        return fmax(interface_distance(labels, x, &body), interface_distance(labels, x, &outside));
    }
    int32_t here = labels_at(labels, x);
    double least = INFINITY;
    for (int i = 0; i < star->labels[node]; i++) {
        const struct interface_beyond region = {star->label[node][i], keep, true};
        least = region.label != here ? fmin(least, interface_distance(labels, x, &region)) : least;
    }
    if (keep[here] && least > LABEL_CELLS_MOST_ASTRAY * labels_voxel(labels)) {
        const struct interface_beyond gap = {-1, keep, false};
        least = fmin(least, interface_distance(labels, x, &gap));
    }
    return least;
}

/* Move nodes that are still off their interface as near to it as the bounds of the angles allow. */
static void settle(const struct shaping *shaping, double *target)
{
    const struct label_cells *mesh = shaping->mesh;
    int dim = mesh->dim;
    find_places(shaping, false, target);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double from[3] = {0}, place[3];
        memcpy(from, mesh->x + n * dim, (size_t)dim * sizeof *from);
        double far = LABEL_CELLS_NEAR * labels_voxel(shaping->labels);
        bool astray = vector_distance(dim, target + n * dim, from) > far && distance(shaping, n) > far;
        for (int step = astray ? 8 : 0; step > 0; step--) {
            vector_between(dim, from, target + n * dim, step / 8.0, place);
            if (star_make_room(shaping, 1.0, n, place)) {
                break;
            }
        }
    }
}

static void measure(const struct shaping *shaping)
{
    struct label_cells *mesh = shaping->mesh;
    int64_t astray = 0;
    double farthest = 0;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : astray) reduction(max : farthest)
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double off = shaping->star.labels[n] > 1 ? distance(shaping, n) : 0;
        astray += off > LABEL_CELLS_MOST_ASTRAY * labels_voxel(shaping->labels);
        farthest = off < INFINITY ? fmax(farthest, off) : farthest;
    }
    mesh->astray = astray;
    mesh->farthest = farthest;
}

enum status label_cells_improve(const struct labels *labels, const struct label_cells_options *options,
                                const struct label_cells_kept *kept, struct label_cells *mesh,
                                struct error *error)
{
    enum status status;
    struct shaping shaping = {.labels = labels, .keep = options->keep, .kept = kept, .mesh = mesh};
    double *target = NULL;
    TRY(star_make(mesh, kept->wanted, &shaping.star, error));
    TRY(NEW_ARRAY(&target, mesh->node_count * mesh->dim, error));
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS; sweep++) {
        label_cells_begin(options, "moving nodes onto interfaces");
        fit(&shaping, target);
        label_cells_repair(&shaping, least_score);
    }
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS; sweep++) {
        label_cells_begin(options, "moving nodes that are far from interfaces");
        settle(&shaping, target);
    }
    label_cells_begin(options, "correcting volumes");
    TRY(label_cells_volumes(&shaping, options, error));
    label_cells_repair(&shaping, 1.0);
    measure(&shaping);
done:
    free(target);
    star_free(&shaping.star);
    return status;
}
