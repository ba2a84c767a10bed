/* Contact between facets of the body: two boxes side by side, made of one sample, the other one moved along
 * axis 0; they meet in its xmax and xmin. Forces are minus the gradient of the energy, without resultant and
 * moment; gaps of linear fields are exact; looking only where that is needed changes nothing; of a boundary
 * against itself one of two facets leads, and a box does not touch itself. */
#include "body_setup.h"

#include "solid/contact/contact_between.h"
#include "solid/contact/friction.h"

enum { LOW_SIDE = 0, HIGH_SIDE = 1 }; /* xmin, xmax */

struct pair {
    const struct sample *sample;
    int64_t nodes; /* of one box */
    double *X;     /* of both */
    struct boundary_averages points, averages;
    int32_t *part;
    struct contact contact;
    bool any; /* facets face each other at rest */
};

/* The opposite facets become those of the other box. */
static void move_over(const struct pair *pair, struct opposite *opposite)
{
    int dim = pair->sample->dim;
    for (int64_t v = 0; v < opposite->rows.count; v++) {
        opposite->rows.node[v] += (int32_t)pair->nodes;
        opposite->rest[v * dim] += sample_size;
    }
    for (int64_t i = 0; i < opposite->rows.ptr[opposite->rows.count]; i++) {
        opposite->rows.idx[i] += (int32_t)pair->nodes;
    }
    for (int64_t f = 0; f < opposite->surface.facet_count; f++) {
        opposite->middle[f * dim] += sample_size;
        opposite->part[f] = 1;
    }
}

/* Both boxes, or the whole boundary of one against itself; the contact refers to *pair. */
static void make_pair(const struct sample *sample, bool itself, struct pair *pair)
{
    *pair = (struct pair){.sample = sample, .nodes = sample->cloud.node_count};
    struct face_table table = sample_face_table(sample);
    struct opposite opposite;
    int dim = sample->dim;
    struct facet_set points = facets_of_side(sample, itself ? -1 : HIGH_SIDE);
    struct facet_set others = itself ? points : facets_of_side(sample, LOW_SIDE);
    pair->X = zeros(2 * pair->nodes * dim, sizeof *pair->X);
    pair->part = zeros(2 * pair->nodes, sizeof *pair->part);
    for (int64_t i = 0; i < 2 * pair->nodes * dim; i++) {
        bool second = i >= pair->nodes * dim;
        pair->X[i] = sample->cloud.x[i % (pair->nodes * dim)] + (second && i % dim == 0 ? sample_size : 0.0);
    }
    GOOD(boundary_points_build(&table, &points, &pair->points, &error));
    GOOD(boundary_averages_build(&table, &points, &pair->averages, &error));
    GOOD(opposite_build(&table, &others, pair->part, itself, &opposite, &error));
    if (!itself) {
        move_over(pair, &opposite);
        double *u = zeros(2 * pair->nodes * dim, sizeof *u);
        opposite_move(&opposite, u);
    }
    GOOD(contact_between_build(&pair->points, &pair->averages, dim, 2 * pair->nodes, table.per_face,
                               &opposite, pair->part, itself ? 0 : 1, 1e5, NULL, NULL, true, &pair->contact,
                               &pair->any, &error));
}

static void pair_free(struct pair *pair)
{
    contact_free(&pair->contact);
    boundary_averages_free(&pair->points);
    boundary_averages_free(&pair->averages);
}

static int64_t pressing(const struct contact *contact)
{
    int64_t count = 0;
    for (int64_t p = 0; p < contact->count; p++) {
        count += contact->pressure[p] > 0.0;
    }
    return count;
}

/* A field in which the boxes overlap by `depth` and are rough. */
static void overlap(const struct pair *pair, double depth, double rough, struct random *random, double *u)
{
    int dim = pair->sample->dim;
    for (int64_t i = 0; i < 2 * pair->nodes * dim; i++) {
        double closer = i >= pair->nodes * dim && i % dim == 0 ? -depth : 0.0;
        u[i] = closer + rough * uniform(random, -1.0, 1.0);
    }
}

