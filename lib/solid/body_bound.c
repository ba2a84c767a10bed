/* The bound of the diagonal of the stiffness: body_diagonal. */
#include "solid/stress.h"

#include <math.h>
#include <string.h>

/* What a point adds to the bounds: for each neighbour g A g, if positive, and tie |g|^2, g its gradient. */
static inline __attribute__((always_inline)) void add_bounds(const struct body *body, int64_t row, int dim,
                                                             const double A[9], double tie, double *stiffness)
{
    for (int64_t i = body->ptr[row]; i < body->ptr[row + 1]; i++) {
        const double *g = body->dphi + i * dim;
        double bound = 0.0, g2 = 0.0;
        for (int a = 0; a < dim; a++) {
            double half = 0.5 * A[3 * a + a] * g[a];
            for (int b = 0; b < a; b++) {
                half += A[3 * a + b] * g[b];
            }
            bound += 2.0 * half * g[a];
            g2 += g[a] * g[a];
        }
        stiffness[body->idx[i]] += (bound > 0.0 ? bound : 0.0) + tie * g2;
    }
}

void body_diagonal(struct body *body, double *stiffness)
{
    int dim = body->dim;
    body_keep_state(body);
    memset(stiffness, 0, (size_t)body->node_count * sizeof *stiffness);
    for (int64_t q = 0; q < body->point_count; q++) {
        double F[9], C[9], A[9], I1 = 0.0;
        stress_matrix(body->dim, body->F + q, body->point_count, F);
        double J = determinant(F);
        if (!(J > 0.0 && isfinite(J))) { /* as at rest: its bounds stay positive until the run is told */
            J = 1.0;
            for (int k = 0; k < 9; k++) {
                F[k] = k % 4 == 0 ? 1.0 : 0.0;
            }
        }
        cofactor(F, C);
        for (int k = 0; k < 9; k++) {
            I1 += F[k] * F[k];
        }
        double shear = body->weight[q] * body->shear[q] / cbrt(J * J);
        double tie = body->conforming ? 2.0 * body->weight[q] * stress_tie(body, q, F).stiffness : 0.0;
        double along = body->weight[q] * body->bulk[q] + 5.0 / 9.0 * I1 * shear / (J * J);
        /* along |J F^-T g|^2 - shear |g|^2 / 3 = g A g */
        for (int k = 0; k < 9; k++) {
            int a = k / 3, b = k % 3;
            A[k] = along * (C[a] * C[b] + C[3 + a] * C[3 + b] + C[6 + a] * C[6 + b]) -
                   (a == b ? shear / 3.0 : 0.0);
        }
        if (dim == 2) {
            add_bounds(body, body->order[q], 2, A, tie, stiffness);
        } else {
            add_bounds(body, body->order[q], 3, A, tie, stiffness);
        }
    }
}
