/* The place of a node, the nearest one on its interface, and guarded moves of nodes. */
#include "approx/cells/cells.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells_private.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* How near to an interface a place on it is, voxels. */
static const double least_step = 1e-3;

/* Move x onto the interface of the labels: steps along the gradients of the differences of their shares, each
 * of which makes one difference vanish to first order. False if there is none near. */
static bool interface_project(const struct label_body *body, int count, const uint16_t label[], double x[])
{
    const struct labels *labels = body->labels;
    int dim = labels->dim;
    double y[3] = {0}, longest = INFINITY, last = INFINITY;
    struct label_mix mix;
    memcpy(y, x, (size_t)dim * sizeof *x);
    for (int i = 0; i < 20 && longest > least_step * body->voxel; i++) {
        double residual = 0;
        longest = 0;
        for (int r = 1; r < count && r <= dim; r++) {
            double gradient[3], value = labels_difference(labels, y, label[0], label[r], gradient);
            double slope = vector_length(dim, gradient), length = value / slope;
            residual += fabs(value);
            if (!(slope * body->voxel > 0.01 && residual < last)) {
                return false;
            }
            length = fmin(fmax(length, -body->voxel / 2), body->voxel / 2);
            for (int d = 0; d < dim; d++) {
                y[d] -= length * gradient[d] / slope;
            }
            longest = fmax(longest, fabs(length));
        }
        last = residual;
    }
    labels_mix(labels, y, &mix);
    double share = label_share(&mix, label[0]);
    for (int i = 0; i < mix.count; i++) {
        if (mix.share[i] > share + 0.05) {
            return false;
        }
    }
    memcpy(x, y, (size_t)dim * sizeof *x);
    return longest <= least_step * body->voxel;
}

/* The label beyond an interface: one label, or any that is kept, or any that is not. */
struct beyond {
    int32_t label; /* -1: any with keep[] == kept */
    const bool *keep;
    bool kept;
};

static bool is_beyond(const struct beyond *beyond, int32_t label)
{
    return beyond->label >= 0 ? label == beyond->label : beyond->keep[label] == beyond->kept;
}

/* Move y, beyond, to where that begins on the way from x. */
static void step_back(const struct label_body *body, const struct beyond *beyond, const double x[],
                      double y[3])
{
    int dim = body->labels->dim;
    double low = 0, high = 1, length = vector_distance(dim, x, y), end[3];
    memcpy(end, y, sizeof end);
    while ((high - low) * length > least_step * body->voxel) {
        double t = (low + high) / 2;
        vector_between(dim, x, end, t, y);
        *(is_beyond(beyond, labels_at(body->labels, y)) ? &high : &low) = t;
    }
    vector_between(dim, x, end, high, y);
}

/* Search on the ways from x to the places of a grid about it with the spacing of the voxels for one where the
 * label beyond begins, nearer than `least`, m: place[]. Returns its distance, or `least`. */
static double search(const struct label_body *body, const struct beyond *beyond, double least,
                     const double x[], double place[3])
{
    const struct labels *labels = body->labels;
    int dim = labels->dim, side = 1 + 2 * (int)ceil(least / body->voxel);
    for (int i = 0; i < side * side * (dim == 3 ? side : 1); i++) {
        const int at[3] = {i % side, i / side % side, i / side / side};
        double y[3] = {0}, square = 0, nearest = least / body->voxel + 1;
        for (int d = 0; d < dim; d++) {
            int steps = at[d] % 2 ? (at[d] + 1) / 2 : -at[d] / 2; /* 0, 1, -1, 2, -2, ... */
            y[d] = x[d] + body->voxel * steps;
            square += steps * steps;
        }
        if (square == 0 || square > nearest * nearest || !is_beyond(beyond, labels_nearest(labels, y))) {
            continue;
        }
        vector_between(dim, x, y, fmin(1, least / (body->voxel * sqrt(square))), y);
        if (is_beyond(beyond, labels_at(labels, y))) {
            step_back(body, beyond, x, y);
            least = vector_distance(dim, x, y);
            memcpy(place, y, sizeof y);
        }
    }
    return least;
}

/* Move x to the nearest place where the label beyond begins, within `reach`, m, if Newton's method does not
 * find one near. Returns its distance, infinity if there is none. */
static double move_beyond(const struct label_body *body, const struct beyond *beyond,
                          const struct label_mix *mix, double reach, double x[])
{
    const struct labels *labels = body->labels;
    double from[3] = {0}, place[3] = {0}, least = INFINITY;
    int dim = labels->dim;
    int32_t here = label_largest(mix, NULL, false), there = beyond->label;
    there = there < 0 ? label_largest(mix, beyond->keep, beyond->kept) : there;
    const uint16_t pair[2] = {(uint16_t)here, (uint16_t)there};
    memcpy(from, x, (size_t)dim * sizeof *x);
    memcpy(place, x, (size_t)dim * sizeof *x);
    if (there >= 0 && interface_project(body, 2, pair, place)) {
        least = vector_distance(dim, place, x);
    }
    /* Newton's method need not find the nearest place. */
    if (least >= body->voxel / 2) {
        double nearest = fmin(reach, least), found = search(body, beyond, nearest, from, place);
        least = found < nearest ? found : least;
    }
    if (least < INFINITY) {
        memcpy(x, place, (size_t)dim * sizeof *x);
    }
    return least;
}

