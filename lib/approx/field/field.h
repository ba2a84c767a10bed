/* Nodal fields and their values at points. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/shape/shape.h"
#include "approx/support/support.h"

#include <stdbool.h>

/* The shape functions of a field u_h = sum_j phi_j d_j. */
struct field_shapes {
    struct supports supports;       /* of the nodes; radius NULL: not known, and the others are defaults */
    struct support_options support; /* of the lists; its radius and factor are the defaults */
    struct mls shapes;              /* if different from support.mls */
};

/* A view of a field: its nodes, with their cells if there are any, and values[cells.node_count * cols]. */
struct nodal_field {
    struct cells cells;
    int64_t cols;
    const double *values;
    /* Of a computed field; NULL: the values are taken as parameters of MMLS with the default supports. */
    const double *parameters; /* d_j: cells.node_count * cols */
    const struct field_shapes *shapes;
};

/* spacing[node_count], m: the mean length of the cell edges at each node; at nodes without cell, and without
 * cells, the mean distance to the nearest nodes. */
MUST_CHECK enum status field_spacing(const struct cells *cells, double *spacing, struct error *error);

/* outside[count]: whether a point of x[count * dim] is farther from every cell than `within` times the
 * spacing of that cell's nodes (0: lies in no cell); where there are no cells, farther from every node than
 * twice that node's spacing. Values there would be extrapolated. */
MUST_CHECK enum status field_outside(const struct cells *cells, const double *spacing, double within,
                                     int64_t count, const double *x, bool *outside, struct error *error);

/* The distance from the cells, in spacings, up to which fields are extrapolated: landmarks and nodes of
 * another mesh may lie slightly outside of a curved boundary. */
#define FIELD_MARGIN 1.0

/* cell[to->node_count]: the cell nearest to each node of other cells, on the side of its own cells where
 * faces of a slit or bodies touch; -1: all are farther than `within` spacings. Without cells: as
 * field_outside. inward[to->node_count * dim]: the nodes moved into their own cells by a thousandth, which
 * were looked for.
 */
MUST_CHECK enum status field_cells_at_nodes(const struct cells *from, const double *spacing, double within,
                                            const struct cells *to, int64_t *cell, double *inward,
                                            struct error *error);

/* result[to->node_count * cols] at the nodes of other cells of about the same body: linear interpolation in
 * each cell of values[node_count * cols]. Outside of the cells, that of the nearest cell is continued;
 * STATUS_INPUT farther away than FIELD_MARGIN. An interpolated displacement that inverts none of these cells
 * hardly inverts a cell of a finer mesh. The solver's smooth field may, as its gradients vary within a cell
 * near corners. Where faces of a slit or bodies touch, each node takes the value on the side of its own
 * cells. */
MUST_CHECK enum status field_carry(const struct cells *from, int64_t cols, const double *values,
                                   const struct cells *to, double *result, struct error *error);

/* Lists, values and gradients of shape functions at points. */
struct field_table {
    struct neighbours lists;
    double *phi;  /* lists.ptr[lists.count] */
    double *dphi; /* lists.ptr[lists.count] * dim, 1/m; NULL: not wanted */
};

/* Supports and shape functions at x[count * dim], in the cells of `places` (NULL: not known). Where there are
 * cells, neighbours are those visible through them (visibility.h). Nodal values are taken as the parameters
 * of the approximation, u_h = sum_j phi_j u_j; linear fields (quadratic ones with mls2) are reproduced.
 * `what` names the points in messages. */
MUST_CHECK enum status field_table_at(const struct field_shapes *shapes, const struct visibility *space,
                                      const struct visibility_places *places, int64_t count, const double *x,
                                      const char *what, bool gradients, struct field_table *table,
                                      struct error *error);

/* The same, without gradients, for a space of these cells; cell[count]: which of them each point is in, -1:
 * not known; NULL: of none. */
MUST_CHECK enum status field_table_build(const struct field_shapes *shapes, const struct cells *cells,
                                         const int32_t *cell, int64_t count, const double *x,
                                         const char *what, struct field_table *table, struct error *error);
void field_table_free(struct field_table *table);

/* values[count * cols] = sum over the row's neighbours of phi_j field[j * cols ...]. */
void field_evaluate(int64_t count, const int64_t *ptr, const int32_t *idx, const double *phi, int64_t cols,
                    const double *field, double *values);

/* Cells in which a displacement field inverts the body.
 *
 * The map x + u(x) preserves orientation where det (I + grad u) > 0. For cells that are not flat, the linear
 * interpolant between the vertices decides. Across a flat cell of height t and edges of length h, the error
 * of its gradient is of the order of h^2 / t times the second derivative of u: it may be inverted where the
 * field only bends. These cells are therefore judged by the gradient of the field itself, at the points
 * within whose barycentric coordinates are positive multiples of 1/6: ten in a triangle, ten in a
 * tetrahedron. */
enum { FIELD_TURNING_POINTS = 10 };

/* least[count]: the least determinant at the points within each cell of cell[count]; NaN if u is not finite.
 * u[node_count * dim]: parameters of the field, m. Errors: as support_build and shape_table. */
MUST_CHECK enum status field_least_determinants(const struct field_shapes *shapes,
                                                const struct visibility *space, int64_t count,
                                                const int32_t *cell, const double *u, double *least,
                                                struct error *error);
