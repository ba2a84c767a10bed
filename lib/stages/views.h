/* Views of the sections of a stream, with shapes and indices checked. If a section is missing, the message
 * names the tool that makes it. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/shape/shape.h"
#include "base/names.h"
#include "io/stream/sections.h"

/* A section that is in the table of sections, with the type, columns, rows, numbers and indices that it
 * states; what concerns lists is for stream_neighbours. */
MUST_CHECK enum status stream_view(const struct stream *stream, const char *name,
                                   const struct section **section, struct error *error);
MUST_CHECK enum status section_check(const struct stream *stream, const struct section *section,
                                     const struct section_kind *kind, struct error *error);

/* Check the numbers of a section of type f8: FINITE, POSITIVE or AT_LEAST_ONE. */
MUST_CHECK enum status section_check_numbers(const struct section *section, enum content content,
                                             struct error *error);

/* Check that the numbers of a section of type i4 are within [least, bound). `what` names what they are in the
 * message, which ends with `why`. */
MUST_CHECK enum status section_check_indices(const struct section *section, int64_t least, int64_t bound,
                                             const char *what, const char *why, struct error *error);

/* The program that makes a section. */
const char *section_producer(const struct section_kind *kind);

/* The dimension, from the columns of coordinates; 0 if there are none. */
int stream_dimension(const struct stream *stream);

/* Node coordinates; or, with node_count and x NULL, only their dimension. */
MUST_CHECK enum status stream_nodes(const struct stream *stream, int *dim, int64_t *node_count,
                                    const double **x, struct error *error);

/* Nodes and background cells. Without cells cells->count is 0, or it is an error if they are needed. */
MUST_CHECK enum status stream_cells(const struct stream *stream, bool needed, struct cells *cells,
                                    struct error *error);

/* A nodal field of so many columns; 0: of 1 to 3. */
MUST_CHECK enum status stream_field(const struct stream *stream, const char *name, int cols,
                                    int64_t node_count, const struct section **field, struct error *error);

/* The names in an attribute of a section: names= of groups, or another list such as rows=, separated by
 * commas; to be freed also on failure. */
MUST_CHECK enum status names_of(const struct section *section, const char *key, struct names *names,
                                struct error *error);

/* Named groups: of facets of the boundary, sets of nodes, or the regions of the cells. To be freed, also
 * where reading them failed. Without groups all is 0, or it is an error if they are needed. */
enum group_kind { GROUP_FACETS, GROUP_NODES, GROUP_REGION, GROUP_KINDS };
struct groups {
    struct names names;
    int64_t count;        /* facets, cells, or nodes of all sets */
    const int32_t *node;  /* count * dim: of the facets; count: nodes of one set after the other, ascending in
                             each; NULL: cells */
    const int32_t *group; /* count: below names.count */
    int32_t *owned;       /* sets: the array of `group` */
};
MUST_CHECK enum status stream_groups(const struct stream *stream, enum group_kind kind, bool needed,
                                     struct groups *groups, struct error *error);

/* Put groups, as above, in place of those that there are; without names, or without facets, remove these.
 * The nodes of sets come by group, ascending. The stream takes the arrays that it keeps and sets these to
 * NULL; the others stay the caller's. */
MUST_CHECK enum status stream_put_groups(struct stream *stream, enum group_kind kind,
                                         const struct names *names, int64_t count, int32_t **node,
                                         int32_t **group, struct error *error);
void groups_free(struct groups *groups);

/* Faces of the cells; those on the boundary come first. The view is not to be freed. */
MUST_CHECK enum status stream_faces(const struct stream *stream, struct faces *faces, struct error *error);

/* A CSR list: PREFIX.ptr (rows + 1), PREFIX.idx (ascending in each row), and PREFIX.widen and PREFIX.side if
 * they exist. */
MUST_CHECK enum status stream_neighbours(const struct stream *stream, const char *prefix, int64_t rows,
                                         struct neighbours *lists, struct error *error);

/* The supports of the nodes: PREFIX.radius, and PREFIX.stretch and PREFIX.sides if they exist. */
MUST_CHECK enum status stream_supports(const struct stream *stream, const char *prefix,
                                       struct supports *supports, struct error *error);

/* Whether points.x has one point for each cell, for smoothed cells. */
bool points_are_smoothed(const struct section *points);

/* Put a section with a copy of the data. */
MUST_CHECK enum status stream_put_copy(struct stream *stream, const char *name, enum element_type type,
                                       int64_t rows, int64_t cols, const char *attributes, const void *data,
                                       struct error *error);

/* text[64] = the attributes of a section with a vector in each row, "unit=UNIT cols=x,y[,z]". Returns
 * text. */
const char *vector_attributes(int dim, const char *unit, char text[64]);
