/* Fields derived from the sections of a stream, for viewing. */
#pragma once

#include "stages/views.h"

/* Sections in addition to those of the stream. */
struct derived {
    struct section *items; /* count; all owned */
    int64_t count;
};

/* Append fields derived from the symmetric tensors stress and strain, and from those of each frame (X.frame.K
 * gives X.NAME.frame.K), with the same rows:
 *
 *   stress.von_mises   sqrt(3/2 s:s), s the deviator, Pa
 *   stress.principal   the principal stresses, Pa, the largest first
 *   pressure           -tr(stress)/3, Pa, unless the stream has it
 *   strain.principal   the principal strains, the largest first
 *   J                  sqrt det(1 + 2 strain), exactly det F, unless the stream has volume_ratio */
MUST_CHECK enum status derived_add_invariants(const struct stream *stream, struct derived *derived,
                                              struct error *error);

/* Append the groups of facets and the node sets: sections facets.NAME and set.NAME, 1 at the nodes of the
 * group and 0 elsewhere. STATUS_INPUT for groups that do not fit the nodes. */
MUST_CHECK enum status derived_add_groups(const struct stream *stream, const struct cells *cells,
                                          struct derived *derived, struct error *error);

void derived_free(struct derived *derived);
