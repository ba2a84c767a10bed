/* Slow modes that a relaxation has met, with less mass (deflation: Nicolaides 1987; equation (26a) of
 * lib/README.md); private to lib/solid.
 *
 * A few modes whose stiffness is far below that of all others, such as the turning of a buckled rod, lie in
 * no coarse space that is chosen beforehand. What a run has moved by for some time is such a mode w. With w .
 * M w = 1 and a gain g > 1,
 *
 *   M'^-1 = M^-1 + (g - 1) w (x) w,    M' = M - (1 - 1 / g) M w (x) M w,
 *
 * it is g times as light, and no other motion heavier. The largest eigenvalue of M'^-1 K rises by at most
 * (g - 1) w . K w, which is small for a slow mode. The next mode is added to M' in the same way. */
#pragma once

#include "base/status.h"

#include <stdint.h>

enum { SLOW_MODES_MOST = 8 };

struct slow_modes {
    int64_t size;            /* of a mode */
    int64_t count, room;     /* modes; arrays are allocated for `room` of them */
    double *mode, *momentum; /* count * size each: w, and M w with the mass before w was added */
};

void slow_modes_free(struct slow_modes *modes);

/* Make room for so many modes. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status slow_modes_reserve(struct slow_modes *modes, int64_t count, struct error *error);

/* Add a mode; `momentum` is M' mode. There must be room. */
void slow_modes_add(struct slow_modes *modes, const double *mode, const double *momentum);

/* acceleration += (M'^-1 - M^-1) force */
void slow_modes_accelerate(const struct slow_modes *modes, const double *force, double *acceleration);

/* force += (M' - M) move, and move . (M' - M) move */
void slow_modes_multiply(const struct slow_modes *modes, const double *move, double *force);
double slow_modes_square(const struct slow_modes *modes, const double *move);
