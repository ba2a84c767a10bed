/* Materials of every law, with parameters of all orders. */
#pragma once

#include "solid/material/law.h"

#include <assert.h>
#include <stddef.h>

/* Each law has a row; its first is the one of make_material. Tests take deformation gradients that
 * differ from I by up to 0.6. */
static const struct sample_law {
    const char *name;
    struct law_input input;
} sample_laws[] = {
    {"neo-hookean", {true, {0}, {0}}},
    {"neo-hookean-log", {true, {0}, {0}}},
    {"mooney-rivlin", {true, {1}, {0.4}}},
    {"mooney-rivlin", {true, {1}, {2.5}}},
    {"mooney-rivlin", {false, {0, 1, 1}, {0, 0, 500}}},
    {"mooney-rivlin", {false, {0, 1, 1}, {0, -100, 300}}},
    {"ogden", {true, {0, 1}, {[6] = -4.7}}},
    {"ogden", {true, {0, 1}, {[6] = 18}}},
    {"ogden", {false, {3, 3}, {400, 100, -30, [6] = 3.3, -2, -1}}},
    {"st-venant-kirchhoff", {true, {0}, {0}}},
    {"yeoh", {false, {1, 1, 1}, {600, -40, 20}}},
    {"trans-iso", {false, {1, 1, 1, 1}, {300, 100, 500, 2}}},
    {"trans-iso", {false, {1, 1, 1, 1, 1, 1}, {300, 0, 500, 3, 900, 1.15}}},
    {"guccione", {false, {1, 1, 1, 1}, {300, 8, 2, 4}}},
    {"guccione", {false, {1, 1, 1, 1}, {900, 1, 1, 1}}},
    {"holzapfel-gasser-ogden", {false, {1, 1, 1}, {300, 500, 0.7}}},
    {"holzapfel-gasser-ogden", {false, {1, 1, 1, 1, 1}, {300, 900, 1.5, 0.2, 40}}},
};
enum { SAMPLE_LAWS = sizeof sample_laws / sizeof sample_laws[0] };

/* Sample law i, scaled to these moduli. */
static inline struct material sample_material(int i, double youngs_modulus, double poisson_ratio)
{
    static double parameters[SAMPLE_LAWS][LAW_NUMBERS];
    static const double fibre[6] = {0.8, 0.6, 0.0, -0.6, 0.8, 0.0};
    struct material material = {.model = law_find(sample_laws[i].name), .density = 1000.0};
    struct law_fault fault = {NULL, NULL};
    double shear = law_prepare(material_laws[material.model], &sample_laws[i].input, parameters[i], &fault);
    assert(shear >= 0.0 && fault.key == NULL);
    (void)shear;
    material.parameters = parameters[i];
    material.fibre = material_laws[material.model]->has_fibres ? fibre : NULL;
    material_set_moduli(&material, youngs_modulus, poisson_ratio);
    return material;
}

static inline struct material make_material(int model, double youngs_modulus)
{
    int i = 0;
    while (law_find(sample_laws[i].name) != model) {
        i++;
        assert(i < SAMPLE_LAWS && "a law of law.c has no row in sample_laws");
    }
    return sample_material(i, youngs_modulus, 0.49);
}
