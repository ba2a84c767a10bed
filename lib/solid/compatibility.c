#include "solid/compatibility.h"

#include "base/memory.h"
#include "solid/body.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a_q over the pressure beyond the threshold: buckling stops at about 1 in two dimensions and in three. */
static const double share_of_pressure = 1.0;
/* Pressures below this share of the shear modulus buckle nothing. */
static const double least_pressure = 0.25;
/* Share of the way to its new value that a_q goes at an update: it follows the pressures without ringing. */
static const double follow = 0.2;

/* Gradients of the hat functions of a simplex, (dim + 1) x dim. */
static void hat_gradients(int dim, const double *x, const int32_t *vertex, double *gradient)
{
    double F[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0}, C[9];
    for (int k = 0; k < dim; k++) {
        for (int a = 0; a < dim; a++) {
            F[3 * a + k] = x[(int64_t)vertex[k + 1] * dim + a] - x[(int64_t)vertex[0] * dim + a];
        }
    }
    double J = determinant(F);
    cofactor(F, C); /* C / J = F^-T: its columns are the gradients of hats 1.. */
    for (int a = 0; a < dim; a++) {
        double sum = 0.0;
        for (int k = 0; k < dim; k++) {
            gradient[(k + 1) * dim + a] = C[3 * a + k] / J;
            sum += gradient[(k + 1) * dim + a];
        }
        gradient[a] = -sum;
    }
}

/* CSR lists from `count` pairs (key, value) given by key_of; values ascend within a key. */
static enum status list_by_key(int64_t keys, int64_t count, const int32_t *key_of, int64_t **ptr,
                               int64_t **item, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(ptr, keys + 2, error));
    TRY(NEW_ARRAY(item, count, error));
    for (int64_t i = 0; i < count; i++) {
        (*ptr)[key_of[i] + 2]++;
    }
    for (int64_t k = 0; k < keys; k++) {
        (*ptr)[k + 2] += (*ptr)[k + 1];
    }
    for (int64_t i = 0; i < count; i++) {
        (*item)[(*ptr)[key_of[i] + 1]++] = i;
    }
done:
    return status;
}

static enum status transpose_table(const struct body *body, struct compatibility *c, struct error *error)
{
    enum status status;
    int64_t *item = NULL, pairs = c->input.node_ptr[body->node_count], node = 0;
    int32_t *node_of = NULL;
    TRY(list_by_key(body->node_count, pairs, c->input.node_idx, &c->back_ptr, &item, error));
    TRY(NEW_ARRAY(&node_of, pairs, error));
    TRY(NEW_ARRAY(&c->back_node, pairs, error));
    TRY(NEW_ARRAY(&c->back_phi, pairs, error));
    for (int64_t i = 0; i < pairs; i++) {
        while (i >= c->input.node_ptr[node + 1]) {
            node++;
        }
        node_of[i] = (int32_t)node;
    }
    for (int64_t i = 0; i < pairs; i++) {
        c->back_node[i] = node_of[item[i]];
        c->back_phi[i] = c->input.node_phi[item[i]];
    }
done:
    free(item);
    free(node_of);
    return status;
}

enum status compatibility_build(const struct body *body, const struct compatibility_input *input,
                                struct compatibility *compatibility, struct error *error)
{
    enum status status;
    struct compatibility *c = compatibility;
    int dim = body->dim, corners = dim + 1;
    int64_t points = body->point_count, nodes = body->node_count;
    *c = (struct compatibility){.input = *input};
    TRY(NEW_ARRAY(&c->vertex, points * corners, error));
    TRY(NEW_ARRAY(&c->gradient, points * corners * dim, error));
    TRY(NEW_ARRAY(&c->coefficient, points, error));
    TRY(NEW_ARRAY(&c->value, nodes * dim, error));
    TRY(NEW_ARRAY(&c->pull, nodes * dim, error));
    TRY(NEW_ARRAY(&c->stress, points * dim * dim, error));
    for (int64_t q = 0; q < points; q++) {
        memcpy(c->vertex + q * corners, input->cell_node + body->order[q] * corners,
               (size_t)corners * sizeof *c->vertex);
        hat_gradients(dim, input->x, c->vertex + q * corners, c->gradient + q * corners * dim);
    }
    TRY(list_by_key(nodes, points * corners, c->vertex, &c->use_ptr, &c->use, error));
    TRY(transpose_table(body, c, error));
done:
    if (status != STATUS_OK) {
        compatibility_free(c);
    }
    return status;
}

