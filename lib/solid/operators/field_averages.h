/* Face averages and node values of the displacement field, for smoothed cells. Corner k of a cell uses the
 * average over the face opposite vertex k (equation (6) of lib/README.md: the mean of FACE_ROWS(dim) rows of
 * the operator) and the value at vertex k.
 *
 * An evaluation computes the averages (apply), evaluates the cells, sums the forces of the corners on each
 * average, and adds these to the nodes (transposed apply), equation (12) of lib/README.md. */
#pragma once

#include "approx/cells/face_rows.h"
#include "base/sparse.h"

#include <stdbool.h>

/* Stride of displacements and forces in the force loop, in doubles: 2, or 3 padded to 4. */
#define VECTOR_STRIDE(dim) ((dim) == 2 ? 2 : 4)

/* One of the caller's tables: averages over the faces, or values at the nodes. */
struct average_table {
    int64_t row_count;
    const int64_t *order; /* row_count: the rows in an order that keeps near ones near */
    const int64_t *ptr;   /* row_count + 1 */
    const int32_t *idx;
    const double *phi;
    const int32_t *row_of_corner; /* one for each corner; in the table of faces FACE_ROWS(dim) */
};

/* The rows of B are those of the faces, followed by one for each node. The body stores B (body.h). With
 * several processes, the rows that others compute are empty. */
struct field_averages {
    int64_t row_count;
    double *value;        /* of each row at the last evaluation, m, with stride VECTOR_STRIDE(dim) */
    double *force;        /* on each row, with that stride, N (2D: N/m) */
    int64_t corner_count; /* cells * (dim + 1); once for faces, once for nodes */
    int32_t *of_corner;   /* offsets in value[] of the rows that each corner uses: FACE_ROWS(dim)
                             for each corner of faces, then one for each of nodes */
    double *corner_force; /* 2 corner_count, with that stride: force of each corner on each of its rows */
    int64_t *corner_ptr;  /* row_count + 1: the corners that use each row, */
    int32_t *corner;      /* as many as of_corner has, ascending in each row */
    /* With several processes: */
    struct average_table given[2]; /* the caller's tables: faces, nodes */
    int64_t *face_order;           /* order of the rows of faces */
    struct sparse fetched;         /* if no process has read all rows of faces: those that this one needs */
};

struct field_averages_input {
    int dim;
    int64_t node_count, corner_count;
    const int32_t *place;           /* node_count: the body's index of each of the caller's nodes */
    struct average_table tables[2]; /* faces, nodes */
    bool lets_go; /* release the memory of idx and phi of the faces once they are copied (memory_give_back) */
};

/* List the rows that each corner uses, and the corners that use each row. STATUS_INPUT for more rows than
 * 32-bit offsets can address. */
MUST_CHECK enum status field_averages_build(const struct field_averages_input *input,
                                            struct field_averages *averages, struct error *error);

/* Copy the wanted rows of the tables (NULL: all) into a matrix, with the columns of the nodes from `first` to
 * before `last` in the body's order; other rows are empty. */
MUST_CHECK enum status field_averages_copy(const struct field_averages_input *input, const bool *wanted,
                                           int64_t first, int64_t last, struct sparse *matrix,
                                           struct error *error);

/* Free the fetched rows that have been copied into the matrix. */
MUST_CHECK enum status field_averages_drop_copied(const struct sparse *matrix,
                                                  struct field_averages *averages, struct error *error);
void field_averages_free(struct field_averages *averages);
