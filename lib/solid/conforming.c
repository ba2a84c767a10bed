#include "solid/conforming.h"

#include "approx/renumber.h"
#include "base/memory.h"
#include "solid/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Gradients of the hat functions 1 .. dim of a simplex, dim x dim. */
static void hat_gradients(int dim, const double *x, const int32_t *vertex, double *gradient)
{
    double F[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, C[9];
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            F[3 * a + k] = x[(int64_t)vertex[k + 1] * dim + a] - x[(int64_t)vertex[0] * dim + a];
        }
    }
    double J = determinant(F);
    cofactor(F, C); /* C / J = F^-T: its columns are the gradients of hats 1 .. dim */
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            gradient[k * dim + a] = C[3 * a + k] / J;
        }
    }
}

static enum status set_hats(const struct conforming_input *input, int dim, int64_t cell_count,
                            const int64_t *order, struct conforming *conforming, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&conforming->hat, cell_count * dim * dim + BODY_POINT_PADDING, error));
    for (int64_t q = 0; q < cell_count; q++) {
        double gradient[9];
        hat_gradients(dim, input->x, input->cell_node + order[q] * (dim + 1), gradient);
        for (int k = 0; k < dim * dim; k++) {
            conforming->hat[k * cell_count + q] = gradient[k];
        }
    }
done:
    return status;
}

/* Lists of the faces, the union of those of their quadrature points, with the means. */
struct face_means {
    int64_t *ptr;
    int32_t *idx;
    double *phi;
};

static enum status average_faces(const struct conforming_input *input, int64_t node_count,
                                 struct face_means *means, struct error *error)
{
    enum status status;
    int64_t most = input->face_ptr[input->face_count * input->per_face];
    int64_t *at = NULL; /* where each node stands in the lists */
    TRY(NEW_ARRAY(&at, node_count, error));
    TRY(NEW_ARRAY(&means->ptr, input->face_count + 1, error));
    TRY(NEW_ARRAY(&means->idx, most, error));
    TRY(NEW_ARRAY(&means->phi, most, error));
    for (int64_t n = 0; n < node_count; n++) {
        at[n] = -1;
    }
    for (int64_t f = 0; f < input->face_count; f++) {
        int64_t first = means->ptr[f], end = first;
        for (int64_t p = f * input->per_face; p < (f + 1) * input->per_face; p++) {
            for (int64_t i = input->face_ptr[p]; i < input->face_ptr[p + 1]; i++) {
                int32_t node = input->face_idx[i];
                if (at[node] < first) {
                    means->idx[end] = node;
                    at[node] = end++;
                }
                means->phi[at[node]] += input->face_weight[p % input->per_face] * input->face_phi[i];
            }
        }
        means->ptr[f + 1] = end;
    }
done:
    free(at);
    return status;
}

/* Faces in an order that keeps near ones near. */
static enum status order_faces(const struct conforming_input *input, int dim, int64_t *order,
                               struct error *error)
{
    enum status status;
    double *x = NULL;
    TRY(NEW_ARRAY(&x, input->face_count * dim, error));
    for (int64_t f = 0; f < input->face_count; f++) {
        for (int i = 0; i < dim * dim; i++) {
            x[f * dim + i % dim] +=
                input->x[(int64_t)input->face_node[f * dim + i / dim] * dim + i % dim] / dim;
        }
    }
    TRY(renumber_morton(dim, input->face_count, x, NULL, order, error));
done:
    free(x);
    return status;
}

/* Corner of a cell that is opposite a face: the one whose vertex the face has not. */
static int opposite_corner(int dim, const int32_t *vertex, const int32_t *face)
{
    for (int k = 0; k < dim; k++) {
        bool on_face = false;
        for (int i = 0; i < dim; i++) {
            on_face = on_face || face[i] == vertex[k];
        }
        if (!on_face) {
            return k;
        }
    }
    return dim;
}

/* The face opposite each corner. */
static enum status match_corners(const struct conforming_input *input, int dim, int64_t cell_count,
                                 const int64_t *order, int32_t *face_of_corner, struct error *error)
{
    enum status status;
    int64_t *cell_place = NULL;
    TRY(NEW_ARRAY(&cell_place, cell_count, error));
    for (int64_t q = 0; q < cell_count; q++) {
        cell_place[order[q]] = q;
    }
    for (int64_t i = 0; i < cell_count * (dim + 1); i++) {
        face_of_corner[i] = -1;
    }
    for (int64_t i = 0; i < input->face_count * 2; i++) {
        int64_t face = i / 2, cell = input->face_cell[i];
        if (cell >= 0 && cell < cell_count) {
            int corner =
                opposite_corner(dim, input->cell_node + cell * (dim + 1), input->face_node + face * dim);
            face_of_corner[cell_place[cell] * (dim + 1) + corner] = (int32_t)face;
        }
    }
    for (int64_t i = 0; i < cell_count * (dim + 1); i++) {
        if (face_of_corner[i] < 0) {
            status = fail(error, STATUS_INPUT,
                          "faces.cell: cell %lld lacks a face: run ipoints for conforming cells",
                          (long long)order[i / (dim + 1)]);
            goto done;
        }
    }
done:
    free(cell_place);
    return status;
}

