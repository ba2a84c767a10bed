/* The scalar stiffness of smoothed cells that inverse_factor.h describes, row by row; private to lib/solid.
 */
#ifndef SOLID_SCALAR_STIFFNESS_H
#define SOLID_SCALAR_STIFFNESS_H

#include "base/sparse.h"

#include <stdint.h>

struct solid_system;

/* Fields are the rows of the averages over the faces, then the values at the nodes. Bonds are the averages
 * that penalties act on. */
struct scalar_stiffness {
    const struct solid_system *system;
    int64_t begin, end; /* rows that can be asked for */
    int64_t field_count, bond_count;
    struct sparse bonds;    /* a row for each node: the bonds that it is in, and its shares there; */
    struct sparse fields;   /* likewise the fields, of several processes, from `begin` to before `end`. Of one
                               process empty: the transpose that the body has tells them */
    double *bond_stiffness; /* N/m (2D: N/m2) */
};

/* A sum at a node, where `row` is 1 + that of the row. */
struct scalar_sum {
    double sum;
    int64_t row;
};

/* For the rows from `begin` to before `end`. */
MUST_CHECK enum status scalar_stiffness_make(const struct solid_system *system, int64_t begin, int64_t end,
                                             struct scalar_stiffness *stiffness, struct error *error);
void scalar_stiffness_free(struct scalar_stiffness *stiffness);

/* Of several processes: work[node_count]: about how much work each row is, as the fields that the node is in;
 * what lies beyond the diagonal is looked at only, and takes half the time. `work` has zeros. */
void scalar_stiffness_work(const struct solid_system *system, double *work);

/* A row, and scratch for it: zeros between calls, where nothing else is said. */
struct scalar_row {
    int64_t count;
    int32_t *node; /* its entries, ascending, */
    double *value; /* and their values, N/m (2D: N/m2) */
    double *at_field, *on_field;
    struct scalar_sum *sum;          /* of nodes in the body's order */
    int32_t *touched;                /* fields */
    int64_t *cell_seen, *field_seen; /* 1 + the last row that has seen each */
};
MUST_CHECK enum status scalar_row_make(const struct scalar_stiffness *stiffness, struct scalar_row *row,
                                       struct error *error);
void scalar_row_free(struct scalar_row *row);

/* Row i up to the diagonal, which is its last entry. */
void scalar_stiffness_row(const struct scalar_stiffness *stiffness, int64_t i, struct scalar_row *row);

#endif
