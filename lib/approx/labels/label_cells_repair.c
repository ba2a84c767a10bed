#include "approx/labels/label_cells_private.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum { STEPS = 5 }; /* of a search, each half as long as the last */

/* Mean length of the edges that end at a node. */
static double edge_length(const struct shaping *shaping, int64_t node)
{
    const struct label_cells *mesh = shaping->mesh;
    const struct label_cells_star *star = &shaping->star;
    int dim = mesh->dim;
    double sum = 0;
    int64_t count = 0;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        for (int k = 0; k <= dim; k++) {
            int64_t other = mesh->cell[(int64_t)star->cell[i] * (dim + 1) + k];
            sum += vector_distance(dim, mesh->x + other * dim, mesh->x + node * dim);
            count += other != node;
        }
    }
    return sum / (double)count;
}

/* Try steps of decreasing length in all directions, along the axes and between them; nodes of interfaces stay
 * on them. Takes the first step after which the poorest cell at the node scores `least`, else the
 * best of each length that improves it. */
static bool search(const struct shaping *shaping, double least, int64_t node)
{
    int dim = shaping->mesh->dim;
    double *x = shaping->mesh->x + node * dim, length = 0.25 * edge_length(shaping, node);
    double score = star_score(shaping, node, -INFINITY);
    bool improved = false;
    for (int step = 0; step < STEPS && score < least; step++, length /= 2) {
        double here[3] = {0}, best[3] = {0}, best_score = score;
        memcpy(here, x, (size_t)dim * sizeof *x);
        for (int direction = 0; direction < label_cells_directions(dim) && best_score < least; direction++) {
            double place[3], norm = label_cells_direction(dim, direction, place);
            for (int d = 0; d < dim; d++) {
                place[d] = here[d] + (norm > 0 ? length / norm * place[d] : 0);
            }
            if (shaping->star.labels[node] >= 2 && !node_project(shaping, node, place)) {
                continue;
            }
            memcpy(x, place, (size_t)dim * sizeof *x);
            double fresh = star_score(shaping, node, best_score);
            if (fresh > best_score) {
                best_score = fresh;
                memcpy(best, place, sizeof best);
            }
        }
        improved = improved || best_score > score;
        memcpy(x, best_score > score ? best : here, (size_t)dim * sizeof *x);
        score = best_score;
    }
    return improved;
}

void label_cells_repair(const struct shaping *shaping, double least)
{
    const struct label_cells *mesh = shaping->mesh;
    bool improved = true;
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && improved; sweep++) {
        improved = false;
        for (int64_t c = 0; c < mesh->cell_count; c++) {
            for (int k = 0; k <= mesh->dim && shaping_score(shaping, c) < least; k++) {
                int64_t node = mesh->cell[c * (mesh->dim + 1) + k];
                improved = (shaping->star.labels[node] > 0 && search(shaping, least, node)) || improved;
            }
        }
    }
}

/* ---- room for a node ---- */

enum { ROOM_MOST = 64 };

/* The nodes around a node that may move, and their positions. */
struct room {
    int count;
    int64_t node[ROOM_MOST];
    double x[ROOM_MOST][3];
};

static void find_room(const struct shaping *shaping, int64_t node, struct room *room)
{
    const struct label_cells *mesh = shaping->mesh;
    const struct label_cells_star *star = &shaping->star;
    int dim = mesh->dim;
    room->count = 0;
    for (int64_t i = star->ptr[node]; i < star->ptr[node + 1]; i++) {
        for (int k = 0; k <= dim; k++) {
            int64_t other = mesh->cell[(int64_t)star->cell[i] * (dim + 1) + k];
            bool fixed = shaping->kept->apart[other] || shaping->star.labels[other] == 0;
            bool listed = other == node || fixed || room->count == ROOM_MOST;
            for (int r = 0; r < room->count && !listed; r++) {
                listed = room->node[r] == other;
            }
            if (!listed) {
                memcpy(room->x[room->count], mesh->x + other * dim, (size_t)dim * sizeof(double));
                room->node[room->count++] = other;
            }
        }
    }
}

/* The poorest score of the cells at the node and at those around it, or one below `least`. */
static double room_score(const struct shaping *shaping, int64_t node, const struct room *room, double least)
{
    double poorest = star_score(shaping, node, least);
    for (int r = 0; r < room->count && poorest >= least; r++) {
        poorest = fmin(poorest, star_score(shaping, room->node[r], least));
    }
    return poorest;
}

bool star_make_room(const struct shaping *shaping, double least, int64_t node, const double target[])
{
    struct label_cells *mesh = shaping->mesh;
    int dim = mesh->dim;
    double *x = mesh->x + node * dim, before[3] = {0};
    struct room room;
    find_room(shaping, node, &room);
    double wanted = fmin(least, room_score(shaping, node, &room, -INFINITY));
    memcpy(before, x, (size_t)dim * sizeof *x);
    memcpy(x, target, (size_t)dim * sizeof *x);
    bool improved = true;
    for (int sweep = 0; sweep < LABEL_CELLS_SWEEPS && improved; sweep++) {
        improved = false;
        for (int r = 0; r < room.count; r++) {
            if (star_score(shaping, room.node[r], wanted) < wanted) {
                improved = search(shaping, wanted, room.node[r]) || improved;
            }
        }
        if (room_score(shaping, node, &room, wanted) >= wanted) {
            return true;
        }
    }
    memcpy(x, before, (size_t)dim * sizeof *x);
    for (int r = 0; r < room.count; r++) {
        memcpy(mesh->x + room.node[r] * dim, room.x[r], (size_t)dim * sizeof *x);
    }
    return false;
}
