/* The rows of the operator B of a body (row_operator.h): those of the caller's tables, in an order that keeps
 * near ones near. */
#pragma once

#include "approx/support/support.h"
#include "base/sparse.h"

struct body;
struct body_input;

/* A table of the caller: shape functions on edges and boundary faces, at nodes, or their derivatives. */
struct row_table {
    int per; /* numbers of each neighbour: list f has the rows per place[f] + k of the table, k < per */
    const struct neighbours *lists;
    const double *phi;
    const int64_t *order; /* of each place: its list, */
    const int32_t *place; /* and back */
};

/* Copy the rows of these tables, which follow each other, into body->rows, and set what the processes
 * exchange of them: of one process all rows, and the tables are released (input->copied). */
MUST_CHECK enum status body_rows_copy(const struct body_input *input, int count,
                                      const struct row_table *tables, struct body *body, struct error *error);
