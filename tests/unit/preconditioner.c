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
    GOOD(preconditioner_set_mass(&s->preconditioner, &s->l.system, mass, &error));
    int64_t evaluations = 0;
    GOOD(preconditioner_measure(&s->preconditioner, &s->l.system, s->u, &evaluations, &error));
    assert_int_equal(evaluations, s->preconditioner.size > 0);
    (void)system_residual(&s->l.system, s->u, s->residual);
}

static void strain_bar_of(struct strained *s, int dim, double poisson_ratio, double strain, bool clamped,
                          bool coarse)
{
    struct lattice_options options = lattice_defaults(dim, dim == 2 ? 9 : 5);
    options.poisson_ratio = poisson_ratio;
    options.count[0] *= 4;
    options.size[0] *= 4.0;
    options.jitter = 0.1;
    lattice_build(&s->l, &options);
    body_limit_bulk(&s->l.system.body, 50.0);
    int32_t curve = lattice_curve(&s->l, curve_of_kind(CURVE_SMOOTH));
    s->size = s->l.system.node_count * dim;
    s->u = lattice_vector(&s->l);
    s->residual = lattice_vector(&s->l);
    for (int a = 0; clamped && a < dim; a++) {
        double direction[3] = {a == 0, a == 1, a == 2};
        lattice_prescribe(&s->l, 1u << 0, direction, NULL, NULL, curve);
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

/* x . M y */
static double product(struct strained *s, const double *x, const double *y)
{
    double *force = lattice_vector(&s->l);
    preconditioner_multiply(&s->preconditioner, y, force);
    return dot(s, x, force);
}

/* A move that the conditions admit. */
static double *random_move(struct strained *s, struct random *random)
{
    double *move = lattice_vector(&s->l);
    for (int64_t i = 0; i < s->size; i++) {
        move[i] = uniform(random, -1.0, 1.0);
    }
    constraint_project(&s->preconditioner.constraint, NULL, move);
    return move;
}

/* M^-1 M is the identity on moves that the conditions admit, M is symmetric and positive, its squares are
 * those of what it multiplies, and accelerations meet the conditions. */
static void check_inverse(struct strained *s)
{
    struct random random = {7};
    assert_true(s->preconditioner.size > 0);
    assert_false(s->preconditioner.has_rigid_mode);
    double *x = random_move(s, &random), *y = random_move(s, &random), *force = lattice_vector(&s->l);
    for (int64_t i = 0; i < s->size; i++) {
        force[i] = uniform(&random, -1.0, 1.0);
    }
    preconditioner_apply(&s->preconditioner, force, y);
    double work = dot(s, x, force), square = preconditioner_square(&s->preconditioner, x);
    AT_MOST(fabs(product(s, x, y) - work), 1e-8 * fabs(work));
    AT_MOST(fabs(product(s, y, x) - work), 1e-8 * fabs(work));
    AT_MOST(0.0, square);
    AT_MOST(fabs(product(s, x, x) - square), 1e-8 * square);
    double most = 0.0;
    for (int64_t i = 0; i < s->size; i++) {
        most = fmax(most, fabs(y[i]));
    }
    AT_MOST(constraint_violation(&s->preconditioner.constraint, s->l.system.factor, y, NULL), 1e-10 * most);
}

/* The shape x^2 along the second axis, as the bar bends. */
static void add_bending(struct strained *s)
{
    int dim = s->l.system.dim;
    double *move = lattice_vector(&s->l);
    for (int64_t n = 0; n < s->l.system.node_count; n++) {
        move[n * dim + 1] = s->l.system.X[n * dim] * s->l.system.X[n * dim];
    }
    constraint_project(&s->preconditioner.constraint, NULL, move);
    GOOD(preconditioner_add_slow_mode(&s->preconditioner, move, &error));
}

TEST(mass_and_inverse_agree)
{
    for (int dim = 2; dim <= 3; dim++) {
        struct strained s;
        struct random random = {3};
        strain_bar(&s, dim, 0.0, true, true);
        check_inverse(&s);
        for (int i = 0; i < SLOW_MODES_MOST; i++) {
            double *move = random_move(&s, &random);
            GOOD(preconditioner_add_slow_mode(&s.preconditioner, move, &error));
            check_inverse(&s);
        }
        add_bending(&s); /* one too many: the first is dropped */
        assert_int_equal(s.preconditioner.slow.count, SLOW_MODES_MOST);
        check_inverse(&s);
        release(&s);
    }
}

static void frequencies(struct strained *s, double *largest, double *lowest)
{
    double *mode = lattice_vector(&s->l), *start = lattice_vector(&s->l), *scratch;
    struct spectrum spectrum;
    scratch = zeros(5 * s->size, sizeof *scratch);
    for (int64_t i = 0; i < s->size; i++) {
        start[i] = sin(1.0 + (double)(i * i % 97));
    }
    *largest =
        system_largest_frequency(&s->l.system, &s->preconditioner, s->u, s->residual, 200, mode, scratch);
    GOOD(system_spectrum(&s->l.system, &s->preconditioner, s->u, s->residual, 2000, start, scratch, &spectrum,
                         &error));
    AT_MOST(fabs(spectrum.largest / (*largest * *largest) - 1.0), 0.01);
    *lowest = sqrt(spectrum.lowest);
}

/* The coarse fields carry the modes as large as the bar: the ratio of its frequencies, which is the number of
 * steps, falls by far, and the inverse factor leaves the largest one below 2. */
TEST(slow_modes_are_gone)
{
    for (int dim = 2; dim <= 3; dim++) {
        double largest[2], lowest[2];
        for (int coarse = 0; coarse < 2; coarse++) {
            struct strained s;
            strain_bar(&s, dim, 0.0, true, coarse);
            frequencies(&s, &largest[coarse], &lowest[coarse]);
            release(&s);
        }
        print_message("%dD: ratio of the frequencies %g, with fields %g\n", dim, largest[0] / lowest[0],
                      largest[1] / lowest[1]);
        AT_MOST(largest[1], 2.0);
        AT_MOST(largest[1] / lowest[1], 0.05 * largest[0] / lowest[0]);
    }
}

/* A slow mode that is added becomes four times as fast, and no other one faster. */
TEST(added_modes_are_faster)
{
    struct strained s;
    double largest[2], lowest[2];
    strain_bar(&s, 2, 0.0, true, false);
    frequencies(&s, &largest[0], &lowest[0]);
    add_bending(&s);
    frequencies(&s, &largest[1], &lowest[1]);
    print_message("lowest frequency %g, then %g; largest %g, %g\n", lowest[0], lowest[1], largest[0],
                  largest[1]);
    AT_MOST(2.0, lowest[1] / lowest[0]);
    AT_MOST(lowest[1] / lowest[0], 4.5);
    AT_MOST(fabs(largest[1] / largest[0] - 1.0), 0.01);
    release(&s);
}

/* With a limit of the bulk modulus nearly incompressible bodies have the frequencies of one that is less so;
 * otherwise their ratio would grow by the root of the bulk modulus, 100 times here. */
TEST(bulk_modulus_is_limited)
{
    for (int dim = 2; dim <= 3; dim++) {
        double ratio[2];
        for (int k = 0; k < 2; k++) {
            struct strained s;
            double largest, lowest;
            strain_bar_of(&s, dim, k == 0 ? 0.49 : 0.499999, 0.0, true, true);
            frequencies(&s, &largest, &lowest);
            ratio[k] = largest / lowest;
            release(&s);
        }
        print_message("%dD: ratio of the frequencies at nu .49 %g, .499999, limited %g\n", dim, ratio[0],
                      ratio[1]);
        AT_MOST(ratio[1], 1.05 * ratio[0]);
    }
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
        one[k] = 1.0;
        preconditioner_prolongate(p, one, field);
        one[k] = 0.0;
        for (int way = 0; way < 2; way++) {
            for (int64_t i = 0; i < s->size; i++) {
                moved[i] = s->u[i] + (way == 0 ? epsilon : -epsilon) * field[i];
            }
            system_resist(&s->l.system, moved, force[way]);
        }
        for (int64_t i = 0; i < s->size; i++) {
            force[0][i] = (force[0][i] - force[1][i]) / (2.0 * epsilon);
        }
        preconditioner_restrict_force(p, force[0], moved, exact + k * p->size);
    }
    return exact;
}

/* Whether `most` times matrix a is above b: the difference positive definite. */
static bool is_above(int64_t size, double most, const double *a, const double *b)
{
    double *difference = zeros(size * size, sizeof *difference);
    for (int64_t i = 0; i < size * size; i++) {
        int64_t across = i % size * size + i / size;
        difference[i] = 0.5 * (most * (a[i] + a[across]) - b[i] - b[across]);
    }
    return dense_factorise(size, difference);
}

/* Of the norm of the exact stiffness: how far the assembled one is off. */
static double part_off(const struct strained *s, const double *exact)
{
    double off2 = 0.0, whole2 = 0.0;
    for (int64_t i = 0; i < s->preconditioner.size * s->preconditioner.size; i++) {
        double off = s->preconditioner.body[i] - exact[i];
        off2 += off * off;
        whole2 += exact[i] * exact[i];
    }
    return sqrt(off2 / whole2);
}

/* The assembled stiffness is that of the forces to a twentieth, at rest and strained; in 2D near
 * incompressibility to a fifth, as it leaves out the pressure projection. No field is more than half
 * as stiff again as assembled; the margin of A is four times. Fields that conditions bend within a few cells
 * are assembled up to six times as stiff as they are. */
TEST(stiffness_is_assembled)
{
    for (int k = 0; k < 8; k++) {
        struct strained s;
        int dim = 2 + k % 2;
        double poisson_ratio = k / 2 % 2 == 0 ? 0.3 : 0.49, strain = k < 4 ? 0.0 : 0.3;
        strain_bar_of(&s, dim, poisson_ratio, strain, true, true);
        double *exact = stiffness_by_differences(&s), off = part_off(&s, exact);
        print_message("%dD, nu %g, strain %g: off by %g\n", dim, poisson_ratio, strain, off);
        AT_MOST(off, dim == 2 && poisson_ratio > 0.4 ? 0.2 : 0.05);
        if (strain == 0.0) { /* else the state is no equilibrium, and may have negative ones */
            assert_true(is_above(s.preconditioner.size, 1.5, s.preconditioner.body, exact));
            assert_true(is_above(s.preconditioner.size, 6.0, exact, s.preconditioner.body));
        }
        release(&s);
    }
}

/* A strained bar against a plate that it has just met: the contact nodes are not counted in yet. */
struct pressed {
    struct strained s;
    struct boundary_averages averages;
    struct contact contact;
};

static void press_bar(struct pressed *p, bool clamped)
{
    struct rigid_surface plate;
    const double corners[4] = {-1.0, 0.1, 2.0, 0.1}; /* the body is below: on the right of it */
    struct strained *s = &p->s;
    strain_bar(s, 2, -0.05, clamped, true);
    preconditioner_free(&s->preconditioner);
    p->averages = lattice_averages(&s->l, 1u << 3);
    GOOD(rigid_build(2, 1, corners, false, &plate, &error));
    GOOD(contact_build(&p->averages, NULL, s->l.system.X, 2, &plate, 1e6, &p->contact, &error));
    s->l.system.contacts = &p->contact;
    s->l.system.contact_count = 1;
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

/* Pressed against a plate, contact nodes are counted in at once: the largest frequency stays what it was,
 * where otherwise a stiff contact would move a body that weighs nothing. */
TEST(contacts_are_followed)
{
    struct pressed p;
    struct strained *s = &p.s;
    press_bar(&p, false);
    assert_true(s->preconditioner.has_rigid_mode);
    double alone[2];
    for (int followed = 0; followed < 2; followed++) {
        if (followed) {
            assert_true(preconditioner_follow(&s->preconditioner, &s->l.system, false, NULL, NULL));
            assert_false(preconditioner_follow(&s->preconditioner, &s->l.system, false, NULL, NULL));
        }
        double *mode = lattice_vector(&s->l), *scratch;
        scratch = zeros(2 * s->size, sizeof *scratch);
        alone[followed] =
            system_largest_frequency(&s->l.system, &s->preconditioner, s->u, s->residual, 60, mode, scratch);
    }
    print_message("largest frequency with contacts left out %g, followed %g\n", alone[0], alone[1]);
    AT_MOST(3.0 * alone[1], alone[0]);
    AT_MOST(alone[1], 2.0);
    release_pressed(&p);
}

/* An impact changes no momentum, x . M v for all moves x that the conditions admit, and the kinetic energy
 * falls. */
TEST(impacts_keep_momentum)
{
    enum { MOVES = 5 };
    for (int clamped = 0; clamped < 2; clamped++) {
        struct pressed p;
        struct random random = {11};
        press_bar(&p, clamped);
        struct preconditioner *preconditioner = &p.s.preconditioner;
        double *velocity = lattice_vector(&p.s.l), *field = lattice_vector(&p.s.l), *move[MOVES];
        for (int64_t i = 1; i < p.s.size; i += 2) { /* towards the plate */
            velocity[i] = 1.0;
        }
        constraint_project(&preconditioner->constraint, NULL, velocity);
        double momentum[MOVES], before = preconditioner_square(preconditioner, velocity);
        for (int m = 0; m < MOVES; m++) {
            move[m] = random_move(&p.s, &random);
            momentum[m] = product(&p.s, move[m], velocity);
        }
        assert_true(preconditioner_follow(preconditioner, &p.s.l.system, false, velocity, field));
        double after = preconditioner_square(preconditioner, velocity);
        print_message("kinetic energy before the impact %g, after it %g\n", before, after);
        AT_MOST(after, 0.7 * before);
        for (int m = 0; m < MOVES; m++) {
            double now = product(&p.s, move[m], velocity);
            AT_MOST(fabs(now - momentum[m]), 1e-8 * before);
        }
        release_pressed(&p);
    }
}

RUN_TESTS(NULL, NULL)