static void hold(struct contact *contact, struct random *random)
{
    int64_t dim = contact->dim;
    for (int64_t i = 0; i < contact_nodes(contact)->count * dim; i++) { /* the points press along axis 0 */
        contact->multiplier[i] = i % dim == 0 ? uniform(random, -200.0, 0.0) : uniform(random, -50.0, 50.0);
    }
    contact_spread_multipliers(contact);
}

TEST(force_is_gradient)
{
    struct random random = {1};
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], false, &pair);
        int64_t size = 2 * pair.nodes * samples[s].dim;
        double *u = zeros(size, sizeof *u), *force = zeros(size, sizeof *force);
        double *aside = zeros(size, sizeof *aside), h = 1e-8, most = 0.0;
        assert_true(pair.any);
        hold(&pair.contact, &random);
        overlap(&pair, 1e-3, 5e-4, &random, u);
        contact_force(&pair.contact, u, force);
        assert_true(pressing(&pair.contact) > pair.contact.count / 2);
        for (int64_t i = 0; i < size; i++) {
            most = fmax(most, fabs(force[i]));
        }
        for (int64_t i = 0; i < size; i += 1 + size / 150) {
            double at = u[i], energy[2];
            for (int side = 0; side < 2; side++) {
                u[i] = at + (side ? h : -h);
                contact_force(&pair.contact, u, aside);
                energy[side] = contact_energy(&pair.contact);
            }
            u[i] = at;
            NEAR_TO(force[i], -(energy[1] - energy[0]) / (2.0 * h), 2e-4 * most);
        }
    }
}

/* Friction, from an accepted state on: minus the gradient of its energy, without resultant, where points
 * stick and slip. As they slide, the energy falls by what is dissipated, and the force stays. */
TEST(friction)
{
    struct random random = {5};
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], false, &pair);
        struct contact *contact = &pair.contact;
        int64_t size = 2 * pair.nodes * samples[s].dim, sticks = 0, slips = 0;
        double *u = zeros(size, sizeof *u), *force = zeros(size, sizeof *force), h = 1e-9, most = 0.0,
               sum[3] = {0.0};
        double *aside = zeros(size, sizeof *aside);
        GOOD(friction_build(contact, 0.4, 1.0, false, &error));
        overlap(&pair, 1e-3, 1e-4, &random, u);
        contact_measure(contact, u, true);
        contact_accept(contact);
        friction_slide(contact);
        for (int64_t i = 0; i < size; i++) {
            u[i] += uniform(&random, -8e-4, 8e-4);
        }
        contact_force(contact, u, force);
        for (int64_t p = 0; p < contact->count; p++) {
            sticks += friction_sticks(contact, p);
            slips += friction_acts(contact, p) && !friction_sticks(contact, p);
        }
        assert_true(sticks > contact->count / 10 && slips > contact->count / 10);
        for (int64_t i = 0; i < size; i++) {
            most = fmax(most, fabs(force[i]));
            sum[i % samples[s].dim] += force[i];
        }
        for (int64_t i = 0; i < size; i += 1 + size / 150) {
            double at = u[i], energy[2];
            NEAR_TO(sum[i % samples[s].dim], 0.0, 1e-12 * most);
            for (int side = 0; side < 2; side++) {
                u[i] = at + (side ? h : -h);
                contact_force(contact, u, aside);
                energy[side] = contact_energy(contact);
            }
            u[i] = at;
            NEAR_TO(force[i], -(energy[1] - energy[0]) / (2.0 * h), 1e-3 * most);
        }
        contact_measure(contact, u, true);
        double before = contact_energy(contact), done = contact->friction->dissipated;
        friction_slide(contact);
        done = contact->friction->dissipated - done;
        assert_true(done > 0.01 * before);
        NEAR_TO(contact_energy(contact) + done, before, 1e-12 * before);
        double total[3], again[3];
        contact_total(contact, total);
        contact_measure(contact, u, true);
        contact_total(contact, again);
        for (int a = 0; a < samples[s].dim; a++) { /* the corners that react may be others */
            NEAR_TO(again[a], total[a], 1e-9 * most);
        }
    }
}

