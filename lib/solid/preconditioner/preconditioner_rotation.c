/* The rotations of the nodes, with which the factor of the stiffness at rest turns. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

enum { NODES_FOR_THREAD = 4000 };         /* see chunks_of */
enum { MOST_TURNS = 20 };                 /* of the iteration for the polar decomposition, */
static const double least_change = 1e-12; /* and where it ends */

/* The rotation of the polar decomposition of F by Newton's iteration (Higham 1986); I where F is inverted. */
static void find_rotation(const double F[9], double R[9])
{
    static const double identity[9] = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
    double change = INFINITY, C[9];
    memcpy(R, F, sizeof C);
    for (int turn = 0; turn < MOST_TURNS && change > least_change; turn++) {
        double J = determinant(R);
        if (!(J > 0.0)) {
            break;
        }
        cofactor(R, C); /* C / J = R^-T */
        change = 0.0;
        for (int i = 0; i < 9; i++) {
            double next = 0.5 * (R[i] + C[i] / J);
            change = fmax(change, fabs(next - R[i]));
            R[i] = next;
        }
    }
    if (!(change <= least_change)) {
        memcpy(R, identity, sizeof identity);
    }
}

enum status preconditioner_find_rotations(struct preconditioner *p, const struct body *body,
                                          struct error *error)
{
    int dim = p->dim, size = dim * dim;
    NEW_SCRATCH(double, sum, p->node_count * size, error); /* of F by the volume of the cells around a node, */
    NEW_SCRATCH(double, volume, p->node_count, error);
    for (int64_t q = 0; q < body->point_count; q++) {
        for (int k = 0; k <= dim; k++) {
            int64_t n = body->order.nodes[smoothed_cells_node(body, q, k)];
            volume[n] += body->weight[q];
            for (int c = 0; c < size; c++) {
                sum[n * size + c] += body->weight[q] * body->F[c * body->point_count + q];
            }
        }
    }
#pragma omp parallel for schedule(static) num_threads(chunks_of(p->node_count, NODES_FOR_THREAD).threads)
    for (int64_t n = 0; n < p->node_count; n++) {
        double F[9] = {0.0}, R[9];
        F[8] = 1.0;
        for (int c = 0; c < size; c++) {
            F[3 * (c / dim) + c % dim] = sum[n * size + c] / volume[n];
        }
        find_rotation(F, R);
        for (int c = 0; c < size; c++) {
            p->rotation[n * size + c] = R[3 * (c / dim) + c % dim];
        }
    }
    return STATUS_OK;
}

void preconditioner_turn(const struct preconditioner *p, bool back, const double *x, double *y)
{
    int dim = p->dim;
#pragma omp parallel for schedule(static) num_threads(chunks_of(p->node_count, NODES_FOR_THREAD).threads)
    for (int64_t n = 0; n < p->node_count; n++) {
        const double *R = p->rotation + n * dim * dim;
        double turned[3] = {0.0, 0.0, 0.0};
        for (int i = 0; i < dim; i++) {
            for (int k = 0; k < dim; k++) {
                turned[i] += R[back ? k * dim + i : i * dim + k] * x[n * dim + k];
            }
        }
        memcpy(y + n * dim, turned, (size_t)dim * sizeof *y);
    }
}
