/* The fictitious mass: what is stated of M and its inverse, the frequencies that it leaves, contacts that are
 * followed. */
#include "lattice_fixture.h"

#include "base/dense.h"
#include "solid/preconditioner/frequency.h"
#include "solid/preconditioner/preconditioner_private.h"

/* A slender bar, clamped at one end and strained, and its preconditioner measured there. */
struct strained {
    struct lattice l;
    struct preconditioner preconditioner;
    double *u, *residual;
    int64_t size;
};

static void measure(struct strained *s, bool coarse)
{
    double *mass = zeros(s->l.system.node_count, sizeof *mass);
    (void)system_residual(&s->l.system, s->u, s->residual);
    system_relaxation_mass(&s->l.system, false, mass);
    GOOD(preconditioner_build(&s->l.system, coarse, &s->preconditioner, &error));
    preconditioner_set_mass(&s->preconditioner, mass);
    int64_t evaluations = 0;
    GOOD(preconditioner_measure(&s->preconditioner, &s->l.system, s->u, &evaluations, &error));
    assert_int_equal(evaluations, 0);
    preconditioner_follow(&s->preconditioner, &s->l.system);
}

/* The displacement of the first side is 0. */
static void clamp(struct lattice *l)
{
    FREED_BY(boundary_averages_free) struct boundary_averages averages = lattice_averages(l, 0);
    ARRAY(l->system.curves, 1);
    ARRAY(l->system.factor, 1);
    l->system.curves[0] = curve_of_kind(CURVE_SMOOTH);
    l->system.curve_count = 1;
    for (int64_t i = 0; i < averages.count * l->cloud.dim; i++) {
        int64_t a = i % averages.count, at = averages.ptr[a], axis = i / averages.count;
        double direction[3] = {axis == 0, axis == 1, axis == 2};
        GOOD(constraint_rows_add(&l->system.rows, averages.ptr[a + 1] - at, averages.idx + at,
                                 averages.phi + at, direction, 0.0, 0, 0, averages.node[a], &error));
    }
}

static void strain_bar_of(struct strained *s, int dim, double poisson_ratio, double strain, bool clamped,
                          bool coarse)
{
    lattice_build(&s->l, dim, dim == 2 ? 9 : 5, 4, 0.1, poisson_ratio);
    body_limit_bulk(&s->l.system.body, 50.0);
    s->size = s->l.system.node_count * dim;
    s->u = lattice_vector(&s->l);
    s->residual = lattice_vector(&s->l);
    if (clamped) {
        clamp(&s->l);
    }
    for (int64_t i = 0; i < s->size; i++) {
        s->u[i] = (i % dim == 0 ? strain : -strain / (dim - 1)) * s->l.system.X[i];
    }
    measure(s, coarse);
}

static void strain_bar(struct strained *s, int dim, double strain, bool clamped, bool coarse)
{
    strain_bar_of(s, dim, 0.49, strain, clamped, coarse);
}

static void release(struct strained *s)
{
    preconditioner_free(&s->preconditioner);
    lattice_free(&s->l);
}

static double dot(const struct strained *s, const double *x, const double *y)
{
    double sum = 0.0;
    for (int64_t i = 0; i < s->size; i++) {
        sum += x[i] * y[i];
    }
    return sum;
}

/* M^-1 is symmetric and positive, and accelerations meet the conditions. */
TEST(inverse_is_symmetric)
{
    for (int dim = 2; dim <= 3; dim++) {
        struct strained s;
        struct random random = {7};
        strain_bar(&s, dim, 0.0, true, true);
        assert_true(s.preconditioner.size > 0);
        assert_false(s.preconditioner.has_rigid_mode);
        double *f[2], *a[2], most = 0.0;
        for (int k = 0; k < 2; k++) {
            f[k] = lattice_vector(&s.l);
            a[k] = lattice_vector(&s.l);
            for (int64_t i = 0; i < s.size; i++) {
                f[k][i] = uniform(&random, -1.0, 1.0);
            }
            preconditioner_apply(&s.preconditioner, f[k], a[k]);
        }
        for (int64_t i = 0; i < s.size; i++) {
            most = fmax(most, fabs(a[0][i]));
        }
        AT_MOST(0.0, dot(&s, f[0], a[0]));
        AT_MOST(fabs(dot(&s, f[0], a[1]) - dot(&s, f[1], a[0])), 1e-10 * dot(&s, f[0], a[0]));
        AT_MOST(constraint_violation(&s.preconditioner.constraint, s.l.system.factor, a[0], NULL),
                1e-10 * most);
        release(&s);
    }
}

