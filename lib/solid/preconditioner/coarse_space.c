#include "solid/preconditioner/coarse_space.h"

#include "approx/cells/cells.h"
#include "base/box.h"
#include "base/chunks.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/sets.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SHARES_FOR_THREAD = 20000 }; /* see chunks_of */

/* group[]: of each node, or -1 where a body is too small for one; and how many there are. */
struct node_groups {
    int32_t *group;
    int64_t count;
};

static void groups_free(struct node_groups *groups)
{
    free(groups->group);
}

/* part[]: of each node, the first of those that are connected to it within a run of the Morton curve: by
 * neighbours, or as nodes of two bodies in succession, which contact may couple. */
static enum status find_parts(int dim, int64_t nodes, const double *X, const struct neighbours *neighbours,
                              int64_t runs, int32_t *part, struct error *error)
{
    NEW_SCRATCH(int64_t, order, nodes, error);
    NEW_SCRATCH(int64_t, run, nodes, error);
    NEW_SCRATCH(int32_t, body, nodes, error);
    RETURN_IF_ERROR(renumber_morton(dim, nodes, X, NULL, order, error));
    for (int64_t i = 0; i < nodes; i++) {
        run[order[i]] = i * runs / nodes;
        body[i] = part[i] = (int32_t)i;
    }
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t k = neighbours->ptr[n]; k < neighbours->ptr[n + 1]; k++) {
            set_join(body, (int32_t)n, neighbours->idx[k]);
            if (run[neighbours->idx[k]] == run[n]) {
                set_join(part, (int32_t)n, neighbours->idx[k]);
            }
        }
    }
    for (int64_t i = 1; i < nodes; i++) {
        int32_t a = (int32_t)order[i - 1], b = (int32_t)order[i];
        if (run[a] == run[b] && set_first(body, a) != set_first(body, b)) {
            set_join(part, a, b);
        }
    }
    for (int64_t n = 0; n < nodes; n++) {
        part[n] = set_first(part, (int32_t)n);
    }
    return STATUS_OK;
}

/* Nodes without a group join that of a neighbour. Returns whether any did. */
static bool join_neighbours(const struct neighbours *neighbours, int64_t nodes, int32_t *group)
{
    bool joined = false;
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t k = neighbours->ptr[n]; k < neighbours->ptr[n + 1] && group[n] < 0; k++) {
            group[n] = group[neighbours->idx[k]];
            joined = joined || group[n] >= 0;
        }
    }
    return joined;
}

/* A part with half of a run's nodes is a group; of smaller ones there would be too many. */
static enum status group_nodes(int dim, int64_t nodes, const double *X, const struct neighbours *neighbours,
                               int64_t runs, struct node_groups *groups, struct error *error)
{
    NEW_SCRATCH(int32_t, part, nodes, error);
    NEW_SCRATCH(int64_t, size, nodes, error);
    RETURN_IF_ERROR(NEW_ARRAY(&groups->group, nodes, error));
    RETURN_IF_ERROR(find_parts(dim, nodes, X, neighbours, runs, part, error));
    for (int64_t n = 0; n < nodes; n++) {
        size[part[n]]++;
    }
    for (int64_t n = 0; n < nodes; n++) {
        bool is_group = 2 * runs * size[part[n]] >= nodes;
        groups->group[n] = !is_group ? -1 : part[n] < n ? groups->group[part[n]] : (int32_t)groups->count++;
    }
    while (join_neighbours(neighbours, nodes, groups->group)) {
    }
    return STATUS_OK;
}

/* The mean of the nodes of each group, centre[count * dim]. */
static enum status place_centres(const struct coarse_space *coarse, const struct node_groups *groups,
                                 double *centre, struct error *error)
{
    int dim = coarse->dim;
    NEW_SCRATCH(int64_t, size, groups->count, error);
    for (int64_t n = 0; n < coarse->node_count; n++) {
        if (groups->group[n] >= 0) {
            size[groups->group[n]]++;
        }
    }
    for (int64_t n = 0; n < coarse->node_count; n++) {
        int64_t c = groups->group[n];
        if (c >= 0) {
            add_scaled(dim, 1.0 / (double)size[c], coarse->X + n * dim, centre + c * dim);
        }
    }
    return STATUS_OK;
}

/* Number the groups along the axis on which their centres are spread most: so the profile is narrow, of
 * bodies that touch each other, too. */
static enum status sort_groups(struct coarse_space *coarse, struct node_groups *groups, struct error *error)
{
    int dim = coarse->dim, axis = 0;
    NEW_SCRATCH(double, centre, groups->count * dim, error);
    NEW_SCRATCH(struct placed, placed, groups->count, error);
    NEW_SCRATCH(int32_t, number, groups->count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&coarse->centre, groups->count * dim, error));
    RETURN_IF_ERROR(place_centres(coarse, groups, centre, error));
    struct box box = box_of(dim, groups->count, centre);
    for (int a = 1; a < dim; a++) {
        axis = box.high[a] - box.low[a] > box.high[axis] - box.low[axis] ? a : axis;
    }
    for (int64_t c = 0; c < groups->count; c++) {
        placed[c] = (struct placed){centre[c * dim + axis], c};
    }
    qsort(placed, (size_t)groups->count, sizeof *placed, compare_placed);
    for (int64_t c = 0; c < groups->count; c++) {
        number[placed[c].item] = (int32_t)c;
        memcpy(coarse->centre + c * dim, centre + placed[c].item * dim, (size_t)dim * sizeof *centre);
    }
    for (int64_t n = 0; n < coarse->node_count; n++) {
        groups->group[n] = groups->group[n] >= 0 ? number[groups->group[n]] : -1;
    }
    return STATUS_OK;
}

