/* Poor cells, merged with a neighbour: nothing grows as they become flat, linear fields stay exact, and there
 * is an energy. */
#include "body_setup.h"

#include "approx/cells/quality.h"
#include "solid/body/merged_cells.h"

/* Height of vertex k of a cell above the opposite face, and that face's unit normal, toward the vertex. */
static double height_of(const struct cells *cells, int64_t cell, int k, double normal[3])
{
    int dim = cells->dim;
    int32_t face[3] = {0}, vertex = cells->node[cell * (dim + 1) + k];
    double length = 0.0, height = 0.0;
    for (int i = 0; i < dim; i++) {
        face[i] = cells->node[cell * (dim + 1) + (k + 1 + i) % (dim + 1)];
    }
    face_area_vector(dim, cells->x, face, normal);
    for (int a = 0; a < dim; a++) {
        length += normal[a] * normal[a];
        height += normal[a] * (cells->x[(int64_t)vertex * dim + a] - cells->x[(int64_t)face[0] * dim + a]);
    }
    for (int a = 0; a < dim; a++) {
        normal[a] *= copysign(1.0 / sqrt(length), height);
    }
    return fabs(height) / sqrt(length);
}

static bool has_node(const struct cells *cells, int64_t cell, int32_t node)
{
    int corners = cells->dim + 1;
    for (int k = 0; k < corners; k++) {
        if (cells->node[cell * corners + k] == node) {
            return true;
        }
    }
    return false;
}

/* Move a node within the body so far toward the opposite face of a cell that this is nearly flat, if that
 * leaves no other cell poor. Whether it does. */
static bool flatten(const struct cells *cells, int64_t cell, int k, double thickness, double *x)
{
    int dim = cells->dim;
    double normal[3], height = height_of(cells, cell, k, normal), worst = 1.0;
    double *place = x + (int64_t)cells->node[cell * (dim + 1) + k] * dim, before[3];
    for (int a = 0; a < dim; a++) {
        before[a] = place[a];
        place[a] -= (height - thickness) * normal[a];
    }
    for (int64_t c = 0; c < cells->count; c++) {
        bool at_node = c != cell && has_node(cells, c, cells->node[cell * (dim + 1) + k]);
        worst = at_node ? fmin(worst, cell_quality(cells, c, NULL)) : worst;
    }
    if (worst > POOR_QUALITY && cell_quality(cells, cell, NULL) > 0.0) {
        return true;
    }
    memcpy(place, before, (size_t)dim * sizeof *place);
    return false;
}

/* A sample with some slivers so thin, at nodes within the body. */
static struct sample sliver_sample(int dim, double thickness)
{
    struct cloud cloud = sample_cloud(dim, dim == 2 ? 8 : 6);
    const struct cells cells = {dim, cloud.node_count, cloud.x, cloud.cell_count, cloud.cells};
    int slivers = 0;
    bool *used = zeros(cloud.node_count, sizeof *used);
    for (int64_t i = 0; i < cells.count * (dim + 1) && slivers < 5; i++) {
        int64_t cell = i / (dim + 1);
        bool inside = true, fresh = true;
        for (int a = 0; a < dim; a++) {
            double place = cloud.x[(int64_t)cells.node[i] * dim + a];
            inside = inside && place > 1e-3 * sample_size && place < 0.999 * sample_size;
        }
        for (int k = 0; k <= dim; k++) {
            fresh = fresh && !used[cells.node[cell * (dim + 1) + k]];
        }
        if (inside && fresh && flatten(&cells, cell, (int)(i % (dim + 1)), thickness, cloud.x)) {
            slivers++;
            for (int64_t c = 0; c < cells.count; c++) { /* keep away from what touches it */
                for (int k = 0; k <= dim && has_node(&cells, c, cells.node[i]); k++) {
                    used[cells.node[c * (dim + 1) + k]] = true;
                }
            }
        }
    }
    assert_true(slivers > 0);
    return sample_of(dim, true, cloud, dim == 2 ? 1.8 : 2.0);
}

/* A field with second derivatives at the nodes. */
static double *quadratic_field(const struct sample *sample)
{
    int dim = sample->dim;
    double *u = zeros(sample->cloud.node_count * dim, sizeof *u);
    for (int64_t n = 0; n < sample->cloud.node_count; n++) {
        const double *x = sample->cloud.x + n * dim;
        for (int a = 0; a < dim; a++) {
            u[n * dim + a] = 0.5 * x[a] * x[(a + 1) % dim] + x[dim - 1] * x[0];
        }
    }
    return u;
}

