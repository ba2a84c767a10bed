/* Boundary averages: sums, linear fields, boundary averages split where the boundary turns, areas, the
 * divergence theorem against the cells' table, and facets that are none. */
#include "body_fixture.h"
#include "approx/cells/quadrature.h"
#include "base/vector.h"

static struct boundary_averages averages_of(const struct sample *sample, struct facet_set set)
{
    struct boundary_averages averages;
    struct face_table table = sample_face_table(sample);
    GOOD(boundary_averages_build(&table, &set, &averages, &error));
    return averages;
}

/* How many sides of the box a node lies on. */
static int sides_at(const struct sample *sample, int32_t node)
{
    int count = 0;
    for (int a = 0; a < sample->dim; a++) {
        double x = sample->cloud.x[(int64_t)node * sample->dim + a];
        count += fabs(x) < 1e-12 || fabs(x - sample_size) < 1e-12;
    }
    return count;
}

/* Weights sum to 1, samples too, both at `position`; areas and outward normals sum to those of the sides. */
static void check_averages(const struct sample *sample, const struct boundary_averages *averages)
{
    int dim = sample->dim;
    for (int64_t a = 0; a < averages->count; a++) {
        double sum = 0.0, mean[3] = {0.0}, share = 0.0, sampled[3] = {0.0}, length2 = 0.0;
        for (int64_t i = averages->ptr[a]; i < averages->ptr[a + 1]; i++) {
            sum += averages->phi[i];
            assert_true(i == averages->ptr[a] || averages->idx[i - 1] < averages->idx[i]);
            add_scaled(dim, averages->phi[i], sample->cloud.x + (int64_t)averages->idx[i] * dim, mean);
        }
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            share += averages->sample_share[s];
            assert_true(averages->sample_share[s] > 0.0);
            add_scaled(dim, averages->sample_share[s], averages->sample_x + s * dim, sampled);
        }
        NEAR_TO(sum, 1.0, 1e-12);
        NEAR_TO(share, 1.0, 1e-14);
        for (int c = 0; c < dim; c++) {
            NEAR_TO(mean[c], averages->position[a * dim + c], 1e-12 * sample_size);
            NEAR_TO(sampled[c], averages->position[a * dim + c], 1e-14 * sample_size);
            length2 += averages->normal[a * dim + c] * averages->normal[a * dim + c];
        }
        NEAR_TO(length2, 1.0, 1e-14);
        assert_true(averages->area[a] > 0.0);
        assert_true(a == 0 || averages->node[a - 1] <= averages->node[a]);
    }
}

/* The whole boundary in one set: a boundary average for each side that meets at a node. */
TEST_IN_EACH_DIM(averages_split_at_corners)
{
    for (int smoothed = 0; smoothed < 2; smoothed++) {
        FREED_BY(sample_free)
        struct sample sample = make_wide_sample(dim, smoothed == 1, dim == 2 ? 6 : 5, 2.6);
        FREED_BY(boundary_averages_free)
        struct boundary_averages averages = averages_of(&sample, facets_of_side(&sample, -1));
        int64_t expected = 0, longest = 0;
        double area = 0.0, outward[3] = {0.0};
        check_averages(&sample, &averages);
        for (int32_t n = 0; n < sample.cloud.node_count; n++) {
            int sides = sides_at(&sample, n); /* averages are in the order of their nodes */
            for (int64_t a = expected; a < expected + sides; a++) {
                assert_int_equal(averages.node[a], n);
            }
            expected += sides;
        }
        assert_int_equal(averages.count, expected);
        for (int64_t a = 0; a < averages.count; a++) {
            int aligned = 0;
            longest = averages.ptr[a + 1] - averages.ptr[a] > longest ? averages.ptr[a + 1] - averages.ptr[a]
                                                                      : longest;
            area += averages.area[a];
            for (int c = 0; c < dim; c++) {
                double n = averages.normal[a * dim + c], x = averages.position[a * dim + c];
                outward[c] += averages.area[a] * n;
                aligned += fabs(fabs(n) - 1.0) < 1e-14;
                if (fabs(n) > 0.5) {
                    NEAR_TO(x, n > 0.0 ? sample_size : 0.0, 1e-14);
                }
            }
            assert_int_equal(aligned, 1); /* no part mixes two sides */
        }
        assert_true(dim == 2 || longest > 64); /* so that its row has grown */
        NEAR_TO(area, 2.0 * dim * pow(sample_size, dim - 1), 1e-14);
        ALL_NEAR(dim, outward, NULL, 1e-14);
    }
}

