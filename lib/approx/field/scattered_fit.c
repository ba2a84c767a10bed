#include "approx/field/scattered_fit.h"

#include "approx/mls/weight.h"
#include "base/memory.h"
#include "base/vector.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdbool.h>

/* Singular values below this share of the largest are noise: the points do not determine the combination. */
static const double cut = 1e-5;

enum { MOST_NEIGHBOURS = NEAREST_MOST, MOST_MONOMIALS = 10 };

enum status scattered_fit_build(struct scattered_fit *fit, struct error *error)
{
    int dim = fit->dim;
    double extent = 0.0;
    RETURN_IF_ERROR(NEW_ARRAY(&fit->x, fit->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&fit->radius, fit->count, error));
    for (int64_t i = 0; i < fit->count; i++) {
        for (int a = 0; a < dim; a++) {
            fit->x[i * dim + a] = fit->row[i * fit->row_size + a];
            extent = fmax(extent, fabs(fit->x[i * dim + a] - fit->x[a]));
        }
    }
    /* Only a start: the search widens it. */
    double radius = extent > 0.0 ? 2.0 * extent / pow((double)fit->count, 1.0 / dim) : 1.0;
    if (!(radius < 1e150)) {
        return fail(error, STATUS_INPUT, "interpolation of a table: its points are too far apart");
    }
    for (int64_t i = 0; i < fit->count; i++) {
        fit->radius[i] = radius;
    }
    return point_grid_build(&fit->grid, dim, fit->count, fit->x, fit->radius, error);
}

void scattered_fit_free(struct scattered_fit *fit)
{
    FREE_ALL(fit->x, fit->radius);
    point_grid_free(&fit->grid);
    fit->x = fit->radius = NULL;
}

/* Whether a point is connected to the node, or not yet checked. */
static bool is_usable(const void *paths, int32_t row)
{
    return ((const struct edge_paths *)paths)->verdict[row] != PATH_NONE;
}

/* The nearest points that are connected or not yet checked, with distances in the table's unit. */
static enum status find_nearest(const struct scattered_fit *fit, const double *x,
                                struct nearest_nodes *nearest, struct error *error)
{
    double at[3] = {0.0, 0.0, 0.0};
    for (int a = 0; a < fit->dim; a++) {
        at[a] = x[a] / fit->unit;
    }
    return fail_in(error,
                   point_grid_nearest(&fit->grid, at, fit->dim == 2 ? 12 : MOST_NEIGHBOURS,
                                      fit->paths != NULL ? is_usable : NULL, fit->paths, nearest, error),
                   "interpolation of a table");
}

/* Mean spacing of the points around row `row`, in the table's unit: each of n points within a radius r has
 * the area pi r^2 / n or the volume 4/3 pi r^3 / n, if they lie throughout the body; on its boundary they are
 * closer. */
static enum status spacing_around(const struct scattered_fit *fit, int64_t row, double *spacing,
                                  struct error *error)
{
    double x[3] = {0.0, 0.0, 0.0};
    struct nearest_nodes nearest;
    for (int a = 0; a < fit->dim; a++) {
        x[a] = fit->row[row * fit->row_size + a] * fit->unit;
    }
    enum status status = find_nearest(fit, x, &nearest, error);
    if (status == STATUS_OK) {
        double radius = nearest.distance[nearest.count - 1], count = (double)nearest.count;
        *spacing = radius * (fit->dim == 2 ? sqrt(M_PI / count) : cbrt(4.0 / 3.0 * M_PI / count));
    }
    return status;
}

/* The nearest connected points: the nearest ones are checked, and unconnected ones replaced, until all are
 * connected. */
