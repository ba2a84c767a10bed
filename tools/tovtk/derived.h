/* Fields derived from the sections of a stream, for viewing. */
#pragma once

#include "stages/views.h"

/* Names of the sections of groups begin so; "label=facets.NAME" or "label=set.NAME" are their attributes. */
#define DERIVED_GROUP "derived."

/* Put fields into the stream, derived from the symmetric tensors stress and strain of a frame (X.frame.K
 * gives X.NAME.frame.K) or of the final state (FRAME_NONE), with the same rows:
 *
 *   stress.von_mises   sqrt(3/2 s:s), s the deviator, Pa
 *   stress.principal   the principal stresses, Pa, the largest first
 *   pressure           -tr(stress)/3, Pa, unless the stream has it
 *   strain.principal   the principal strains, the largest first
 *   J                  sqrt det(1 + 2 strain), exactly det F, unless the stream has volume_ratio
 *
 * And the groups of facets and the node sets: 1 at the nodes of the group and 0 elsewhere. STATUS_INPUT for
 * groups that do not fit the nodes. */
MUST_CHECK enum status derived_add(struct stream *stream, const struct cells *cells, int64_t frame,
                                   struct error *error);
