#include "approx/field/scattered_fit.h"

#include "approx/mls/mls.h"
#include "base/memory.h"
#include "base/vector.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Singular values below this share of the largest are noise: the points do not determine the combination. */
static const double cut = 1e-5;

enum { MOST_NEIGHBOURS = NEAREST_MOST, MOST_MONOMIALS = 10, MOST_COLUMNS = 6 };

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

/* The nearest points that are connected or not yet checked; in the table's unit. */
static enum status find_nearest(const struct scattered_fit *fit, const double *at,
                                struct nearest_nodes *nearest, struct error *error)
{
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
    struct nearest_nodes nearest;
    RETURN_IF_ERROR(find_nearest(fit, fit->x + row * fit->dim, &nearest, error));
    double radius = nearest.distance[nearest.count - 1], count = (double)nearest.count;
    *spacing = radius * (fit->dim == 2 ? sqrt(M_PI / count) : cbrt(4.0 / 3.0 * M_PI / count));
    return STATUS_OK;
}

/* The nearest connected points: the nearest ones are checked, and unconnected ones replaced, until all are
 * connected. */
static enum status find_reached(const struct scattered_fit *fit, int32_t from, const double *at,
                                struct nearest_nodes *nearest, struct error *error)
{
    if (fit->paths != NULL) {
        edge_paths_begin(fit->paths, from);
    }
    for (bool settled = false; !settled;) {
        settled = true;
        RETURN_IF_ERROR(find_nearest(fit, at, nearest, error));
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

/* Columns A of a weighted fit, padded by zero rows, and A = U s V^T; singular values below the cut are 0. */
struct part {
    size_t rows, columns;
    double A[MOST_NEIGHBOURS * MOST_COLUMNS], U[MOST_NEIGHBOURS * MOST_COLUMNS];
    double V[MOST_COLUMNS * MOST_COLUMNS], s[MOST_COLUMNS];
};

/* Decompose the columns. largest: singular value to which the cut refers; 0: the largest one. By the method
 * of Jacobi: the other one of GSL takes memory unchecked. */
static enum status part_decompose(struct part *part, double largest, struct error *error)
{
    gsl_matrix_view U = gsl_matrix_view_array(part->U, part->rows, part->columns);
    gsl_matrix_view V = gsl_matrix_view_array(part->V, part->columns, part->columns);
    gsl_vector_view s = gsl_vector_view_array(part->s, part->columns);
    memcpy(part->U, part->A, sizeof part->A);
    if (gsl_linalg_SV_decomp_jacobi(&U.matrix, &V.matrix, &s.vector) != GSL_SUCCESS) {
        return fail(error, STATUS_VERDICT, "interpolation of a table: no singular value decomposition");
    }
    double least = cut * (largest > 0.0 ? largest : part->s[0]);
    for (size_t k = 0; k < part->columns; k++) {
        part->s[k] = part->s[k] > least ? part->s[k] : 0.0;
    }
    return STATUS_OK;
}

/* x[columns] = A^+ b, A^+ the pseudo-inverse. */
static void part_solve(const struct part *part, const double *b, double *x)
{
    memset(x, 0, part->columns * sizeof *x);
    for (size_t k = 0; k < part->columns; k++) {
        double product = 0.0;
        for (size_t i = 0; i < part->rows; i++) {
            product += part->U[i * part->columns + k] * b[i];
        }
        for (size_t j = 0; j < part->columns && part->s[k] > 0.0; j++) {
            x[j] += part->V[j * part->columns + k] * product / part->s[k];
        }
    }
}

/* Replace column k of the quadratic part by what the linear part does not fit of it, and the monomial at x,
 * *at_x, by what the linear fit does not give there; linear[]: the linear monomials at x. */
static void part_take_rest(const struct part *by, size_t k, const double *linear, struct part *part,
                           double *at_x)
{
    double column[MOST_NEIGHBOURS] = {0.0}, fit[MOST_COLUMNS];
    for (size_t i = 0; i < part->rows; i++) {
        column[i] = part->A[i * part->columns + k];
    }
    part_solve(by, column, fit);
    for (size_t j = 0; j < by->columns; j++) {
        *at_x -= linear[j] * fit[j];
        for (size_t i = 0; i < by->rows; i++) {
            part->A[i * part->columns + k] -= by->A[i * by->columns + j] * fit[j];
        }
    }
}

/* The weighted basis at the neighbours, in coordinates from their weighted mean: the linear columns, and the
 * quadratic ones. at_x: the basis at x. With coordinates from the mean, the combinations that the points do
 * not determine are those that vanish on them. */
static void fill_columns(const struct scattered_fit *fit, const double *at,
                         const struct nearest_nodes *nearest, double *root, struct part *linear,
                         struct part *quadratic, double *at_x)
{
    int dim = fit->dim == 2 ? 2 : 3;
    double radius = 1.1 * nearest->distance[nearest->count - 1], total = 0.0;
    double mean[3] = {0.0, 0.0, 0.0}, xi[3], p[MOST_MONOMIALS];
    for (int64_t i = 0; i < nearest->count; i++) {
        double weight, slope, relative = nearest->distance[i] / radius;
        weight_quartic(relative * relative, &weight, &slope);
        root[i] = sqrt(weight);
        total += weight;
        add_scaled(dim, weight, fit->row + nearest->node[i] * fit->row_size, mean);
    }
    for (int a = 0; a < dim; a++) {
        mean[a] /= total;
        xi[a] = (at[a] - mean[a]) / radius;
    }
    monomials(dim, xi, at_x);
    for (size_t i = 0; i < (size_t)nearest->count; i++) {
        for (int a = 0; a < dim; a++) {
            xi[a] = (fit->row[nearest->node[i] * fit->row_size + a] - mean[a]) / radius;
        }
        monomials(dim, xi, p);
        for (size_t k = 0; k < linear->columns; k++) {
            linear->A[i * linear->columns + k] = root[i] * p[k];
        }
        for (size_t k = 0; k < quadratic->columns; k++) {
            quadratic->A[i * quadratic->columns + k] = root[i] * p[linear->columns + k];
        }
    }
}

/* The values at x. The quadratic monomials fit the remainder of the linear fit, so that linear fields are
 * exact however few the points are. */
static enum status fit_values(const struct scattered_fit *fit, const double *at,
                              const struct nearest_nodes *nearest, double *values, struct error *error)
{
    size_t dim = (size_t)fit->dim, count = (size_t)nearest->count;
    struct part linear = {.rows = count > 1 + dim ? count : 1 + dim, .columns = 1 + dim};
    struct part quadratic = {.columns = dim * (dim + 1) / 2};
    double root[MOST_NEIGHBOURS], b[MOST_NEIGHBOURS] = {0.0}, at_x[MOST_MONOMIALS], fitted[MOST_COLUMNS];
    quadratic.rows = count > quadratic.columns ? count : quadratic.columns;
    fill_columns(fit, at, nearest, root, &linear, &quadratic, at_x);
    RETURN_IF_ERROR(part_decompose(&linear, 0.0, error));
    for (size_t k = 0; k < quadratic.columns; k++) {
        part_take_rest(&linear, k, at_x, &quadratic, &at_x[1 + dim + k]);
    }
    RETURN_IF_ERROR(part_decompose(&quadratic, linear.s[0], error));
    for (int v = 0; v < fit->value_count; v++) {
        values[v] = 0.0;
        for (size_t i = 0; i < count; i++) {
            b[i] = root[i] * fit->row[nearest->node[i] * fit->row_size + fit->dim + v];
        }
        part_solve(&linear, b, fitted);
        for (size_t k = 0; k < linear.columns; k++) {
            values[v] += at_x[k] * fitted[k];
        }
        part_solve(&quadratic, b, fitted);
        for (size_t k = 0; k < quadratic.columns; k++) {
            values[v] += at_x[1 + dim + k] * fitted[k];
        }
    }
    return STATUS_OK;
}

enum status scattered_fit_evaluate(const struct scattered_fit *fit, int32_t from, const double *x,
                                   double *values, double *distance, double *spacing, struct error *error)
{
    struct nearest_nodes nearest = {0};
    double at[3];
    for (int a = 0; a < fit->dim; a++) {
        at[a] = x[a] / fit->unit;
    }
    RETURN_IF_ERROR(find_reached(fit, from, at, &nearest, error));
    int64_t last = nearest.count - 1;
    *distance = nearest.distance[0] * fit->unit;
    RETURN_IF_ERROR(spacing_around(fit, nearest.node[0], spacing, error));
    *spacing *= fit->unit;
    memcpy(values, fit->row + nearest.node[0] * fit->row_size + fit->dim,
           (size_t)fit->value_count * sizeof *values);
    if (nearest.count > 1 && nearest.distance[last] > 0.0) {
        RETURN_IF_ERROR(fit_values(fit, at, &nearest, values, error));
    }
    for (int v = 0; v < fit->value_count; v++) {
        values[v] *= fit->unit;
    }
    return STATUS_OK;
}
