/* Groups of cells whose gradients act on each other; private to lib/solid. Of cells i of volumes w_i:
 *
 *   F~_i = k F_i + (1 - k) sum_j w_j F_j / W,   F_h~ the same,   W = sum_j w_j,
 *
 * and J follows from these. By the transpose, the weighted stresses on the members' own gradients are
 * k P_i + (1 - k) w_i / W sum_j P_j, so that the forces still derive from an energy. Linear fields stay
 * exact, and so does the mean stress.
 *
 * Poor cells (approx/cells/quality.h) are merged with the largest neighbour of their region, k = 0, as small
 * cut cells are aggregated in unfitted finite elements (Badia, Verdugo and Martin, Comput. Methods Appl.
 * Mech. Eng. 336, 2018, 533). Gradients of the interpolant differ by a matrix of rank one across a face; so
 * for two cells det F_h gives the volume between their vertices.
 *
 * At a junction of prescribed and free boundary, where the stress is singular, cells of finite size are too
 * stiff. Those around a node there have k = JUNCTION_KEPT. Why: lib/README.md. */
#pragma once

#include "solid/body/kernel.h"

/* Most cells that are merged, and most of a group. */
enum { MERGED_MOST_CELLS = 16, GROUP_MOST_CELLS = 32 };

/* k of cells at a junction. */
#define JUNCTION_KEPT 0.8

/* root[point_count]: for each of the caller's cells a cell that represents those it is merged with; itself if
 * it is alone. */
MUST_CHECK enum status merged_cells_find(const struct body_input *input, int64_t *root, struct error *error);

/* Let cells at a junction that are alone, of one part of it, of one region and law, have one root as well.
 * (*kept)[point_count], to be freed: k of each cell, 1 of those that are alone. */
MUST_CHECK enum status merged_cells_join(const struct body_input *input, int64_t *root, double **kept,
                                         struct error *error);

/* Reorder the body's points so that the members of a group are consecutive, and list the groups. */
MUST_CHECK enum status merged_cells_order(const int64_t *root, const double *kept, struct body *body,
                                          struct error *error);

/* Replace the rows of F and F_h of the groups of a block, and det F and J of these. */
void merged_cells_gradients(const struct body *body, const struct block *block, block_rows F,
                            block_rows interpolant, double *determinant, double *J);

/* Replace the weighted stresses of the groups of a block. */
void merged_cells_stresses(const struct body *body, const struct block *block, block_rows P, block_rows T);
