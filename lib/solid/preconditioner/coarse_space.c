#include "solid/preconditioner/coarse_space.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/processor.h"
#include "base/queue.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radius of the shares, by the largest distance of a node from its nearest centre: 1.2 to 2.5 give as many
 * steps. */
static const double radius_factor = 1.5;
/* The length of a path is divided by this before it is compared with the Euclidean distance, so that in
 * convex bodies the latter counts. */
static const double most_detour = 2.0;
enum { NODES_FOR_THREAD = 10000 }; /* see chunks_of */

/* length[node_count]: of the shortest paths from a node, from neighbour to neighbour; infinite where there is
 * none. */
static enum status path_lengths(const struct coarse_space *coarse, const struct neighbours *neighbours,
                                int64_t from, struct queue *queue, double *length, struct error *error)
{
    int dim = coarse->dim;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        length[n] = INFINITY;
    }
    length[from] = 0.0;
    RETURN_IF_ERROR(queue_push(queue, 0.0, (int32_t)from, error));
    while (queue->count > 0) {
        struct path_end end = queue_pop(queue);
        int64_t last = end.length > length[end.node] ? 0 : neighbours->ptr[end.node + 1];
        for (int64_t i = neighbours->ptr[end.node]; i < last; i++) {
            int32_t next = neighbours->idx[i];
            double path = end.length + vector_distance(dim, coarse->X + (int64_t)end.node * dim,
                                                       coarse->X + (int64_t)next * dim);
            if (path < length[next]) {
                length[next] = path;
                RETURN_IF_ERROR(queue_push(queue, path, next, error));
            }
        }
    }
    return STATUS_OK;
}

/* The shares of centre c = distances from node `from`, which becomes that centre; length[node_count]:
 * scratch.
 */
static enum status add_centre(struct coarse_space *coarse, const struct neighbours *neighbours, int64_t c,
                              int64_t from, struct queue *queue, double *length, struct error *error)
{
    int dim = coarse->dim;
    const double *place = coarse->X + from * dim;
    for (int a = 0; a < dim; a++) {
        coarse->centre[a][c] = place[a];
    }
    if (neighbours != NULL) {
        RETURN_IF_ERROR(path_lengths(coarse, neighbours, from, queue, length, error));
    }
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double straight = vector_distance(dim, coarse->X + n * dim, place);
        double path = neighbours != NULL ? length[n] / most_detour : 0.0;
        coarse->share[n * coarse->stride + c] = isfinite(path) ? fmax(straight, path) : straight;
    }
    return STATUS_OK;
}

/* Centres: nodes, each the farthest from those before it. Sets the radius; share = distances from the
 * centres, m. */
static enum status pick_centres(struct coarse_space *coarse, const struct neighbours *neighbours,
                                struct error *error)
{
    FREED_BY(queue_free) struct queue queue = {0};
    SCRATCH double *least = NULL, *length = NULL;
    int64_t next = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&length, coarse->node_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&least, coarse->node_count, error));
    for (int64_t n = 0; n < coarse->node_count; n++) {
        least[n] = INFINITY;
    }
    for (int64_t c = 0; c < coarse->centre_count; c++) {
        RETURN_IF_ERROR(add_centre(coarse, neighbours, c, next, &queue, length, error));
        for (int64_t n = 0; n < coarse->node_count; n++) {
            least[n] = fmin(least[n], coarse->share[n * coarse->stride + c]);
        }
        for (int64_t n = 0; n < coarse->node_count; n++) {
            next = least[n] > least[next] ? n : next;
        }
    }
    coarse->radius = radius_factor * least[next];
    return STATUS_OK;
}

/* Quartic spline of a distance. */
static double weight_at(const struct coarse_space *coarse, double distance)
{
    double q = distance / coarse->radius, q2 = q * q;
    return q < 1.0 ? 1.0 + q2 * (-6.0 + q * (8.0 - 3.0 * q)) : 0.0;
}

