/* Patches of blocks of a table of pairs; private to pairs. */
#ifndef SOLID_PAIRS_PATCHES_H
#define SOLID_PAIRS_PATCHES_H

#include "solid/pairs.h"

/* Cut the blocks, whose nodes are known, into patches, and list what each node sums. */
MUST_CHECK enum status patches_make(struct pairs *pairs, struct error *error);

#endif
