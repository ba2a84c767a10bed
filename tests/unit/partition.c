/* Cutting a body into parts: owners, balance, and that a part holds all that reaches its own cells. */
#include "approx_fixture.h"

#include "approx/points/cloud.h"
#include "approx/partition/partition.h"
#include "approx/support/support.h"

struct body {
    struct cloud cloud;
    struct cells cells;
    struct cell_stars stars;
    struct point_grid grid;
    double *radius;
    int32_t *work, *owner, *own_cell;
    int64_t *own_ptr;
    struct partition partition;
};

static void body_setup(struct body *body, int dim, double ratio, int32_t parts, double widen)
{
    SCRATCH double *spacing = NULL;
    struct cloud_options wanted = {
        .kind = CLOUD_GRADED, .dim = dim, .count = {16, 7, 6}, .high = {0.2, 0.1, 0.1}, .ratio = ratio};
    struct support_options options = support_defaults(dim);
    *body = (struct body){0};
    GOOD(cloud_make(&wanted, &body->cloud, &error));
    body->cells =
        (struct cells){dim, body->cloud.node_count, body->cloud.x, body->cloud.cell_count, body->cloud.cells};
    int64_t nodes = body->cells.node_count;
    GOOD(NEW_ARRAY(&spacing, nodes, &error));
    GOOD(NEW_ARRAY(&body->radius, nodes, &error));
    GOOD(NEW_ARRAY(&body->owner, nodes, &error));
    GOOD(NEW_ARRAY(&body->work, body->cells.count, &error));
    GOOD(cells_node_spacing(&body->cells, spacing, &error));
    GOOD(support_radii(&options, nodes, spacing, body->radius, &error));
    GOOD(point_grid_build(&body->grid, dim, nodes, body->cells.x, body->radius, &error));
    GOOD(cell_stars_build(&body->cells, &body->stars, &error));
    GOOD(partition_work(&body->cells, &body->grid, body->work, &error));
    GOOD(partition_nodes(&body->cells, &body->stars, body->work, parts, body->owner, &error));
    body->partition =
        (struct partition){&body->cells, &body->stars, &body->grid, parts, body->owner, body->work, widen};
    GOOD(partition_own_cells(&body->partition, &body->own_ptr, &body->own_cell, &error));
}

static void body_teardown(struct body *body)
{
    free(body->radius);
    free(body->work);
    free(body->owner);
    free(body->own_cell);
    free(body->own_ptr);
    cell_stars_free(&body->stars);
    point_grid_free(&body->grid);
    cloud_free(&body->cloud);
}

static bool holds(const int32_t *list, int64_t count, int32_t number)
{
    for (int64_t i = 0; i < count; i++) {
        if (list[i] == number) {
            return true;
        }
    }
    return false;
}

/* A point within a cell, from weights that differ from call to call. */
static void point_in(const struct cells *cells, int64_t cell, uint32_t *state, double x[3])
{
    double weight[4], sum = 0;
    for (int k = 0; k <= cells->dim; k++) {
        *state = *state * 1664525u + 1013904223u;
        weight[k] = *state / 4294967296.0 + 1e-3;
        sum += weight[k];
    }
    for (int a = 0; a < cells->dim; a++) {
        x[a] = 0;
        for (int k = 0; k <= cells->dim; k++) {
            int32_t node = cells->node[cell * (cells->dim + 1) + k];
            x[a] += weight[k] / sum * cells->x[(int64_t)node * cells->dim + a];
        }
    }
}

/* Every node whose support reaches a point of an own cell is there with all of its cells; ascending numbers.
 */