static void share_unity(struct coarse_space *coarse)
{
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double *share = coarse->share + n * coarse->stride, sum = 0.0;
        for (int64_t c = 0; c < coarse->centre_count; c++) {
            sum += share[c] = weight_at(coarse, share[c]);
        }
        for (int64_t c = 0; c < coarse->centre_count; c++) {
            share[c] /= sum;
        }
    }
}

enum status coarse_space_build(int dim, int64_t node_count, const double *X,
                               const struct neighbours *neighbours, int64_t centre_count,
                               struct coarse_space *coarse, struct error *error)
{
    *coarse = (struct coarse_space){.dim = dim,
                                    .node_count = node_count,
                                    .X = X,
                                    .centre_count = centre_count,
                                    .count = centre_count * (dim + 1),
                                    .stride = (centre_count + COARSE_FOUR - 1) / COARSE_FOUR * COARSE_FOUR};
    if (centre_count > 0) {
        RETURN_IF_ERROR(NEW_ARRAY(&coarse->share, node_count * coarse->stride, error));
        RETURN_IF_ERROR(pick_centres(coarse, neighbours, error));
        share_unity(coarse);
    }
    return STATUS_OK;
}

void coarse_space_free(struct coarse_space *coarse)
{
    free(coarse->share);
    *coarse = (struct coarse_space){0};
}

int coarse_space_at_node(const struct coarse_space *coarse, int64_t node, int field[COARSE_MOST_AT_NODE],
                         double value[COARSE_MOST_AT_NODE])
{
    int dim = coarse->dim, count = 0;
    for (int c = 0; c < coarse->centre_count; c++) {
        double share = coarse->share[node * coarse->stride + c];
        for (int m = 0; m <= dim && share > 0.0; m++, count++) {
            double coordinate =
                m == 0 ? 1.0 : (coarse->X[node * dim + m - 1] - coarse->centre[m - 1][c]) / coarse->radius;
            field[count] = c * (dim + 1) + m;
            value[count] = share * coordinate;
        }
    }
    return count;
}

/* Amounts by monomial and direction: those of the coarse fields of all centres at once. */
typedef of_centres coarse_amounts[4][3];

/* Numbers of four centres, which fit into one register of processors with AVX2: longer vectors would go
 * through memory there. */
typedef double four_centres __attribute__((vector_size(8 * COARSE_FOUR), aligned(8), may_alias));
typedef double two_centres __attribute__((vector_size(16)));

#define FOUR_OF(from) (*(const four_centres *)(from))

/* The coarse fields at a node of four centres, from `first` on, but for the radius. The dimension is known
 * when compiling, here and below. */
KERNEL_INLINE void monomials(const struct coarse_space *coarse, int dim, int first, int64_t node,
                             four_centres value[4])
{
    value[0] = FOUR_OF(coarse->share + node * coarse->stride + first);
    for (int a = 0; a < dim; a++) {
        value[a + 1] = value[0] * (coarse->X[node * dim + a] - FOUR_OF(coarse->centre[a] + first));
    }
}

/* Centres whose amounts are summed at a time, so that partial sums of all chunks fit on small stacks of
 * threads. */
enum { CENTRES_AT_A_TIME = 16 };
typedef double some_amounts[4][3][CENTRES_AT_A_TIME];

/* sum = what v does at the nodes from `begin` to before `end`, along the fields of some centres from
 * `first_centre` on. */
KERNEL_INLINE void collect(const struct coarse_space *coarse, int dim, int64_t begin, int64_t end,
                           int first_centre, const double *v, some_amounts sum)
{
    for (int first = first_centre; first < coarse->centre_count && first < first_centre + CENTRES_AT_A_TIME;
         first += COARSE_FOUR) {
        four_centres all[4][3] = {{{0.0}}}, value[4];
        for (int64_t n = begin; n < end; n++) {
            monomials(coarse, dim, first, n, value);
            for (int a = 0; a < dim; a++) {
                for (int m = 0; m <= dim; m++) {
                    all[m][a] += value[m] * v[n * dim + a];
                }
            }
        }
        for (int i = 0; i < (dim + 1) * dim; i++) {
            memcpy(sum[i / dim][i % dim] + first - first_centre, &all[i / dim][i % dim], sizeof all[0][0]);
        }
    }
}

