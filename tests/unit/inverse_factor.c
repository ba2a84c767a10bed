/* The scalar stiffness and its sparse approximate inverse: what is stated of S and of the factor L. */
#include "lattice_fixture.h"

#include "solid/preconditioner/inverse_stiffness.h"
#include "solid/preconditioner/scalar_stiffness.h"

/* A jittered cube, one side of it held, and S of it as a full matrix. */
struct cube {
    struct lattice l;
    struct inverse_factor factor;
    double *S;
    int64_t n;
};

static void build(struct cube *cube, bool bonded)
{
    FREED_BY(scalar_stiffness_free) struct scalar_stiffness stiffness = {0};
    FREED_BY(scalar_row_free) struct scalar_row row = {0};
    struct lattice_options options = lattice_defaults(3, 5);
    options.jitter = 0.2;
    lattice_build(&cube->l, &options);
    int32_t curve = lattice_curve(&cube->l, curve_of_kind(CURVE_SMOOTH));
    lattice_slide(&cube->l, 1u << 2, curve);
    struct solid_system *system = &cube->l.system;
    if (bonded) {
        struct average average = constraint_rows_average(&system->rows, 0);
        constraint_rows_init(&system->penalties, 3);
        GOOD(constraint_rows_add(&system->penalties, average.length, average.idx, average.phi,
                                 system->rows.direction, 0.0, curve, 0, 0, &error));
        ARRAY(system->penalty_stiffness, 1);
        system->penalty_stiffness[0] = 300.0;
    }
    cube->n = system->node_count;
    ARRAY(cube->S, cube->n * cube->n);
    GOOD(scalar_stiffness_make(system, &stiffness, &error));
    GOOD(scalar_row_make(&stiffness, &row, &error));
    SCRATCH int32_t *place = NULL;
    ARRAY(place, cube->n);
    for (int64_t p = 0; p < cube->n; p++) {
        place[p] = (int32_t)p;
    }
    GOOD(scalar_stiffness_prepare(&stiffness, place, cube->n, &error));
    for (int64_t i = 0; i < cube->n; i++) {
        scalar_stiffness_row(&stiffness, i, &row);
        assert_int_equal(row.node[row.count - 1], i);
        for (int64_t k = 0; k < row.count; k++) {
            cube->S[i * cube->n + row.node[k]] = cube->S[row.node[k] * cube->n + i] = row.value[k];
        }
    }
    GOOD(inverse_stiffness_factor(system, &cube->factor, &error));
}

static void release(struct cube *cube)
{
    inverse_factor_free(&cube->factor);
    free(cube->S);
    lattice_free(&cube->l);
}

static double energy(const struct cube *cube, const double *x)
{
    double sum = 0.0;
    for (int64_t i = 0; i < cube->n * cube->n; i++) {
        sum += x[i / cube->n] * cube->S[i] * x[i % cube->n];
    }
    return sum;
}

/* x . S x of a constant is 0 but for the bonds; of a linear field it is volume times modulus, as the shape
 * functions reproduce it. */
TEST(linear_fields_have_their_energy)
{
    for (int bonded = 0; bonded < 2; bonded++) {
        struct cube cube;
        build(&cube, bonded);
        const struct body *body = &cube.l.system.body;
        const struct material *material = body->materials;
        double *x = zeros(cube.n, sizeof *x);
        for (int64_t i = 0; i < cube.n; i++) {
            x[i] = 1.0;
        }
        double modulus = material->bulk_modulus + 4.0 / 3.0 * material->shear_modulus;
        double whole = body_volume(body) * modulus;
        AT_MOST(fabs(energy(&cube, x) - (bonded ? 300.0 : 0.0)), 1e-6 * whole);
        for (int64_t i = 0; i < cube.n && !bonded; i++) {
            x[i] = 3.0 * cube.l.system.X[3 * i] - 2.0 * cube.l.system.X[3 * i + 1];
        }
        if (!bonded) {
            AT_MOST(fabs(energy(&cube, x) / (13.0 * whole) - 1.0), 1e-9);
        }
        release(&cube);
    }
}

