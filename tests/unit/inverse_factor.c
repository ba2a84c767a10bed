/* The assembled stiffness and its sparse approximate inverse: what is stated of K and of the factor L. */
#include "lattice_fixture.h"

#include "solid/preconditioner/inverse_stiffness.h"
#include "solid/preconditioner/stiffness_rows.h"

/* A jittered block, and K of it as a full matrix. */
struct cube {
    struct lattice l;
    struct inverse_factor factor;
    double *K;
    int64_t n, size;
};

static void build(struct cube *cube, int dim, double poisson_ratio, bool penalised, double least_weight)
{
    FREED_BY(stiffness_rows_free) struct stiffness_rows rows = {0};
    FREED_BY(stiffness_row_free) struct stiffness_row row = {0};
    *cube = (struct cube){0};
    lattice_build(&cube->l, dim, dim == 2 ? 9 : 5, 1, 0.2, poisson_ratio);
    struct solid_system *system = &cube->l.system;
    int64_t n = cube->n = system->node_count, size = cube->size = n * dim;
    if (penalised) {
        const int32_t idx[] = {3, 7, 11};
        const double phi[] = {0.2, 0.5, 0.3}, direction[] = {0.6, 0.8, 0.0};
        constraint_rows_init(&system->springs.rows, dim);
        GOOD(constraint_rows_add(&system->springs.rows, 3, idx, phi, direction, 0.0, 0, 0, 0, &error));
        ARRAY(system->springs.stiffness, 1);
        system->springs.stiffness[0] = 300.0;
    }
    ARRAY(cube->K, size * size);
    GOOD(stiffness_rows_begin(system, &rows, &error));
    GOOD(stiffness_row_begin(&rows, &row, &error));
    rows.least_weight = least_weight;
    int32_t *place = zeros(n, sizeof *place);
    double *block = zeros(n * dim * dim, sizeof *block);
    for (int64_t p = 0; p < n; p++) {
        place[p] = (int32_t)p;
    }
    GOOD(stiffness_rows_prepare(&rows, place, n, &error));
    for (int64_t p = 0; p < n; p++) {
        stiffness_row_make(&rows, (int32_t)p, n, place, &row, block);
        for (int64_t i = 0; i < n * dim * dim; i++) {
            int64_t from = system->body.order.nodes[p] * dim + i / dim % dim;
            cube->K[from * size + system->body.order.nodes[i / (dim * dim)] * dim + i % dim] = block[i];
        }
    }
    GOOD(inverse_stiffness_factor(system, &cube->factor, &error));
}

static void release(struct cube *cube)
{
    inverse_factor_free(&cube->factor);
    free(cube->K);
    lattice_free(&cube->l);
}

/* Without nodal pressures and offsets K is the change of the forces at rest. */
TEST_IN_EACH_DIM(stiffness_is_exact)
{
    const double epsilon = 1e-7;
    struct cube cube;
    build(&cube, dim, 0.2, false, 0.0);
    double *offsets = cube.l.system.body.cells.offset_stiffness;
    memset(offsets, 0, (size_t)cube.n * sizeof *offsets);
    double *u = lattice_vector(&cube.l), *force[2] = {lattice_vector(&cube.l), lattice_vector(&cube.l)};
    double largest = 0.0, off = 0.0;
    for (int64_t j = 0; j < cube.size; j++) {
        for (int way = 0; way < 2; way++) {
            u[j] = way == 0 ? epsilon : -epsilon;
            system_resist(&cube.l.system, u, force[way]);
        }
        u[j] = 0.0;
        for (int64_t i = 0; i < cube.size; i++) {
            double exact = (force[0][i] - force[1][i]) / (2.0 * epsilon);
            largest = fmax(largest, fabs(exact));
            off = fmax(off, fabs(exact - cube.K[i * cube.size + j]));
        }
    }
    AT_MOST(off, 1e-6 * largest);
    release(&cube);
}

/* A spring adds the square of its row; a linear field of pure shear has the energy of the material also with
 * nodal pressures. */
