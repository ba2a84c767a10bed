/* What support.c and support_point.c share; private to lib/approx. */
#ifndef APPROX_SUPPORT_PRIVATE_H
#define APPROX_SUPPORT_PRIVATE_H

#include "approx/candidates.h"
#include "approx/steep_bound.h"
#include "approx/support.h"

#define SUPPORT_WIDEN_LIMIT 8.0

/* A group of points shares its search: at most so many of them. */
enum { MOST_OF_GROUP = 32 };

/* What lists are made of. */
struct search {
    const struct support_options *options;
    const struct point_grid *grid;
    const struct reach *reach; /* NULL: supports are as large as their radii */
    struct reach_places places;
    const double *x;
    const char *what;
};

/* One thread's growing lists and scratch. */
struct worker {
    struct index_list list;
    int64_t around_count, around_capacity; /* neighbours seen around corners */
    int64_t *around_pair;                  /* places in the list */
    double *around_offset;
    struct reach_work reach;
    struct candidates candidates;
    double bounds[MOST_OF_GROUP]; /* on the gradients at each point of the group, see steep_bounds */
    struct mls_work work;
    struct steep_work steep;
    double *order;
    int64_t capacity;
};

/* Append the neighbours of point p to the worker's list, widened as it takes; *serves: whether they do. A
 * grouped point has its candidates found, and a bound on its gradients. */
MUST_CHECK enum status support_find(const struct search *search, int64_t p, bool grouped, double bound,
                                    struct worker *worker, double *widen, bool *serves, struct error *error);

#endif
