/* The field that mtled computed: u_h(x) = sum_j phi_j(x) d_j. Its results hold the parameters d_j in the
 * sections parameters and parameters.frame.K, and the supports of phi_j in parameters.radius. */
#pragma once

#include "stages/stages.h"

struct solved {
    const double *radius;     /* of the nodes, m; NULL: the stream has no such field */
    struct recorded recorded; /* further settings of supports and shape functions */
};

/* A view of the supports of the sections PREFIX.radius and PREFIX.side; zeros if the stream has none. */
MUST_CHECK enum status supports_read(const struct stream *stream, const char *prefix, struct solved *solved,
                                     struct error *error);

/* The section to evaluate for a field: for u and u.frame.K their parameters, if they exist and fit; else the
 * field itself, whose values are taken as parameters. */
const struct section *solved_parameters(const struct stream *stream, const struct solved *solved,
                                        const struct section *field);

/* Whether a section contains parameters, so that it is not a field itself. */
bool solved_is_parameters(const struct section *section);