TEST(forces_balance)
{
    struct random random = {2};
    for (int round = 0; round < 12; round++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[round % 4], false, &pair);
        int dim = pair.sample->dim;
        int64_t size = 2 * pair.nodes * dim;
        double *u = zeros(size, sizeof *u), *force = zeros(size, sizeof *force);
        double sum[3] = {0.0}, moment[3] = {0.0}, levers[3] = {0.0}, total[3], scale = 0.0;
        hold(&pair.contact, &random);
        overlap(&pair, 1e-3, 1e-3, &random, u);
        contact_force(&pair.contact, u, force);
        contact_total(&pair.contact, total);
        for (int64_t n = 0; n < 2 * pair.nodes; n++) {
            double x[3] = {0.0}, f[3] = {0.0};
            for (int a = 0; a < dim; a++) {
                x[a] = pair.X[n * dim + a] + u[n * dim + a];
                f[a] = force[n * dim + a];
                sum[a] += f[a];
                scale += fabs(f[a]);
            }
            for (int a = 0; a < 3; a++) {
                moment[a] += x[(a + 1) % 3] * f[(a + 2) % 3] - x[(a + 2) % 3] * f[(a + 1) % 3];
            }
        }
        /* The line of a force goes through y_p, which is held_p / k_p from where the force acts. */
        for (int64_t p = 0; p < pair.contact.count; p++) {
            const double *held = pair.contact.held + p * dim;
            double lever[3] = {0.0}, f[3] = {0.0};
            contact_point_force(&pair.contact, p, f);
            for (int a = 0; a < dim; a++) {
                lever[a] = held[a] / pair.contact.stiffness[p];
            }
            for (int a = 0; a < 3; a++) {
                levers[a] += lever[(a + 1) % 3] * f[(a + 2) % 3] - lever[(a + 2) % 3] * f[(a + 1) % 3];
            }
        }
        assert_true(total[0] < -1e-3 * scale); /* the points are on the left, and are pushed back */
        for (int a = 0; a < 3; a++) {
            NEAR_TO(sum[a], 0.0, 1e-14 * scale);
            NEAR_TO(moment[a], levers[a], 1e-14 * sample_size * scale);
        }
    }
}

/* Points that are held, and pass the creases of a hollow side, into which they bulge: their tractions change
 * by no more than the penalty times the way. */
TEST(creases)
{
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], false, &pair);
        struct contact *contact = &pair.contact;
        int dim = pair.sample->dim;
        int64_t size = 2 * pair.nodes * dim, turned = 0;
        double *u = zeros(size, sizeof *u), *before = zeros(contact->count * 3, sizeof *before), way = 1e-5;
        for (int64_t a = 0; a < pair.averages.count; a++) {
            contact->multiplier[a * dim] = -150.0;
        }
        contact_spread_multipliers(contact);
        for (int step = 0; step < 1000; step++) {
            for (int64_t n = 0; n < 2 * pair.nodes; n++) {
                double aside = pair.X[n * dim + 1] - 0.5 * sample_size;
                u[n * dim] = -8.0 * aside * aside - (n < pair.nodes ? 0.0 : 1e-3);
                u[n * dim + 1] = n < pair.nodes ? way * step : 0.0;
            }
            contact_measure(contact, u, true);
            for (int64_t p = 0; p < contact->count; p++) {
                double traction[3] = {0.0}, change2 = 0.0;
                for (int a = 0; a < dim; a++) {
                    traction[a] = contact->pressure[p] * contact->normal[p * dim + a];
                    change2 += pow(traction[a] - before[p * 3 + a], 2);
                    before[p * 3 + a] = traction[a];
                }
                bool on = contact->gap[p] < INFINITY && contact->pressure[p] > 0.0;
                assert_true(step == 0 || !on || sqrt(change2) <= contact->stiffness[p] * way * 1.001);
                turned += contact->view[p].turned;
            }
        }
        assert_true(turned > 10);
    }
}