static double largest_frequency(struct strained *s)
{
    double *mode = lattice_vector(&s->l), *scratch = zeros(2 * s->size, sizeof *scratch);
    return system_largest_frequency(&s->l.system, &s->preconditioner, s->u, s->residual, 200, mode, scratch);
}

/* M is near the stiffness: no mode is faster than 2.5, of a nearly incompressible body neither, by the limit
 * of the bulk modulus. */
TEST(no_mode_is_fast)
{
    for (int dim = 2; dim <= 3; dim++) {
        for (int k = 0; k < 2; k++) {
            struct strained s;
            strain_bar_of(&s, dim, k == 0 ? 0.49 : 0.499999, 0.0, true, true);
            double largest = largest_frequency(&s);
            print_message("%dD: largest frequency %g\n", dim, largest);
            AT_MOST(largest, 2.5);
            AT_MOST(0.9, largest);
            release(&s);
        }
    }
}

/* field[size] = the coarse field k, without what the conditions hold. one[p->size]: zeros. */
static void take_coarse_field(struct strained *s, int64_t k, double *one, double *field)
{
    struct preconditioner *p = &s->preconditioner;
    one[k] = 1.0;
    memset(field, 0, (size_t)s->size * sizeof *field);
    coarse_space_prolongate(&p->coarse, one, field);
    preconditioner_project(p, field);
    one[k] = 0.0;
}

/* exact[size * size]: the stiffness along the coarse fields, by the change of the forces along each. */
static double *stiffness_by_differences(struct strained *s)
{
    struct preconditioner *p = &s->preconditioner;
    const double epsilon = 1e-7;
    double *exact = zeros(p->size * p->size, sizeof *exact), *one = zeros(p->size, sizeof *one);
    double *force[2], *field = lattice_vector(&s->l), *moved = lattice_vector(&s->l);
    for (int way = 0; way < 2; way++) {
        force[way] = lattice_vector(&s->l);
    }
    for (int64_t k = 0; k < p->size; k++) {
        take_coarse_field(s, k, one, field);
        for (int way = 0; way < 2; way++) {
            for (int64_t i = 0; i < s->size; i++) {
                moved[i] = s->u[i] + (way == 0 ? epsilon : -epsilon) * field[i];
            }
            system_resist(&s->l.system, moved, force[way]);
        }
        for (int64_t i = 0; i < s->size; i++) {
            force[0][i] = (force[0][i] - force[1][i]) / (2.0 * epsilon);
        }
        preconditioner_project(p, force[0]);
        coarse_space_restrict(&p->coarse, force[0], exact + k * p->size);
    }
    return exact;
}

/* Whether `most` times matrix a is above b, but for rigid motions: the difference is positive definite. Of
 * both the lower triangle counts. */
static bool is_above(int64_t size, double most, const double *a, const double *b)
{
    double *difference = zeros(size * size, sizeof *difference);
    for (int64_t i = 0; i < size * size; i++) {
        difference[i] = most * a[i] - b[i] + (i / size == i % size ? 1e-6 * a[i] : 0.0);
    }
    return dense_factorise(size, difference);
}

/* body[size * size]: the assembled stiffness; its lower triangle. */
static double *assembled(const struct strained *s)
{
    const struct preconditioner *p = &s->preconditioner;
    double *body = zeros(p->size * p->size, sizeof *body);
    for (int64_t i = 0; i < p->size * p->size; i++) {
        int64_t row = i / p->size, column = i % p->size, numbers = p->profile.numbers;
        if (column <= row && column / numbers >= p->profile.first[row / numbers]) {
            body[i] = *profile_entry(&p->profile, row, column, p->body);
        }
    }
    return body;
}

