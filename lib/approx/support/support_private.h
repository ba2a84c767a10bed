/* Declarations shared by support.c and support_point.c; private to lib/approx. */
#pragma once

#include "approx/support/support.h"

#define SUPPORT_WIDEN_LIMIT 8.0

/* The input of a search for neighbours. */
struct search {
    const struct support_options *options;
    int dim;
    int64_t body_count;
    const struct support_body *body;
    const int32_t *body_of; /* of each point; NULL: the first */
    struct visibility_places places;
    const double *x;
    const char *what;
    bool *unserved; /* points without a good support; NULL: such a point is an error */
};

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    struct visibility_work *visibility; /* for each body */
    struct mls_work work;
    double *order, *gradient;
    int64_t order_room, gradient_room;
    struct steep_points steep;
};

/* The support of a point. */
struct found {
    double widen;
    double steepness;         /* largest |grad phi| times the spacing where that exceeds the bound; else 0 */
    enum mls_verdict verdict; /* if not MLS_GOOD, why there is none */
};

/* Append the neighbours of point p to the worker's list. The radii are widened until the support is
 * admissible, at most by SUPPORT_WIDEN_LIMIT. If gradients exceed their bound with all radii, those that
 * exceed it least are taken. */
MUST_CHECK enum status support_find(const struct search *search, int64_t p, struct worker *worker,
                                    struct found *found, struct error *error);

/* The number of the body in which neighbours of point p are searched. */
static inline int32_t search_body(const struct search *search, int64_t p)
{
    return search->body_of != NULL ? search->body_of[p] : 0;
}
