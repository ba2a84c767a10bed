#include "solid/system/membrane.h"

#include "base/memory.h"
#include "base/vector.h"
#include "solid/constraint/average.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* metric[n * n] of n edges, edge[n][3]. */
static void metric_of(int n, int dim, double edge[2][3], double *metric)
{
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < n; k++) {
            metric[i * n + k] = vector_dot(dim, edge[i], edge[k]);
        }
    }
}

/* Replace the metric of a facet at rest by its inverse; returns the size of the facet. */
static double invert_metric(int n, double *metric)
{
    if (n == 1) {
        double length2 = metric[0];
        metric[0] = 1.0 / length2;
        return sqrt(length2);
    }
    double determinant = metric[0] * metric[3] - metric[1] * metric[2], first = metric[0];
    metric[0] = metric[3] / determinant;
    metric[3] = first / determinant;
    metric[1] = metric[2] = -metric[1] / determinant;
    return 0.5 * sqrt(determinant);
}

/* u[dim]: the displacement of corner c: that of the boundary there, but for what is prescribed. */
static void corner_displacement(const struct membrane *membrane, int32_t c, const double *field, double *u)
{
    int dim = membrane->dim;
    double free[3];
    struct average average = average_of_boundary(&membrane->corners, c);
    average_take(&average, dim, field, free);
    memcpy(u, free, (size_t)dim * sizeof *u);
    for (int64_t k = (int64_t)c * dim; k < (int64_t)(c + 1) * dim && membrane->held[k] >= 0; k++) {
        const double *direction = membrane->rows->direction + membrane->held[k] * dim;
        double off = constraint_rows_value(membrane->rows, membrane->held[k], field) -
                     vector_dot(dim, direction, free);
        add_scaled(dim, off, membrane->along + k * dim, u);
    }
}

/* The transpose: force += that of `on` on corner c. */
static void spread_corner(const struct membrane *membrane, int32_t c, const double *on, double *force)
{
    int dim = membrane->dim;
    double rest[3], part[3];
    memcpy(rest, on, (size_t)dim * sizeof *rest);
    for (int64_t k = (int64_t)c * dim; k < (int64_t)(c + 1) * dim && membrane->held[k] >= 0; k++) {
        const double *direction = membrane->rows->direction + membrane->held[k] * dim;
        struct average average = constraint_rows_average(membrane->rows, membrane->held[k]);
        double amount = vector_dot(dim, membrane->along + k * dim, on);
        memset(part, 0, sizeof part);
        add_scaled(dim, amount, direction, part);
        add_scaled(dim, -amount, direction, rest);
        average_spread(&average, dim, part, force);
    }
    struct average average = average_of_boundary(&membrane->corners, c);
    average_spread(&average, dim, rest, force);
}

/* The edges of facet f from its first corner, of points at x[corner * dim] = X + the corner's displacement.
 */
static void edges_at(const struct membrane *membrane, const double *X, const double *u, int64_t f,
                     double edge[2][3])
{
    int dim = membrane->dim;
    double x[3][3];
    for (int k = 0; k < dim; k++) {
        int32_t c = membrane->corner[f * dim + k];
        corner_displacement(membrane, c, u, x[k]);
        add_scaled(dim, 1.0, X + (int64_t)membrane->corners.node[c] * dim, x[k]);
    }
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, x[k], x[0], edge[k - 1]);
    }
}

/* Add row r, with the direction a, to those that prescribe corner c, unless it depends on them. The vectors b
 * lie in the span of the directions: each loses its part along a, b_j -= (b_j . a) b. */
static void hold_corner(struct membrane *membrane, int32_t c, int64_t r)
{
    int dim = membrane->dim, count = 0;
    int64_t *held = membrane->held + (int64_t)c * dim;
    double *along = membrane->along + (int64_t)c * dim * dim, rest[3], part[3] = {0.0};
    const double *a = membrane->rows->direction + r * dim;
    for (; count < dim && held[count] >= 0; count++) {
        const double *before = membrane->rows->direction + held[count] * dim;
        add_scaled(dim, vector_dot(dim, before, a), along + count * dim, part);
    }
    for (int i = 0; i < dim; i++) {
        rest[i] = a[i] - part[i];
    }
    double length2 = vector_dot(dim, rest, rest);
    if (count == dim || length2 < 0.01) {
        return;
    }
    held[count] = r;
    for (int i = 0; i < dim; i++) {
        along[count * dim + i] = rest[i] / length2;
    }
    for (int k = 0; k < count; k++) {
        add_scaled(dim, -vector_dot(dim, along + k * dim, a), along + count * dim, along + k * dim);
    }
}

