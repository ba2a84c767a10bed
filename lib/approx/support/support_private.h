/* Declarations shared by support.c and support_point.c; private to lib/approx. */
#pragma once

#include "approx/support/support.h"

#define SUPPORT_WIDEN_LIMIT 8.0

/* The input of a search for neighbours. */
struct search {
    const struct support_options *options;
    const struct point_grid *grid;
    const struct visibility *visibility; /* NULL: all nodes within their radius are neighbours */
    struct visibility_places places;
    const double *x;
    const char *what;
};

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    struct visibility_work visibility;
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
 * exceed it least are taken. Without a good support on its side, the point sees the whole body. */
MUST_CHECK enum status support_find(const struct search *search, int64_t p, struct worker *worker,
                                    struct found *found, struct error *error);
