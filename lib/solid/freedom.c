#include "solid/freedom.h"

#include "base/box.h"

#include <string.h>

enum { MOST_MOVES = 6 };
/* A move of which the conditions see no more than this part, squared, beside the others is free. */
static const double least_seen = 1e-8;

/* Rigid move k at X, of the order of 1: translations, then rotations about the centre. */
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
    move[a] = -(X[b] - 0.5 * (box->low[b] + box->high[b])) / side;
    move[b] = (X[a] - 0.5 * (box->low[a] + box->high[a])) / side;
}

/* What a row of the conditions sees of each rigid move. */
static void look(const struct solid_system *system, const struct box *box, int64_t r, int moves,
                 double value[])
{
    const struct constraint_rows *rows = &system->rows;
    int dim = system->dim;
    memset(value, 0, (size_t)moves * sizeof *value);
    struct average average = constraint_rows_average(rows, r);
    for (int64_t i = 0; i < average.length; i++) {
        for (int k = 0; k < moves; k++) {
            double move[3];
            rigid_move(box, k, system->X + (int64_t)average.idx[i] * dim, move);
            for (int a = 0; a < dim; a++) {
                value[k] += average.phi[i] * rows->direction[r * dim + a] * move[a];
            }
        }
    }
}

bool system_floats(const struct solid_system *system)
{
    int moves = system->dim == 2 ? 3 : MOST_MOVES;
    double seen[MOST_MOVES][MOST_MOVES] = {{0.0}}, value[MOST_MOVES], diagonal[MOST_MOVES];
    struct box box = box_of(system->dim, system->node_count, system->X);
    for (int64_t r = 0; r < system->rows.count; r++) {
        look(system, &box, r, moves, value);
        for (int i = 0; i < moves; i++) {
            for (int k = 0; k < moves; k++) {
                seen[i][k] += value[i] * value[k];
            }
        }
    }
    for (int k = 0; k < moves; k++) {
        diagonal[k] = seen[k][k];
    }
    for (int k = 0; k < moves; k++) { /* elimination: what is seen of k beside those before it */
        if (!(seen[k][k] > least_seen * diagonal[k])) {
            return true;
        }
        for (int i = k + 1; i < moves; i++) {
            double factor = seen[i][k] / seen[k][k];
            for (int m = k; m < moves; m++) {
                seen[i][m] -= factor * seen[k][m];
            }
        }
    }
    return false;
}
