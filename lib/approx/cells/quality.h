/* Quality of background cells, and parts of a body whose bending stiffness is wrong, as they are thin for
 * their cells. */
#pragma once

#include "approx/cells/cells.h"

/* The radius ratio of a cell, dim r / R with the radii r of its inscribed and R of its circumscribed circle
 * or sphere (Liu and Joe, Relationship between tetrahedron shape measures, BIT 34, 1994; gamma in gmsh): 1
 * for the regular simplex, 0 without volume, negative if inverted. Node coordinates need not be finite.
 * angles[2], or NULL: the least and the largest angle between faces (2D: edges), degrees; 0 and 180 without
 * volume or inverted. */
double cell_quality(const struct cells *cells, int64_t cell, double angles[2]);

/* A cell of lower quality is poor; smoothed cells are then merged with a neighbour
 * (solid/body/merged_cells.h). */
#define POOR_QUALITY 1e-2

/* The thickness t of a body at a boundary facet is the length of the ray from the facet's middle along its
 * inward normal to the point where it leaves the body, through a facet whose normal is opposite within 60
 * degrees. There the body may bend: u_z = c x^2 / 2, u_x = -c x z. Within a cell the gradient of this field
 * varies by the rotation c x and the strain c z. Smoothed cells give that the energy mu / 2 of its variance,
 * equation (10) of lib/README.md, in place of 0 and E / (1 - nu^2) / 2. With the variances V_x and V_z of the
 * places within a cell (means over the ray, V_x in the worst direction), the bending stiffness of a plate is
 * therefore 1 + e times the true one, to first order, with e = 6 (V_x - V_z) / t^2 for nu = 1/2 and
 * 6 (2 V_x - V_z) / t^2 for nu = 0. Not more cells across, but shorter ones make V_x / t^2 smaller.
 * Where cells are flat, the supports are too narrow along them to reproduce x^2, which alone makes about as
 * much of an error: with |sym grad|^2 in (10), 40 x 4 cells on 25 : 1 are off by -16 % in place of -14 %, and
 * by 1 % with a support radius of 3 spacings in place of -13 %. */
struct thin_report {
    double share;     /* of facets with an |e| above the bound in the boundary, by area or length */
    double excess[2]; /* the largest e, for nu = 1/2 and 0; 0 if that ray was not followed */
    double thickness; /* t there, m */
    double place[3];  /* the middle of that facet, m */
};

/* Errors: as cells_across; STATUS_SYSTEM (memory). */
MUST_CHECK enum status cells_find_thin(const struct cells *cells, double bound, struct thin_report *report,
                                       struct error *error);
