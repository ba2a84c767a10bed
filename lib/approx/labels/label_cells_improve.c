#include "approx/cells/cells.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells_private.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Nodes of interfaces are moved as long as the cells at them keep this score, or their own if it is lower. */
static const double goal = 1.3;
/* Cells with a lower score are improved. In the end, nodes farther than last_slack voxels from their
 * interface are moved towards it, while scores stay above last_score. */
static const double least_score = 1.25, last_score = 1.02, last_slack = 0.55;
/* Separated nodes move towards the middle of their own cells by this share of the distance, at most this many
 * voxels. */
static const double separation = 0.25, most_separation = 0.5;
enum { FIT_SWEEPS = 4 };

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
    double score = fmin(star_score(shaping, node, -INFINITY), goal);
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

/* The place that was found for a node when it was at `from`. */
struct found_place {
    double from[3], place[3];
    bool known, found;
};
typedef bool place_finder(const struct shaping *shaping, int64_t node, double x[]);

/* place[3] of a node by `find`, which depends on the node's position alone: searched for again only where the
 * node has moved. Where there is none, it is the node's position. */
static bool find_place(const struct shaping *shaping, place_finder *find, int64_t node,
                       struct found_place *last, double place[3])
{
    int dim = shaping->mesh->dim;
    double x[3] = {0};
    memcpy(x, shaping->mesh->x + node * dim, (size_t)dim * sizeof *x);
    if (!last->known || vector_distance2(3, x, last->from) > 0.0) {
        memcpy(last->from, x, sizeof x);
        memcpy(last->place, x, sizeof x);
        last->known = true;
        last->found = find(shaping, node, last->place);
    }
    memcpy(place, last->found ? last->place : x, sizeof x);
    return last->found;
}

/* The number of kept labels among those that meet at a node. */
static int kept_labels(const struct shaping *shaping, int64_t node)
{
    int count = 0;
    for (int i = 0; i < shaping->star.labels[node]; i++) {
        count += shaping->keep[shaping->star.label[node][i]];
    }
    return count;
}

static bool meets(const struct label_cells_star *star, int64_t node, uint16_t label)
{
    for (int i = 0; i < star->labels[node]; i++) {
        if (star->label[node][i] == label) {
            return true;
        }
    }
    return false;
}

/* The places of all nodes on interfaces at their present positions. */
static void find_places(const struct shaping *shaping, place_finder *find, struct found_place *found)
{
#pragma omp parallel for schedule(dynamic, 64)
    for (int64_t n = 0; n < shaping->mesh->node_count; n++) {
        double place[3];
        if (shaping->star.labels[n] >= 2) {
            (void)find_place(shaping, find, n, &found[n], place);
        }
    }
}

static void move_there(const struct shaping *shaping, double voxel, int64_t node, const double target[])
{
    int dim = shaping->mesh->dim;
    double distance = 0;
    for (int d = 0; d < dim; d++) {
        distance = fmax(distance, fabs(target[d] - shaping->mesh->x[node * dim + d]));
    }
    if (distance > 0.01 * voxel) {
        star_move(shaping, node, target);
    }
}

/* Move x to the place of a node, where all its labels meet. In a gap between labels that no cell fills, the
 * label there counts, too. False if there is none near. */
static bool line_place(const struct shaping *shaping, int64_t node, double x[])
{
    const struct labels *labels = shaping->labels;
    const struct label_cells_star *star = &shaping->star;
    uint16_t label[LABEL_CELLS_MOST_LABELS + 1];
    int count = star->labels[node];
    memcpy(label, star->label[node], sizeof star->label[node]);
    if (interface_project(labels, count, label, x)) {
        return true;
    }
    const double *here = shaping->mesh->x + node * labels->dim;
    label[count] = (uint16_t)labels_at(labels, here);
    memcpy(x, here, (size_t)labels->dim * sizeof *x);
    return !meets(star, node, label[count]) && interface_project(labels, count + 1, label, x);
}