enum status membrane_build(const struct face_table *table, const struct facet_set *set,
                           const struct constraint_rows *rows, const struct membrane_law *law,
                           struct membrane *membrane, struct error *error)
{
    int dim = table->dim, n = dim - 1;
    double nu = law->poisson_ratio, stiffness = law->youngs_modulus / (1.0 - nu * nu);
    *membrane = (struct membrane){.dim = dim,
                                  .facet_count = set->count,
                                  .nu = nu,
                                  .tension = law->prestress / stiffness,
                                  .curve = law->curve,
                                  .rows = rows};
    RETURN_IF_ERROR(boundary_corners_build(table, set, &membrane->corners, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->corner, set->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->metric, set->count * n * n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->weight, set->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->held, membrane->corners.count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->along, membrane->corners.count * dim * dim, error));
    NEW_SCRATCH(int32_t, number, table->node_count, error);
    memset(number, -1, (size_t)table->node_count * sizeof *number);
    memset(membrane->held, -1, (size_t)membrane->corners.count * (size_t)dim * sizeof *membrane->held);
    for (int64_t c = 0; c < membrane->corners.count; c++) {
        number[membrane->corners.node[c]] = (int32_t)c;
    }
    for (int64_t r = 0; r < rows->count; r++) {
        if (number[rows->node[r]] >= 0) {
            hold_corner(membrane, number[rows->node[r]], r);
        }
    }
    for (int64_t f = 0; f < set->count; f++) {
        const int32_t *node = set->facet + f * dim;
        double edge[2][3];
        for (int k = 0; k < dim; k++) {
            membrane->corner[f * dim + k] = number[node[k]];
        }
        for (int k = 1; k < dim; k++) {
            vector_subtract(dim, table->x + (int64_t)node[k] * dim, table->x + (int64_t)node[0] * dim,
                            edge[k - 1]);
        }
        metric_of(n, dim, edge, membrane->metric + f * n * n);
        membrane->weight[f] = stiffness * law->thickness * invert_metric(n, membrane->metric + f * n * n);
    }
    return STATUS_OK;
}

void membrane_free(struct membrane *membrane)
{
    boundary_averages_free(&membrane->corners);
    FREE_ALL(membrane->corner, membrane->held, membrane->along, membrane->metric, membrane->weight);
    *membrane = (struct membrane){0};
}

/* stress[n * n], by the weight: (1 - nu) A E A + nu tr(A E) A + tension A, with the strain E = (d . d - D .
 * D) / 2 of the edges d, at rest D, and the inverse metric A of those. Returns the energy by the weight. */
static double stress_of(int n, double nu, double tension, const double *A, const double *metric,
                        const double *rest, double *stress)
{
    double strain[4], mixed[4] = {0.0}, trace = 0.0, energy = 0.0;
    for (int i = 0; i < n * n; i++) {
        strain[i] = 0.5 * (metric[i] - rest[i]);
    }
    for (int i = 0; i < n * n; i++) {
        for (int k = 0; k < n; k++) {
            mixed[i] += A[i / n * n + k] * strain[k * n + i % n];
        }
        trace += i / n == i % n ? mixed[i] : 0.0;
    }
    for (int i = 0; i < n * n; i++) {
        stress[i] = nu * trace * A[i];
        for (int k = 0; k < n; k++) {
            stress[i] += (1.0 - nu) * mixed[i / n * n + k] * A[k * n + i % n];
        }
        energy += 0.5 * stress[i] * strain[i];
        stress[i] += tension * A[i];
    }
    return energy + tension * trace;
}

/* Subtract the forces of facet f, whose edges are d, from those on its corners. */
static void pull_corners(const struct membrane *membrane, int64_t f, double d[2][3], const double *stress,
                         double *force)
{
    int dim = membrane->dim, n = dim - 1;
    double on[3][3] = {{0.0}};
    for (int i = 0; i < n * n; i++) {
        double amount = membrane->weight[f] * stress[i];
        add_scaled(dim, -amount, d[i % n], on[i / n + 1]);
        add_scaled(dim, amount, d[i % n], on[0]);
    }
    for (int k = 0; k < dim; k++) {
        spread_corner(membrane, membrane->corner[f * dim + k], on[k], force);
    }
}

double membrane_pull(const struct membrane *membrane, const double *X, double factor, const double *u,
                     double *force)
{
    int dim = membrane->dim, n = dim - 1;
    double energy = 0.0;
    for (int64_t f = 0; f < membrane->facet_count; f++) {
        const double *A = membrane->metric + f * n * n;
        double d[2][3], rest[4], metric[4], stress[4];
        edges_at(membrane, X, u, f, d);
        metric_of(n, dim, d, metric);
        for (int i = 0; i < n * n; i++) {
            rest[i] = A[i];
        }
        (void)invert_metric(n, rest);
        energy += membrane->weight[f] *
                  stress_of(n, membrane->nu, factor * membrane->tension, A, metric, rest, stress);
        if (force != NULL) {
            pull_corners(membrane, f, d, stress, force);
        }
    }
    return energy;
}

/* The stiffness between corners is at most the weight, with the prestress, times the inverse metric; a corner
 * in the middle of the others, on two edges each, has twice the sum of its own. */
void membrane_add_to_bound(const struct membrane *membrane, double *mass)
{
    int dim = membrane->dim, n = dim - 1;
    for (int64_t f = 0; f < membrane->facet_count; f++) {
        double stiffness = 0.0;
        for (int i = 0; i < n; i++) {
            stiffness += 2.0 * (1.0 + membrane->tension) * membrane->weight[f] *
                         membrane->metric[f * n * n + i * n + i];
        }
        for (int k = 0; k < dim; k++) {
            struct average average = average_of_boundary(&membrane->corners, membrane->corner[f * dim + k]);
            for (int64_t i = 0; i < average.length; i++) {
                mass[average.idx[i]] += stiffness * average.phi[i] * average.phi[i];
            }
        }
    }
}
