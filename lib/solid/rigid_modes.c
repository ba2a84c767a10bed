#include "solid/rigid_modes.h"

#include "base/box.h"
#include "base/eigen.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_MODES = EIGEN_MOST };
/* A rigid mode is free when the squared norm of G times it is below this share of the largest one. */
static const double least_seen = 1e-8;

/* A body, and the Gram matrix of the conditions on its rigid modes: sum over the rows of value value^T. */
struct seen {
    struct box box;
    double matrix[MOST_MODES * MOST_MODES]; /* rows of as many as there are rigid modes */
};

static int move_count(int dim)
{
    return dim == 2 ? 3 : MOST_MODES;
}

static double middle(const struct box *box, int a)
{
    return 0.5 * (box->low[a] + box->high[a]);
}

/* Rigid move k at X, of the order of 1: translations, then rotations about the centre, in 3D about the axes
 * z, x, y. */
static void rigid_move(const struct box *box, int k, const double *X, double move[3])
{
    int dim = box->dim;
    memset(move, 0, 3 * sizeof *move);
    if (k < dim) {
        move[k] = 1.0;
        return;
    }
    int a = k - dim, b = (a + 1) % dim; /* turns a towards b */
    double side = box_side(box);
    move[a] = -(X[b] - middle(box, b)) / side;
    move[b] = (X[a] - middle(box, a)) / side;
}

/* Add the values of row r on each rigid mode of a body; body NULL: of all nodes. */
static void look(const struct solid_system *system, const struct constraint_rows *rows, int64_t r,
                 const int32_t *body, int32_t number, struct seen *seen)
{
    int dim = system->dim, moves = move_count(dim);
    double value[MOST_MODES] = {0.0};
    struct average average = constraint_rows_average(rows, r);
    for (int64_t i = 0; i < average.length; i++) {
        for (int k = 0; k < moves && (body == NULL || body[average.idx[i]] == number); k++) {
            double move[3];
            rigid_move(&seen->box, k, system->X + (int64_t)average.idx[i] * dim, move);
            for (int a = 0; a < dim; a++) {
                value[k] += average.phi[i] * rows->direction[r * dim + a] * move[a];
            }
        }
    }
    for (int i = 0; i < moves; i++) {
        add_scaled(moves, value[i], value, seen->matrix + i * moves);
    }
}

/* free[count][MOST_MODES]: an orthonormal basis of the null space of the conditions. */
static int free_moves(int dim, const struct seen *seen, double basis[][MOST_MODES])
{
    int n = move_count(dim), count = 0;
    double seen_by[MOST_MODES], vector[MOST_MODES * MOST_MODES], largest = 0.0;
    eigen_symmetric(n, seen->matrix, seen_by, vector);
    for (int k = 0; k < n; k++) {
        largest = fmax(largest, seen_by[k]);
    }
    for (int k = 0; k < n; k++) {
        if (!(seen_by[k] > least_seen * largest)) {
            for (int i = 0; i < n; i++) {
                basis[count][i] = vector[i * n + k];
            }
            count++;
        }
    }
    return count;
}

/* A rotation of coefficients `move`: its axis, and a point of it. */
static void put_turn(const struct box *box, const double *move, struct rigid_modes *moves)
{
    int dim = box->dim;
    double w[3] = {0.0, 0.0, 0.0}, t[3] = {move[0], move[1], dim == 3 ? move[2] : 0.0};
    double *axis = moves->axis[moves->turns], *through = moves->through[moves->turns];
    for (int k = dim; k < move_count(dim); k++) {
        w[(k - dim + 2) % 3] = move[k] / box_side(box);
    }
    double length2 = vector_dot(3, w, w);
    for (int a = 0; a < 3; a++) { /* where t + w x (p - centre) = 0 */
        int b = (a + 1) % 3, c = (a + 2) % 3;
        axis[a] = w[a] / sqrt(length2);
        through[a] = (a < dim ? middle(box, a) : 0.0) + (w[b] * t[c] - w[c] * t[b]) / length2;
    }
    moves->turns++;
}

