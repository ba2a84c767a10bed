/* Slow modes that a relaxation has met, with less mass: a rank-one update of M^-1 multiplies the eigenvalue
 * of each (equation (26a) of lib/README.md; compare deflation: Nicolaides 1987).
 *
 * A few modes whose stiffness is far below that of all others, such as the turning of a buckled rod, lie in
 * no coarse space that is chosen beforehand. An increment that keeps its direction over several checks
 * approximates such a mode w. With w . M w = 1 and a gain g > 1,
 *
 *   M'^-1 = M^-1 + (g - 1) w (x) w,    M' = M - (1 - 1 / g) M w (x) M w,
 *
 * the mass along w is divided by g. No motion becomes heavier, as M - M' is positive semidefinite. The
 * largest eigenvalue of M'^-1 K rises by at most (g - 1) w . K w, which is small for a slow mode. The next
 * mode is added to M' in the same way. */
#pragma once

#include "base/status.h"

#include <stdint.h>

enum { SLOW_MODES_MOST = 8 };
#define SLOW_MODE_GAIN 16.0 /* g: the frequency of a mode becomes four times as high */

struct slow_modes {
    int64_t size;            /* of a mode */
    int64_t count, room;     /* modes; arrays are allocated for `room` of them */
    double *mode, *momentum; /* count * size each: mode k is w_k, momentum k is M_(k-1) w_k, and w_k . M_(k-1)
                                w_k = 1; M_(k-1) includes the modes before it */
};

void slow_modes_free(struct slow_modes *modes);

/* Make room for so many modes. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status slow_modes_reserve(struct slow_modes *modes, int64_t count, struct error *error);

/* Where the caller puts M mode, where M includes the modes already stored, before it adds a mode. */
static inline double *slow_modes_next_momentum(const struct slow_modes *modes)
{
    return modes->momentum + modes->count * modes->size;
}

/* Add a mode, which may be a later one of those stored. It and its momentum are scaled so that their product
 * is
 * 1. There must be room. A mode whose product is not positive, by round-off, is left out. */
void slow_modes_add(struct slow_modes *modes, const double *mode);

/* acceleration += (M'^-1 - M^-1) force */
void slow_modes_accelerate(const struct slow_modes *modes, const double *force, double *acceleration);

/* force += (M' - M) move, and move . (M' - M) move */
void slow_modes_multiply(const struct slow_modes *modes, const double *move, double *force);
double slow_modes_square(const struct slow_modes *modes, const double *move);
