/* Poor cells (approx/cells/quality.h), merged with the largest neighbour of their region, as small cut cells
 * are aggregated in unfitted finite elements (Badia, Verdugo and Martin, Comput. Methods Appl. Mech. Eng.
 * 336, 2018, 533); private to lib/solid. Why: lib/README.md. Members of a group have the gradients
 *
 *   F = sum_i w_i F_i / W,   F_h = sum_i w_i F_h,i / W,   W = sum_i w_i,
 * and J follows from these. By the transpose, the stresses on the members' own gradients are w_i / W sum_j
 * P_j, so that the forces still derive from an energy. Gradients of the interpolant differ by a matrix of
 * rank one across a face; so for two cells det F_h gives the volume between their vertices. */
#pragma once

#include "solid/body/kernel.h"

/* Most cells of a group. */
enum { MERGED_MOST_CELLS = 16 };

/* root[point_count]: for each of the caller's cells a cell that represents its group; itself if it is
 * alone. */
MUST_CHECK enum status merged_cells_find(const struct body_input *input, int64_t *root, struct error *error);

/* Reorder the body's points so that the members of a group are consecutive, and list the groups. */
MUST_CHECK enum status merged_cells_order(const int64_t *root, struct body *body, struct error *error);

/* Replace the rows of F and F_h of merged cells of a block, and det F and J of these. */
void merged_cells_gradients(const struct body *body, const struct block *block, block_rows F,
                            block_rows interpolant, double *determinant, double *J);

/* Replace the weighted stresses of merged cells of a block. */
void merged_cells_stresses(const struct body *body, const struct block *block, block_rows P, block_rows T);