void compatibility_free(struct compatibility *compatibility)
{
    struct compatibility *c = compatibility;
    void *arrays[] = {c->vertex,    c->gradient, c->coefficient, c->use_ptr, c->use,   c->back_ptr,
                      c->back_node, c->back_phi, c->value,       c->pull,    c->stress};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        free(arrays[i]);
    }
    *c = (struct compatibility){0};
}

void compatibility_update(struct body *body)
{
    struct compatibility *c = body->compatibility;
    if (c == NULL) {
        return;
    }
    c->active = false;
    for (int64_t q = 0; q < body->point_count; q++) {
        double beyond = fabs(body_pressure(body, q)) - least_pressure * body->shear[q];
        double wanted = beyond > 0.0 ? share_of_pressure * beyond : 0.0;
        c->coefficient[q] += follow * (wanted - c->coefficient[q]);
        if (c->coefficient[q] < 1e-3 * body->shear[q]) {
            c->coefficient[q] = 0.0;
        }
        c->active = c->active || c->coefficient[q] > 0.0;
    }
}

void compatibility_value(const struct body *body, int64_t node, const double *u)
{
    const struct compatibility *c = body->compatibility;
    int dim = body->dim;
    double sum[3] = {0.0, 0.0, 0.0};
    for (int64_t i = c->input.node_ptr[node]; i < c->input.node_ptr[node + 1]; i++) {
        for (int a = 0; a < dim; a++) {
            sum[a] += c->input.node_phi[i] * u[(int64_t)c->input.node_idx[i] * dim + a];
        }
    }
    memcpy(c->value + node * dim, sum, (size_t)dim * sizeof *sum);
}

void compatibility_stress(const struct body *body, int64_t point)
{
    const struct compatibility *c = body->compatibility;
    int dim = body->dim;
    const int32_t *vertex = c->vertex + point * (dim + 1);
    const double *gradient = c->gradient + point * (dim + 1) * dim;
    double scale = body->weight[point] * c->coefficient[point];
    for (int a = 0; a < dim; a++) {
        for (int b = 0; b < dim; b++) {
            double difference = (a == b ? 1.0 : 0.0) - body->F[(a * dim + b) * body->point_count + point];
            for (int k = 0; k <= dim; k++) {
                difference += c->value[(int64_t)vertex[k] * dim + a] * gradient[k * dim + b];
            }
            c->stress[point * dim * dim + a * dim + b] = scale * difference;
        }
    }
}

void compatibility_pull(const struct body *body, int64_t node)
{
    const struct compatibility *c = body->compatibility;
    int dim = body->dim;
    double sum[3] = {0.0, 0.0, 0.0};
    for (int64_t i = c->use_ptr[node]; i < c->use_ptr[node + 1]; i++) {
        const double *gradient = c->gradient + c->use[i] * dim;
        const double *stress = c->stress + c->use[i] / (dim + 1) * dim * dim;
        for (int a = 0; a < dim; a++) {
            for (int b = 0; b < dim; b++) {
                sum[a] += stress[a * dim + b] * gradient[b];
            }
        }
    }
    memcpy(c->pull + node * dim, sum, (size_t)dim * sizeof *sum);
}

void compatibility_add_force(const struct body *body, int64_t node, double *force)
{
    const struct compatibility *c = body->compatibility;
    int dim = body->dim;
    for (int64_t i = c->back_ptr[node]; i < c->back_ptr[node + 1]; i++) {
        for (int a = 0; a < dim; a++) {
            force[a] += c->back_phi[i] * c->pull[(int64_t)c->back_node[i] * dim + a];
        }
    }
}

double compatibility_energy(const struct body *body)
{
    const struct compatibility *c = body->compatibility;
    int size = body->dim * body->dim;
    double energy = 0.0;
    for (int64_t q = 0; c != NULL && c->active && q < body->point_count; q++) {
        double sum = 0.0;
        for (int k = 0; k < size; k++) {
            sum += c->stress[q * size + k] * c->stress[q * size + k];
        }
        energy += c->coefficient[q] > 0.0 ? 0.5 * sum / (body->weight[q] * c->coefficient[q]) : 0.0;
    }
    return energy;
}