/* Of the norm of the exact stiffness: how far the assembled one is off. */
static double part_off(int64_t size, const double *body, const double *exact)
{
    double off2 = 0.0, whole2 = 0.0;
    for (int64_t i = 0; i < size * size; i += i % size < i / size ? 1 : size - i % size) {
        double off = body[i] - exact[i];
        off2 += off * off;
        whole2 += exact[i] * exact[i];
    }
    return sqrt(off2 / whole2);
}

/* Without the springs that stand for conditions the assembled stiffness is that of the forces to .07, at rest
 * and strained; in 2D near incompressibility to a quarter, as it leaves out the pressure projection. No field
 * is more than half as stiff again as assembled; the margin of A is four times. Fields that conditions bend
 * within a few cells are assembled up to six times as stiff as they are. */
TEST(stiffness_is_assembled)
{
    for (int k = 0; k < 8; k++) {
        struct strained s;
        int dim = 2 + k % 2;
        double poisson_ratio = k / 2 % 2 == 0 ? 0.3 : 0.49, strain = k < 4 ? 0.0 : 0.3;
        strain_bar_of(&s, dim, poisson_ratio, strain, false, true);
        double *exact = stiffness_by_differences(&s), *body = assembled(&s);
        int64_t size = s.preconditioner.size;
        double off = part_off(size, body, exact);
        print_message("%dD, nu %g, strain %g: off by %g\n", dim, poisson_ratio, strain, off);
        AT_MOST(off, dim == 2 && poisson_ratio > 0.4 ? 0.25 : 0.07);
        if (strain == 0.0) { /* else the state is no equilibrium, and may have negative ones */
            assert_true(is_above(size, 1.5, body, exact));
            assert_true(is_above(size, 6.0, exact, body));
        }
        release(&s);
    }
}

/* A strained bar against a plate that it has just met. */
struct pressed {
    struct strained s;
    struct boundary_averages averages;
    struct contact contact;
};

static void press_bar(struct pressed *p)
{
    struct rigid_surface plate;
    const double corners[4] = {-1.0, 0.1, 2.0, 0.1}; /* the body is below: on the right of it */
    struct strained *s = &p->s;
    strain_bar(s, 2, -0.05, false, true);
    preconditioner_free(&s->preconditioner);
    p->averages = lattice_averages(&s->l, 3);
    GOOD(rigid_build(2, 1, corners, false, &plate, &error));
    GOOD(contact_build(&p->averages, NULL, s->l.system.X, 2, &plate, 1e6, &p->contact, &error));
    s->l.system.contacts = &p->contact;
    s->l.system.contact_count = 1;
    s->l.system.floats = true;
    measure(s, true);
}

static void release_pressed(struct pressed *p)
{
    p->s.l.system.contacts = NULL;
    p->s.l.system.contact_count = 0;
    contact_free(&p->contact);
    boundary_averages_free(&p->averages);
    release(&p->s);
}

/* Pressed against a plate, contact nodes are counted in: the largest frequency stays what it was,
 * where otherwise a stiff contact would move a body that weighs nothing. */
TEST(contacts_are_followed)
{
    struct pressed p;
    struct strained *s = &p.s;
    press_bar(&p);
    double alone[2];
    memset(s->preconditioner.along, 0, (size_t)s->preconditioner.contact_node_count * sizeof(double));
    preconditioner_factorise(&s->preconditioner, &s->l.system);
    for (int followed = 0; followed < 2; followed++) {
        if (followed) {
            preconditioner_follow(&s->preconditioner, &s->l.system);
        }
        double *mode = lattice_vector(&s->l), *scratch;
        scratch = zeros(2 * s->size, sizeof *scratch);
        alone[followed] =
            system_largest_frequency(&s->l.system, &s->preconditioner, s->u, s->residual, 60, mode, scratch);
    }
    print_message("largest frequency with contacts left out %g, followed %g\n", alone[0], alone[1]);
    AT_MOST(3.0 * alone[1], alone[0]);
    AT_MOST(alone[1], 3.0);
    release_pressed(&p);
}

RUN_TESTS(NULL, NULL)