/* Values of the field at the nodes must be those of these nodes: they reproduce 1 and x. */
static enum status check_nodes(const struct conforming_input *input, int dim, int64_t node_count,
                               struct error *error)
{
    for (int64_t n = 0; n < node_count; n++) {
        double sum[4] = {-1.0}, size = 0.0, extent = 0.0;
        for (int64_t i = input->node_ptr[n]; i < input->node_ptr[n + 1]; i++) {
            sum[0] += input->node_phi[i];
            size += fabs(input->node_phi[i]);
            for (int a = 0; a < dim; a++) {
                double offset = input->x[(int64_t)input->node_idx[i] * dim + a] - input->x[n * dim + a];
                sum[1 + a] += input->node_phi[i] * offset;
                extent = fmax(extent, fabs(offset));
            }
        }
        for (int k = 0; k <= dim; k++) {
            if (!(fabs(sum[k]) <= 1e-5 * size * (k == 0 ? 1.0 : extent))) {
                return fail(error, STATUS_INPUT,
                            "node.phi: node %lld: not the shape functions at this node: run shapefn again",
                            (long long)n);
            }
        }
    }
    return STATUS_OK;
}

/* A row for each node; its corners are the vertices of the cells. */
static enum status build_nodes(const struct conforming_input *input, const struct body *body,
                               struct means *means, struct error *error)
{
    enum status status;
    int corners = body->dim + 1;
    int32_t *node_of_corner = NULL;
    TRY(check_nodes(input, body->dim, body->node_count, error));
    TRY(NEW_ARRAY(&node_of_corner, body->point_count * corners, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        memcpy(node_of_corner + q * corners, input->cell_node + body->order[q] * corners,
               (size_t)corners * sizeof *node_of_corner);
    }
    struct means_input nodes = {.dim = body->dim,
                                .node_count = body->node_count,
                                .row_count = body->node_count,
                                .order = body->node_order,
                                .ptr = input->node_ptr,
                                .idx = input->node_idx,
                                .phi = input->node_phi,
                                .place = body->node_place,
                                .corner_count = body->point_count * corners,
                                .row_of_corner = node_of_corner};
    status = means_build(&nodes, means, error);
done:
    free(node_of_corner);
    return status;
}

/* A row for each face; its corners are those opposite it. */
static enum status build_faces(const struct conforming_input *input, const struct body *body,
                               struct means *means, struct error *error)
{
    enum status status;
    int dim = body->dim;
    int64_t cell_count = body->point_count;
    struct face_means rows = {0};
    int64_t *face_order = NULL;
    int32_t *face_of_corner = NULL;
    TRY(NEW_ARRAY(&face_order, input->face_count, error));
    TRY(NEW_ARRAY(&face_of_corner, cell_count * (dim + 1), error));
    TRY(match_corners(input, dim, cell_count, body->order, face_of_corner, error));
    TRY(order_faces(input, dim, face_order, error));
    TRY(average_faces(input, body->node_count, &rows, error));
    struct means_input faces = {.dim = dim,
                                .node_count = body->node_count,
                                .row_count = input->face_count,
                                .order = face_order,
                                .ptr = rows.ptr,
                                .idx = rows.idx,
                                .phi = rows.phi,
                                .place = body->node_place,
                                .corner_count = cell_count * (dim + 1),
                                .row_of_corner = face_of_corner};
    status = means_build(&faces, means, error);
done:
    free(rows.ptr);
    free(rows.idx);
    free(rows.phi);
    free(face_order);
    free(face_of_corner);
    return status;
}

enum status conforming_build(const struct conforming_input *input, const struct body *body,
                             struct conforming *conforming, struct error *error)
{
    enum status status;
    int64_t entries = body->point_count * body->dim * body->dim + BODY_POINT_PADDING;
    *conforming = (struct conforming){.cell_node = input->cell_node};
    TRY(set_hats(input, body->dim, body->point_count, body->order, conforming, error));
    TRY(NEW_ARRAY(&conforming->interpolant, entries, error));
    TRY(build_faces(input, body, &conforming->faces, error));
    TRY(build_nodes(input, body, &conforming->nodes, error));
done:
    if (status != STATUS_OK) {
        conforming_free(conforming);
    }
    return status;
}

void conforming_free(struct conforming *conforming)
{
    means_free(&conforming->faces);
    means_free(&conforming->nodes);
    free(conforming->interpolant);
    free(conforming->hat);
    *conforming = (struct conforming){0};
}
