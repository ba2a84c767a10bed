#include "solid/fields.h"

#include "base/memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Radius of a centre over the distance within which every node has one: 1.2 to 2.5 serve alike. */
static const double reach = 1.5;
/* Nodes that are worth a second thread. */
enum { NODES_FOR_THREADS = 5000 };

/* Centres: nodes, each the farthest from those before it. Sets the radius. */
static enum status pick_centres(struct fields *fields, struct error *error)
{
    enum status status;
    int dim = fields->dim;
    double *distance2 = NULL;
    int64_t next = 0;
    TRY(NEW_ARRAY(&distance2, fields->node_count, error));
    for (int64_t n = 0; n < fields->node_count; n++) {
        distance2[n] = INFINITY;
    }
    for (int64_t c = 0; c < fields->centre_count; c++) {
        double *centre = fields->centre + c * dim;
        memcpy(centre, fields->X + next * dim, (size_t)dim * sizeof *centre);
        for (int64_t n = 0; n < fields->node_count; n++) {
            double sum = 0.0;
            for (int a = 0; a < dim; a++) {
                double step = fields->X[n * dim + a] - centre[a];
                sum += step * step;
            }
            distance2[n] = fmin(distance2[n], sum);
        }
        for (int64_t n = 0; n < fields->node_count; n++) {
            next = distance2[n] > distance2[next] ? n : next;
        }
    }
    fields->radius = reach * sqrt(distance2[next]);
done:
    free(distance2);
    return status;
}

/* Quartic spline of the distance of a node from centre c. */
static double weight(const struct fields *fields, int64_t c, int64_t node)
{
    double q2 = 0.0;
    for (int a = 0; a < fields->dim; a++) {
        double way =
            (fields->X[node * fields->dim + a] - fields->centre[c * fields->dim + a]) / fields->radius;
        q2 += way * way;
    }
    double q = sqrt(q2);
    return q < 1.0 ? 1.0 + q2 * (-6.0 + q * (8.0 - 3.0 * q)) : 0.0;
}

