/* One sheet in a body; private to lib/solid/incision. */
#pragma once

#include "base/round_off.h"
#include "solid/incision/incision.h"

#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

/* What edges are split at. */
enum level { LEVEL_HEIGHT, LEVEL_EXTENT };

struct cut {
    struct division *body;
    const struct sheet *sheet;
    int64_t known, old; /* the first `known` nodes have values */
    double *value[2];   /* by level, m; 0: on it; heights NAN: far; extents only of nodes on the sheet */
    double *shortest, *longest; /* edges at the node, m */
    double *face_normal; /* old nodes * dim: mean normal of the front face, reversed of the back, of a cut
                    that is continued */
    int64_t face_count;
    struct keyed *face; /* of cells with a node that is near; item = cell * (dim + 1) + vertex opposite */
};

/* An edge between values of different signs. */
struct crossing {
    struct split split;
    double extent; /* at the place of the split; HEIGHT: INFINITY: there is none */
    bool used;     /* found to be split */
};

struct crossings {
    int64_t count, room;
    struct crossing *item; /* sorted by nodes */
};

/* Take a node to be on the sheet, at the extent of its place. */
void cut_lay(struct cut *cut, int64_t node);

/* On which side of the sheet a cell is: 1 in front, -1 behind, 0: both, or far. */
int cut_side(const struct cut *cut, int64_t cell);

/* Whether face i of two, with the next one, parts a cell in front from one behind, all its nodes on the
 * sheet. */
bool cut_parts(const struct cut *cut, int64_t i);

/* The edges to be split: with different signs of the height, in cells that the sheet meets; or of the extent,
 * of faces on the sheet; and what is within the border between nodes on it. */
MUST_CHECK enum status cut_crossings(const struct cut *cut, enum level level, struct crossings *crossings,
                                     struct error *error);
void crossings_free(struct crossings *crossings);

/* Where the value on an edge is 0. False: nowhere, where it jumps. */
bool cut_root(const struct cut *cut, enum level level, const int32_t node[2], double *share,
              struct sheet_place *place);

/* Move nodes near the zero of the level onto it. */
MUST_CHECK enum status cut_snap(struct cut *cut, enum level level, const struct crossings *crossings,
                                struct error *error);
