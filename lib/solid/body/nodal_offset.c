#include "solid/body/nodal_offset.h"

#include "approx/cells/cells.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/body/body.h"

/* k_n by the sum of mu w / h^2 over the cells at the node, h^2 the mean square of a cell's edges. Nodes at
 * junctions of prescribed and free boundary, where the field is singular, have none. */
static const double offset_factor = 0.08;

static bool is_at_junction(const struct body *body, int64_t q)
{
    const double *kept = body->cells.kept;
    return kept != NULL && kept[q] > 0.0 && kept[q] < 1.0;
}

/* The mean square of a cell's edges, m2. */
static double mean_square_edge(const struct cells *cells, int64_t cell)
{
    const int32_t *vertex = cells->node + cell * (cells->dim + 1);
    double sum = 0.0;
    for (int e = 0; e < CELL_EDGES(cells->dim); e++) {
        const double *x = cells->x + (int64_t)vertex[cell_edge_ends[e][0]] * cells->dim;
        const double *y = cells->x + (int64_t)vertex[cell_edge_ends[e][1]] * cells->dim;
        sum += vector_distance2(cells->dim, x, y);
    }
    return sum / CELL_EDGES(cells->dim);
}

enum status nodal_offsets_build(const struct body_input *input, struct body *body, struct error *error)
{
    double **stiffness = &body->cells.offset_stiffness;
    RETURN_IF_ERROR(NEW_ARRAY(stiffness, body->node_count, error));
    for (int64_t q = 0; q < body->point_count; q++) {
        const struct material *material = &body->materials[body->material[q]];
        double mu = material_long_term(material) * material->shear_modulus;
        double square = mean_square_edge(&input->cells, body->order.points[q]);
        for (int k = 0; k <= body->dim; k++) {
            (*stiffness)[smoothed_cells_node(body, q, k)] += offset_factor * mu * body->weight[q] / square;
        }
    }
    for (int64_t q = 0; q < body->point_count; q++) {
        for (int k = 0; k <= body->dim && is_at_junction(body, q); k++) {
            (*stiffness)[smoothed_cells_node(body, q, k)] = 0.0;
        }
    }
    return STATUS_OK;
}

/* offset[dim] of a node in the body's order. */
static void offset_of(const struct body *body, int64_t node, double *offset)
{
    int stride = VECTOR_STRIDE(body->dim);
    const double *field = body->cells.averages.value + body_node_row(body, node) * stride;
    vector_subtract(body->dim, body->u + node * stride, field, offset);
}

void nodal_offsets_push_rows(struct body *body)
{
    const struct row_ranges *sums = &body->share.sums;
    int64_t first = body_node_row(body, 0);
#pragma omp for schedule(static)
    for (int64_t i = 0; i < sums->count; i++) {
        int64_t begin = sums->items[i].begin < first ? first : sums->items[i].begin;
        for (int64_t r = begin; r < sums->items[i].end; r++) {
            double offset[3], *force = body->cells.averages.force + r * VECTOR_STRIDE(body->dim);
            offset_of(body, r - first, offset);
            add_scaled(body->dim, -body->cells.offset_stiffness[r - first], offset, force);
        }
    }
}

void nodal_offsets_push_nodes(struct body *body)
{
#pragma omp for schedule(static)
    for (int64_t n = body->share.begin_node; n < body->share.end_node; n++) {
        double offset[3];
        offset_of(body, n, offset);
        add_scaled(body->dim, body->cells.offset_stiffness[n], offset,
                   body->force + n * VECTOR_STRIDE(body->dim));
    }
}

double nodal_offsets_energy(struct body *body)
{
    const struct body_share *share = &body->share;
    double *energy = body->cells.averages.force, sum = 0.0; /* scratch here */
    for (int64_t n = share->begin_node; n < share->end_node; n++) {
        double offset[3];
        offset_of(body, n, offset);
        energy[n] = 0.5 * body->cells.offset_stiffness[n] * vector_dot(body->dim, offset, offset);
    }
    ranks_gather(share->ranks, energy, sizeof *energy, share->node_first);
    for (int64_t n = 0; n < body->node_count; n++) {
        sum += energy[n];
    }
    return sum;
}
