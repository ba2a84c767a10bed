#include "solid/body/smoothed_cells.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"
#include "solid/body/nodal_offset.h"
#include "solid/body/nodal_volume.h"

#include <string.h>

/* Gradients of the linear shape functions 1 .. dim of a simplex, dim x dim. */
static void linear_gradients(int dim, const double *x, const int32_t *vertex, double *gradient)
{
    double F[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, C[9];
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            F[3 * a + k] = x[(int64_t)vertex[k + 1] * dim + a] - x[(int64_t)vertex[0] * dim + a];
        }
    }
    double J = determinant(F);
    cofactor(F, C); /* C / J = F^-T: its columns are the gradients of N_1 .. N_dim */
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            gradient[k * dim + a] = C[3 * a + k] / J;
        }
    }
}

static enum status set_linear_gradients(const struct cells *cells, struct body *body, struct error *error)
{
    int dim = body->dim;
    double **to = &body->cells.linear_gradient;
    RETURN_IF_ERROR(NEW_ARRAY(to, body->point_count * dim * dim + BODY_POINT_PADDING, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        double gradient[9];
        linear_gradients(dim, cells->x, cells->node + body->order.points[q] * (dim + 1), gradient);
        for (int k = 0; k < dim * dim; k++) {
            (*to)[k * body->point_count + q] = gradient[k];
        }
    }
    return STATUS_OK;
}

/* Of the linear shape functions of the vertices opposite boundary faces. */
static enum status set_face_gradients(struct body *body, struct error *error)
{
    struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    double grad_N[12];
    RETURN_IF_ERROR(NEW_ARRAY(&averages->face_gradient, averages->face_count * 3, error));
    for (int64_t f = 0; f < averages->face_count; f++) {
        smoothed_cells_linear_gradients(body, averages->face_cell[f], grad_N);
        memcpy(averages->face_gradient + 3 * f, grad_N + dim * averages->face_vertex[f],
               (size_t)dim * sizeof *grad_N);
    }
    return STATUS_OK;
}

struct variance_moduli smoothed_cells_moduli(const struct material *material)
{
    struct variance_moduli moduli = {.rest = material_at_rest(material)};
    moduli.bulk = nodal_volume_part(material_bulk(material), material->stiffness * moduli.rest.along);
    for (int f = 0; f < moduli.rest.families; f++) {
        moduli.rest.fibre[f] = nodal_volume_part(moduli.rest.fibre[f], moduli.rest.along);
    }
    return moduli;
}

static enum status set_fibres(struct body *body, struct error *error)
{
    for (int64_t m = 0; m < body->material_count; m++) {
        struct material_rest rest = smoothed_cells_moduli(&body->materials[m]).rest;
        if (rest.families > 0 && body->cells.fibres == NULL) {
            RETURN_IF_ERROR(NEW_ARRAY(&body->cells.fibres, body->material_count, error));
        }
        for (int f = 0; f < rest.families; f++) {
            struct variance_fibres *fibres = &body->cells.fibres[m];
            fibres->share[f] = 3.0 * rest.fibre[f] / rest.shear;
            fibres->turned[f] = 2.0 * (rest.along - rest.shear) / rest.shear;
            memcpy(fibres->direction[f], rest.direction[f], sizeof rest.direction[f]);
        }
    }
    return STATUS_OK;
}

void smoothed_cells_renew(struct body *body)
{
    struct smoothed_cells *smoothed = &body->cells;
    if (!body->smoothed) {
        return;
    }
    memset(smoothed->variance_shear, 0, (size_t)body->point_count * sizeof *smoothed->variance_shear);
    memset(smoothed->variance_bulk, 0, (size_t)body->point_count * sizeof *smoothed->variance_bulk);
    for (int64_t q = 0; q < body->point_count; q++) {
        int64_t cell = smoothed_cells_group(body, q);
        struct variance_moduli moduli = smoothed_cells_moduli(&body->materials[body->material[cell]]);
        double volume = VARIANCE_FACTOR(body->dim) * body->weight[q];
        smoothed->variance_shear[cell] += volume * stiffening_at(body, cell) * moduli.rest.shear;
        smoothed->variance_bulk[cell] += volume * moduli.bulk;
    }
}

enum status smoothed_cells_build(const struct body_input *input, struct body *body, struct error *error)
{
    struct smoothed_cells *smoothed = &body->cells;
    int64_t entries = body->point_count * body->dim * body->dim + BODY_POINT_PADDING;
    RETURN_IF_ERROR(set_linear_gradients(&input->cells, body, error));
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->variance_shear, body->point_count + BODY_POINT_PADDING, error));
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->variance_bulk, body->point_count + BODY_POINT_PADDING, error));
    smoothed_cells_renew(body);
    RETURN_IF_ERROR(set_fibres(body, error));
    RETURN_IF_ERROR(NEW_ARRAY(&smoothed->interpolant, entries, error));
    RETURN_IF_ERROR(smoothed_rows_build(input, body, error));
    RETURN_IF_ERROR(nodal_offsets_build(input, body, error));
    RETURN_IF_ERROR(set_face_gradients(body, error));
    for (int64_t b = 0; b < body->block_count; b++) {
        body->blocks[b].boundary_face = field_averages_face(&smoothed->averages, body->blocks[b].first_point);
    }
    return STATUS_OK;
}

void smoothed_cells_free(struct smoothed_cells *smoothed)
{
    field_averages_free(&smoothed->averages);
    prescribed_values_free(&smoothed->prescribed);
    FREE_ALL(smoothed->interpolant, smoothed->offset_stiffness, smoothed->variance_shear,
             smoothed->variance_bulk, smoothed->fibres, smoothed->linear_gradient, smoothed->group,
             smoothed->group_end, smoothed->kept);
    *smoothed = (struct smoothed_cells){0};
}

