/* Conforming cells: the gradient of a cell is the mean of the field's over the cell, by the divergence
 * theorem the sum over its faces of the field's mean on the face times the outward normal, per volume.
 *
 * For a simplex the normal of the face opposite vertex k, times its area, is -dim V grad N_k, N_k the hat
 * function of the vertex. So F = I - dim sum_k m_k (x) grad N_k, where m_k is the field's mean on the face: a
 * table of means over faces, one value for each pair of face and node, does the work of the table of
 * gradients, dim values for each pair of cell and node, and two cells share each face. */
#ifndef SOLID_CONFORMING_H
#define SOLID_CONFORMING_H

#include "solid/means.h"

/* What they are made of, in the caller's arrays. One integration point per cell. */
struct conforming_input {
    const double *x;          /* nodes, node_count * dim, m */
    const int32_t *cell_node; /* cells * (dim + 1) */
    int64_t face_count;
    const int32_t *face_node; /* face_count * dim */
    const int32_t *face_cell; /* face_count * 2, or -1 beyond the boundary */
    int per_face;             /* quadrature points of each face, and their shares, sum 1 */
    const double *face_weight;
    const int64_t *face_ptr; /* the table of shape functions there: face_count * per_face + 1 */
    const int32_t *face_idx;
    const double *face_phi;
};

struct conforming {
    struct means faces;
    double *hat; /* dim * dim rows of as many as there are cells, and BODY_POINT_PADDING more: row (k - 1) dim
                    + b holds component b of the gradient of hat k = 1 .. dim in each cell; those of all
                    vanish together, 1/m */
};

/* order[cell_count]: the caller's cell at each place; place[node_count]: the number by which each node goes
 * in the body. STATUS_INPUT when a cell lacks a face. */
MUST_CHECK enum status conforming_build(const struct conforming_input *input, int dim, int64_t node_count,
                                        int64_t cell_count, const int64_t *order, const int32_t *place,
                                        bool single, struct conforming *conforming, struct error *error);
void conforming_free(struct conforming *conforming);

#endif
