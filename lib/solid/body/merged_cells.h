/* Poor cells, merged with a neighbour; private to lib/solid.
 *
 * Across a sliver, of thickness t and edges of length h, the gradient of the linear interpolant of a smooth
 * field is off by the order of h^2 / t times the field's second derivative, and that of the averages over the
 * faces by what their quadrature misses, over t. Both grow without bound, and with them the stabilisation,
 * the volume ratio and the frequencies. A smoothing domain may have any shape, however (Chen et al. 2001). So
 * a cell of poor quality (approx/cells/quality.h) becomes one domain with the largest neighbour of its
 * region, as small cut cells are aggregated in unfitted finite elements (Badia, Verdugo and Martin, Comput.
 * Methods Appl. Mech. Eng. 336, 2018, 533). Members of a group have the gradients
 *
 *   F = sum_i w_i F_i / W,   F_h = sum_i w_i F_h,i / W,   W = sum_i w_i,
 *
 * and J of these. The stresses on the members' own gradients are by the transpose w_i / W sum_j P_j, so that
 * there still is an energy. Linear fields stay exact. Gradients of the interpolant differ by a matrix of rank
 * one across a face; so for two cells det F_h gives the volume between their vertices. */
#pragma once

#include "solid/body/kernel.h"

/* Cells of a group at most. */
enum { MERGED_MOST_CELLS = 16 };

/* root[point_count]: a cell of the group of each of the caller's cells, itself where it is alone. */
MUST_CHECK enum status merged_cells_find(const struct body_input *input, int64_t *root, struct error *error);

/* Reorder the body's points, whose order is known, so that the members of a group follow each other, and list
 * the groups. */
MUST_CHECK enum status merged_cells_order(const int64_t *root, struct body *body, struct error *error);

/* Replace the rows of F and F_h of merged cells of a block, and det F and J of these. */
void merged_cells_gradients(const struct body *body, const struct block *block, block_rows F,
                            block_rows interpolant, double *determinant, double *J);

/* Replace the weighted stresses of merged cells of a block. */
void merged_cells_stresses(const struct body *body, const struct block *block, block_rows P, block_rows T);
