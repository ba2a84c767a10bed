/* The rows of the scalar stiffness S of inverse_stiffness.h; private to lib/solid. */
#pragma once

#include "base/sparse.h"

#include <stdint.h>

struct solid_system;

/* Fields: the rows of the edges, then the values at the nodes. Bonds: the averages that penalties act on. */
struct scalar_stiffness {
    const struct solid_system *system;
    int64_t field_count, bond_count;
    int32_t *range;         /* of the fields' rows, see row_operator_ranges */
    struct sparse bonds;    /* a row for each node: the bonds that contain it, and its weights there */
    double *bond_stiffness; /* N/m (2D: N/m2) */
    struct sparse fields;   /* a row for each prepared node: the fields that contain it, and its weights */
    int32_t *slot;          /* of nodes in the body's order: the number of that row */
    struct sparse cells; /* a row for each field of these: the forces of the cells on fields, by its value */
    int64_t *cells_end;  /* the end of each of these rows */
    int32_t *field_slot; /* of fields: the number of that row */
};

/* The force on a node, while it is summed for the row number `row`. */
struct scalar_sum {
    double sum;
    int32_t row, node; /* `node`: the caller's number */
};

/* Prepare for the rows of this process's nodes (body_share.h). */
MUST_CHECK enum status scalar_stiffness_make(const struct solid_system *system,
                                             struct scalar_stiffness *stiffness, struct error *error);
void scalar_stiffness_free(struct scalar_stiffness *stiffness);

/* A row, and scratch for it. */
struct scalar_row {
    int64_t count;
    int32_t *node;               /* columns of the entries, ascending, */
    double *value;               /* and values, N/m (2D: N/m2) */
    double *at_field, *on_field; /* values of fields, zero but for those in use; forces on fields */
    int32_t *touched;            /* the fields with forces */
    int64_t touched_count;
    struct scalar_sum *sum;          /* of nodes in the body's order */
    int32_t turn;                    /* number of rows computed so far, */
    int32_t *cell_seen, *field_seen; /* and when each was used last */
};
MUST_CHECK enum status scalar_row_make(const struct scalar_stiffness *stiffness, struct scalar_row *row,
                                       struct error *error);
void scalar_row_free(struct scalar_row *row);

/* Prepare for the rows of the nodes place[count] in the body's order, ascending. */
MUST_CHECK enum status scalar_stiffness_prepare(struct scalar_stiffness *stiffness, const int32_t *place,
                                                int64_t count, struct error *error);

/* Compute row i of a prepared node, up to the diagonal, which is its last entry. */
void scalar_stiffness_row(const struct scalar_stiffness *stiffness, int64_t i, struct scalar_row *row);
