/* Comparing two nodal fields, on one cloud of nodes or on two. */
#pragma once

#include "approx/field/field.h"

/* The largest Euclidean norm of a row; NaN where any value is NaN. */
double field_largest(int64_t count, int64_t cols, const double *field);

/* Statistics of a list of differences. */
struct field_statistics {
    int64_t count;
    double average, largest, rmse;
    int64_t largest_at; /* index of the (first) largest, or of the first NaN */
    double *sorted;     /* count, ascending, for field_percentile */
};

/* Statistics of difference[index[i]], i < count. They are NaN if one difference is NaN, or if there is
 * none. */
MUST_CHECK enum status field_statistics(int64_t count, const int64_t *index, const double *difference,
                                        struct field_statistics *statistics, struct error *error);
void field_statistics_free(struct field_statistics *statistics);

/* The value that `percent` of the differences do not exceed, linear between two. */
double field_percentile(const struct field_statistics *statistics, double percent);

/* The difference of two fields at the nodes of A. */
struct field_comparison {
    bool coincide;      /* the clouds coincide; else B was interpolated */
    int64_t count;      /* nodes compared */
    int64_t *node;      /* those nodes, ascending */
    int64_t outside;    /* nodes left out because they lie outside of B's cloud */
    double *difference; /* for each node of A; NaN where not compared */
};

/* Compare at the nodes of A with chosen[n] (NULL: all). B's values are taken as they are where the clouds
 * coincide, else B's field is evaluated there. Nodes of A outside of B's cloud
 * are left out if skip_outside, else STATUS_INPUT naming the first (and comparison->outside is their number).
 * Clouds that cannot be interpolated are STATUS_INPUT. Both fields have the same dimension and columns. The
 * comparison is to be freed also on failure. */
MUST_CHECK enum status field_compare(const struct nodal_field *a, const struct nodal_field *b,
                                     const bool *chosen, bool skip_outside,
                                     struct field_comparison *comparison, struct error *error);
void field_comparison_free(struct field_comparison *comparison);