/* Energy of that field, largest bound of a node's stiffness, least det F. */
static void measure(int dim, double thickness, double result[3])
{
    FREED_BY(sample_free) struct sample sample = sliver_sample(dim, thickness);
    struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, true);
    setup.faces = true;
    FREED_BY(body_free) struct body body = make_body(&sample, &setup);
    int64_t nodes = sample.cloud.node_count;
    double *u = quadratic_field(&sample), *force = zeros(nodes * dim, sizeof *force);
    double *stiffness = zeros(nodes, sizeof *stiffness);
    assert_true(body.cells.merged_count > 0);
    result[2] = body_force(&body, u, force).least_jacobian;
    body_diagonal(&body, false, stiffness);
    result[1] = largest(stiffness, nodes);
    result[0] = body_energy(&body, u);
}

/* Slivers a thousand times thinner change nothing: without merging all three go with 1 / thickness. */
TEST_IN_EACH_DIM(flatness)
{
    double thick[3], thin[3];
    measure(dim, 1e-4 * sample_size, thick);
    measure(dim, 1e-7 * sample_size, thin);
    for (int k = 0; k < 3; k++) {
        NEAR_TO(thin[k], thick[k], (k == 1 ? 0.02 : 0.01) * thick[k]); /* the bound is by linear functions */
    }
}

/* F is that of a linear field to round-off, and forces inside vanish. */
TEST_IN_EACH_DIM(linear)
{
    static const double A[9] = {1.1, 0.2, 0, 0.1, 0.95, 0, 0, 0, 1};
    FREED_BY(sample_free) struct sample sample = sliver_sample(dim, 1e-6 * sample_size);
    struct setup setup = one_material(MATERIAL_NEO_HOOKEAN, true);
    setup.faces = true;
    FREED_BY(body_free) struct body body = make_body(&sample, &setup);
    int64_t nodes = sample.cloud.node_count;
    double *u = linear_field(&sample, A, NULL), *force = zeros(nodes * dim, sizeof *force);
    double *F = zeros(sample.assembly.point_count * 9, sizeof *F), sum = 0.0, total = 0.0;
    (void)body_force(&body, u, force);
    body_gradient(&body, F);
    for (int64_t i = 0; i < sample.assembly.point_count * 9; i++) {
        NEAR_TO(F[i], A[i % 9], 1e-11);
    }
    for (int64_t q = 0; q < sample.assembly.point_count; q++) {
        sum += body.weight[q] * body.J[q];
        total += body.weight[q];
    }
    NEAR_TO(sum, determinant(A) * total, 1e-11 * total);
}

/* Forces are the gradient of the energy, whatever the law, and of groups with cells of large volume. */
TEST(gradient)
{
    struct random random = {5};
    for (int i = 0; i < 8; i++) {
        int dim = 2 + i % 2;
        FREED_BY(sample_free) struct sample sample = sliver_sample(dim, 1e-3 * sample_size);
        struct setup setup = i < 4 ? one_material(MATERIAL_NEO_HOOKEAN, i < 2) : three_materials(i < 6);
        setup.faces = true;
        FREED_BY(body_free) struct body body = make_body(&sample, &setup);
        int64_t count = sample.cloud.node_count * dim;
        double *u = random_field(&sample, 0.005 * sample_size, &random), *force = zeros(count, sizeof *force);
        assert_true(body.cells.merged_count > 0);
        assert_true(body_force(&body, u, force).least_jacobian > 0.3);
        check_work(&sample, &body, u, 1, &random);
    }
}

/* A group is of one material, in one block, and has a cell that is not poor. */
TEST_IN_EACH_DIM(groups)
{
    FREED_BY(sample_free) struct sample sample = sliver_sample(dim, 1e-5 * sample_size);
    struct setup setup = three_materials(true);
    setup.faces = true;
    FREED_BY(body_free) struct body body = make_body(&sample, &setup);
    int64_t merged = 0;
    for (int64_t b = 0; b < body.block_count; b++) {
        const struct block *block = &body.blocks[b];
        for (int64_t q = block->first_point; q < block->first_point + block->point_count; q++) {
            int64_t first = smoothed_cells_group(&body, q);
            assert_true(first >= block->first_point && first <= q);
            assert_true(smoothed_cells_group_end(&body, q) <= block->first_point + block->point_count);
            assert_int_equal(body.material[first], body.material[q]);
            if (first != q) {
                assert_true(cell_quality(&sample.assembly.cells, body.order.points[q], NULL) < POOR_QUALITY);
                assert_true(cell_quality(&sample.assembly.cells, body.order.points[first], NULL) >
                            POOR_QUALITY);
                merged++;
            }
        }
    }
    assert_int_equal(merged, body.cells.merged_count);
    assert_true(merged > 0);
}

