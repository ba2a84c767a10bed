/* Smooth fields on a cloud: they share unity and hold linear fields; Z and its transpose agree, with plain
 * sums and with themselves, whatever the threads. */
#include "unit.h"

#include "approx/cells/cells.h"
#include "base/vector.h"
#include "solid/preconditioner/coarse_space.h"

enum { NODES = 34000 }; /* worth three threads */
enum { MOST_GROUPS = 64 };

struct cloud {
    struct coarse_space coarse;
    struct neighbours neighbours;
    double *X, *v, *amount; /* v: vectors at nodes, amount: of the coarse fields, both without pattern */
    int64_t size;           /* of v */
};

static double *numbers(int64_t count, double low, double high, struct random *random)
{
    double *array = zeros(count, sizeof *array);
    for (int64_t i = 0; i < count; i++) {
        array[i] = uniform(random, low, high);
    }
    return array;
}

/* Itself and the three nodes before and behind each on the Morton curve. */
static struct neighbours list_neighbours(int dim, int64_t nodes, const double *X)
{
    int64_t *order = zeros(nodes, sizeof *order), *place = zeros(nodes, sizeof *place), count = 0;
    int64_t *ptr = zeros(nodes + 1, sizeof *ptr);
    int32_t *idx = zeros(7 * nodes, sizeof *idx);
    GOOD(renumber_morton(dim, nodes, X, NULL, order, &error));
    for (int64_t i = 0; i < nodes; i++) {
        place[order[i]] = i;
    }
    for (int64_t n = 0; n < nodes; n++) {
        for (int64_t i = place[n] - 3; i <= place[n] + 3; i++) {
            if (i >= 0 && i < nodes) {
                idx[count++] = (int32_t)order[i];
            }
        }
        ptr[n + 1] = count;
    }
    return (struct neighbours){.count = nodes, .ptr = ptr, .idx = idx};
}

static struct cloud make_cloud(int dim, int64_t node_count, int64_t group_count)
{
    struct cloud cloud = {.size = node_count * dim};
    struct random random = {(uint64_t)(17 * dim + group_count)};
    cloud.X = numbers(cloud.size, -0.1, 0.1, &random);
    for (int64_t n = 0; n < node_count; n++) {
        cloud.X[n * dim] += 5.0 * cloud.X[n * dim + 1]; /* slender, so that some shares vanish */
    }
    cloud.neighbours = list_neighbours(dim, node_count, cloud.X);
    GOOD(coarse_space_build(dim, node_count, cloud.X, &cloud.neighbours, group_count, &cloud.coarse, &error));
    assert_int_equal(cloud.coarse.count, group_count * (dim + 1));
    cloud.v = numbers(cloud.size, -1.0, 1.0, &random);
    cloud.amount = numbers(cloud.coarse.count * dim, -1.0, 1.0, &random);
    return cloud;
}

static void release(struct cloud *cloud)
{
    coarse_space_free(&cloud->coarse);
}

/* What coarse_space_restrict and coarse_space_prolongate say, by plain sums. */
static void sum_plainly(const struct cloud *cloud, double *amount, double *u)
{
    const struct coarse_space *coarse = &cloud->coarse;
    int dim = coarse->dim;
    double value[4];
    for (int64_t n = 0; n < coarse->node_count; n++) {
        for (int64_t i = coarse->shares.ptr[n]; i < coarse->shares.ptr[n + 1]; i++) {
            int32_t group = coarse->shares.idx[i];
            coarse_space_values(coarse, n, group, coarse->shares.value[i], value);
            for (int64_t k = 0; k < (dim + 1) * dim; k++) {
                int64_t at = group * (dim + 1) * dim + k;
                amount[at] += value[k / dim] * cloud->v[n * dim + k % dim];
                u[n * dim + k % dim] += value[k / dim] * cloud->amount[at];
            }
        }
    }
}

TEST_IN_EACH_DIM(plain_sums)
{
    for (int64_t groups = 1; groups <= MOST_GROUPS; groups += 7) {
        FREED_BY(release) struct cloud cloud = make_cloud(dim, NODES, groups);
        int64_t size = cloud.coarse.count * dim;
        double *amount = zeros(size, sizeof *amount), *expected = zeros(size, sizeof *expected);
        double *u = zeros(cloud.size, sizeof *u), *field = zeros(cloud.size, sizeof *field);
        sum_plainly(&cloud, expected, field);
        coarse_space_restrict(&cloud.coarse, cloud.v, amount);
        coarse_space_prolongate(&cloud.coarse, cloud.amount, u);
        ALL_NEAR(size, amount, expected, 1e-12 * NODES);
        ALL_NEAR(cloud.size, u, field, 1e-13);
    }
}

/* The same bits for 1, 2 and 3 threads. */
TEST_IN_EACH_DIM(same_bits)
{
    int before = omp_get_max_threads();
    FREED_BY(release) struct cloud cloud = make_cloud(dim, NODES, MOST_GROUPS);
    int64_t size = cloud.coarse.count * dim;
    double *amounts[3], *u[3];
    for (int i = 0; i < 3; i++) {
        amounts[i] = zeros(size, sizeof **amounts);
        u[i] = zeros(cloud.size, sizeof **u);
        omp_set_num_threads(i + 1);
        coarse_space_restrict(&cloud.coarse, cloud.v, amounts[i]);
        coarse_space_prolongate(&cloud.coarse, cloud.amount, u[i]);
        assert_memory_equal(amounts[0], amounts[i], (size_t)size * sizeof **amounts);
        assert_memory_equal(u[0], u[i], (size_t)cloud.size * sizeof **u);
    }
    omp_set_num_threads(before);
}

