/* The centres of the coarse space and the distances of the nodes from them; private to
 * lib/solid/preconditioner. */
#pragma once

#include "solid/preconditioner/coarse_space.h"

/* Set centres, radius, and of_centre: for each centre the nodes within the radius and their distances, m. A
 * node that is within that of no centre is listed with the distance 0 from the nearest one. */
MUST_CHECK enum status coarse_centres_pick(struct coarse_space *coarse, const struct neighbours *neighbours,
                                           struct error *error);
