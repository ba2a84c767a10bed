/* How the tests of the force loop make bodies of the fixture's samples, and what they have in common: fields,
 * and a check of every kind of body. */
#pragma once

#include "body_fixture.h"
#include "law_fixture.h"

#include "solid/body/body.h"

enum { MATERIALS = 3 };

/* How a body is made from a sample. */
struct setup {
    bool averaged;
    bool faces;      /* smoothed cells: by averages over faces, not by the table of gradients */
    int model_count; /* points take the models in turn, by their place */
    struct material material[MATERIALS];
    const bool *at_edge;  /* of each node; NULL: none */
    const int32_t *group; /* of each material; NULL: each by itself */
};

static inline struct setup one_material(int model, bool averaged)
{
    struct setup setup = {.averaged = averaged, .model_count = 1};
    setup.material[0] = make_material(model, 3000.0);
    return setup;
}

static inline struct setup three_materials(bool averaged)
{
    struct setup setup = {.averaged = averaged, .model_count = 3};
    setup.material[0] = make_material(MATERIAL_NEO_HOOKEAN, 3000.0);
    setup.material[1] = make_material(law_find("ogden"), 2000.0);
    setup.material[2] = make_material(MATERIAL_NEO_HOOKEAN, 6000.0);
    return setup;
}

/* Materials lie in layers across axis 0. */
static inline int32_t material_at(const struct sample *sample, const struct setup *setup, int64_t q)
{
    return (int32_t)(sample->assembly.x[q * sample->dim] / sample_size * setup->model_count);
}

static inline struct body make_body(const struct sample *sample, const struct setup *setup)
{
    struct body body;
    SCRATCH int32_t *material = NULL;
    ARRAY(material, sample->assembly.point_count);
    for (int64_t q = 0; q < sample->assembly.point_count; q++) {
        material[q] = material_at(sample, setup, q);
    }
    struct body_input input =
        sample_input(sample, setup->faces, setup->material, setup->model_count, material);
    input.cell = setup->averaged ? input.cell : NULL;
    input.at_edge = setup->at_edge;
    input.group = setup->group;
    GOOD(body_build(&input, &body, &error));
    return body;
}

/* u = (A - I) x + b */
static inline double *linear_field(const struct sample *sample, const double *A, const double *b)
{
    int dim = sample->dim;
    double *u = zeros(sample->cloud.node_count * dim, sizeof *u);
    for (int64_t n = 0; n < sample->cloud.node_count; n++) {
        for (int i = 0; i < dim; i++) {
            u[n * dim + i] = b != NULL ? b[i] : 0.0;
            for (int k = 0; k < dim; k++) {
                u[n * dim + i] += (A[3 * i + k] - (i == k)) * sample->cloud.x[n * dim + k];
            }
        }
    }
    return u;
}

static inline double *random_field(const struct sample *sample, double size, struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    double *u = zeros(count, sizeof *u);
    for (int64_t i = 0; i < count; i++) {
        u[i] = size * uniform(random, -1.0, 1.0);
    }
    return u;
}

/* Made once: smoothed cells and Gauss points in 2D, the same in 3D. */
static struct sample samples[4];

static inline int make_samples(void **state)
{
    (void)state;
    omp_set_num_threads(1); /* bodies so small gain nothing by more */
    for (int i = 0; i < 4; i++) {
        samples[i] = make_sample(2 + i / 2, i % 2 == 0, i < 2 ? 6 : 4);
    }
    return 0;
}

static inline int free_samples(void **state)
{
    (void)state;
    for (int i = 0; i < 4; i++) {
        sample_free(&samples[i]);
    }
    return 0;
}

/* Every combination of dimension, integration, material and averaging. */
static inline void for_all(void (*check)(const struct sample *, const struct setup *, struct random *))
{
    struct random random = {1};
    for (int i = 0; i < 4; i++) {
        for (int averaged = 0; averaged < 2; averaged++) {
            for (int faces = 0; faces < 1 + (int)samples[i].smoothed; faces++) {
                for (int model = 0; model < law_count; model++) {
                    struct setup setup = one_material(model, averaged == 1);
                    setup.faces = faces == 1;
                    check(&samples[i], &setup, &random);
                }
                struct setup setup = three_materials(averaged == 1);
                setup.faces = faces == 1;
                check(&samples[i], &setup, &random);
            }
        }
    }
}

static inline double largest(const double *values, int64_t count)
{
    double most = 0.0;
    for (int64_t i = 0; i < count; i++) {
        most = fabs(values[i]) <= most ? most : isnan(values[i]) ? INFINITY : fabs(values[i]);
    }
    return most;
}

/* Random displacements, as large as leaves J > 0.3. */
static inline double *deformed_field(const struct sample *sample, struct body *body, double *force,
                                     struct random *random)
{
    double *u = random_field(sample, 0.05 * sample_size, random);
    while (body_force(body, u, force).least_jacobian < 0.3) {
        for (int64_t i = 0; i < sample->cloud.node_count * sample->dim; i++) {
            u[i] *= 0.9;
        }
    }
    return u;
}

/* In random directions v, f . v = d/dt W(u + t v). */
static inline void check_work(const struct sample *sample, struct body *body, const double *u, int directions,
                              struct random *random)
{
    int64_t count = sample->cloud.node_count * sample->dim;
    double *force = zeros(count, sizeof *force), *at = zeros(count, sizeof *at);
    (void)body_force(body, u, force);
    for (int direction = 0; direction < directions; direction++) {
        double *v = random_field(sample, 1.0, random), work = 0.0, value[4], h = 2e-7, sum = 0.0;
        for (int k = 0; k < 4; k++) {
            for (int64_t i = 0; i < count; i++) {
                at[i] = u[i] + h * (k < 2 ? k - 2 : k - 1) * v[i];
            }
            value[k] = body_energy(body, at);
        }
        for (int64_t i = 0; i < count; i++) {
            work += force[i] * v[i];
            sum += fabs(force[i] * v[i]);
        }
        NEAR_TO(work, (value[0] - 8.0 * value[1] + 8.0 * value[2] - value[3]) / (12.0 * h), 2e-7 * sum);
    }
}