/* L is lower triangular, the diagonal of L S L^T is 1. */
TEST(the_diagonal_is_one)
{
    struct cube cube;
    build(&cube, true);
    const struct inverse_factor *factor = &cube.factor;
    double *x = zeros(cube.n, sizeof *x);
    for (int64_t i = 0; i < cube.n; i++) {
        assert_int_equal(factor->rows.idx[factor->rows.ptr[i + 1] - 1], i);
        memset(x, 0, (size_t)cube.n * sizeof *x);
        for (int64_t k = factor->rows.ptr[i]; k < factor->rows.ptr[i + 1]; k++) {
            assert_true(k == factor->rows.ptr[i] || factor->rows.idx[k] > factor->rows.idx[k - 1]);
            x[factor->rows.idx[k]] = factor->rows.value[k];
        }
        AT_MOST(fabs(energy(&cube, x) - 1.0), 1e-6);
    }
    release(&cube);
}

/* Solving undoes applying, of L and of L^T; rows of conditions act on y as they do on L^T y. */
TEST(both_factors_are_undone)
{
    struct cube cube;
    FREED_BY(constraint_rows_free) struct constraint_rows rows = {0};
    build(&cube, false);
    struct random random = {3};
    double *y = lattice_vector(&cube.l), *u = lattice_vector(&cube.l), *back = lattice_vector(&cube.l);
    double product = 0.0, transposed = 0.0;
    for (int64_t i = 0; i < 3 * cube.n; i++) {
        y[i] = uniform(&random, -1.0, 1.0);
    }
    inverse_factor_apply_transposed(&cube.factor, 3, y, u);
    GOOD(inverse_stiffness_rows(&cube.factor, &cube.l.system.rows, &rows, &error));
    assert_int_equal(rows.count, cube.l.system.rows.count);
    for (int64_t r = 0; r < rows.count; r++) {
        double expected = constraint_rows_value(&cube.l.system.rows, r, u);
        AT_MOST(fabs(constraint_rows_value(&rows, r, y) - expected), 1e-10 * fabs(expected) + 1e-12);
    }
    inverse_factor_apply(&cube.factor, 3, u, back);
    for (int64_t i = 0; i < 3 * cube.n; i++) { /* y . L u = L^T y . u */
        product += y[i] * back[i];
        transposed += u[i] * u[i];
    }
    AT_MOST(fabs(product / transposed - 1.0), 1e-10);
    inverse_factor_solve(&cube.factor, 3, back);
    for (int64_t i = 0; i < 3 * cube.n; i++) {
        AT_MOST(fabs(back[i] - u[i]), 1e-9);
    }
    inverse_factor_solve_transposed(&cube.factor, 3, u);
    for (int64_t i = 0; i < 3 * cube.n; i++) {
        AT_MOST(fabs(u[i] - y[i]), 1e-9);
    }
    release(&cube);
}

static void same_bits(const struct sparse *a, const struct sparse *b)
{
    assert_int_equal(a->row_count, b->row_count);
    assert_memory_equal(a->ptr, b->ptr, (size_t)(a->row_count + 1) * sizeof *a->ptr);
    assert_memory_equal(a->idx, b->idx, (size_t)a->ptr[a->row_count] * sizeof *a->idx);
    assert_memory_equal(a->value, b->value, (size_t)a->ptr[a->row_count] * sizeof *a->value);
}

/* L does not depend on how many rows of S are there at once, also where nodes have hardly any stiffness. */
TEST(stretches_make_no_difference)
{
    static const int64_t batches[] = {1, 7, 60, 124};
    for (int weak = 0; weak < 2; weak++) {
        struct cube cube;
        build(&cube, true);
        struct solid_system *system = &cube.l.system;
        for (int64_t q = 0; q < system->body.point_count && weak == 1; q++) {
            int64_t node = system->body.node_order[smoothed_cells_node(&system->body, q, 0)];
            system->body.weight[q] *=
                system->X[3 * node] < 0.7 * cube.l.assembly.cells.x[3 * (cube.n - 1)] ? 1e-12 : 1.0;
        }
        FREED_BY(inverse_factor_free) struct inverse_factor whole = {0};
        GOOD(inverse_stiffness_factor(system, &whole, &error));
        for (size_t k = 0; k < sizeof batches / sizeof *batches; k++) {
            FREED_BY(inverse_factor_free) struct inverse_factor factor = {0};
            GOOD(inverse_stiffness_factor_by(system, batches[k], &factor, &error));
            same_bits(&factor.rows, &whole.rows);
        }
        assert_true((memcmp(whole.rows.value, cube.factor.rows.value, sizeof(double)) != 0) == (weak == 1));
        release(&cube);
    }
}

RUN_TESTS(NULL, NULL)
