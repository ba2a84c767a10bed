#include "solid/preconditioner/coarse_space.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"
#include "solid/preconditioner/coarse_centres.h"

#include <stdlib.h>

enum { SHARES_FOR_THREAD = 20000 }; /* see chunks_of */

/* Quartic spline of a distance within the radius. */
static double weight_at(const struct coarse_space *coarse, double distance)
{
    double q = distance / coarse->radius, q2 = q * q;
    return 1.0 + q2 * (-6.0 + q * (8.0 - 3.0 * q));
}

/* The shares, of the distances that stand in of_centre. */
static enum status share_unity(struct coarse_space *coarse, struct error *error)
{
    struct sparse *shares = &coarse->shares;
    RETURN_IF_ERROR(sparse_transpose(&coarse->of_centre, shares, error));
    sparse_free(&coarse->of_centre);
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double sum = 0.0;
        for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
            sum += shares->value[i] = weight_at(coarse, shares->value[i]);
        }
        for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
            shares->value[i] /= sum;
        }
    }
    return sparse_transpose(shares, &coarse->of_centre, error);
}

enum status coarse_space_build(int dim, int64_t node_count, const double *X,
                               const struct neighbours *neighbours, int64_t centre_count,
                               struct coarse_space *coarse, struct error *error)
{
    *coarse = (struct coarse_space){.dim = dim,
                                    .node_count = node_count,
                                    .X = X,
                                    .centre_count = centre_count,
                                    .count = centre_count * (dim + 1)};
    if (centre_count > 0) {
        RETURN_IF_ERROR(NEW_ARRAY(&coarse->centre, centre_count * dim, error));
        RETURN_IF_ERROR(coarse_centres_pick(coarse, neighbours, error));
        RETURN_IF_ERROR(share_unity(coarse, error));
    }
    return STATUS_OK;
}

void coarse_space_free(struct coarse_space *coarse)
{
    sparse_free(&coarse->shares);
    sparse_free(&coarse->of_centre);
    free(coarse->centre);
    *coarse = (struct coarse_space){0};
}

/* amount[(dim + 1) * dim] of centre c. The dimension is known when compiling, here and below. */
KERNEL_INLINE void collect(const struct coarse_space *coarse, int dim, int64_t c, const double *v,
                           double *amount)
{
    const struct sparse *of_centre = &coarse->of_centre;
    double sum[4][3] = {{0.0}}, value[4];
    const double *place = coarse->centre + c * dim;
    for (int64_t i = of_centre->ptr[c]; i < of_centre->ptr[c + 1]; i++) {
        const double *X = coarse->X + (int64_t)of_centre->idx[i] * dim;
        const double *at = v + (int64_t)of_centre->idx[i] * dim;
        value[0] = of_centre->value[i];
        for (int a = 0; a < dim; a++) {
            value[a + 1] = value[0] * (X[a] - place[a]);
        }
        for (int m = 0; m <= dim; m++) {
            for (int a = 0; a < dim; a++) {
                sum[m][a] += value[m] * at[a];
            }
        }
    }
    for (int m = 0; m <= dim; m++) {
        for (int a = 0; a < dim; a++) {
            amount[m * dim + a] = m == 0 ? sum[m][a] : sum[m][a] / coarse->radius;
        }
    }
}

/* u += amount at node n. */
KERNEL_INLINE void add(const struct coarse_space *coarse, int dim, int64_t n, const double *amount, double *u)
{
    const struct sparse *shares = &coarse->shares;
    const double *X = coarse->X + n * dim;
    double constant[3] = {0.0}, linear[3] = {0.0};
    for (int64_t i = shares->ptr[n]; i < shares->ptr[n + 1]; i++) {
        const double *place = coarse->centre + (int64_t)shares->idx[i] * dim;
        const double *of_share = amount + (int64_t)shares->idx[i] * (dim + 1) * dim;
        double share = shares->value[i], value[3];
        for (int m = 0; m < dim; m++) {
            value[m] = share * (X[m] - place[m]);
        }
        for (int a = 0; a < dim; a++) {
            double sum = value[0] * of_share[dim + a];
            for (int m = 1; m < dim; m++) {
                sum += value[m] * of_share[(m + 1) * dim + a];
            }
            linear[a] += sum;
            constant[a] += share * of_share[a];
        }
    }
    for (int a = 0; a < dim; a++) {
        u[n * dim + a] += constant[a] + linear[a] / coarse->radius;
    }
}

ALL_SETS static void collect_centre(const struct coarse_space *coarse, int64_t c, const double *v,
                                    double *amount)
{
    if (coarse->dim == 2) {
        collect(coarse, 2, c, v, amount);
    } else {
        collect(coarse, 3, c, v, amount);
    }
}

ALL_SETS static void add_nodes(const struct coarse_space *coarse, int64_t begin, int64_t end,
                               const double *amount, double *u)
{
    for (int64_t n = begin; n < end; n++) {
        if (coarse->dim == 2) {
            add(coarse, 2, n, amount, u);
        } else {
            add(coarse, 3, n, amount, u);
        }
    }
}

/* The threads that are worth using. */
static struct chunks chunks_of_shares(const struct coarse_space *coarse, int64_t items)
{
    return chunks_for_threads(items, coarse->shares.ptr[coarse->node_count], SHARES_FOR_THREAD);
}

void coarse_space_restrict(const struct coarse_space *coarse, const double *v, double *amount)
{
    int64_t numbers = (coarse->dim + 1) * coarse->dim;
#pragma omp parallel for schedule(dynamic, 1) num_threads(chunks_of_shares(coarse, 1).threads)
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        collect_centre(coarse, c, v, amount + c * numbers);
    }
}

void coarse_space_prolongate(const struct coarse_space *coarse, const double *amount, double *u)
{
    struct chunks chunks = chunks_of_shares(coarse, coarse->node_count);
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        add_nodes(coarse, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1), amount, u);
    }
}