/* The shares of all groups make the constant field, and with the places of the groups the coordinates. */
TEST_IN_EACH_DIM(linear_fields)
{
    FREED_BY(release) struct cloud cloud = make_cloud(dim, 500, 6);
    const struct coarse_space *coarse = &cloud.coarse;
    double *u = zeros(cloud.size, sizeof *u);
    memset(cloud.amount, 0, (size_t)(coarse->count * dim) * sizeof *cloud.amount);
    for (int c = 0; c < coarse->group_count; c++) {
        for (int a = 0; a < dim; a++) {
            int64_t first = (int64_t)c * (dim + 1);
            cloud.amount[first * dim + a] = 1.0 + coarse->centre[c * dim + a];
            cloud.amount[(first + 1 + a) * dim + a] = coarse->radius;
        }
    }
    coarse_space_prolongate(coarse, cloud.amount, u);
    for (int64_t i = 0; i < cloud.size; i++) {
        NEAR_TO(u[i], 1.0 + cloud.X[i], 1e-14);
    }
}

static double share_at(const struct coarse_space *coarse, int64_t node, int32_t group)
{
    double share = 0.0;
    for (int64_t i = coarse->shares.ptr[node]; i < coarse->shares.ptr[node + 1]; i++) {
        share += coarse->shares.idx[i] == group ? coarse->shares.value[i] : 0.0;
    }
    return share;
}

/* A node has shares of the groups of its neighbours only, however many there are, which sum to one. */
TEST(shares_are_few)
{
    FREED_BY(release) struct cloud cloud = make_cloud(3, 20000, 400);
    const struct coarse_space *coarse = &cloud.coarse;
    for (int64_t n = 0; n < coarse->node_count; n++) {
        double sum = 0.0;
        AT_MOST((double)(coarse->shares.ptr[n + 1] - coarse->shares.ptr[n]), 2.0);
        for (int64_t i = coarse->shares.ptr[n]; i < coarse->shares.ptr[n + 1]; i++) {
            const double *centre = coarse->centre + (int64_t)coarse->shares.idx[i] * 3;
            AT_MOST(vector_distance(3, coarse->X + n * 3, centre), coarse->radius);
            AT_MOST(0.0, coarse->shares.value[i]);
            sum += coarse->shares.value[i];
        }
        NEAR_TO(sum, 1.0, 1e-14);
    }
}

/* A ring of nodes with a slit, each with its neighbours, and `alone` nodes behind it without any. */
static void make_ring(int64_t ring, int64_t alone, double *X, int64_t *ptr, int32_t *idx)
{
    int64_t count = 0;
    for (int64_t n = 0; n < ring + alone; n++) {
        double angle = 6.28 * (double)n / (double)ring;
        X[2 * n] = n < ring ? cos(angle) : 2.0 + 0.1 * (double)(n - ring);
        X[2 * n + 1] = n < ring ? sin(angle) : 0.0;
        ptr[n] = count;
        for (int64_t next = n - 2; next <= n + 2 && n < ring; next++) {
            if (next >= 0 && next < ring) {
                idx[count++] = (int32_t)next;
            }
        }
    }
    ptr[ring + alone] = count;
}

/* What one end of a ring with a slit feels the other does not, though they are one run of the curve. Nodes
 * that are too few for a group have no shares. */
TEST(slit)
{
    enum { RING = 200, ALONE = 5, ALL = RING + ALONE };
    double X[2 * ALL];
    int64_t ptr[ALL + 1];
    int32_t idx[5 * ALL];
    struct neighbours neighbours = {.count = ALL, .ptr = ptr, .idx = idx};
    make_ring(RING, ALONE, X, ptr, idx);
    for (int64_t runs = 1; runs <= 8; runs++) {
        FREED_BY(coarse_space_free) struct coarse_space coarse = {0};
        GOOD(coarse_space_build(2, ALL, X, &neighbours, runs, &coarse, &error));
        assert_true(coarse.group_count >= runs - 1 && coarse.group_count <= 2 * runs);
        for (int64_t n = 0; n < ALL; n++) {
            double sum = 0.0;
            for (int c = 0; c < coarse.group_count; c++) {
                sum += share_at(&coarse, n, c);
                assert_true(runs == 1 || share_at(&coarse, 0, c) * share_at(&coarse, RING - 1, c) == 0.0);
            }
            NEAR_TO(sum, n < RING ? 1.0 : 0.0, 1e-14);
        }
    }
}

/* Nodes on a line, of which each has only the one before as neighbour, as at interfaces: they are connected.
 */
TEST(neighbours_in_one_direction)
{
    enum { ALL = 50 };
    double X[2 * ALL] = {0.0};
    int64_t ptr[ALL + 1] = {0};
    int32_t idx[2 * ALL];
    struct neighbours neighbours = {.count = ALL, .ptr = ptr, .idx = idx};
    for (int n = 0; n < ALL; n++) {
        X[2 * n] = 0.1 * n;
        idx[2 * n] = n;
        idx[2 * n + 1] = n > 0 ? n - 1 : 0;
        ptr[n + 1] = 2 * (n + 1);
    }
    for (int runs = 1; runs < 8; runs += 3) {
        FREED_BY(coarse_space_free) struct coarse_space coarse = {0};
        GOOD(coarse_space_build(2, ALL, X, &neighbours, runs, &coarse, &error));
        assert_int_equal(coarse.group_count, runs);
        for (int64_t n = 0; n < ALL; n++) {
            double sum = 0.0;
            for (int c = 0; c < runs; c++) {
                sum += share_at(&coarse, n, c);
            }
            NEAR_TO(sum, 1.0, 1e-14);
        }
    }
}

RUN_TESTS(NULL, NULL)
