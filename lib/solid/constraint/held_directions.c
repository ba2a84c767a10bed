#include "solid/constraint/held_directions.h"

#include "base/memory.h"
#include "base/vector.h"

#include <string.h>

enum status held_build(int dim, int64_t node_count, struct held_directions *held, struct error *error)
{
    *held = (struct held_directions){.dim = dim};
    RETURN_IF_ERROR(NEW_ARRAY(&held->count, node_count, error));
    return NEW_ARRAY(&held->axis, node_count * dim * dim, error);
}

void held_free(struct held_directions *held)
{
    FREE_ALL(held->count, held->axis);
    *held = (struct held_directions){0};
}

/* Subtract from rest[dim] its components along axis[count * dim], orthonormal vectors. */
static void take_out(int dim, int count, const double *axis, double *rest)
{
    for (int k = 0; k < count; k++) {
        double along = vector_dot(dim, axis + k * dim, rest);
        for (int i = 0; i < dim; i++) {
            rest[i] -= along * axis[k * dim + i];
        }
    }
}

double held_rest(const struct held_directions *held, int32_t node, int count, const double *more,
                 const double *direction, double *rest)
{
    int dim = held->dim;
    memcpy(rest, direction, (size_t)dim * sizeof *rest);
    for (int twice = 0; twice < 2; twice++) { /* against round-off */
        take_out(dim, held->count[node], held->axis + (int64_t)node * dim * dim, rest);
        take_out(dim, count, more, rest);
    }
    return vector_length(dim, rest);
}

void held_note(struct held_directions *held, const struct constraint_rows *rows, int64_t first, int64_t last)
{
    int dim = held->dim;
    for (int64_t r = first; r < last; r++) {
        int32_t node = rows->node[r];
        double rest[3], length = held_rest(held, node, 0, NULL, rows->direction + r * dim, rest);
        if (length > HELD_LEAST) {
            double *axis = held->axis + ((int64_t)node * dim + held->count[node]++) * dim;
            for (int i = 0; i < dim; i++) {
                axis[i] = rest[i] / length;
            }
        }
    }
}
