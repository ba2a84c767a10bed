/* Face averages and node values of the displacement field, which the corners of smoothed cells use: corner k
 * of a cell stands for the face opposite vertex k (its average, equation (6) of lib/README.md: the mean of
 * FACE_ROWS(dim) rows of the operator), and for vertex k (its value).
 *
 * An evaluation computes the averages (apply), evaluates the cells, sums the forces of the corners on each
 * average, and adds these to the nodes (transposed apply), equation (12) of lib/README.md. */
#ifndef SOLID_FIELD_AVERAGES_H
#define SOLID_FIELD_AVERAGES_H

#include "approx/face_rows.h"
#include "base/sparse.h"

#include <stdbool.h>

/* Displacements and forces stand so many doubles apart in the force loop: 2, or 3 padded to 4. */
#define VECTOR_STRIDE(dim) ((dim) == 2 ? 2 : 4)

/* One of the caller's tables: averages over the faces, or values at the nodes. */
struct average_table {
    int64_t row_count;
    const int64_t *order; /* row_count: the rows in an order that keeps near ones near */
    const int64_t *ptr;   /* row_count + 1 */
    const int32_t *idx;
    const double *phi;
    const int32_t *row_of_corner; /* of faces FACE_ROWS(dim) for each corner */
};

struct field_averages {
    int64_t row_count;
    struct sparse matrix, transposed; /* B: the rows of faces, then one for each node; and its transpose.
                                         Of several processes: rows that are not computed here are empty */
    double *value;                    /* of each row at the last evaluation, m: VECTOR_STRIDE(dim) for each */
    double *force;                    /* on each row, likewise, N (2D: N/m) */
    int64_t corner_count;             /* of faces; as many of nodes follow */
    int32_t *of_corner;               /* where the values begin that each corner looks at: FACE_ROWS(dim) for
                                         each of faces, then one for each of nodes */
    double *corner_force;         /* 2 corner_count, likewise: what each corner puts on each of its rows */
    int64_t *corner_ptr;          /* row_count + 1: the corners of each row, */
    int32_t *corner;              /* as many as of_corner: by rows, ascending */
    struct average_table told[2]; /* of several processes: the tables, the caller's, */
    int64_t *face_order;          /* with this order of the rows of faces */
};

struct field_averages_input {
    int dim;
    int64_t node_count, corner_count;
    const int32_t *place; /* node_count: the number by which each of the caller's nodes goes in the body */
    struct average_table tables[2]; /* faces, nodes */
};

/* Lay out which corner looks at which row. */
MUST_CHECK enum status field_averages_build(const struct field_averages_input *input,
                                            struct field_averages *averages, struct error *error);

/* The rows that are wanted (NULL: all) of the tables, whose arrays are copied, with the nodes from `first` to
 * before `last` in the body's order; other rows are empty. */
MUST_CHECK enum status field_averages_copy(const struct field_averages_input *input, const bool *wanted,
                                           int64_t first, int64_t last, struct sparse *matrix,
                                           struct error *error);
void field_averages_free(struct field_averages *averages);

#endif