/* Both tables: the entries of a node or centre are counted, then filled in. */
static enum status share_unity(struct fields *fields, struct error *error)
{
    enum status status;
    struct share_table *nodes = &fields->by_node, *centres = &fields->by_centre;
    TRY(NEW_ARRAY(&nodes->ptr, fields->node_count + 1, error));
    TRY(NEW_ARRAY(&centres->ptr, fields->centre_count + 2, error));
    for (int64_t n = 0; n < fields->node_count; n++) {
        nodes->ptr[n + 1] = nodes->ptr[n];
        for (int64_t c = 0; c < fields->centre_count; c++) {
            bool has_share = weight(fields, c, n) > 0.0;
            nodes->ptr[n + 1] += has_share;
            centres->ptr[c + 2] += has_share;
        }
    }
    for (int64_t c = 0; c < fields->centre_count; c++) {
        centres->ptr[c + 2] += centres->ptr[c + 1];
    }
    int64_t pairs = nodes->ptr[fields->node_count];
    TRY(NEW_ARRAY(&nodes->idx, pairs, error));
    TRY(NEW_ARRAY(&nodes->share, pairs, error));
    TRY(NEW_ARRAY(&centres->idx, pairs, error));
    TRY(NEW_ARRAY(&centres->share, pairs, error));
    for (int64_t n = 0; n < fields->node_count; n++) {
        double values[FIELDS_MOST_CENTRES], sum = 0.0;
        for (int64_t c = 0; c < fields->centre_count; c++) {
            sum += values[c] = weight(fields, c, n);
        }
        for (int64_t c = 0, at = nodes->ptr[n]; c < fields->centre_count; c++) {
            if (values[c] > 0.0) {
                int64_t place = centres->ptr[c + 1]++;
                nodes->idx[at] = (int32_t)c;
                centres->idx[place] = (int32_t)n;
                nodes->share[at++] = centres->share[place] = values[c] / sum;
            }
        }
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
                              .count = centre_count * (dim + 1)};
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

static void free_table(struct share_table *table)
{
    free(table->ptr);
    free(table->idx);
    free(table->share);
}

void fields_free(struct fields *fields)
{
    free_table(&fields->by_node);
    free_table(&fields->by_centre);
    *fields = (struct fields){0};
}

/* Values at a node of the fields of centre c, which has that share in it. */
static inline void monomials(const struct fields *fields, int dim, int64_t c, int64_t node, double share,
                             double value[4])
{
    double scale = share / fields->radius;
    value[0] = share;
    for (int a = 0; a < dim; a++) {
        value[a + 1] = scale * (fields->X[node * dim + a] - fields->centre[c * dim + a]);
    }
}

int fields_at_node(const struct fields *fields, int64_t node, int field[FIELDS_MOST_AT_NODE],
                   double value[FIELDS_MOST_AT_NODE])
{
    const struct share_table *table = &fields->by_node;
    int count = 0;
    for (int64_t i = table->ptr[node]; i < table->ptr[node + 1]; i++) {
        double of_centre[4];
        monomials(fields, fields->dim, table->idx[i], node, table->share[i], of_centre);
        for (int m = 0; m <= fields->dim; m++, count++) {
            field[count] = table->idx[i] * (fields->dim + 1) + m;
            value[count] = of_centre[m];
        }
    }
    return count;
}

/* What the forces do along the fields of centre c. The dimension is known when compiling, here and below. */
static inline void collect_centre(const struct fields *fields, int dim, int64_t c, const double *force,
                                  double *amount)
{
    const struct share_table *table = &fields->by_centre;
    double sum[4][3] = {{0.0}}, value[4];
    for (int64_t i = table->ptr[c]; i < table->ptr[c + 1]; i++) {
        const double *f = force + (int64_t)table->idx[i] * dim;
        monomials(fields, dim, c, table->idx[i], table->share[i], value);
        for (int m = 0; m <= dim; m++) {
            for (int a = 0; a < dim; a++) {
                sum[m][a] += value[m] * f[a];
            }
        }
    }
    for (int m = 0; m <= dim; m++) {
        memcpy(amount + (c * (dim + 1) + m) * dim, sum[m], (size_t)dim * sizeof *amount);
    }
}

void fields_collect(const struct fields *fields, const double *force, double *amount)
{
#pragma omp parallel for schedule(dynamic, 1) if (fields->node_count > NODES_FOR_THREADS)
    for (int64_t c = 0; c < fields->centre_count; c++) {
        if (fields->dim == 2) {
            collect_centre(fields, 2, c, force, amount);
        } else {
            collect_centre(fields, 3, c, force, amount);
        }
    }
}

static inline void add_at_node(const struct fields *fields, int dim, int64_t node, const double *amount,
                               double *u)
{
    const struct share_table *table = &fields->by_node;
    double sum[3] = {0.0, 0.0, 0.0}, value[4];
    for (int64_t i = table->ptr[node]; i < table->ptr[node + 1]; i++) {
        const double *of_centre = amount + (int64_t)table->idx[i] * (dim + 1) * dim;
        monomials(fields, dim, table->idx[i], node, table->share[i], value);
        for (int m = 0; m <= dim; m++) {
            for (int a = 0; a < dim; a++) {
                sum[a] += value[m] * of_centre[m * dim + a];
            }
        }
    }
    for (int a = 0; a < dim; a++) {
        u[node * dim + a] += sum[a];
    }
}

void fields_add(const struct fields *fields, const double *amount, double *u)
{
#pragma omp parallel for schedule(static) if (fields->node_count > NODES_FOR_THREADS)
    for (int64_t n = 0; n < fields->node_count; n++) {
        if (fields->dim == 2) {
            add_at_node(fields, 2, n, amount, u);
        } else {
            add_at_node(fields, 3, n, amount, u);
        }
    }
}
