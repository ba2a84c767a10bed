/* Where boundaries of two displacement sections meet, they share nodes: each section claims a value there.
 * The section that comes first holds the node (model_held.h), so that another value would be left out
 * silently. */
#ifndef TOOLS_MODEL_CLAIMS_H
#define TOOLS_MODEL_CLAIMS_H

#include "model.h"

struct claim {
    int32_t node;
    int32_t section;     /* index into the scene's displacements */
    double direction[3]; /* unit */
    double value;        /* m */
};

struct claims {
    int64_t count, room;
    struct claim *list;
};

MUST_CHECK enum status claims_add(struct claims *claims, const struct claim *claim, struct error *error);
void claims_free(struct claims *claims);

/* Two sections that claim values of one node along one direction, further apart than a tenth of the largest
 * value that either prescribes, are an error that names them. Of those that are nearer, as measured values at
 * a rim may be, the first is told in `note`, which is empty when all agree; the section that holds fewer
 * directions decides, or the one that comes first in the scene. */
MUST_CHECK enum status claims_check(const struct model_input *input, struct claims *claims,
                                    struct error *note, struct error *error);

#endif