TEST_IN_EACH_DIM(springs_and_shear_have_their_energy)
{
    double energy[2] = {0.0, 0.0};
    for (int penalised = 0; penalised < 2; penalised++) {
        struct cube cube;
        build(&cube, dim, 0.49, penalised, 0.0);
        const double *X = cube.l.system.X;
        double *x = zeros(cube.size, sizeof *x);
        for (int64_t i = 0; i < cube.n; i++) {
            x[i * dim] = X[i * dim + 1];
        }
        for (int64_t i = 0; i < cube.size * cube.size; i++) {
            energy[penalised] += x[i / cube.size] * cube.K[i] * x[i % cube.size];
        }
        double whole = body_volume(&cube.l.system.body) * cube.l.system.body.materials[0].shear_modulus;
        double along = 0.6 * (0.2 * x[3 * dim] + 0.5 * x[7 * dim] + 0.3 * x[11 * dim]);
        AT_MOST(fabs(energy[0] / whole - 1.0), 1e-9);
        AT_MOST(fabs(energy[penalised] - energy[0] - penalised * 300.0 * along * along), 1e-9 * whole);
        release(&cube);
    }
}

/* L is lower triangular, the diagonal blocks of L K L^T are 1. */
TEST_IN_EACH_DIM(the_diagonal_is_one)
{
    struct cube cube;
    build(&cube, dim, 0.49, true, 0.02);
    const struct block_rows *rows = &cube.factor.rows;
    double *x[3];
    for (int64_t i = 0; i < cube.n; i++) {
        assert_int_equal(rows->idx[rows->ptr[i + 1] - 1], i);
        for (int a = 0; a < dim; a++) {
            x[a] = zeros(cube.size, sizeof **x);
        }
        for (int64_t k = rows->ptr[i] * dim * dim; k < rows->ptr[i + 1] * dim * dim; k++) {
            int32_t node = rows->idx[k / (dim * dim)];
            assert_true(node <= i);
            x[k % dim][node * dim + k / dim % dim] = (double)rows->block[k];
        }
        for (int a = 0; a < dim; a++) {
            for (int b = 0; b < dim; b++) {
                double sum = 0.0;
                for (int64_t k = 0; k < cube.size * cube.size; k++) {
                    sum += x[a][k / cube.size] * cube.K[k] * x[b][k % cube.size];
                }
                AT_MOST(fabs(sum - (a == b)), 1e-4);
            }
        }
    }
    release(&cube);
}

/* y . L u = L^T y . u */
TEST_IN_EACH_DIM(one_is_the_transpose_of_the_other)
{
    struct cube cube;
    build(&cube, dim, 0.49, false, 0.0);
    struct random random = {3};
    double *y = lattice_vector(&cube.l), *u = lattice_vector(&cube.l), *back = lattice_vector(&cube.l);
    double product = 0.0, transposed = 0.0;
    for (int64_t i = 0; i < cube.size; i++) {
        y[i] = uniform(&random, -1.0, 1.0);
    }
    inverse_factor_apply_transposed(&cube.factor, y, u);
    inverse_factor_apply(&cube.factor, u, back);
    for (int64_t i = 0; i < cube.size; i++) {
        product += y[i] * back[i];
        transposed += u[i] * u[i];
    }
    AT_MOST(fabs(product / transposed - 1.0), 1e-10);
    release(&cube);
}

/* L does not depend on how many rows of K are there at once, also where nodes have hardly any stiffness. */
TEST(stretches_make_no_difference)
{
    static const int64_t batches[] = {1, 7, 60, 124};
    for (int weak = 0; weak < 2; weak++) {
        struct cube cube;
        build(&cube, 3, 0.49, true, 0.0);
        struct solid_system *system = &cube.l.system;
        for (int64_t q = 0; q < system->body.point_count && weak == 1; q++) {
            int64_t node = system->body.order.nodes[smoothed_cells_node(&system->body, q, 0)];
            system->body.weight[q] *= system->X[3 * node] < 0.7 * system->X[3 * (cube.n - 1)] ? 1e-12 : 1.0;
        }
        FREED_BY(inverse_factor_free) struct inverse_factor whole = {0};
        GOOD(inverse_stiffness_factor(system, &whole, &error));
        size_t entries = (size_t)whole.rows.ptr[cube.n];
        for (size_t k = 0; k < sizeof batches / sizeof *batches; k++) {
            FREED_BY(inverse_factor_free) struct inverse_factor factor = {0};
            GOOD(inverse_stiffness_factor_by(system, batches[k], &factor, &error));
            assert_memory_equal(factor.rows.ptr, whole.rows.ptr, (size_t)(cube.n + 1) * sizeof(int64_t));
            assert_memory_equal(factor.rows.idx, whole.rows.idx, entries * sizeof(int32_t));
            assert_memory_equal(factor.rows.block, whole.rows.block, entries * 9 * sizeof(float));
        }
        release(&cube);
    }
}

RUN_TESTS(NULL, NULL)
