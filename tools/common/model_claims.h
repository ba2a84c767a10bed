/* Where boundaries of two displacement sections meet, they share nodes: each section claims a value there.
 * The means over hats on either side of such a node are conditions of their own, so that a jump between them
 * would bend the field, not stop the run. */
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
 * value that either prescribes, are an error that names them. (Less than that is smoothed over: measured
 * values at a rim.) */
MUST_CHECK enum status claims_check(const struct model_input *input, struct claims *claims,
                                    struct error *error);

#endif