void smoothed_cells_linear_gradients(const struct body *body, int64_t q, double *gradient)
{
    int dim = body->dim;
    memset(gradient, 0, (size_t)dim * sizeof *gradient);
    for (int k = 1; k <= dim; k++) {
        for (int b = 0; b < dim; b++) {
            gradient[k * dim + b] = body->cells.linear_gradient[((k - 1) * dim + b) * body->point_count + q];
            gradient[b] -= gradient[k * dim + b];
        }
    }
}

void smoothed_cells_variation(int dim, const double *grad_N, const double *edge, const double *vertex,
                              double *variation)
{
    double mean[3] = {0.0, 0.0, 0.0};
    memset(variation, 0, (size_t)((dim + 1) * dim) * sizeof *variation);
    for (int e = 0; e < CELL_EDGES(dim); e++) {
        int k = cell_edge_ends[e][0], l = cell_edge_ends[e][1];
        double offset = EDGE_OFFSET * (edge[e] - 0.5 * (vertex[k] + vertex[l]));
        add_scaled(dim, offset, grad_N + l * dim, variation + k * dim);
        add_scaled(dim, offset, grad_N + k * dim, variation + l * dim);
    }
    for (int k = 0; k <= dim; k++) {
        add_scaled(dim, 1.0 / (dim + 1), variation + k * dim, mean);
    }
    for (int i = 0; i < (dim + 1) * dim; i++) {
        variation[i] -= mean[i % dim];
    }
}

int64_t smoothed_cells_group(const struct body *body, int64_t q)
{
    return body->cells.group != NULL && body->cells.kept[q] <= 0.0 ? body->cells.group[q] : q;
}

int64_t smoothed_cells_group_end(const struct body *body, int64_t q)
{
    return body->cells.group != NULL && body->cells.kept[q] <= 0.0 ? body->cells.group_end[q] : q + 1;
}

int32_t smoothed_cells_edge(const struct body *body, int64_t q, int e)
{
    return body->cells.averages.of_use[q * CELL_EDGES(body->dim) + e] / VECTOR_STRIDE(body->dim);
}

/* The rows of boundary faces of cell q, after `count` of its edges and vertices, whose gradients change by
 * them. Returns the number of all. */
static int add_boundary_rows(const struct body *body, int64_t q, const double *grad_N, int count,
                             int32_t *row, double *gradient)
{
    const struct field_averages *averages = &body->cells.averages;
    int dim = body->dim;
    for (int64_t f = field_averages_face(averages, q);
         f < averages->face_count && averages->face_cell[f] == q; f++) {
        int k = averages->face_vertex[f];
        const double *along = grad_N + dim * k;
        for (int e = 0; e < FACE_EDGES(dim); e++) {
            add_scaled(dim, dim * EDGE_IN_FACE(dim), along, gradient + dim * cell_face_edge(dim, k, e));
        }
        for (int v = 0; v <= dim && VERTEX_IN_FACE(dim) > 0.0; v++) {
            if (v != k) {
                add_scaled(dim, dim * VERTEX_IN_FACE(dim), along, gradient + dim * (CELL_EDGES(dim) + v));
            }
        }
        memset(gradient + dim * count, 0, (size_t)dim * sizeof *gradient);
        add_scaled(dim, -dim, along, gradient + dim * count);
        row[count++] = averages->of_use[field_averages_faces(averages, dim) + f] / VECTOR_STRIDE(dim);
    }
    return count;
}

int smoothed_cells_rows(const struct body *body, int64_t q, int32_t row[SMOOTHED_MOST_ROWS],
                        double gradient[SMOOTHED_MOST_ROWS * 3])
{
    int dim = body->dim, count = CELL_EDGES(dim);
    double grad_N[12];
    smoothed_cells_linear_gradients(body, q, grad_N);
    memset(gradient, 0, (size_t)(count * dim) * sizeof *gradient);
    for (int e = 0; e < count; e++) {
        row[e] = smoothed_cells_edge(body, q, e);
        add_scaled(dim, EDGE_GRADIENT(dim), grad_N + cell_edge_ends[e][0] * dim, gradient + e * dim);
        add_scaled(dim, EDGE_GRADIENT(dim), grad_N + cell_edge_ends[e][1] * dim, gradient + e * dim);
    }
    for (int k = 0; k <= dim && VERTEX_GRADIENT(dim) > 0.0; k++) {
        row[count] = (int32_t)body_node_row(body, smoothed_cells_node(body, q, k));
        memset(gradient + dim * count, 0, (size_t)dim * sizeof *gradient);
        add_scaled(dim, VERTEX_GRADIENT(dim), grad_N + k * dim, gradient + dim * count++);
    }
    return add_boundary_rows(body, q, grad_N, count, row, gradient);
}

int32_t smoothed_cells_node(const struct body *body, int64_t q, int k)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t use = field_averages_vertices(averages, body->dim) + q * (body->dim + 1) + k;
    int32_t row = averages->of_use[use] / VECTOR_STRIDE(body->dim);
    return row - (int32_t)body_node_row(body, 0);
}

double smoothed_cells_share(const struct body *body, int64_t q)
{
    double sum = 0.0;
    for (int64_t i = smoothed_cells_group(body, q); i < smoothed_cells_group_end(body, q); i++) {
        sum += body->weight[i];
    }
    return body->weight[q] / sum;
}