/* (grad f . v) . w of the forces, about. */
static double second(struct body *body, const double *u, const double *v, const double *w, int64_t count)
{
    double h = 1e-6, sum = 0.0, *at = zeros(count, sizeof *at), *force[2];
    for (int k = 0; k < 2; k++) {
        force[k] = zeros(count, sizeof **force);
        for (int64_t n = 0; n < count; n++) {
            at[n] = u[n] + (k == 0 ? h : -h) * v[n];
        }
        (void)body_force(body, at, force[k]);
    }
    for (int64_t n = 0; n < count; n++) {
        sum += (force[0][n] - force[1][n]) / (2.0 * h) * w[n];
    }
    return sum;
}

/* A viscoelastic body that is held, in steps: forces and energy go from those of the moduli at first to those
 * of the last, whatever varies within cells. In a step forces have an energy, as their derivative is
 * symmetric, and turn with the body. */
TEST_IN_EACH_DIM(relaxation)
{
    static const double prony[] = {0.5, 2.0, 0.2, 2.0}, turned[9] = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
    struct random random = {7};
    FREED_BY(sample_free) struct sample sample = sliver_sample(dim, 1e-3 * sample_size);
    struct setup setup[3];
    struct body body[3];
    int64_t count = sample.cloud.node_count * dim;
    double *u = random_field(&sample, 0.005 * sample_size, &random), *force[3], energy[3];
    double *expected = zeros(count, sizeof *expected);
    double *v = random_field(&sample, 1.0, &random), *w = random_field(&sample, 1.0, &random);
    for (int i = 0; i < 3; i++) { /* at first, at last, in time */
        setup[i] = three_materials(false);
        setup[i].faces = true;
        for (int m = 0; m < 2; m++) {
            setup[i].material[m].shear_modulus *= i == 1 ? 0.3 : 1.0;
            setup[i].material[m].prony = prony;
            setup[i].material[m].prony_terms = i == 2 ? 2 : 0;
        }
        body[i] = make_body(&sample, &setup[i]);
        /* What stays elastic, by the long-term and the first mu. */
        memset(body[i].cells.offset_stiffness, 0, (size_t)sample.cloud.node_count * sizeof *u);
        memcpy(body[i].cells.variance_bulk, body[i == 1 ? 0 : i].cells.variance_bulk,
               (size_t)body->point_count * sizeof *u);
        force[i] = zeros(count, sizeof *u);
        (void)body_force(&body[i], u, force[i]);
        energy[i] = body_energy(&body[i], u);
    }
    assert_true(body[2].cells.merged_count > 0);
    ALL_NEAR(count, force[2], force[0], 1e-12 * largest(force[0], count));
    for (int step = 0; step <= 3; step++) {
        double left = exp(-0.35 * step);
        body_step(&body[2], step > 0 ? 0.7 : 0.0);
        (void)body_force(&body[2], u, force[2]);
        for (int64_t n = 0; n < count; n++) {
            expected[n] = force[1][n] + left * (force[0][n] - force[1][n]);
        }
        ALL_NEAR(count, force[2], expected, 1e-12 * largest(force[0], count));
        body_accept(&body[2]);
        NEAR_TO(body_energy(&body[2], u), energy[1] + left * left * (energy[0] - energy[1]),
                1e-12 * energy[0]);
        NEAR_TO(body_energy(&body[2], u) + body[2].prony.dissipated, energy[0], 1e-12 * energy[0]);
    }
    body_step(&body[2], 0.5);
    double product = second(&body[2], u, v, w, count);
    NEAR_TO(product, second(&body[2], u, w, v, count), 1e-7 * fabs(product));
    (void)body_force(&body[2], u, force[2]);
    for (int64_t i = 0; i < count; i += dim) {
        for (int a = 0; a < dim; a++) {
            v[i + a] = -sample.cloud.x[i + a];
            expected[i + a] = 0.0;
            for (int b = 0; b < dim; b++) {
                v[i + a] += turned[3 * a + b] * (sample.cloud.x[i + b] + u[i + b]);
                expected[i + a] += turned[3 * a + b] * force[2][i + b];
            }
        }
    }
    (void)body_force(&body[2], v, force[0]);
    ALL_NEAR(count, force[0], expected, 1e-11 * largest(expected, count));
    for (int i = 0; i < 3; i++) {
        body_free(&body[i]);
    }
}

RUN_TESTS(NULL, NULL)
