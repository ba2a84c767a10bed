/* Exchange of the small sections of the parts, so that all processes have them. */
#pragma once

#include "parts/rejoin.h"

/* Set the streams of parts that other processes have read: sections, large tables without rows, and
 * provenance. Process r has the parts from first[r] to before first[r + 1]. Collective. *packed holds the
 * data of these streams, to be freed after them; NULL for one process. */
MUST_CHECK enum status parts_share_small(struct rejoin *rejoin, const int64_t *first, void **packed,
                                         struct error *error);
