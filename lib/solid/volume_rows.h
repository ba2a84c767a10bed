/* The derivative of the volume ratios of the nodal volumes by the displacements, and with it the volumetric
 * stiffness of a nearly incompressible body, which the preconditioner contains (equation (23) of
 * lib/README.md).
 *
 * With theta_a the mean ratio of nodal volume a (nodal_volume.h), the energy of the averages has about the
 * stiffness
 *
 *   C^T K C,    C = d theta / d u,    K_ab = sum_q w_q (kappa_q - s_q) N_a(q) N_b(q),
 *
 * at a state u, but for the geometric part, from the change of C under the pressure, which is of the order of
 * mu. C is exact: it differentiates J = det F_h - cof F_h : (F_h - F) of conforming cells by the means over
 * the faces and by the values at the nodes. */
#ifndef SOLID_VOLUME_ROWS_H
#define SOLID_VOLUME_ROWS_H

#include "solid/body.h"

/* A sparse matrix by rows: row r has columns idx[ptr[r] .. ptr[r + 1]). */
struct volume_matrix {
    int64_t *ptr;
    int32_t *idx;
    double *value;
};

void volume_matrix_free(struct volume_matrix *matrix);

/* List the columns of row r that seen[column] does not have as `row` yet in idx, from `count` on, and mark
 * them; idx NULL: count only. Returns the count then. */
int64_t volume_matrix_note_columns(const struct volume_matrix *matrix, int64_t r, int64_t row, int64_t *seen,
                                   int64_t count, int32_t *idx);

struct volume_rows {
    int dim;
    int64_t count; /* nodal volumes; 0: none, and nothing else is set */
    int64_t node_count;
    struct volume_matrix faces, nodes; /* tables of the means, on the caller's nodes: a row for each mean */
    struct volume_matrix change;       /* C: idx are nodes, value has dim entries for each, 1/m */
    struct volume_matrix stiffness;    /* K, J (2D: J/m) */
    double *theta;                     /* 2 * count: scratch */
};

/* Lay out the rows of a body of averaged conforming cells; C and K are not set. */
MUST_CHECK enum status volume_rows_build(const struct body *body, struct volume_rows *rows,
                                         struct error *error);
void volume_rows_free(struct volume_rows *rows);

/* Values of C. */
int64_t volume_rows_size(const struct volume_rows *rows);

/* Set C and K at the body's last evaluation. */
MUST_CHECK enum status volume_rows_set(const struct body *body, struct volume_rows *rows,
                                       struct error *error);

/* force[count] = K C x */
void volume_rows_force(const struct volume_rows *rows, const double *x, double *force);

/* The transpose: x += D^-1 C^T K amount, D the mass of the nodes. */
void volume_rows_spread(const struct volume_rows *rows, const double *amount, const double *mass, double *x);

/* x . C^T K C y */
double volume_rows_product(const struct volume_rows *rows, const double *x, const double *y);

#endif
