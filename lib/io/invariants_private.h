/* Parts of invariants.c; private to lib/io. */
#ifndef IO_INVARIANTS_PRIVATE_H
#define IO_INVARIANTS_PRIVATE_H

#include "io/invariants.h"

struct check {
    const struct stream *stream;
    int dim; /* columns of nodes.x or points.x; 0: unknown */
    violation_function *report;
    void *context;
    int64_t count;
};

__attribute__((format(printf, 3, 4))) void
invariants_violation(struct check *check, const struct section *section, const char *format, ...);

/* Faces on the boundary come first; the rows of their averages, and the points on them, are as many as the
 * faces ask for. */
void invariants_check_faces(struct check *check);

#endif