/* The mean gradient of any field over the body is its boundary's: for every node j,
 * sum_cells V dphi_j = sum_averages A Phi_j n, to round-off, since cells and boundary averages share their
 * quadrature. */
TEST_IN_EACH_DIM(divergence_theorem)
{
    FREED_BY(sample_free) struct sample sample = make_sample(dim, true, dim == 2 ? 7 : 4);
    FREED_BY(boundary_averages_free)
    struct boundary_averages averages = averages_of(&sample, facets_of_side(&sample, -1));
    int64_t count = sample.cloud.node_count * dim;
    double *inside = zeros(count, sizeof *inside), *outside = zeros(count, sizeof *outside);
    double largest = 0.0;
    for (int64_t q = 0; q < sample.assembly.point_count; q++) {
        for (int64_t i = sample.lists.ptr[q]; i < sample.lists.ptr[q + 1]; i++) {
            for (int c = 0; c < dim; c++) {
                inside[(int64_t)sample.lists.idx[i] * dim + c] +=
                    sample.assembly.weight[q] * sample.dphi[i * dim + c];
            }
        }
    }
    for (int64_t a = 0; a < averages.count; a++) {
        for (int64_t i = averages.ptr[a]; i < averages.ptr[a + 1]; i++) {
            for (int c = 0; c < dim; c++) {
                outside[(int64_t)averages.idx[i] * dim + c] +=
                    averages.area[a] * averages.phi[i] * averages.normal[a * dim + c];
            }
        }
    }
    for (int64_t i = 0; i < count; i++) {
        largest = fmax(largest, fabs(outside[i]));
        NEAR_TO(inside[i], outside[i], 1e-13 * pow(sample_size, dim - 1));
    }
    assert_true(largest > 0.01 * pow(sample_size, dim - 1));
}

/* In 3D two facets that touch at one node only do not share its boundary average. */
TEST(touching_facets)
{
    FREED_BY(sample_free) struct sample sample = make_sample(3, true, 4);
    struct facet_set side = facets_of_side(&sample, 0);
    int pairs[4] = {0};
    for (int64_t f = 1; f < side.count; f++) {
        int32_t facets[6];
        int shared = 0;
        memcpy(facets, side.facet, 3 * sizeof *facets);
        memcpy(facets + 3, side.facet + 3 * f, 3 * sizeof *facets);
        for (int i = 0; i < 9; i++) {
            shared += facets[i / 3] == facets[3 + i % 3];
        }
        FREED_BY(boundary_averages_free)
        struct boundary_averages averages = averages_of(&sample, (struct facet_set){2, facets});
        assert_int_equal(averages.count, shared == 2 ? 4 : 6);
        pairs[shared]++;
    }
    assert_true(pairs[0] > 0 && pairs[1] > 0 && pairs[2] > 0);
}