/* sum[count]: the weights of the groups that node n and its neighbours are in; returns the sum of all. */
static double weigh_groups(const struct coarse_space *coarse, const struct neighbours *neighbours, int64_t n,
                           const struct node_groups *groups, double *sum)
{
    const double *x = coarse->X + n * coarse->dim;
    double farthest2 = 0.0, all = 0.0;
    memset(sum, 0, (size_t)groups->count * sizeof *sum);
    for (int64_t k = neighbours->ptr[n]; k < neighbours->ptr[n + 1]; k++) {
        const double *other = coarse->X + (int64_t)neighbours->idx[k] * coarse->dim;
        farthest2 = fmax(farthest2, vector_distance2(coarse->dim, x, other));
    }
    for (int64_t k = neighbours->ptr[n]; k < neighbours->ptr[n + 1]; k++) {
        const double *other = coarse->X + (int64_t)neighbours->idx[k] * coarse->dim;
        double distance2 = vector_distance2(coarse->dim, x, other);
        int32_t c = groups->group[neighbours->idx[k]];
        if (c >= 0) {
            double weight = distance2 > 0.0 ? 1.0 - distance2 / farthest2 : 1.0;
            sum[c] += weight;
            all += weight;
        }
    }
    return all;
}

static enum status share_unity(struct coarse_space *coarse, const struct neighbours *neighbours,
                               const struct node_groups *groups, struct error *error)
{
    struct sparse *shares = &coarse->shares;
    int64_t at = 0, room = 0, values = 0;
    NEW_SCRATCH(double, sum, groups->count, error);
    RETURN_IF_ERROR(sparse_new(coarse->node_count, groups->count, 0, shares, error));
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double all = weigh_groups(coarse, neighbours, n, groups, sum);
        RETURN_IF_ERROR(GROW_ARRAY(&shares->idx, at + groups->count, &room, error));
        RETURN_IF_ERROR(GROW_ARRAY(&shares->value, at + groups->count, &values, error));
        for (int64_t c = 0; c < groups->count; c++) {
            if (sum[c] > 0.0) {
                double far = vector_distance(coarse->dim, coarse->X + n * coarse->dim,
                                             coarse->centre + c * coarse->dim);
                coarse->radius = fmax(coarse->radius, far);
                shares->idx[at] = (int32_t)c;
                shares->value[at++] = sum[c] / all;
            }
        }
        shares->ptr[n + 1] = at;
    }
    return sparse_transpose(shares, &coarse->of_group, error);
}

enum status coarse_space_build(int dim, int64_t node_count, const double *X,
                               const struct neighbours *neighbours, int64_t runs, struct coarse_space *coarse,
                               struct error *error)
{
    FREED_BY(groups_free) struct node_groups groups = {0};
    *coarse = (struct coarse_space){.dim = dim, .node_count = node_count, .X = X};
    if (runs > 0) {
        RETURN_IF_ERROR(group_nodes(dim, node_count, X, neighbours, runs, &groups, error));
        coarse->group_count = groups.count;
        coarse->count = groups.count * (dim + 1);
        RETURN_IF_ERROR(sort_groups(coarse, &groups, error));
        RETURN_IF_ERROR(share_unity(coarse, neighbours, &groups, error));
    }
    return STATUS_OK;
}

void coarse_space_free(struct coarse_space *coarse)
{
    sparse_free(&coarse->shares);
    sparse_free(&coarse->of_group);
    free(coarse->centre);
    *coarse = (struct coarse_space){0};
}

/* amount[(dim + 1) * dim] of group c. The dimension is known when compiling, here and below. */
KERNEL_INLINE void collect(const struct coarse_space *coarse, int dim, int64_t c, const double *v,
                           double *amount)
{
    const struct sparse *of_group = &coarse->of_group;
    double sum[4][3] = {{0.0}}, value[4];
    const double *place = coarse->centre + c * dim;
    for (int64_t i = of_group->ptr[c]; i < of_group->ptr[c + 1]; i++) {
        const double *X = coarse->X + (int64_t)of_group->idx[i] * dim;
        const double *at = v + (int64_t)of_group->idx[i] * dim;
        value[0] = of_group->value[i];
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

ALL_SETS static void collect_group(const struct coarse_space *coarse, int64_t c, const double *v,
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
    for (int64_t c = 0; c < coarse->group_count; c++) {
        collect_group(coarse, c, v, amount + c * numbers);
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