/* Move the nodes on interfaces to their places. */
static void fit(const struct shaping *shaping, struct found_place *line, struct found_place *surface)
{
    double voxel = labels_voxel(shaping->labels);
    find_places(shaping, line_place, line);
    for (int64_t n = 0; n < shaping->mesh->node_count; n++) {
        double target[3] = {0};
        if (shaping->star.labels[n] < 2) {
            continue;
        }
        (void)find_place(shaping, line_place, n, &line[n], target);
        move_there(shaping, voxel, n, target);
        /* If the line on which labels meet cannot be reached, use the surface or the interface. */
        if (find_place(shaping, node_project, n, &surface[n], target)) {
            move_there(shaping, voxel, n, target);
        }
    }
}

/* ---- apart ---- */

/* Move nodes that have others at the same place towards the middle of their own cells. */
static void separate(const struct shaping *shaping)
{
    const struct label_cells *mesh = shaping->mesh;
    const struct label_cells_star *star = &shaping->star;
    const bool *apart = shaping->kept->apart, *wanted = shaping->kept->wanted;
    int dim = mesh->dim;
    double most = most_separation * labels_voxel(shaping->labels);
    struct cells cells = label_cells_view(mesh);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double target[3] = {0};
        int64_t count = 0;
        for (int64_t i = star->ptr[n]; i < star->ptr[n + 1] && apart[n]; i++) {
            double middle[3];
            cell_centroid(&cells, star->cell[i], middle);
            for (int d = 0; d < dim && wanted[star->cell[i]]; d++) {
                target[d] += middle[d];
            }
            count += wanted[star->cell[i]];
        }
        double square = 0;
        for (int d = 0; d < dim; d++) {
            target[d] = separation * (target[d] / (double)count - mesh->x[n * dim + d]);
            square += target[d] * target[d];
        }
        for (int d = 0; d < dim; d++) {
            target[d] = mesh->x[n * dim + d] + target[d] * fmin(1, most / sqrt(square));
        }
        if (apart[n]) {
            star_move(shaping, n, target);
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

/* target[]: the place of a node that is still off its interface; false if it is near, or there is no
 * such place. */
static bool astray_place(const struct shaping *shaping, int64_t node, double target[])
{
    int dim = shaping->mesh->dim;
    double most = last_slack * labels_voxel(shaping->labels);
    const double *x = shaping->mesh->x + node * dim;
    memcpy(target, x, (size_t)dim * sizeof *target);
    return shaping->star.labels[node] >= 2 && distance(shaping, node) > most &&
           node_project(shaping, node, target);
}

/* Move nodes that are still off their interface as near to it as the bounds of the angles allow. */
static void settle(const struct shaping *shaping, struct found_place *astray)
{
    struct label_cells *mesh = shaping->mesh;
    int dim = mesh->dim;
    find_places(shaping, astray_place, astray);
    for (int64_t n = 0; n < mesh->node_count; n++) {
        double *x = mesh->x + n * dim, from[3] = {0}, target[3] = {0};
        if (!find_place(shaping, astray_place, n, &astray[n], target)) {
            continue;
        }
        memcpy(from, x, (size_t)dim * sizeof *x);
        for (int step = 8; step > 0; step--) {
            double place[3];
            vector_between(dim, from, target, step / 8.0, place);
            if (star_make_room(shaping, last_score, n, place)) {
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
    struct found_place *found[3] = {NULL};
    TRY(star_make(mesh, kept->wanted, &shaping.star, error));
    for (int k = 0; k < 3; k++) {
        TRY(NEW_ARRAY(&found[k], mesh->node_count, error));
    }
    for (int sweep = 0; sweep < FIT_SWEEPS; sweep++) {
        label_cells_begin(options, "moving nodes onto interfaces");
        fit(&shaping, found[0], found[1]);
        label_cells_repair(&shaping, least_score, 0);
    }
    separate(&shaping);
    for (int sweep = 0; sweep < FIT_SWEEPS; sweep++) {
        label_cells_begin(options, "moving nodes that are far from interfaces");
        settle(&shaping, found[2]);
    }
    label_cells_begin(options, "correcting volumes");
    TRY(label_cells_volumes(&shaping, options, error));
    label_cells_repair(&shaping, last_score, last_slack * labels_voxel(labels));
    measure(&shaping);
done:
    FREE_ALL(found[0], found[1], found[2]);
    star_free(&shaping.star);
    return status;
}
