#include "solid/preconditioner/slow_modes.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

void slow_modes_free(struct slow_modes *modes)
{
    FREE_ALL(modes->mode, modes->momentum);
    *modes = (struct slow_modes){0};
}

enum status slow_modes_reserve(struct slow_modes *modes, int64_t count, struct error *error)
{
    if (count > modes->room) {
        RETURN_IF_ERROR(RESIZE_ARRAY(&modes->mode, count * modes->size, error));
        RETURN_IF_ERROR(RESIZE_ARRAY(&modes->momentum, count * modes->size, error));
        modes->room = count;
    }
    return STATUS_OK;
}

void slow_modes_add(struct slow_modes *modes, const double *mode)
{
    double *to = modes->mode + modes->count * modes->size, *momentum = slow_modes_next_momentum(modes);
    double square = vector_product(modes->size, mode, momentum), scale = 1.0 / sqrt(square);
    if (!(square > 0.0)) {
        return; /* round-off */
    }
    for (int64_t i = 0; i < modes->size; i++) {
        to[i] = scale * mode[i];
        momentum[i] *= scale;
    }
    modes->count++;
}

/* y += factor (direction . x) direction */
static void add_along(int64_t size, double factor, const double *direction, const double *x, double *y)
{
    double amount = factor * vector_product(size, direction, x);
    for (int64_t i = 0; i < size; i++) {
        y[i] += amount * direction[i];
    }
}

void slow_modes_accelerate(const struct slow_modes *modes, const double *force, double *acceleration)
{
    for (int64_t k = 0; k < modes->count; k++) {
        add_along(modes->size, SLOW_MODE_GAIN - 1.0, modes->mode + k * modes->size, force, acceleration);
    }
}

void slow_modes_multiply(const struct slow_modes *modes, const double *move, double *force)
{
    for (int64_t k = 0; k < modes->count; k++) {
        add_along(modes->size, 1.0 / SLOW_MODE_GAIN - 1.0, modes->momentum + k * modes->size, move, force);
    }
}

double slow_modes_square(const struct slow_modes *modes, const double *move)
{
    double sum = 0.0;
    for (int64_t k = 0; k < modes->count; k++) {
        double along = vector_product(modes->size, modes->momentum + k * modes->size, move);
        sum += (1.0 / SLOW_MODE_GAIN - 1.0) * along * along;
    }
    return sum;
}
