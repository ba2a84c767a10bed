/* Smoothed cells (strain smoothing: Chen et al. 2001), equations (6) to (10) of lib/README.md.
 *
 * With the values v_k at the vertices, m_e at the midpoints of edges and s_e = 4 (m_e - (v_i + v_j) / 2), e
 * from i to j, the gradient of the quadratic interpolant is F_h + R_k at vertex k, R_k the sum of s_e (x)
 * grad N_j over the edges e from k to other vertices j; its mean F = F_h + R. The mean over a face on the
 * boundary is that of its own row (approx/cells/face_edges.h) in place of the interpolant's, so that
 * gradients agree with integrals over the boundary. What is exact for linear fields stays so, as J and det F
 * differ by the square of F_h - F only. */
#pragma once

#include "solid/body/field_averages.h"
#include "solid/body/prescribed_values.h"
#include "solid/material/material.h"

/* s_e by m_e. */
#define EDGE_OFFSET 4.0

/* F = I + VERTEX_GRADIENT (F_h - I) + EDGE_GRADIENT sum_e m_e (x) (grad N_i + grad N_j) */
#define EDGE_GRADIENT(dim) ((dim) == 2 ? 4.0 / 3.0 : 1.0)
#define VERTEX_GRADIENT(dim) ((dim) == 2 ? 1.0 / 3.0 : 0.0)

/* The mean of the interpolant over a face by the values on each of its edges and at each of its vertices. */
#define EDGE_IN_FACE(dim) ((dim) == 2 ? 2.0 / 3.0 : 1.0 / 3.0)
#define VERTEX_IN_FACE(dim) ((dim) == 2 ? 1.0 / 6.0 : 0.0)

/* The energy (10) within a cell by the sum over its vertices, per volume. */
#define VARIANCE_FACTOR(dim) (1.0 / (((dim) + 1) * ((dim) + 2)))

/* In (11b): c by W_iso, and the square of the slope of g by its bound. */
#define COUPLING_OF_ENERGY (2.0 / 3.0)
#define COUPLING_CURVE 4.0

struct body;

/* The moduli of (10) in a material, Pa: those at rest, but of what would lock cells, kappa and fibres, up to
 * twice the shear modulus along fibres. */
struct variance_moduli {
    struct material_rest rest;
    double bulk;
};
struct variance_moduli smoothed_cells_moduli(const struct material *material);

/* The families of fibres of a material: by the shear modulus, three times their modulus, and twice the
 * difference of that along them; and their unit vectors; zeros where there are fewer. */
struct variance_fibres {
    double share[2], turned[2], direction[2][3];
};

struct smoothed_cells {
    struct field_averages averages;         /* on the edges and at the vertices */
    struct prescribed_values prescribed;    /* on the boundary */
    double *interpolant;                    /* F_h at the last evaluation, as body->F */
    double *variance_shear, *variance_bulk; /* point_count, padded as body->weight: moduli of the energy
                                               within a cell, N m (2D: N) */
    struct variance_fibres *fibres;         /* material_count; NULL: there are none */
    double *linear_gradient; /* dim * dim rows of as many as there are cells, and BODY_POINT_PADDING more: row
                    (k - 1) dim
                    + b holds component b of the gradient of N_k, k = 1 .. dim, in each cell, 1/m; the
                    gradients of all N_k sum to zero */
    double *offset_stiffness; /* node_count, in the body's order: see nodal_offset.h, N/m (2D: N/m2) */
    int64_t merged_count;     /* cells that are merged with a larger one (merged_cells.h) */
    int32_t *group,
        *group_end; /* of each cell in the body's order: the cells of its group; NULL: all are alone */
    double *kept;   /* of each cell: how much of its difference from the mean of its group it keeps; 0 of
                       merged cells, JUNCTION_KEPT at junctions, 1 of cells that are alone; or NULL */
};

/* Lay out the cells of a body whose sizes, orders and shares are known. STATUS_INPUT when a cell lacks a
 * face, or the values are not those on the edges and at the nodes. */
MUST_CHECK enum status smoothed_cells_build(const struct body_input *input, struct body *body,
                                            struct error *error);

/* The moduli of the variance in each cell: by its own volume, or in a cell that others are merged with by
 * that of the group, and in those none. Again after a change of the stiffening. */
void smoothed_cells_renew(struct body *body);

/* The part of that in smoothed_rows.c: body->cells.averages, and its rows in body->rows. */
MUST_CHECK enum status smoothed_rows_build(const struct body_input *input, struct body *body,
                                           struct error *error);
void smoothed_cells_free(struct smoothed_cells *smoothed);

/* gradient[(dim + 1) * dim]: gradients of the linear shape functions of cell q, in the body's order, 1/m. */
void smoothed_cells_linear_gradients(const struct body *body, int64_t q, double *gradient);

/* The cells that are merged with cell q (merged_cells.h), from the first to before the last; and the volume
 * of cell q as a share of that of all of them. */
int64_t smoothed_cells_group(const struct body *body, int64_t q);
int64_t smoothed_cells_group_end(const struct body *body, int64_t q);
double smoothed_cells_share(const struct body *body, int64_t q);

/* The row of edge e of cell q in the averages' matrix. */
int32_t smoothed_cells_edge(const struct body *body, int64_t q, int e);

/* variation[(dim + 1) * dim]: R_k - R at each vertex, of one component of a field with the values
 * edge[CELL_EDGES(dim)] and vertex[dim + 1] in a cell of these gradients grad_N, 1/m times its unit. */
void smoothed_cells_variation(int dim, const double *grad_N, const double *edge, const double *vertex,
                              double *variation);

/* The rows that the mean gradient of cell q depends on, those of its edges first, and how: F changes by
 * value (x) gradient[dim] of each. Returns how many. */
enum { SMOOTHED_MOST_ROWS = 10 };
int smoothed_cells_rows(const struct body *body, int64_t q, int32_t row[SMOOTHED_MOST_ROWS],
                        double gradient[SMOOTHED_MOST_ROWS * 3]);

/* Vertex k of cell q, as a number in the body's order. */
int32_t smoothed_cells_node(const struct body *body, int64_t q, int k);