double node_place(const struct label_body *body, int64_t node, bool meeting, double reach, double x[])
{
    const struct labels *labels = body->labels;
    int count = body->star.labels[node], dim = labels->dim;
    const uint16_t *label = body->star.label[node];
    double best[3] = {0}, least = INFINITY;
    struct label_mix mix;
    memcpy(best, x, (size_t)dim * sizeof *x);
    if (meeting && interface_project(body, count, label, best)) {
        least = vector_distance(dim, best, x);
        memcpy(x, best, (size_t)dim * sizeof *x);
        return least;
    }
    labels_mix(labels, x, &mix);
    int32_t here = label_largest(&mix, NULL, false);
    for (int i = 0; i < count; i++) {
        if (!body->options->keep[label[i]]) {
            const struct beyond other = {-1, body->options->keep, !body->options->keep[here]};
            return move_beyond(body, &other, &mix, reach, x);
        }
    }
    /* The nearest of the interfaces; a gap that cells fill counts where none is near. */
    for (int i = 0; i <= count; i++) {
        const struct beyond other = {i < count ? label[i] : -1, body->options->keep, false};
        double place[3] = {0};
        if (i < count ? label[i] == here
                      : !body->options->keep[here] || least <= LABEL_CELLS_NEAR * body->voxel) {
            continue;
        }
        memcpy(place, x, (size_t)dim * sizeof *x);
        double distance = move_beyond(body, &other, &mix, fmin(reach, least), place);
        if (distance < least) {
            least = distance;
            memcpy(best, place, sizeof best);
        }
    }
    if (least < INFINITY) {
        memcpy(x, best, (size_t)dim * sizeof *x);
    }
    return least;
}

/* ---- moves ---- */

/* Halvings of a move, and of the steps of a search. */
enum { HALVINGS = 5 };

/* The score of a cell: at least 1 if its angles are within the bounds and its quality
 * (approx/cells/quality.h) is not poor; its volume over the product of its edges at one corner if it is
 * inverted. Cells around the body must only not be inverted. */
static double score_of(const struct label_body *body, int64_t cell)
{
    int dim = body->mesh->dim;
    double angles[2], product = 1;
    struct cells cells = label_cells_view(body->mesh);
    double volume = cell_volume(&cells, cell);
    if (!body->wanted[cell] && volume > 0) {
        return INFINITY;
    }
    double quality = cell_quality(&cells, cell, angles);
    if (angles[0] > 0) {
        double of_angles =
            fmin(angles[0] / LABEL_CELLS_LEAST_ANGLE, (180 - angles[1]) / (180 - LABEL_CELLS_MOST_ANGLE));
        return fmin(of_angles, quality / POOR_QUALITY);
    }
    const double *x[4];
    cell_corners(&cells, cell, x);
    for (int k = 1; k <= dim; k++) {
        product *= vector_distance(dim, x[k], x[0]);
    }
    return volume < 0 ? volume / product : 0;
}

/* The poorest score of the cells at a node, or one below `least`. */
static double star_score(const struct label_body *body, int64_t node, double least)
{
    const struct label_cells_star *star = &body->star;
    double poorest = INFINITY;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1] && poorest >= least; i++) {
        poorest = fmin(poorest, score_of(body, star->cell[i]));
    }
    return poorest;
}

/* Mean length of the edges that end at a node. */
static double edge_length(const struct label_body *body, int64_t node)
{
    const struct label_cells *mesh = body->mesh;
    const struct label_cells_star *star = &body->star;
    int dim = mesh->dim;
    double sum = 0;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        for (int k = 0; k <= dim; k++) {
            int64_t other = mesh->cell[(int64_t)star->cell[i] * (dim + 1) + k];
            sum += vector_distance(dim, mesh->x + other * dim, mesh->x + node * dim);
        }
    }
    return sum / (double)((star->ptr[node + 1] - star->ptr[node]) * dim);
}

/* Try steps of decreasing length in all directions, along the axes and between them; nodes of interfaces stay
 * on them. Takes the first step after which the poorest cell at the node scores `least`, else the
 * best of each length that improves it. */
