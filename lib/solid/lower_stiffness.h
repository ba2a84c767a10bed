/* The scalar stiffness S of inverse_factor.h by rows up to the diagonal; private to lib/solid. */
#ifndef SOLID_LOWER_STIFFNESS_H
#define SOLID_LOWER_STIFFNESS_H

#include "solid/inverse_factor.h"

/* S up to its diagonal, by rows: those of own nodes, and such others as are needed. */
struct lower {
    int64_t *begin, *end; /* of each row */
    int32_t *idx;
    double *value;
    int64_t count, capacity;
    double least; /* on the diagonal */
};

/* The rows of this process's nodes (body_share.h). */
MUST_CHECK enum status lower_make(const struct solid_system *system, struct lower *lower,
                                  struct error *error);
void lower_free(struct lower *lower);

/* Of several processes: the rows of S that are wanted (wanted[node_count]) and that others have. */
MUST_CHECK enum status lower_fetch(const struct solid_system *system, const bool *wanted, struct lower *lower,
                                   struct error *error);

/* S_ij, j <= i; 0 where there is no such entry. */
double lower_entry(const struct lower *lower, int32_t i, int32_t j);

#endif
