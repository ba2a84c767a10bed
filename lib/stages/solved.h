/* The field that mtled solved for, as its results carry it: u_h(x) = sum_j phi_j(x) d_j, with the parameters
 * d_j in the sections parameters and parameters.frame.K, and the supports that phi_j has in
 * parameters.radius. */
#pragma once

#include "stages/stages.h"

struct solved {
    const double *radius;     /* of the nodes, m; NULL: the stream carries no such field */
    struct recorded recorded; /* what else supports and shape functions are made with */
};

/* Zeros where the stream has no section parameters.radius. The view is the stream's. */
MUST_CHECK enum status solved_read(const struct stream *stream, struct solved *solved, struct error *error);

/* The same for the supports of the sections PREFIX.radius and PREFIX.side. */
MUST_CHECK enum status supports_read(const struct stream *stream, const char *prefix, struct solved *solved,
                                     struct error *error);

/* The section to evaluate for a field: the parameters of u and u.frame.K, where they are there and fit; else
 * the field itself, whose values are taken as parameters. */
const struct section *solved_parameters(const struct stream *stream, const struct solved *solved,
                                        const struct section *field);

/* Whether a section is of parameters, and no field of its own. */
bool solved_is_parameters(const struct section *section);
