/* Search directions that are conjugate to the ones before. */
#include "base/memory.h"
#include "base/vector.h"
#include "solid/equilibrium/newton_private.h"

#include <stdlib.h>
#include <string.h>

int newton_usual_directions(const struct newton *n)
{
    return system_has_potential(n->system) ? NEWTON_DIRECTIONS : NEWTON_DIRECTIONS_UNSYMMETRIC;
}

enum status newton_keep_directions(struct newton *n, int count, struct error *error)
{
    struct newton_directions *directions = &n->directions;
    directions->most = count;
    for (int k = 0; k < count; k++) {
        if (directions->move[k] == NULL) {
            RETURN_IF_ERROR(NEW_ARRAY(&directions->move[k], n->size, error));
            RETURN_IF_ERROR(NEW_ARRAY(&directions->product[k], n->size, error));
            RETURN_IF_ERROR(n->system->contact_count > 0 ? NEW_ARRAY(&directions->contact[k], n->size, error)
                                                         : STATUS_OK);
        }
    }
    return STATUS_OK;
}

void newton_free_directions(struct newton *n)
{
    for (int k = 0; k < NEWTON_MOST_ITERATIONS; k++) {
        FREE_ALL(n->directions.move[k], n->directions.product[k], n->directions.contact[k]);
    }
}

int newton_directions_kept(const struct newton_directions *directions)
{
    return directions->count < directions->most ? directions->count : directions->most;
}

int newton_direction(const struct newton_directions *directions, int before)
{
    return (directions->count - 1 - before) % directions->most;
}

void newton_forget_directions(struct newton *n)
{
    n->directions.count = 0;
}

void newton_conjugate(struct newton *n)
{
    struct newton_directions *directions = &n->directions;
    directions->part = 0.0;
    for (int before = newton_directions_kept(directions) - 1; before >= 0; before--) {
        int k = newton_direction(directions, before);
        double along = vector_dot(n->size, directions->move[k], n->cg.product);
        if (n->system->contact_count > 0) {
            along += vector_dot(n->size, directions->contact[k], n->cg.search);
        }
        double part = directions->part = -along / directions->curvature[k];
        for (int64_t i = 0; i < n->size; i++) {
            n->cg.search[i] += part * directions->move[k][i];
            n->cg.product[i] += part * directions->product[k][i];
        }
    }
}

void newton_keep_direction(struct newton *n, const double *move, const double *lost, double curvature)
{
    struct newton_directions *directions = &n->directions;
    directions->count++;
    int k = newton_direction(directions, 0);
    size_t bytes = (size_t)n->size * sizeof *move;
    memcpy(directions->move[k], move, bytes);
    memcpy(directions->product[k], n->cg.product, bytes);
    if (lost != NULL) {
        memcpy(directions->contact[k], lost, bytes);
    }
    directions->curvature[k] = curvature;
}

void newton_descend_again(struct newton *n)
{
    const struct newton_directions *directions = &n->directions;
    for (int before = newton_directions_kept(directions) - 1; before >= 0; before--) {
        int k = newton_direction(directions, before);
        const double *move = directions->move[k];
        double way =
            (vector_dot(n->size, move, n->model.smooth) + vector_dot(n->size, move, n->model.contact)) /
            directions->curvature[k];
        for (int64_t i = 0; i < n->size; i++) {
            n->step.move[i] += way * move[i];
            n->model.smooth[i] -= way * directions->product[k][i];
            n->model.contact[i] -= way * directions->contact[k][i];
        }
    }
}
