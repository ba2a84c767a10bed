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
#define JUNCTION_KEPT 0.7

/* Find the groups, reorder the body's points so that the members of each are consecutive, and list them. */
MUST_CHECK enum status merged_cells_build(const struct body_input *input, struct body *body,
                                          struct error *error);

/* Cells that are merged are one domain, with the mean gradients of their linear shape functions. */
struct domain {
    int64_t first, end; /* cells in the body's order */
    double weight;      /* m3 (2D: m2) */
    int count;
    int32_t node[4 * MERGED_MOST_CELLS];       /* in the body's order */
    double gradient[4 * MERGED_MOST_CELLS][3]; /* 1/m */
};

/* The domain of cell q, which has this node. Returns the number of the node's function; or -1 where a cell of
 * the domain before q has the node, too. */
int merged_cells_domain(const struct body *body, int64_t q, int32_t node, struct domain *domain);

/* Replace the rows of F and F_h of the groups of a block, and det F and J of these. */
void merged_cells_gradients(const struct body *body, const struct block *block, block_rows F,
                            block_rows interpolant, double *determinant, double *J);

/* Replace the weighted stresses of the groups of a block. */
void merged_cells_stresses(const struct body *body, const struct block *block, block_rows P, block_rows T);
