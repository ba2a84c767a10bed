/* Which boundaries their facets resolve: curves and flat ones, however they lie; not folds and edges. */
#include "unit.h"

#include "solid/contact/contact_rest.h"

enum { FACETS = 12 };

/* A line of facets through X, as boundary averages and quadrature points see it. */
static bool resolves(const double X[2 * (FACETS + 1)])
{
    int32_t node[2 * FACETS], of_average[FACETS + 1];
    double normal[4 * FACETS], position[4 * FACETS], area[2 * FACETS];
    double average_area[FACETS + 1] = {0}, share[4 * FACETS];
    int64_t ptr[FACETS + 2] = {0}, point[4 * FACETS];
    bool resolved = false;
    for (int p = 0; p < 2 * FACETS; p++) {
        const double *a = X + p / 2 * 2;
        double along[2] = {a[2] - a[0], a[3] - a[1]}, length = hypot(along[0], along[1]);
        node[p] = p / 2 + p % 2;
        area[p] = length / 2;
        normal[2 * p] = along[1] / length;
        normal[2 * p + 1] = -along[0] / length;
        for (int c = 0; c < 2; c++) {
            position[2 * p + c] = a[c] + (p % 2 ? .7887 : .2113) * along[c];
        }
    }
    for (int a = 0, s = 0; a <= FACETS; a++) {
        of_average[a] = a;
        for (int p = 2 * a - 2; p < 2 * a + 2; p++) {
            if (p >= 0 && p < 2 * FACETS) {
                point[s] = p;
                share[s++] = .25;
                average_area[a] += area[p] / 2;
            }
        }
        ptr[a + 1] = s;
    }
    struct boundary_averages points = {
        .count = 2 * FACETS, .node = node, .area = area, .normal = normal, .position = position};
    struct boundary_averages averages = {.count = FACETS + 1,
                                         .node = of_average,
                                         .area = average_area,
                                         .sample_ptr = ptr,
                                         .sample_point = point,
                                         .sample_share = share};
    GOOD(contact_rest_resolved(2, &points, &averages, X, &resolved, &error));
    return resolved;
}

/* A circle of unequal facets; a line that is flat but for round-off; a fold in every facet; an edge between
 * flat sides. */
TEST(curves_and_folds)
{
    for (int kind = 0; kind < 4; kind++) {
        double X[2 * (FACETS + 1)];
        for (int n = 0; n <= FACETS; n++) {
            double angle = .15 * n + .05 * (n % 3), along = .1 * n;
            const double place[4][2] = {
                {cos(angle), sin(angle)},
                {along * cos(.3) + 1e-14 * (n % 3), along * sin(.3) - 1e-14 * (n % 2)},
                {along, .02 * (n % 3)},
                {along, .02 * abs(n - FACETS / 2)}};
            memcpy(X + 2 * n, place[kind], sizeof place[kind]);
        }
        assert_true(resolves(X) == (kind < 2));
    }
}

RUN_TESTS(NULL, NULL)