static void check_part(const struct body *body, int32_t part)
{
    FREED_BY(body_part_free) struct body_part got = {0};
    FREED_BY(body_part_work_free) struct body_part_work work = {0};
    const struct cells *cells = &body->cells;
    const int32_t *own = body->own_cell + body->own_ptr[part];
    int64_t own_count = body->own_ptr[part + 1] - body->own_ptr[part];
    uint32_t state = 7;
    GOOD(body_part_build(&body->partition, part, own, own_count, true, &work, &got, &error));
    bool *reached = zeros(cells->node_count, sizeof *reached);
    for (int64_t i = 0; i < own_count; i++) {
        assert_int_equal(partition_cell_owner(cells, own[i], body->owner), part);
        double x[3];
        point_in(cells, own[i], &state, x);
        for (int64_t j = 0; j < cells->node_count; j++) {
            double square = 0;
            for (int a = 0; a < cells->dim; a++) {
                square += pow(cells->x[j * cells->dim + a] - x[a], 2);
            }
            double distance = sqrt(square) / body->radius[j];
            if (distance < body->partition.widen && !holds(got.node, got.node_count, (int32_t)j)) {
                fail_msg("part %d lacks node %d", part, (int)j);
            }
            reached[j] = reached[j] || distance < body->partition.widen;
        }
    }
    for (int64_t j = 0; j < cells->node_count; j++) {
        for (int64_t s = body->stars.ptr[j]; reached[j] && s < body->stars.ptr[j + 1]; s++) {
            assert_true(holds(got.cell, got.cell_count, body->stars.cell[s]));
        }
    }
    for (int64_t i = 1; i < got.node_count; i++) {
        assert_true(got.node[i] > got.node[i - 1]);
    }
    for (int64_t i = 0; i < got.cell_count; i++) {
        assert_true(i == 0 || got.cell[i] > got.cell[i - 1]);
        for (int k = 0; k <= cells->dim; k++) {
            assert_true(
                holds(got.node, got.node_count, cells->node[(int64_t)got.cell[i] * (cells->dim + 1) + k]));
        }
    }
    assert_true(got.needed <= got.node_count - got.own_nodes);
    assert_true(body->partition.parts == 1 ? got.needed == 0 : got.needed > 0);
}

TEST(parts_hold_what_reaches_them)
{
    static const struct {
        int dim;
        double ratio, widen;
        int32_t parts;
    } cases[] = {{2, 1, 1.5, 4}, {2, 5, 1, 7}, {3, 1, 1, 2}, {3, 3, 1.5, 5}, {3, 1, 1.5, 1}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct body body;
        body_setup(&body, cases[i].dim, cases[i].ratio, cases[i].parts, cases[i].widen);
        for (int32_t k = 0; k < cases[i].parts; k++) {
            check_part(&body, k);
        }
        body_teardown(&body);
    }
}

/* Work is shared to a tenth on a graded body, where equal numbers of nodes are not equal work. */
TEST(work_is_balanced)
{
    struct body body;
    double most = 0, sum = 0;
    body_setup(&body, 3, 2, 4, 1);
    for (int32_t k = 0; k < 4; k++) {
        double work = 0;
        for (int64_t i = body.own_ptr[k]; i < body.own_ptr[k + 1]; i++) {
            work += body.work[body.own_cell[i]];
        }
        sum += work;
        most = fmax(most, work);
    }
    assert_true(most < 1.1 * sum / 4);
    body_teardown(&body);
}

TEST(cells_have_one_owner)
{
    const double x[] = {0, 0, 1, 0, 0, 1};
    const int32_t node[] = {0, 1, 2, 1, 2, 0};
    const struct cells cells = {.dim = 2, .node_count = 3, .x = x, .count = 2, .node = node};
    assert_int_equal(partition_cell_owner(&cells, 0, (int32_t[]){4, 2, 2}), 2);
    assert_int_equal(partition_cell_owner(&cells, 0, (int32_t[]){3, 1, 2}), 3);
    assert_int_equal(partition_cell_owner(&cells, 1, (int32_t[]){3, 1, 2}), 1);
}

TEST(too_many_parts)
{
    struct error error;
    struct body body;
    body_setup(&body, 2, 1, 2, 1);
    enum status status = partition_nodes(&body.cells, &body.stars, body.work, 113, body.owner, &error);
    assert_int_equal(status, STATUS_INPUT);
    assert_string_equal(error.text, "113 parts of 112 nodes");
    body_teardown(&body);
}

RUN_TESTS(NULL, NULL)