/* By halves: in a fixed order, which costs few instructions. */
KERNEL_INLINE double total(const four_centres *value)
{
    four_centres all = *value;
    two_centres half = __builtin_shufflevector(all, all, 0, 1) + __builtin_shufflevector(all, all, 2, 3);
    return half[0] + half[1];
}

/* u += amount there. */
KERNEL_INLINE void add(const struct coarse_space *coarse, int dim, int64_t begin, int64_t end,
                       const coarse_amounts amount, double *u)
{
    for (int64_t n = begin; n < end; n++) {
        four_centres sum[3] = {{0.0}}, value[4];
        for (int first = 0; first < coarse->centre_count; first += COARSE_FOUR) {
            monomials(coarse, dim, first, n, value);
            for (int a = 0; a < dim; a++) {
                four_centres part = value[0] * FOUR_OF(amount[0][a] + first);
                for (int m = 1; m <= dim; m++) {
                    part += value[m] * FOUR_OF(amount[m][a] + first);
                }
                sum[a] += part;
            }
        }
        for (int a = 0; a < dim; a++) {
            u[n * dim + a] += total(&sum[a]);
        }
    }
}

ALL_SETS static void collect_nodes(const struct coarse_space *coarse, int64_t begin, int64_t end,
                                   int first_centre, const double *v, some_amounts sum)
{
    if (coarse->dim == 2) {
        collect(coarse, 2, begin, end, first_centre, v, sum);
    } else {
        collect(coarse, 3, begin, end, first_centre, v, sum);
    }
}

ALL_SETS static void add_nodes(const struct coarse_space *coarse, int64_t begin, int64_t end,
                               const coarse_amounts amount, double *u)
{
    if (coarse->dim == 2) {
        add(coarse, 2, begin, end, amount, u);
    } else {
        add(coarse, 3, begin, end, amount, u);
    }
}

/* The amounts of some centres from `first` on. */
static void restrict_to(const struct coarse_space *coarse, int first, const double *v, double *amount)
{
    struct chunks chunks = chunks_of(coarse->node_count, NODES_FOR_THREAD);
    int dim = coarse->dim;
    some_amounts partial[CHUNKS_MOST];
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        collect_nodes(coarse, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1), first, v, partial[c]);
    }
    for (int i = 0; i < (dim + 1) * dim; i++) {
        int m = i / dim, a = i % dim;
        for (int64_t c = first; c < coarse->centre_count && c < first + CENTRES_AT_A_TIME; c++) {
            double sum = partial[0][m][a][c - first];
            for (int64_t k = 1; k < chunks.count; k++) {
                sum += partial[k][m][a][c - first];
            }
            amount[(c * (dim + 1) + m) * dim + a] = m == 0 ? sum : sum / coarse->radius;
        }
    }
}

void coarse_space_restrict(const struct coarse_space *coarse, const double *v, double *amount)
{
    for (int first = 0; first < coarse->centre_count; first += CENTRES_AT_A_TIME) {
        restrict_to(coarse, first, v, amount);
    }
}

void coarse_space_prolongate(const struct coarse_space *coarse, const double *amount, double *u)
{
    struct chunks chunks = chunks_of(coarse->node_count, NODES_FOR_THREAD);
    int dim = coarse->dim;
    coarse_amounts sorted = {{{0.0}}};
    for (int m = 0; m <= dim; m++) {
        for (int a = 0; a < dim; a++) {
            for (int64_t c = 0; c < coarse->centre_count; c++) {
                double part = amount[(c * (dim + 1) + m) * dim + a];
                sorted[m][a][c] = m == 0 ? part : part / coarse->radius;
            }
        }
    }
#pragma omp parallel for schedule(static) num_threads(chunks.threads)
    for (int64_t c = 0; c < chunks.count; c++) {
        add_nodes(coarse, chunks_begin(&chunks, c), chunks_begin(&chunks, c + 1),
                  (const of_centres(*)[3])sorted, u);
    }
}
