/* Fibres in a wall between two surfaces, which turn from one to the other. */
#pragma once

#include "solid/rigid/rigid.h"

struct wall {
    const struct rigid_surface *from, *to; /* in 3D */
    const double *axis;                    /* [3]: a direction along the wall, of any length but 0 */
    double angles[2];                      /* of the fibres on both, degrees */
};

/* fibre[count * 3], unit, at the places x[count * 3], m: cos(a) c + sin(a) n x c with c = axis x n / |axis x
 * n|. n, unit, goes across the wall from the first surface to the second: (1 - e) n1 + e n2 of their normals
 * at the points nearest to x, of which distances d1 and d2 give the depth e = d1 / (d1 + d2) and the angle a
 * = (1 - e) a1 + e a2. Normals are interpolated between vertices. STATUS_INPUT where the nearest place is
 * the same on both surfaces, and for an axis without length. */
MUST_CHECK enum status wall_fibres(const struct wall *wall, int64_t count, const double *x, double *fibre,
                                   struct error *error);
