/* Face averages and node values of the displacement field, which the corners of smoothed cells use: corner k
 * of a cell stands for the face opposite vertex k (its average, equation (6) of lib/README.md), or for vertex
 * k (its value).
 *
 * An evaluation computes the averages (apply), evaluates the cells, and adds the forces of the corners on
 * their averages to the nodes (transposed apply), equation (12) of lib/README.md. */
#ifndef SOLID_FIELD_AVERAGES_H
#define SOLID_FIELD_AVERAGES_H

#include "solid/sparse_operator.h"

struct field_averages {
    struct sparse_operator op; /* a row for each mean; all slices but the last are full */
    double *value;             /* at the last evaluation, m: OPERATOR_STRIDE(dim) for each mean */
    int32_t *of_corner;        /* corner_count: where the value begins that each corner looks at */
    double *corner_force; /* (corner_count + 1) * stride: what each corner puts on its mean, N (2D: N/m); last
                             zeros */
    int64_t *corner_ptr;  /* op.slice_count + 1: for each slice the corners of its averages, ascending, */
    int32_t *corner;      /* corner_ptr[] * OPERATOR_SLICE: in turn, filled up with the zeros */
};

struct field_averages_input {
    int dim;
    int64_t node_count, row_count; /* rows: the averages */
    const int64_t *order;          /* row_count: the caller's rows in an order that keeps near ones near */
    const int64_t *ptr;            /* the caller's table: row_count + 1 */
    const int32_t *idx;
    const double *phi;
    const int32_t *place; /* node_count: the number by which each of the caller's nodes goes in the body */
    int64_t corner_count;
    const int32_t *row_of_corner; /* corner_count: the caller's row that each corner looks at */
};

/* Lay out a table; the arrays are copied. */
MUST_CHECK enum status field_averages_build(const struct field_averages_input *input,
                                            struct field_averages *averages, struct error *error);
void field_averages_free(struct field_averages *averages);

#endif