/* Boundary averages stay whole on a curve that turns gently. */
TEST(gentle_and_sharp_turns)
{
    /* A fan of triangles about node 0; the outer nodes lie on a polygon. */
    enum { MOST = 24 };
    for (int corners = 4; corners <= MOST; corners += 4) {
        double x[2 * (MOST + 1)] = {0.0}, phi[4 * MOST], widen[2 * MOST];
        int32_t cells[3 * MOST], facets[2 * MOST], idx[4 * MOST];
        int64_t ptr[2 * MOST + 1] = {0};
        FREED_BY(faces_free) struct faces faces = {0};
        FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
        for (int i = 0; i < corners; i++) {
            x[2 * (i + 1)] = cos(2.0 * M_PI * i / corners);
            x[2 * (i + 1) + 1] = sin(2.0 * M_PI * i / corners);
            facets[2 * i] = cells[3 * i + 1] = i + 1;
            facets[2 * i + 1] = cells[3 * i + 2] = (i + 1) % corners + 1;
            cells[3 * i] = 0;
        }
        struct cells view = {2, corners + 1, x, corners, cells};
        GOOD(faces_build(&view, true, &faces, &error));
        assert_int_equal(faces.count, corners);
        struct quadrature_rule rule = quadrature_face_rule(2);
        for (int64_t p = 0; p < faces.count * 2; p++) { /* linear fields along each edge */
            ptr[p + 1] = 2 * (p + 1);
            widen[p] = 1.0;
            for (int k = 0; k < 2; k++) {
                idx[2 * p + k] = faces.node[p / 2 * 2 + k];
                phi[2 * p + k] = rule.barycentric[p % 2 * 2 + k];
            }
        }
        struct neighbours lists = {.count = faces.count * 2, .ptr = ptr, .idx = idx, .widen = widen};
        struct face_table table = {2, corners + 1, x, &faces, 2, &lists, phi, NULL};
        struct facet_set set = {corners, facets};
        GOOD(boundary_averages_build(&table, &set, &averages, &error));
        assert_int_equal(averages.count,
                         corners < 12 ? 2 * corners : corners); /* turns of 90, 45, 30 degrees */
        for (int64_t a = 0; a < averages.count && corners >= 12; a++) {
            int32_t node = averages.node[a];
            double weight[3] = {0.0}, chord = 2.0 * sin(M_PI / corners);
            for (int64_t i = averages.ptr[a]; i < averages.ptr[a + 1]; i++) {
                weight[averages.idx[i] == node ? 1 : 2 * (averages.idx[i] == node % corners + 1)] =
                    averages.phi[i];
            }
            NEAR_TO(weight[0], 1.0 / 6.0, 1e-14); /* integrals of products of hat functions */
            NEAR_TO(weight[1], 2.0 / 3.0, 1e-14);
            NEAR_TO(weight[2], 1.0 / 6.0, 1e-14);
            NEAR_TO(averages.area[a], chord, 1e-14);
            NEAR_TO(averages.normal[2 * a], x[2 * node], 1e-14);
            NEAR_TO(averages.normal[2 * a + 1], x[2 * node + 1], 1e-14);
        }
    }
}

/* Boundary averages that are not split, and the mean over each side of the box: the boundary averages of a
 * side, split there, make its mean. Of split boundary averages the groups are the sides. */
TEST_IN_EACH_DIM(whole_sides)
{
    FREED_BY(sample_free) struct sample sample = make_sample(dim, true, 5);
    struct face_table table = sample_face_table(&sample);
    struct facet_set set = facets_of_side(&sample, -1);
    for (int split = 0; split < 2; split++) {
        FREED_BY(boundary_averages_free) struct boundary_averages averages = {0};
        FREED_BY(boundary_sides_free) struct boundary_sides sides = {0};
        int64_t nodes = 0, parts = 0;
        double whole = pow(sample_size, dim - 1);
        GOOD(boundary_sides_build(&table, &set, split == 1, &averages, &sides, &error));
        for (int32_t n = 0; n < sample.cloud.node_count; n++) {
            nodes += sides_at(&sample, n) > 0;
            parts += sides_at(&sample, n);
        }
        assert_int_equal(sides.node_average_count, split == 1 ? parts : nodes);
        assert_int_equal(averages.count, sides.node_average_count + 2 * dim);
        assert_int_equal(sides.group_count, split == 1 ? 2 * dim : 1);
        for (int64_t a = 0; a < averages.count; a++) {
            bool is_side = a >= sides.node_average_count;
            double extent = 0.0;
            assert_int_equal(sides.flat[a],
                             is_side || split == 1 || sides_at(&sample, averages.node[a]) == 1);
            for (int c = 0; c < dim; c++) {
                double along = fabs(averages.normal[a * dim + c]);
                extent = along > extent ? along : extent;
                if (is_side && along < 0.5) {
                    NEAR_TO(averages.position[a * dim + c], 0.5 * sample_size, 1e-14);
                }
            }
            if (is_side) {
                NEAR_TO(averages.area[a], whole, 1e-12 * whole);
                NEAR_TO(extent, 1.0, 1e-12);
            }
        }
        for (int64_t s = sides.node_average_count; s < averages.count && split == 1; s++) {
            double area = 0.0;
            for (int64_t a = 0; a < sides.node_average_count; a++) {
                area += sides.group[a] == sides.group[s] ? averages.area[a] : 0.0;
            }
            NEAR_TO(area, whole, 1e-12 * whole);
        }
    }
}

