/* Geometry of cells and facets for the search for folds; private to lib/solid. */
#pragma once

#include "approx/cells/cells.h"
#include "base/vector.h"
#include "solid/folds/folds.h"

/* Depth, by the length of a facet, up to which facets that cross each other are no fold: the field at the
 * nodes is as uncertain. */
#define FOLD_BEYOND_FACET 0.05

#define FOLD_NOTHING ((struct fold){.kind = FOLD_NONE, .cell = -1, .facet = {-1, -1}})

/* Deformed position of a node, dim components. */
static inline const double *fold_position(const struct folds *folds, int32_t node)
{
    return folds->y + (int64_t)node * folds->input.dim;
}

/* Set the two facets of a fold, `other` -1 where there is none, and its place, the middle of the first facet
 * at rest. */
void fold_name_facets(const struct fold_input *input, int64_t facet, int64_t other, struct fold *fold);

/* Find the parts and bodies of the cells. */
MUST_CHECK enum status folds_find_bodies(struct folds *folds, struct error *error);

/* ---- folds_crossing.c ---- */

/* Fill folds->boxes, ascending along the first axis. */
void folds_sort_boxes(struct folds *folds);

/* Search the boxes [begin, end) and those behind them for facets that cross. */
struct fold folds_search_boxes(const struct folds *folds, int64_t begin, int64_t end);

/* ---- folds_everted.c ---- */

/* Find the surfaces of the boundary, facets that have nodes together. */
MUST_CHECK enum status folds_find_surfaces(struct folds *folds, struct error *error);

/* Look for surfaces that enclosed a volume at rest, as the outer ones of bodies do, and enclose less than
 * none: the body is outside of them. No motion without folds leads there, though at the end nothing crosses
 * and no cell is inverted. */
void folds_find_everted(const struct folds *folds, struct fold *fold);

/* ---- folds_within.c ---- */

/* Look for a body within another, where boundaries do not cross. */
void folds_find_within(struct folds *folds, struct fold *fold);

/* Look for cells whose middle is deep in a cell of another body, or else in any cell that they share no node
 * with. Boundaries that cross at nodes, or lie on each other, are not found as crossings. */
MUST_CHECK enum status folds_look_for_overlaps(struct folds *folds, bool of_bodies, struct fold *fold,
                                               struct error *error);

/* Set folds->y to the positions displaced by u. */
void folds_take_positions(struct folds *folds, const double *u);
