/* What linear functionals of motions, such as a mean over a boundary, are of the coarse fields; private to
 * lib/solid/preconditioner. */
#pragma once

#include "base/profile.h"
#include "solid/constraint/average.h"
#include "solid/preconditioner/coarse_space.h"

enum { COARSE_MOST_ROWS = 4 };     /* functionals at once */
enum { COARSE_MOST_NUMBERS = 12 }; /* fields of a group times directions */

struct coarse_rows {
    const struct coarse_space *coarse; /* the caller's */
    int64_t count;                     /* groups near: where they are not zero */
    int32_t *group;                    /* group_count: these, */
    int32_t *place;                    /* group_count: where a group is among these, or -1 */
    double (*value)[COARSE_MOST_ROWS][COARSE_MOST_NUMBERS]; /* group_count */
};

/* All are zero. Errors: STATUS_SYSTEM (memory). */
MUST_CHECK enum status coarse_rows_begin(const struct coarse_space *coarse, struct coarse_rows *rows,
                                         struct error *error);
void coarse_rows_free(struct coarse_rows *rows);
void coarse_rows_clear(struct coarse_rows *rows);

/* Add block[count][dim] times what the fields move a node by to the first `count` functionals. */
void coarse_rows_add(struct coarse_rows *rows, int64_t node, int count, const double *block);

/* Add factor times the average along each of direction[count][dim]. */
void coarse_rows_add_average(struct coarse_rows *rows, const struct average *average, double factor,
                             int count, const double *direction);

/* A matrix along the fields, within a profile of blocks by groups, += factor row^T row of functional `row`;
 * or what the fields move a node by, transposed, times the first dim of them. */
void coarse_rows_square(const struct coarse_rows *rows, int row, double factor, const struct profile *profile,
                        double *matrix);
void coarse_rows_multiply(const struct coarse_rows *rows, int64_t node, const struct profile *profile,
                          double *matrix);

/* Widen a profile so that it holds the square of functionals. */
void coarse_rows_widen(const struct coarse_rows *rows, struct profile *profile);
