/* Which rows of each part are its own, where they stand in the whole, and sections made of them: private to
 * rejoin*.c. */
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

/* What the values of a section count. */
enum values_of { VALUES_PLAIN, VALUES_NODES, VALUES_CELLS };

/* The same section of each part; the message names the part where it is missing or another. */
const struct section *rejoin_section(const struct rejoin *rejoin, int64_t k, const char *name,
                                     const struct section *like);

/* Memory for the values of a section. */
void *rejoin_new_values(const struct rejoin *rejoin, const char *name, int64_t rows, size_t bytes);

/* Put a section, which takes the data. */
void rejoin_put(const struct rejoin *rejoin, struct stream *stream, const char *name, enum element_type type,
                int64_t rows, int64_t cols, const char *attributes, void *data);

/* Numbers of nodes or cells of a part become those of the whole. */
void rejoin_renumber(const struct rejoin *rejoin, const struct rejoin_part *part, const char *name,
                     int32_t *value, int64_t count, enum values_of values);

/* A section with a row for each of `rows`. */
void rejoin_put_table(const struct rejoin *rejoin, struct stream *stream, const char *name, enum rows_of rows,
                      enum values_of values);

/* Put the lists of nodes that this section of part 0 belongs to, or what follows their pairs; false: it is
 * none of these. */
bool rejoin_put_lists(const struct rejoin *rejoin, struct stream *stream, const char *name);

#endif
