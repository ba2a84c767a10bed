/* Smoothed cells (strain smoothing: Chen et al. 2001; equations (6) to (10) of lib/README.md): the gradient
 * of a cell is the mean of the field's over the cell, by the divergence theorem the sum over its faces of the
 * field's mean on the face times the outward normal, per volume.
 *
 * For a simplex the normal of the face opposite vertex k, times its area, is -dim V grad N_k, N_k the
 * linear shape function of the vertex. So F = I - dim sum_k m_k (x) grad N_k, where m_k is the field's mean
 * on the face: a sparse operator replaces a table of gradients of dim values for each pair of cell and node.
 * In 2D it has a row for each face, which two cells share. In 3D, away from the boundary, m_k is the mean of
 * the values at the middles of the face's edges (approx/cells/face_rows.h): there are 1.2 edges for each
 * cell, but two faces, and rows for points are shorter than those for faces.
 *
 * F is not the gradient of a continuous piecewise linear map, so that sum V det F is not the volume within
 * the boundary: under pressure the field could buckle within the cells without a change of volume. With F_h,
 * the gradient of the linear interpolant of the field at the cell's vertices, the volume ratio of a cell is
 * therefore
 *
 *   J = det F_h - cof F_h : (F_h - F).
 *
 * V det F_h is the volume between the vertices, and -V cof F_h : (F_h - F) what lies between them and the
 * cell's faces: the mean offset of each face times the area of the deformed facet, with the opposite sign in
 * the neighbour. So sum V J is the volume within the deformed facets of the boundary and their faces'
 * offsets, whatever the field is inside; and as J and det F differ by the square of F_h - F only, what is
 * exact for linear fields stays so.
 *
 * Smoothing loses the energy of what varies within a cell. The stabilisation energy
 *
 *   k |F_h - F|^2 / 2,      k = mu in two dimensions, 2 mu / 3 in three,
 *
 * restores it (stabilised nodal integration: Puso, Chen, Zywicz and Elmer 2008). k is derived: for a
 * quadratic field on a regular simplex, mu / 2 times the variance of the gradient within the cell equals this
 * energy, in 2D for each field with trace-free second derivatives, in 3D in the mean over all such fields. It
 * is of second order in the size of the cells, at any strain, and the same in all cells. What was tried:
 * pipelines/convergence/DEFAULTS.md. */
#pragma once

#include "solid/operators/field_averages.h"

/* k by mu. */
#define SMOOTHING_STIFFNESS(dim) ((dim) == 2 ? 1.0 : 2.0 / 3.0)

struct body;

/* Input, in the caller's arrays. One integration point per cell. */
struct smoothed_cells_input {
    const double *x;           /* nodes, node_count * dim, m */
    const int32_t *cell_node;  /* cells * (dim + 1) */
    const struct faces *faces; /* all of them */
    const int64_t *face_ptr;   /* row_count + 1: the rows of face averages of the shape functions */
    const int32_t *face_idx;
    const double *face_phi;
    const int64_t *node_ptr; /* node_count + 1: values of the shape functions at the nodes */
    const int32_t *node_idx;
    const double *node_phi;
    const int32_t *face_reader; /* row_count: the process that has read each row of the face averages;
                                   the row is empty in others. NULL: every process has all */
    void (*copied)(
        void *context); /* called when face_ptr, face_idx and face_phi are no longer needed, and their memory
                           has been released (memory_give_back); or NULL. Where each of several processes has
                           all rows, they are needed until the body is freed, and it is not called */
    void *context;
};

struct smoothed_cells {
    struct field_averages averages; /* over the faces, and values at the nodes */
    double *interpolant;            /* F_h at the last evaluation, as body->F */
    double *linear_gradient; /* dim * dim rows of as many as there are cells, and BODY_POINT_PADDING more: row
                    (k - 1) dim
                    + b holds component b of the gradient of N_k, k = 1 .. dim, in each cell, 1/m; the
                    gradients of all N_k sum to zero */
    int64_t merged_count;    /* cells that are merged with a larger one (merged_cells.h) */
    int32_t *group,
        *group_end; /* of each cell in the body's order: the cells of its group; NULL: all are alone */
};

/* Lay out the cells of a body whose sizes, orders and shares are known. STATUS_INPUT when a cell lacks a
 * face, or the values are not those at the faces and nodes. */
MUST_CHECK enum status smoothed_cells_build(const struct smoothed_cells_input *input, struct body *body,
                                            struct error *error);
void smoothed_cells_free(struct smoothed_cells *smoothed);

/* gradient[(dim + 1) * dim]: gradients of the linear shape functions of cell q, in the body's order, 1/m. */
void smoothed_cells_linear_gradients(const struct body *body, int64_t q, double *gradient);

/* The cells that are one domain with cell q (merged_cells.h): from the first to before the last. */
int64_t smoothed_cells_group(const struct body *body, int64_t q);
int64_t smoothed_cells_group_end(const struct body *body, int64_t q);

/* The volume of cell q as a share of that of its group. */
double smoothed_cells_share(const struct body *body, int64_t q);

/* Row i of the FACE_ROWS(dim) of the averages' matrix whose mean is the average over the face opposite vertex
 * k of cell q. */
int32_t smoothed_cells_row(const struct body *body, int64_t q, int k, int i);

/* Vertex k of cell q, as a number in the body's order. */
int32_t smoothed_cells_node(const struct body *body, int64_t q, int k);

/* The nodes whose shape functions are not zero on a cell or its group, in the body's order, and the mean
 * gradients of these over that. For bodies without smoothed cells only the room for the gradients. */
struct cell_functions {
    int32_t *slot;    /* node_count: index of a node in the list, valid where node[slot] is that node */
    int32_t *node;    /* the list, with room for the most nodes that a cell has */
    double *gradient; /* dim for each node of the list, 1/m */
    int64_t count;
};
MUST_CHECK enum status cell_functions_make(const struct body *body, struct cell_functions *functions,
                                           struct error *error);
void cell_functions_free(struct cell_functions *functions);

/* Set *functions to those of cell q, in the body's order. */
void cell_functions_list(const struct body *body, int64_t q, struct cell_functions *functions);

/* The same for the linear shape functions of the cells. */
void cell_functions_list_linear(const struct body *body, int64_t q, struct cell_functions *functions);