/* held[faces]: the boundary on the side x = 0 below y = limit; all of it for an infinite limit. */
static void hold(const struct sample *sample, double limit, bool *held)
{
    int dim = sample->dim;
    for (int64_t f = 0; f < sample->assembly.faces.count; f++) {
        held[f] = sample->assembly.faces.cell[2 * f + 1] < 0;
        for (int k = 0; k < dim && isfinite(limit); k++) {
            const double *x = sample->cloud.x + (int64_t)sample->assembly.faces.node[f * dim + k] * dim;
            held[f] = held[f] && fabs(x[0]) < 1e-12 && x[1] < limit;
        }
    }
}

/* A side that is held in part ends where the held faces do; at the edges of the box, where the boundary
 * turns, and within a boundary that is held altogether nothing ends. The edges of the side are sharp ends,
 * unless what is beyond them is held as well. */
TEST_IN_EACH_DIM(ends)
{
    static const double whole[3] = {0.0, 1.0, INFINITY};
    FREED_BY(sample_free) struct sample sample = make_sample(dim, true, 5);
    struct face_table table = sample_face_table(&sample);
    bool *held = zeros(sample.assembly.faces.count, sizeof *held);
    bool *touched = zeros(sample.assembly.faces.count, sizeof *touched);
    bool *end = zeros(sample.cloud.node_count, sizeof *end);
    for (int i = 0; i < 3; i++) {
        hold(&sample, whole[i], held);
        GOOD(boundary_find_junctions(&table, BOUNDARY_JUNCTION_SMOOTH, held, held, end, &error));
    }
    hold(&sample, whole[1], held);
    hold(&sample, whole[2], touched);
    GOOD(boundary_find_junctions(&table, BOUNDARY_JUNCTION_SHARP, held, touched, end, &error));
    for (int64_t n = 0; n < sample.cloud.node_count; n++) {
        assert_false(end[n]);
    }
    GOOD(boundary_find_junctions(&table, BOUNDARY_JUNCTION_SHARP, held, held, end, &error));
    for (int64_t n = 0; n < sample.cloud.node_count; n++) {
        const double *x = sample.cloud.x + n * dim;
        assert_int_equal(end[n], fabs(x[0]) < 1e-12 && sides_at(&sample, (int32_t)n) > 1);
    }
    memset(end, 0, (size_t)sample.cloud.node_count * sizeof *end);
    hold(&sample, 0.6 * sample_size, held);
    GOOD(boundary_find_junctions(&table, BOUNDARY_JUNCTION_SMOOTH, held, held, end, &error));
    int64_t count = 0;
    for (int64_t n = 0; n < sample.cloud.node_count; n++) {
        const double *x = sample.cloud.x + n * dim;
        count += end[n];
        assert_true(!end[n] || (fabs(x[0]) < 1e-12 && x[1] > 0.3 * sample_size && x[1] < 0.6 * sample_size));
    }
    assert_int_equal(count, dim == 2 ? 1 : 5);
}

/* A box without its corner beyond the middle of the first two axes: of all its edges (2D: corners) only that
 * in the middle is re-entrant. */
