#include "solid/fields_kernel.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radius of the shares, by the largest distance of a node from its nearest centre: 1.2 to 2.5 give as many
 * steps. */
static const double reach = 1.5;
enum { NODES_FOR_THREAD = 10000 }; /* see chunks_of */

static double distance2(const struct fields *fields, int64_t c, int64_t node)
{
    double sum = 0.0;
    for (int a = 0; a < fields->dim; a++) {
        double step = fields->X[node * fields->dim + a] - fields->centre[a][c];
        sum += step * step;
    }
    return sum;
}

/* Centres: nodes, each the farthest from those before it. Sets the radius. */
static enum status pick_centres(struct fields *fields, struct error *error)
{
    enum status status;
    double *least2 = NULL;
    int64_t next = 0;
    TRY(NEW_ARRAY(&least2, fields->node_count, error));
    for (int64_t n = 0; n < fields->node_count; n++) {
        least2[n] = INFINITY;
    }
    for (int64_t c = 0; c < fields->centre_count; c++) {
        for (int a = 0; a < fields->dim; a++) {
            fields->centre[a][c] = fields->X[next * fields->dim + a];
        }
        for (int64_t n = 0; n < fields->node_count; n++) {
            least2[n] = fmin(least2[n], distance2(fields, c, n));
        }
        for (int64_t n = 0; n < fields->node_count; n++) {
            next = least2[n] > least2[next] ? n : next;
        }
    }
    fields->radius = reach * sqrt(least2[next]);
done:
    free(least2);
    return status;
}

/* Quartic spline of the distance of a node from centre c. */
static double weight_of(const struct fields *fields, int64_t c, int64_t node)
{
    double q = sqrt(distance2(fields, c, node)) / fields->radius, q2 = q * q;
    return q < 1.0 ? 1.0 + q2 * (-6.0 + q * (8.0 - 3.0 * q)) : 0.0;
}

static enum status share_unity(struct fields *fields, struct error *error)
{
    enum status status;
    TRY(NEW_ARRAY(&fields->share, fields->node_count, error));
    for (int64_t n = 0; n < fields->node_count; n++) {
        double sum = 0.0;
        for (int64_t c = 0; c < fields->centre_count; c++) {
            sum += fields->share[n][c] = weight_of(fields, c, n);
        }
        fields->share[n] /= sum;
    }
done:
    return status;
}

enum status fields_build(int dim, int64_t node_count, const double *X, int64_t centre_count,
                         struct fields *fields, struct error *error)
{
    enum status status = STATUS_OK;
    *fields = (struct fields){.dim = dim,
                              .node_count = node_count,
                              .X = X,
                              .centre_count = centre_count,
                              .count = centre_count * (dim + 1),
                              .kernels = field_kernels_of(processor_best_set())};
    if (centre_count > 0) {
        TRY(pick_centres(fields, error));
        TRY(share_unity(fields, error));
    }
done:
    if (status != STATUS_OK) {
        fields_free(fields);
    }
    return status;
}

void fields_free(struct fields *fields)
{
    free(fields->share);
    *fields = (struct fields){0};
}

int fields_at_node(const struct fields *fields, int64_t node, int field[FIELDS_MOST_AT_NODE],
                   double value[FIELDS_MOST_AT_NODE])
{
    int dim = fields->dim, count = 0;
    for (int c = 0; c < fields->centre_count; c++) {
        double share = fields->share[node][c];
        for (int m = 0; m <= dim && share > 0.0; m++, count++) {
            double way =
                m == 0 ? 1.0 : (fields->X[node * dim + m - 1] - fields->centre[m - 1][c]) / fields->radius;
            field[count] = c * (dim + 1) + m;
            value[count] = share * way;
        }
    }
    return count;
}

void fields_collect(const struct fields *fields, const double *weight, const double *v, double *amount)
{
    struct chunks chunks = chunks_of(fields->node_count, NODES_FOR_THREAD);
    int dim = fields->dim;
    field_amounts partial[CHUNKS_MOST];
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        fields->kernels->collect(fields, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1), weight, v,
                                 partial[c]);
    }
    for (int m = 0; m <= dim; m++) {
        for (int a = 0; a < dim; a++) {
            of_centres sum = partial[0][m][a];
            for (int64_t c = 1; c < chunks.count; c++) {
                sum += partial[c][m][a];
            }
            for (int64_t c = 0; c < fields->centre_count; c++) {
                amount[(c * (dim + 1) + m) * dim + a] = m == 0 ? sum[c] : sum[c] / fields->radius;
            }
        }
    }
}

void fields_add(const struct fields *fields, const double *amount, double *u)
{
    struct chunks chunks = chunks_of(fields->node_count, NODES_FOR_THREAD);
    int dim = fields->dim;
    field_amounts sorted = {{{0.0}}};
    for (int m = 0; m <= dim; m++) {
        for (int a = 0; a < dim; a++) {
            for (int64_t c = 0; c < fields->centre_count; c++) {
                double part = amount[(c * (dim + 1) + m) * dim + a];
                sorted[m][a][c] = m == 0 ? part : part / fields->radius;
            }
        }
    }
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        fields->kernels->add(fields, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1),
                             (const of_centres(*)[3])sorted, u);
    }
}
