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

/* The edges of facet f from its first corner. */
static void edges_at(const struct membrane *membrane, int64_t f, double edge[2][3])
{
    int dim = membrane->dim;
    const int32_t *corner = membrane->corner + f * dim;
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, membrane->place + (int64_t)corner[k] * dim,
                        membrane->place + (int64_t)corner[0] * dim, edge[k - 1]);
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
                                  .curve = law->curve};
    RETURN_IF_ERROR(boundary_corners_build(table, set, &membrane->corners, error));
    RETURN_IF_ERROR(corner_values_build(table, &membrane->corners, rows, &membrane->values, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->corner, set->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->metric, set->count * n * n, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->weight, set->count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->place, membrane->corners.count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&membrane->on, membrane->corners.count * dim, error));
    NEW_SCRATCH(int32_t, number, table->node_count, error);
    memset(number, -1, (size_t)table->node_count * sizeof *number);
    for (int64_t c = 0; c < membrane->corners.count; c++) {
        number[membrane->corners.node[c]] = (int32_t)c;
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
    corner_values_free(&membrane->values);
    FREE_ALL(membrane->corner, membrane->metric, membrane->weight, membrane->place, membrane->on);
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
static void pull_corners(const struct membrane *membrane, int64_t f, double d[2][3], const double *stress)
{
    int dim = membrane->dim, n = dim - 1;
    const int32_t *corner = membrane->corner + f * dim;
    for (int i = 0; i < n * n; i++) {
        double amount = membrane->weight[f] * stress[i];
        add_scaled(dim, -amount, d[i % n], membrane->on + (int64_t)corner[i / n + 1] * dim);
        add_scaled(dim, amount, d[i % n], membrane->on + (int64_t)corner[0] * dim);
    }
}

double membrane_pull(const struct membrane *membrane, const double *X, double factor, const double *u,
                     double *force)
{
    int dim = membrane->dim, n = dim - 1;
    double energy = 0.0;
    for (int64_t c = 0; c < membrane->corners.count; c++) {
        corner_values_take(&membrane->values, c, u, membrane->place + c * dim);
        add_scaled(dim, 1.0, X + (int64_t)membrane->corners.node[c] * dim, membrane->place + c * dim);
    }
    memset(membrane->on, 0, (size_t)(membrane->corners.count * dim) * sizeof *membrane->on);
    for (int64_t f = 0; f < membrane->facet_count; f++) {
        const double *A = membrane->metric + f * n * n;
        double d[2][3], rest[4], metric[4], stress[4];
        edges_at(membrane, f, d);
        metric_of(n, dim, d, metric);
        for (int i = 0; i < n * n; i++) {
            rest[i] = A[i];
        }
        (void)invert_metric(n, rest);
        energy += membrane->weight[f] *
                  stress_of(n, membrane->nu, factor * membrane->tension, A, metric, rest, stress);
        if (force != NULL) {
            pull_corners(membrane, f, d, stress);
        }
    }
    for (int64_t c = 0; force != NULL && c < membrane->corners.count; c++) {
        corner_values_spread(&membrane->values, c, membrane->on + c * dim, force);
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
            average_add_squares(&average, stiffness, mass);
        }
    }
}