TEST_IN_EACH_DIM(reentrant)
{
    struct cloud_options options = {
        .kind = CLOUD_JITTERED, .dim = dim, .count = {5, 5, 3}, .high = {1.0, 1.0, 1.0}, .seed = 1};
    FREED_BY(cloud_free) struct cloud cloud = {0};
    GOOD(cloud_make(&options, &cloud, &error));
    SCRATCH int32_t *kept = calloc((size_t)(cloud.cell_count * (dim + 1)), sizeof *kept);
    struct cells cells = {dim, cloud.node_count, cloud.x, 0, kept};
    for (int64_t c = 0; c < cloud.cell_count; c++) {
        double centre[3];
        vector_middle(dim, cloud.x, dim + 1, cloud.cells + c * (dim + 1), centre);
        if (centre[0] < 0.5 || centre[1] < 0.5) {
            memcpy(kept + cells.count++ * (dim + 1), cloud.cells + c * (dim + 1),
                   (size_t)(dim + 1) * sizeof *kept);
        }
    }
    FREED_BY(faces_free) struct faces faces = {0};
    GOOD(faces_build(&cells, true, &faces, &error));
    struct face_table table = {.dim = dim, .node_count = cloud.node_count, .x = cloud.x, .faces = &faces};
    bool *none = zeros(faces.count, sizeof *none), *edge = zeros(cloud.node_count, sizeof *edge);
    GOOD(boundary_find_junctions(&table, BOUNDARY_REENTRANT, none, none, edge, &error));
    for (int64_t n = 0; n < cloud.node_count; n++) {
        const double *x = cloud.x + n * dim;
        assert_true(edge[n] == (fabs(x[0] - 0.5) < 1e-9 && fabs(x[1] - 0.5) < 1e-9));
    }
}

/* The tip of a slit whose faces lie on each other; its mouth is not re-entrant. */
TEST(closed_slit)
{
    static const double x[] = {0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0, 0.5, 0.5, 1.0, 0.5, 1.0, 0.5};
    static const int32_t node[] = {0, 1, 4, 1, 5, 4, 6, 2, 4, 2, 3, 4, 3, 0, 4};
    struct cells cells = {2, 7, x, 5, node};
    FREED_BY(faces_free) struct faces faces = {0};
    GOOD(faces_build(&cells, true, &faces, &error));
    struct face_table table = {.dim = 2, .node_count = 7, .x = x, .faces = &faces};
    bool none[7] = {false}, edge[7] = {false};
    GOOD(boundary_find_junctions(&table, BOUNDARY_REENTRANT, none, none, edge, &error));
    for (int n = 0; n < 7; n++) {
        assert_true(edge[n] == (n == 4));
    }
}

TEST_IN_EACH_DIM(faults)
{
    FREED_BY(sample_free) struct sample sample = make_sample(dim, true, 4);
    struct face_table table = sample_face_table(&sample);
    struct boundary_averages averages;
    int32_t facets[6];
    struct facet_set set = {2, facets};
    memcpy(facets, sample.cloud.facets, (size_t)dim * sizeof *facets);
    /* A face between two cells. */
    int64_t inner = 0;
    while (sample.assembly.faces.cell[2 * inner + 1] < 0) {
        inner++;
    }
    memcpy(facets + dim, sample.assembly.faces.node + inner * dim, (size_t)dim * sizeof *facets);
    FAILS_WITH(boundary_averages_build(&table, &set, &averages, &error), STATUS_INPUT,
               "facets: row 1 of the set is no boundary face of the cells");
    boundary_averages_free(&averages);
    facets[dim] = (int32_t)sample.cloud.node_count;
    FAILS_WITH(boundary_averages_build(&table, &set, &averages, &error), STATUS_INPUT,
               dim == 2 ? "facets: no node 16" : "facets: no node 64");
    boundary_averages_free(&averages);
    facets[dim] = -1;
    FAILS_WITH(boundary_averages_build(&table, &set, &averages, &error), STATUS_INPUT, "facets: no node -1");
    boundary_averages_free(&averages);
}

RUN_TESTS(NULL, NULL)
