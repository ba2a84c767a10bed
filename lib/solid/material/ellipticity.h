/* Strong ellipticity of a law at a state: waves of every direction and polarisation have a positive modulus.
 * Where it is lost, the energy has no minimum among smooth fields: shear bands and wrinkles as narrow as the
 * mesh allows (Knowles and Sternberg 1976). */
#pragma once

#include "solid/material/material.h"

#include <stdbool.h>

/* Whether the acoustic tensor Q_ik(n) = d2W / dF_ia dF_kb n_a n_b is positive definite at F, row-major 3 x 3,
 * for directions n spread over the sphere (dim 3) or the circle of the plane (dim 2). The active stress T
 * along the fibres, Pa, adds T (a . n)^2 I. */
bool material_is_elliptic(const struct material *material, double active, int dim, const double F[9]);
