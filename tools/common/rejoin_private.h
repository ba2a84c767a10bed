/* Which rows of each part are its own, and where they stand in the whole: private to rejoin*.c. */
#ifndef TOOLS_REJOIN_PRIVATE_H
#define TOOLS_REJOIN_PRIVATE_H

#include "rejoin.h"

/* part->to[kind] of `count` rows, for the caller to fill. */
int32_t *rejoin_new_rows(const struct rejoin *rejoin, struct rejoin_part *part, enum rows_of kind,
                         int64_t count);

/* Exits unless every row of the whole comes from one part; `called`: the section's name. */
void rejoin_check_rows(const struct rejoin *rejoin, enum rows_of kind, const char *called);

/* The faces, the rows that they are averaged over, and the points of these. */
void rejoin_map_faces(struct rejoin *rejoin);

#endif