static bool search_better(const struct label_body *body, int64_t node, double least)
{
    int dim = body->mesh->dim;
    double *x = body->mesh->x + node * dim, length = 0.25 * edge_length(body, node);
    double score = star_score(body, node, -INFINITY), best[3] = {0};
    bool improved = false;
    memcpy(best, x, (size_t)dim * sizeof *x);
    for (int step = 0; step < HALVINGS && score < least; step++, length /= 2) {
        double here[3];
        memcpy(here, best, sizeof here);
        for (int direction = 0; direction < (dim == 2 ? 9 : 27) && score < least; direction++) {
            const double way[3] = {direction % 3 - 1, direction / 3 % 3 - 1,
                                   dim == 3 ? direction / 9 - 1 : 0};
            double norm = vector_length(3, way);
            for (int d = 0; d < dim; d++) {
                x[d] = here[d] + (norm > 0 ? length / norm * way[d] : 0);
            }
            if (body->star.labels[node] >= 2 && node_place(body, node, false, 0, x) == INFINITY) {
                continue;
            }
            double fresh = star_score(body, node, score);
            if (fresh > score) {
                improved = true;
                score = fresh;
                memcpy(best, x, (size_t)dim * sizeof *x);
            }
        }
    }
    memcpy(x, best, (size_t)dim * sizeof *x);
    return improved;
}

void label_cells_repair(const struct label_body *body, double least)
{
    const struct label_cells *mesh = body->mesh;
    bool improved = true;
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && improved; sweep++) {
        improved = false;
        for (int64_t c = 0; c < mesh->cell_count; c++) {
            for (int k = 0; k <= mesh->dim && score_of(body, c) < least; k++) {
                int64_t node = mesh->cell[c * (mesh->dim + 1) + k];
                improved = (body->star.labels[node] > 0 && search_better(body, node, least)) || improved;
            }
        }
    }
}

/* A node, those around it that may move, and their positions. */
enum { ROOM_MOST = 64 };
struct room {
    int count;
    int64_t node[ROOM_MOST];
    double x[ROOM_MOST][3];
};

static void add_node(const struct label_body *body, int64_t node, struct room *room)
{
    int dim = body->mesh->dim;
    for (int r = 0; r < room->count; r++) {
        if (room->node[r] == node) {
            return;
        }
    }
    if (room->count < ROOM_MOST) {
        memcpy(room->x[room->count], body->mesh->x + node * dim, (size_t)dim * sizeof(double));
        room->node[room->count++] = node;
    }
}

static void find_room(const struct label_body *body, int64_t node, bool around, struct room *room)
{
    const struct label_cells_star *star = &body->star;
    int corners = body->mesh->dim + 1;
    room->count = 0;
    add_node(body, node, room);
    for (int64_t i = star->ptr[node] * corners; around && i < star->ptr[node + 1] * corners; i++) {
        int64_t other = body->mesh->cell[(int64_t)star->cell[i / corners] * corners + i % corners];
        if (!body->apart[other] && star->labels[other] > 0) {
            add_node(body, other, room);
        }
    }
}

/* The poorest score of the cells at the nodes, or one below `least`. */
static double room_score(const struct label_body *body, const struct room *room, double least)
{
    double poorest = INFINITY;
    for (int r = 0; r < room->count && poorest >= least; r++) {
        poorest = fmin(poorest, star_score(body, room->node[r], least));
    }
    return poorest;
}

/* Move the nodes but the first until no cell at them scores less than `least`; if that fails, they return. */
static bool make_room(const struct label_body *body, const struct room *room, double least)
{
    int dim = body->mesh->dim;
    bool improved = true;
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && improved; sweep++) {
        improved = false;
        for (int r = 1; r < room->count; r++) {
            bool poor = star_score(body, room->node[r], least) < least;
            improved = (poor && search_better(body, room->node[r], least)) || improved;
        }
        if (room_score(body, room, least) >= least) {
            return true;
        }
    }
    for (int r = 1; r < room->count; r++) {
        memcpy(body->mesh->x + room->node[r] * dim, room->x[r], (size_t)dim * sizeof(double));
    }
    return false;
}

bool star_move(const struct label_body *body, int64_t node, const double target[], double least, bool around)
{
    int dim = body->mesh->dim;
    double *x = body->mesh->x + node * dim, share = 1;
    struct room room;
    find_room(body, node, around, &room);
    memcpy(x, target, (size_t)dim * sizeof *x);
    if (star_score(body, node, least) >= least) {
        return true;
    }
    memcpy(x, room.x[0], (size_t)dim * sizeof *x);
    least = fmin(least, room_score(body, &room, -INFINITY));
    for (int halving = 0; halving < HALVINGS; halving++, share /= 2) {
        vector_between(dim, room.x[0], target, share, x);
        if (star_score(body, node, least) >= least || (around && make_room(body, &room, least))) {
            return share == 1;
        }
    }
    memcpy(x, room.x[0], (size_t)dim * sizeof *x);
    return false;
}
