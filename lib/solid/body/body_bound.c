/* The bound of the diagonal of the stiffness: body_diagonal. Each node is summed by one thread of one
 * process, over the points in their order. */
#include "base/chunks.h"
#include "base/vector.h"
#include "solid/body/merged_cells.h"
#include "solid/body/nodal_volume.h"
#include "solid/body/stress.h"
#include "solid/material/tensor.h"

#include <math.h>
#include <string.h>

enum { NODES_FOR_THREAD = 500 }; /* see chunks_of */

/* Along the gradient g of a shape function the energy of a point has the second derivative along |C g|^2 -
 * shear / 3 |g|^2, C the cofactor of F, and that of the variance's, bounded by twice that of the value at one
 * vertex, smoothing |Z g|^2. */
struct bound {
    double C[9], Z[9], along, shear, smoothing;
};

/* The energy within a cell by mu / 2 |grad N_k|^2, per volume, where the field is one at vertex k and zero at
 * other vertices and on the edges. */
static double vertex_variance(int dim)
{
    return dim == 2 ? 1.0 : 0.6;
}

/* Of a change v (x) g the energy (10) is at most m / 2 |v|^2 |Z g|^2: its strain M = Z sym(F^T v (x) g) Z has
 * squares of at most |Z F^T v|^2 |Z g|^2, and so has its trace. Sets Z. */
static double variance_modulus(const struct material *material, const double F[9], double Z[9])
{
    double FZ[9], largest = 0.0;
    stress_limit_stretch(F, Z);
    multiply(F, Z, FZ);
    for (int a = 0; a < 3; a++) { /* Gershgorin's bound of the eigenvalues of F Z Z F^T */
        double sum = 0.0;
        for (int b = 0; b < 3; b++) {
            sum += fabs(vector_dot(3, FZ + 3 * a, FZ + 3 * b));
        }
        largest = fmax(largest, sum);
    }
    struct variance_moduli moduli = smoothed_cells_moduli(material);
    const struct material_rest *rest = &moduli.rest;
    double fibres = fmax(rest->fibre[0], 0.0) + fmax(rest->fibre[1], 0.0);
    return largest * (moduli.bulk + 4.0 / 3.0 * (fmax(rest->shear, rest->along) + fibres));
}

static struct bound bound_at(const struct body *body, int64_t q, bool rest)
{
    static const double at_rest[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    const struct material *material = &body->materials[body->material[q]];
    struct bound bound = {.smoothing = 0.0};
    double F[9], J, bulk = material->bulk_modulus;
    stress_gradient(body, q, F);
    J = determinant(F);
    if (rest || !(J > 0.0 && isfinite(J))) { /* inverted: the bounds stay positive until the run stops */
        J = 1.0;
        memcpy(F, at_rest, sizeof F);
    }
    cofactor(F, bound.C);
    double stiffening = rest ? 1.0 : stiffening_at(body, q);
    bound.shear = stiffening * body->weight[q] * material->shear_modulus / cbrt(J * J);
    if (body->averaged) {
        bulk = fmin(bulk, body->volumes.pressures.most * material->shear_modulus);
    }
    bound.along = body->weight[q] * bulk + 5.0 / 9.0 * vector_dot(9, F, F) * bound.shear / (J * J);
    if (body->smoothed) {
        bound.smoothing = 2.0 * stiffening * body->weight[q] * vertex_variance(body->dim) *
                          variance_modulus(material, F, bound.Z);
    }
    return bound;
}

static double bound_along(const struct bound *bound, int dim, const double *g)
{
    double along = 0.0, smoothing = 0.0, g2 = vector_dot(dim, g, g);
    for (int a = 0; a < dim; a++) {
        double change = vector_dot(dim, bound->C + 3 * a, g);
        along += bound->along * change * change;
    }
    for (int a = 0; a < dim && bound->smoothing > 0.0; a++) {
        double change = vector_dot(dim, bound->Z + 3 * a, g);
        smoothing += bound->smoothing * change * change;
    }
    return fmax(along - bound->shear / 3.0 * g2, 0.0) + smoothing;
}

/* Of a node of smoothed cells, by the linear shape functions: over the cells around it, with those that these
 * are merged with. */
static double bound_of_node(const struct body *body, int64_t node, bool rest)
{
    const struct field_averages *averages = &body->cells.averages;
    int64_t row = body_node_row(body, node);
    struct domain domain;
    double sum = 0.0;
    for (int64_t i = averages->use_ptr[row]; i < averages->use_ptr[row + 1]; i++) {
        int64_t q = field_averages_cell(averages, body->dim, averages->use[i]);
        int n = merged_cells_domain(body, q, (int32_t)node, &domain);
        for (int64_t c = domain.first; c < domain.end && n >= 0; c++) {
            struct bound bound = bound_at(body, c, rest);
            sum += bound_along(&bound, body->dim, domain.gradient[n]);
        }
    }
    return sum;
}

/* Of the nodes of a stripe of the operator; the rows of a point have the same nodes. */
static void sum_points(const struct body *body, const struct row_stripe *stripe, bool rest, double *stiffness)
{
    const struct sparse *table = &body->rows.matrix;
    int dim = body->dim;
    for (int64_t k = 0; k < stripe->row_count; k++) {
        int64_t r = stripe->row[k] < 0 ? -1 - stripe->row[k] : stripe->row[k];
        int64_t at = table->ptr[r], count = table->ptr[r + 1] - at;
        if (r % dim != 0) {
            continue;
        }
        struct bound bound = bound_at(body, r / dim, rest);
        for (int64_t i = at; i < at + count; i++) {
            double g[3] = {0.0};
            for (int a = 0; a < dim; a++) {
                g[a] = table->value[i + a * count];
            }
            if (table->idx[i] >= stripe->begin && table->idx[i] < stripe->end) {
                stiffness[body->order.nodes[table->idx[i]]] += bound_along(&bound, dim, g);
            }
        }
    }
}

void body_diagonal(struct body *body, bool rest, double *stiffness)
{
    const struct body_share *share = &body->share;
    int64_t first = share->begin_node, last = share->end_node;
    if (!rest) {
        body_share_collect(body);
    }
    memset(stiffness, 0, (size_t)body->node_count * sizeof *stiffness);
    if (body->smoothed) {
#pragma omp parallel for schedule(static) num_threads(chunks_of(last - first, NODES_FOR_THREAD).threads)
        for (int64_t n = first; n < last; n++) {
            stiffness[body->order.nodes[n]] = bound_of_node(body, n, rest) + body->cells.offset_stiffness[n];
        }
    } else {
#pragma omp parallel for schedule(static, 1) num_threads(body->rows.stripe_count)
        for (int s = 0; s < body->rows.stripe_count; s++) {
            sum_points(body, &body->rows.stripes[s], rest, stiffness);
        }
    }
    body_gather(body, 1, stiffness);
}