/* A linear field that shifts the other box into the first: the same gap at all points. */
TEST(linear_fields)
{
    static const double turned[9] = {0.8, -0.6, 0.0, 0.6, 0.8, 0.0, 0.0, 0.0, 1.0};
    static const double stretch[3] = {0.9, 1.2, 0.95};
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], false, &pair);
        int dim = pair.sample->dim;
        double *u = zeros(2 * pair.nodes * dim, sizeof *u), depth = 1e-3;
        for (int64_t n = 0; n < 2 * pair.nodes; n++) {
            for (int a = 0; a < dim; a++) {
                double x = 0.0;
                for (int b = 0; b < dim; b++) {
                    double away = n >= pair.nodes && b == 0 ? depth : 0.0;
                    x += turned[3 * a + b] * (stretch[b] * pair.X[n * dim + b] - away);
                }
                u[n * dim + a] = x - pair.X[n * dim + a];
            }
        }
        contact_measure(&pair.contact, u, true);
        for (int64_t p = 0; p < pair.contact.count; p++) {
            NEAR_TO(pair.contact.gap[p], -depth, 1e-12);
            NEAR_TO(pair.contact.normal[p * dim], -turned[0], 1e-10);
        }
    }
}

/* Along walks in and out of contact the forces are the same bits as when every point always looks. */
TEST(skipping)
{
    struct random random = {3};
    int64_t touches = 0, skipped = 0, steps = 0;
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], false, &pair);
        FREED_BY(pair_free) struct pair always;
        make_pair(&samples[s], false, &always);
        int64_t size = 2 * pair.nodes * samples[s].dim;
        double *u = zeros(size, sizeof *u), *force = zeros(size, sizeof *force);
        double *expected = zeros(size, sizeof *expected);
        for (int step = 0; step < 150; step++) {
            double away = 1e-3 * sin(0.05 * step);
            for (int64_t i = 0; i < size; i++) {
                bool closer = i >= pair.nodes * samples[s].dim && i % samples[s].dim == 0;
                u[i] = 0.98 * u[i] + uniform(&random, -1e-5, 1e-5) + (closer ? 0.02 * away : 0.0);
            }
            for (int64_t p = 0; p < always.contact.count; p++) {
                always.contact.between->checked_free[p] = -INFINITY;
            }
            memset(force, 0, (size_t)size * sizeof *force);
            memset(expected, 0, (size_t)size * sizeof *expected);
            contact_force(&pair.contact, u, force);
            contact_force(&always.contact, u, expected);
            assert_memory_equal(force, expected, (size_t)size * sizeof *force);
            contact_accept(&pair.contact);
            contact_accept(&always.contact);
            if (step % 40 == 39) {
                contact_augment(&pair.contact);
                contact_augment(&always.contact);
            }
            for (int64_t p = 0; p < pair.contact.count; p++) {
                skipped += !pair.contact.view[p].searched;
                steps++;
            }
            touches += pressing(&pair.contact);
        }
    }
    assert_true(touches > steps / 10 && skipped > steps / 5);
}

/* What faces a point through the body is not opposite to it, however the body is deformed. */
TEST(box_against_itself)
{
    struct random random = {4};
    for (int s = 0; s < 4; s++) {
        FREED_BY(pair_free) struct pair pair;
        make_pair(&samples[s], true, &pair);
        const struct opposite *opposite = &pair.contact.between->opposite;
        int dim = pair.sample->dim;
        int64_t size = 2 * pair.nodes * dim;
        double *u = zeros(size, sizeof *u);
        assert_false(pair.any);
        for (int round = 0; round < 20; round++) {
            for (int64_t i = 0; i < size; i++) { /* flattened, sheared and rough */
                double x = pair.X[i - i % dim + 1];
                u[i] = uniform(&random, -3e-3, 3e-3) + (i % dim == 1   ? -0.5 * x
                                                        : i % dim == 0 ? 0.8 * x
                                                                       : 0.0);
            }
            contact_measure(&pair.contact, u, round % 2 == 0);
            assert_int_equal(pressing(&pair.contact), 0);
        }
        for (int64_t f = 0; f < opposite->surface.facet_count; f++) {
            for (int64_t g = 0; g < f; g++) {
                bool one = opposite_leads(opposite, opposite->rest_normal + f * dim, f, g);
                bool other = opposite_leads(opposite, opposite->rest_normal + g * dim, g, f);
                assert_true(one != other);
            }
        }
    }
}

RUN_TESTS(make_samples, free_samples)
