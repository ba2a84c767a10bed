#include "approx/scatter.h"

#include "approx/weight.h"
#include "base/memory.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

/* Singular values below this share of the largest are noise: the points do not determine that combination. */
static const double cut = 1e-5;

enum { MOST_NEIGHBOURS = 24, MOST_MONOMIALS = 10 };

struct nearest {
    int64_t count;
    int64_t row[MOST_NEIGHBOURS];
    double distance[MOST_NEIGHBOURS]; /* ascending, in the table's unit */
};

/* The nearest points by one pass; ties go to the earlier row. */
static void find_nearest(const struct scatter *scatter, const double *x, struct nearest *nearest)
{
    int64_t most = scatter->dim == 2 ? 12 : MOST_NEIGHBOURS;
    nearest->count = 0;
    for (int64_t i = 0; i < scatter->count; i++) {
        double sum = 0.0;
        for (int a = 0; a < scatter->dim; a++) {
            double difference = scatter->row[i * scatter->row_size + a] - x[a] / scatter->unit;
            sum += difference * difference;
        }
        double distance = sqrt(sum);
        if (nearest->count == most && distance >= nearest->distance[most - 1]) {
            continue;
        }
        int64_t at = nearest->count < most ? nearest->count++ : most - 1;
        for (; at > 0 && nearest->distance[at - 1] > distance; at--) {
            nearest->distance[at] = nearest->distance[at - 1];
            nearest->row[at] = nearest->row[at - 1];
        }
        nearest->distance[at] = distance;
        nearest->row[at] = i;
    }
}

static void monomials(int dim, const double *xi, double *p)
{
    int k = 1 + dim;
    p[0] = 1.0;
    for (int a = 0; a < dim; a++) {
        p[1 + a] = xi[a];
        for (int b = a; b < dim; b++) {
            p[k++] = xi[a] * xi[b];
        }
    }
}

/* phi[i]: the weight of neighbour i in the value at x: the first row of the pseudo-inverse of sqrt(W) P. */
static enum status weights_of(const struct scatter *scatter, const double *x, const struct nearest *nearest,
                              double *phi, struct error *error)
{
    enum status status = STATUS_OK;
    int dim = scatter->dim;
    size_t m = (size_t)(1 + dim + dim * (dim + 1) / 2);
    size_t rows = (size_t)nearest->count > m ? (size_t)nearest->count : m; /* padded by zeros */
    double radius = 1.1 * nearest->distance[nearest->count - 1];
    double root[MOST_NEIGHBOURS], xi[3], p[MOST_MONOMIALS];
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_matrix *A = gsl_matrix_calloc(rows, m), *V = gsl_matrix_alloc(m, m);
    gsl_vector *s = gsl_vector_alloc(m), *work = gsl_vector_alloc(m);
    if (A == NULL || V == NULL || s == NULL || work == NULL) {
        status = fail_memory(error, "interpolation of a table");
        goto done;
    }
    for (int64_t i = 0; i < nearest->count; i++) {
        double weight, slope, relative = nearest->distance[i] / radius;
        weight_evaluate(WEIGHT_QUARTIC, relative * relative, &weight, &slope);
        root[i] = sqrt(weight);
        for (int a = 0; a < dim; a++) {
            xi[a] = (scatter->row[nearest->row[i] * scatter->row_size + a] - x[a] / scatter->unit) / radius;
        }
        monomials(dim, xi, p);
        for (size_t k = 0; k < m; k++) {
            gsl_matrix_set(A, (size_t)i, k, root[i] * p[k]);
        }
    }
    if (gsl_linalg_SV_decomp(A, V, s, work) != GSL_SUCCESS) {
        status = fail(error, STATUS_VERDICT, "interpolation of a table: no singular value decomposition");
        goto done;
    }
    for (int64_t i = 0; i < nearest->count; i++) {
        phi[i] = 0.0;
        for (size_t k = 0; k < m && gsl_vector_get(s, k) > cut * gsl_vector_get(s, 0); k++) {
            phi[i] +=
                gsl_matrix_get(V, 0, k) / gsl_vector_get(s, k) * gsl_matrix_get(A, (size_t)i, k) * root[i];
        }
    }
done:
    gsl_matrix_free(A);
    gsl_matrix_free(V);
    gsl_vector_free(s);
    gsl_vector_free(work);
    gsl_set_error_handler(handler);
    return status;
}

enum status scatter_evaluate(const struct scatter *scatter, const double *x, double *values, double *distance,
                             double *spacing, struct error *error)
{
    struct nearest nearest = {0};
    double phi[MOST_NEIGHBOURS] = {1.0};
    find_nearest(scatter, x, &nearest);
    int64_t last = nearest.count - 1;
    *distance = nearest.distance[0] * scatter->unit;
    *spacing = 2.0 * nearest.distance[last] / (double)nearest.count * scatter->unit;
    if (nearest.count > 1 && nearest.distance[last] > 0.0) {
        enum status status = weights_of(scatter, x, &nearest, phi, error);
        if (status != STATUS_OK) {
            return status;
        }
    }
    for (int v = 0; v < scatter->value_count; v++) {
        values[v] = 0.0;
        for (int64_t i = 0; i < nearest.count; i++) {
            values[v] +=
                phi[i] * scatter->row[nearest.row[i] * scatter->row_size + scatter->dim + v] * scatter->unit;
        }
    }
    return STATUS_OK;
}