/* The free moves as translations, and rotations across them. */
static void name_moves(int dim, const struct seen *seen, struct rigid_modes *moves)
{
    int n = move_count(dim);
    double basis[MOST_MODES][MOST_MODES], turning[MOST_MODES * MOST_MODES], mix[MOST_MODES * MOST_MODES];
    double turned[MOST_MODES];
    int count = free_moves(dim, seen, basis);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < count; k++) {
            turning[i * count + k] = 0.0;
            for (int a = dim; a < n; a++) {
                turning[i * count + k] += basis[i][a] * basis[k][a];
            }
        }
    }
    eigen_symmetric(count, turning, turned, mix);
    for (int k = 0; k < count; k++) {
        double move[MOST_MODES] = {0.0};
        for (int i = 0; i < count; i++) {
            for (int a = 0; a < n; a++) {
                move[a] += mix[i * count + k] * basis[i][a];
            }
        }
        if (turned[k] > least_seen) {
            put_turn(&seen->box, move, moves);
        } else {
            memcpy(moves->along[moves->translations++], move, (size_t)dim * sizeof *move);
        }
    }
}

/* The springs of measured points hold as rows do. */
static int64_t first_spring(const struct solid_system *system)
{
    return system->penalties.count - system->spring_count;
}

/* Rows from `first` on, on the bodies that they hold. */
static void look_at_bodies(const struct solid_system *system, const struct constraint_rows *rows,
                           int64_t first, const int32_t *body, struct seen *seen)
{
    for (int64_t r = first; r < rows->count; r++) {
        struct average average = constraint_rows_average(rows, r);
        int32_t last = -1;
        for (int64_t i = 0; i < average.length; i++) { /* a body twice: weighs twice */
            if (body[average.idx[i]] != last && body[average.idx[i]] >= 0) {
                last = body[average.idx[i]];
                look(system, rows, r, body, last, &seen[last]);
            }
        }
    }
}

/* A node that does not move, at X, adds what it sees of a body. */
static void look_at_node(int dim, const double *X, struct seen *seen)
{
    int moves = move_count(dim);
    double move[MOST_MODES][3], value[MOST_MODES];
    for (int k = 0; k < moves; k++) {
        rigid_move(&seen->box, k, X, move[k]);
    }
    for (int a = 0; a < dim; a++) {
        for (int k = 0; k < moves; k++) {
            value[k] = move[k][a];
        }
        for (int i = 0; i < moves; i++) {
            add_scaled(moves, value[i], value, seen->matrix + i * moves);
        }
    }
}

enum status system_rigid_modes(const struct solid_system *system, int64_t body_count, const int32_t *body,
                               int64_t hinge_count, const struct hinge *hinge, struct rigid_modes *moves,
                               struct error *error)
{
    SCRATCH struct seen *seen = NULL;
    int dim = system->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&seen, body_count, error));
    memset(moves, 0, (size_t)body_count * sizeof *moves);
    for (int64_t b = 0; b < body_count; b++) {
        seen[b].box = box_of(dim, 0, NULL);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        if (body[n] >= 0) {
            box_add(&seen[body[n]].box, 1, system->X + n * dim);
            moves[body[n]].nodes++;
        }
    }
    for (int64_t h = 0; h < hinge_count; h++) {
        box_add(&seen[hinge[h].body].box, 1, system->X + (int64_t)hinge[h].node * dim);
    }
    for (int64_t h = 0; h < hinge_count; h++) {
        look_at_node(dim, system->X + (int64_t)hinge[h].node * dim, &seen[hinge[h].body]);
    }
    look_at_bodies(system, &system->rows, 0, body, seen);
    look_at_bodies(system, &system->penalties, first_spring(system), body, seen);
    for (int64_t b = 0; b < body_count; b++) {
        for (int a = 0; a < dim; a++) {
            moves[b].centre[a] = middle(&seen[b].box, a);
        }
        name_moves(dim, &seen[b], &moves[b]);
    }
    return STATUS_OK;
}

bool system_has_rigid_mode(const struct solid_system *system)
{
    double basis[MOST_MODES][MOST_MODES];
    struct seen seen = {.box = box_of(system->dim, system->node_count, system->X)};
    for (int64_t r = 0; r < system->rows.count; r++) {
        look(system, &system->rows, r, NULL, 0, &seen);
    }
    for (int64_t r = first_spring(system); r < system->penalties.count; r++) {
        look(system, &system->penalties, r, NULL, 0, &seen);
    }
    return free_moves(system->dim, &seen, basis) > 0;
}
