/* Guarded moves of nodes. */
#include "approx/cells/cells.h"
#include "approx/cells/quality.h"
#include "approx/labels/label_cells_private.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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
    simplex_angles(&cells, cell, angles);
    if (angles[0] > 0) {
        double of_angles =
            fmin(angles[0] / LABEL_CELLS_LEAST_ANGLE, (180 - angles[1]) / (180 - LABEL_CELLS_MOST_ANGLE));
        return fmin(of_angles, cell_quality(&cells, cell) / POOR_QUALITY);
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
static bool search(const struct label_body *body, int64_t node, double least)
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
                improved = (body->star.labels[node] > 0 && search(body, node, least)) || improved;
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
            improved = (poor && search(body, room->node[r], least)) || improved;
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