static enum status find_reached(const struct scattered_fit *fit, int32_t from, const double *x,
                                struct nearest_nodes *nearest, struct error *error)
{
    if (fit->paths != NULL) {
        edge_paths_begin(fit->paths, from);
    }
    for (bool settled = false; !settled;) {
        settled = true;
        RETURN_IF_ERROR(find_nearest(fit, x, nearest, error));
        for (int64_t i = 0; fit->paths != NULL && i < nearest->count; i++) {
            bool reached;
            RETURN_IF_ERROR(edge_paths_reach(fit->paths, nearest->node[i], &reached, error));
            settled = settled && reached;
        }
    }
    if (nearest->count == 0) {
        return fail(error, STATUS_INPUT, "none of its points is within reach through the cells");
    }
    return STATUS_OK;
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

/* Columns of a weighted fit and their decomposition U s V^T; singular values below the cut are set to 0. */
struct part {
    gsl_matrix *U, *V;
    gsl_vector *s;
};

static enum status part_allocate(struct part *part, size_t rows, size_t columns, struct error *error)
{
    part->U = gsl_matrix_calloc(rows > columns ? rows : columns, columns); /* padded by zeros */
    part->V = gsl_matrix_calloc(columns, columns);
    part->s = gsl_vector_calloc(columns);
    bool good = part->U != NULL && part->V != NULL && part->s != NULL;
    return good ? STATUS_OK : fail_memory(error, "interpolation of a table");
}

static void part_free(struct part *part)
{
    gsl_matrix_free(part->U);
    gsl_matrix_free(part->V);
    gsl_vector_free(part->s);
}

/* Decompose the columns in U, which receives the left singular vectors. largest: singular value to which the
 * cut refers; 0: the largest one. By the method of Jacobi: the other one of GSL takes memory unchecked. */
static enum status part_decompose(struct part *part, double largest, struct error *error)
{
    if (gsl_linalg_SV_decomp_jacobi(part->U, part->V, part->s) != GSL_SUCCESS) {
        return fail(error, STATUS_VERDICT, "interpolation of a table: no singular value decomposition");
    }
    double least = cut * (largest > 0.0 ? largest : gsl_vector_get(part->s, 0));
    for (size_t k = 0; k < part->s->size; k++) {
        if (!(gsl_vector_get(part->s, k) > least)) {
            gsl_vector_set(part->s, k, 0.0);
        }
    }
    return STATUS_OK;
}

/* row[i] += sum_j v[j] A^+(j, i), A^+ the pseudo-inverse. */
static void add_inverse(const struct part *part, const double *v, int64_t count, double *row)
{
    for (size_t k = 0; k < part->s->size; k++) {
        double s = gsl_vector_get(part->s, k), sum = 0.0;
        if (s == 0.0) {
            continue;
        }
        for (size_t j = 0; j < part->s->size; j++) {
            sum += v[j] * gsl_matrix_get(part->V, j, k);
        }
        for (int64_t i = 0; i < count; i++) {
            row[i] += sum / s * gsl_matrix_get(part->U, (size_t)i, k);
        }
    }
}

/* Make the columns of Q orthogonal to the linear part: Q -= U U^T Q. */
static void orthogonalise(const struct part *linear, int64_t count, gsl_matrix *Q)
{
    for (size_t c = 0; c < Q->size2; c++) {
        for (size_t k = 0; k < linear->s->size; k++) {
            double product = 0.0;
            for (int64_t i = 0; i < count && gsl_vector_get(linear->s, k) > 0.0; i++) {
                product += gsl_matrix_get(linear->U, (size_t)i, k) * gsl_matrix_get(Q, (size_t)i, c);
            }
            for (int64_t i = 0; i < count; i++) {
                double value =
                    gsl_matrix_get(Q, (size_t)i, c) - product * gsl_matrix_get(linear->U, (size_t)i, k);
                gsl_matrix_set(Q, (size_t)i, c, value);
            }
        }
    }
}

/* The weighted basis at the neighbours, in coordinates from their weighted mean: the linear columns, and the
 * quadratic ones. at_x: the basis at x. With coordinates from the mean, the combinations that the points do
 * not determine are those that vanish on them. */
static void fill_columns(const struct scattered_fit *fit, const double *x,
                         const struct nearest_nodes *nearest, double *root, gsl_matrix *linear,
                         gsl_matrix *quadratic, double *at_x)
{
    int dim = fit->dim == 2 ? 2 : 3;
    double radius = 1.1 * nearest->distance[nearest->count - 1], total = 0.0;
    double mean[3] = {0.0, 0.0, 0.0}, xi[3], p[MOST_MONOMIALS];
    for (int64_t i = 0; i < nearest->count; i++) {
        double weight, slope, relative = nearest->distance[i] / radius;
        weight_evaluate(WEIGHT_QUARTIC, relative * relative, &weight, &slope);
        root[i] = sqrt(weight);
        total += weight;
        add_scaled(dim, weight, fit->row + nearest->node[i] * fit->row_size, mean);
    }
    for (int a = 0; a < dim; a++) {
        mean[a] /= total;
        xi[a] = (x[a] / fit->unit - mean[a]) / radius;
    }
    monomials(dim, xi, at_x);
    for (int64_t i = 0; i < nearest->count; i++) {
        for (int a = 0; a < dim; a++) {
            xi[a] = (fit->row[nearest->node[i] * fit->row_size + a] - mean[a]) / radius;
        }
        monomials(dim, xi, p);
        for (size_t k = 0; k < linear->size2; k++) {
            gsl_matrix_set(linear, (size_t)i, k, root[i] * p[k]);
        }
        for (size_t k = 0; k < quadratic->size2; k++) {
            gsl_matrix_set(quadratic, (size_t)i, k, root[i] * p[linear->size2 + k]);
        }
    }
}

/* phi[i]: the weight of neighbour i in the value at x. The quadratic monomials fit the remainder of the
 * linear fit, so that linear fields are exact however few the points are. */
static enum status weights_of(const struct scattered_fit *fit, const double *x,
                              const struct nearest_nodes *nearest, double *phi, struct error *error)
{
    size_t linear_columns = (size_t)(1 + fit->dim);
    size_t quadratic_columns = (size_t)(fit->dim * (fit->dim + 1) / 2);
    size_t rows = (size_t)nearest->count;
    FREED_BY(part_free) struct part linear = {0}, quadratic = {0};
    double root[MOST_NEIGHBOURS], value[MOST_NEIGHBOURS] = {0.0}, at_x[MOST_MONOMIALS];
    double beyond[MOST_MONOMIALS] = {0.0}, moment[MOST_NEIGHBOURS * MOST_MONOMIALS];
    RETURN_IF_ERROR(part_allocate(&linear, rows, linear_columns, error));
    RETURN_IF_ERROR(part_allocate(&quadratic, rows, quadratic_columns, error));
    fill_columns(fit, x, nearest, root, linear.U, quadratic.U, at_x);
    for (size_t i = 0; i < rows; i++) {
        for (size_t k = 0; k < quadratic_columns; k++) {
            moment[i * quadratic_columns + k] = gsl_matrix_get(quadratic.U, i, k);
        }
    }
    RETURN_IF_ERROR(part_decompose(&linear, 0.0, error));
    orthogonalise(&linear, nearest->count, quadratic.U);
    RETURN_IF_ERROR(part_decompose(&quadratic, gsl_vector_get(linear.s, 0), error));
    /* p_l c_l + p_q c_q with c_l = L^+ (b - Q c_q), c_q = Q'^+ b. */
    add_inverse(&linear, at_x, nearest->count, value);
    for (size_t k = 0; k < quadratic_columns; k++) {
        beyond[k] = at_x[linear_columns + k];
        for (size_t i = 0; i < rows; i++) {
            beyond[k] -= value[i] * moment[i * quadratic_columns + k];
        }
    }
    add_inverse(&quadratic, beyond, nearest->count, value);
    for (int64_t i = 0; i < nearest->count; i++) {
        phi[i] = value[i] * root[i];
    }
    return STATUS_OK;
}

enum status scattered_fit_evaluate(const struct scattered_fit *fit, int32_t from, const double *x,
                                   double *values, double *distance, double *spacing, struct error *error)
{
    struct nearest_nodes nearest = {0};
    double phi[MOST_NEIGHBOURS] = {1.0};
    RETURN_IF_ERROR(find_reached(fit, from, x, &nearest, error));
    int64_t last = nearest.count - 1;
    *distance = nearest.distance[0] * fit->unit;
    RETURN_IF_ERROR(spacing_around(fit, nearest.node[0], spacing, error));
    *spacing *= fit->unit;
    if (nearest.count > 1 && nearest.distance[last] > 0.0) {
        RETURN_IF_ERROR(weights_of(fit, x, &nearest, phi, error));
    }
    for (int v = 0; v < fit->value_count; v++) {
        values[v] = 0.0;
        for (int64_t i = 0; i < nearest.count; i++) {
            values[v] += phi[i] * fit->row[nearest.node[i] * fit->row_size + fit->dim + v] * fit->unit;
        }
    }
    return STATUS_OK;
}
