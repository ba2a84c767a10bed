/* Means of the displacement field that the corners of conforming cells look at: one for each face (its mean),
 * or one for each node (its value). Corner k of a cell stands for its vertex k, or for the face opposite.
 *
 * An evaluation gathers the means, works on the cells, and scatters what the corners put on their means. */
#ifndef SOLID_MEANS_H
#define SOLID_MEANS_H

#include "solid/pairs.h"

struct means {
    struct pairs pairs;   /* width 1 */
    double *value;        /* row_count * stride: at the last evaluation, m */
    int32_t *of_corner;   /* cells * (dim + 1): the row that each corner looks at */
    double *corner_force; /* cells * (dim + 1) * stride: what each corner puts on it, N (2D: N/m) */
    int64_t *corner_ptr;  /* row_count + 1: the corners of each row, ascending */
    int32_t *corner;
};

/* Lay out a table of width 1, cut into even blocks whatever the input says; of_corner[corner_count] counts
 * rows as they come in the table, and is copied. */
MUST_CHECK enum status means_build(const struct pairs_input *input, int64_t corner_count,
                                   const int32_t *of_corner, struct means *means, struct error *error);
void means_free(struct means *means);

#endif
