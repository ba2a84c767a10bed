/* The elastic stiffness K at rest of a body of smoothed cells, and of springs, by rows of
 * dim x dim blocks K_pq: exact but for the nodal pressures, which are taken without their projection, and
 * nodal offsets, which are left out: with them no fewer iterations; private to lib/solid/preconditioner.
 *
 * A row is found as the forces of a move of node p: the mean gradients g of its shape function in the cells
 * around it, the contents of the nodal volumes there and their pressures, and the forces of the cells on the
 * values at edges, boundary faces and vertices (`fields`); K_pq is their sum by the weights of node q. */
#pragma once

#include "base/sparse.h"
#include "solid/body/smoothed_cells.h"
#include "solid/constraint/constraint.h"

struct solid_system;

/* What rows need of a cell again and again. */
struct stiffness_cell {
    int32_t first, end;                                  /* its group (merged_cells.h) */
    int32_t count, field[SMOOTHED_MOST_ROWS], vertex[4]; /* fields: edges first; those at the vertices */
    double share, shear, first_lame;         /* of the group: its part; moduli times volume, N m (2D: N) */
    double variance_shear, variance_lame;    /* moduli of the variance, likewise */
    double gradient[SMOOTHED_MOST_ROWS * 3]; /* by the fields, */
    double linear_gradient[12];              /* and of the linear shape functions, 1/m */
};

/* Places: nodes in the body's order. Fields: the rows of body->rows. */
struct stiffness_rows {
    const struct solid_system *system;
    struct stiffness_cell *cells; /* point_count */
    struct sparse columns;        /* a row for each prepared node: the fields that contain it, its weights */
    int32_t *slot;                /* of places: the number of that row */
    struct constraint_rows
        touching;               /* points of contacts with rigid surfaces, along their normals at rest, */
    double *touching_stiffness; /* N/m (2D: N/m2) */
    struct sparse springs, held, touched; /* a row for each of the caller's nodes: lists of springs, of
                                               conditions, and of these points, with it */
    double least_weight;                  /* entries of fields up to this are left out */
    double hold;                          /* stiffness of conditions, N/m (2D: N/m2) */
};

MUST_CHECK enum status stiffness_rows_begin(const struct solid_system *system, struct stiffness_rows *rows,
                                            struct error *error);
void stiffness_rows_free(struct stiffness_rows *rows);

/* Prepare for the rows of the nodes place[count], and for columns of these, in place of earlier ones. */
MUST_CHECK enum status stiffness_rows_prepare(struct stiffness_rows *rows, const int32_t *place,
                                              int64_t count, struct error *error);

/* Numbers for the items of a list, without clearing (Briggs and Torczon 1993). */
struct numbered {
    int64_t count;
    int32_t *number, *item;
};

/* Scratch of a thread. */
struct stiffness_row {
    double *at_field; /* zero but for those in use */
    struct numbered cells, fields, volumes, columns;
    double (*on_cell)[8];   /* gradient of the move's shape function, and sum of pressures times shares */
    double (*on_volume)[4]; /* content */
    double (*on_field)[12]; /* forces: three by three, of stride 4 */
};
MUST_CHECK enum status stiffness_row_begin(const struct stiffness_rows *rows, struct stiffness_row *row,
                                           struct error *error);
void stiffness_row_free(struct stiffness_row *row);

/* block[count * dim * dim] = K_pq for q = column[count], of prepared places. */
void stiffness_row_make(const struct stiffness_rows *rows, int32_t p, int64_t count, const int32_t *column,
                        struct stiffness_row *row, double *block);
