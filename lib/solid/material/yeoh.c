/* c1 (I1' - 3) + c2 (I1' - 3)^2 + c3 (I1' - 3)^3 + kappa/2 (J - 1)^2, 2 c1 = mu (also called C10, C20, C30)
 */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

/* The parameters are c_i / mu. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    (void)fault;
    double mu = 2.0 * input->number[0];
    for (int i = 0; i < 3; i++) {
        parameters[i] = input->number[i] / mu;
    }
    return mu;
}

static double energy(const struct material *material, const double F[9])
{
    const double *c = material->parameters;
    double J = determinant(F), x = norm2(F) / cbrt(J * J) - 3.0;
    return material->shear_modulus * x * (c[0] + x * (c[1] + x * c[2]));
}

/* As neo-Hookean, of the modulus 2 dW/dI1'. */
static void stress(const struct material *material, const double F[9], double P[9])
{
    const double *c = material->parameters;
    double J = determinant(F), x = norm2(F) / cbrt(J * J) - 3.0;
    neo_hookean_stress(2.0 * material->shear_modulus * (c[0] + x * (2.0 * c[1] + x * 3.0 * c[2])), F, P);
}

static const struct law_key keys[] = {{"c1", "give it in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
                                      {"c2", NULL, LAW_WITHOUT_E, LAW_ANY},
                                      {"c3", NULL, LAW_WITHOUT_E, LAW_ANY},
                                      {.name = NULL}};

const struct law law_yeoh = {
    .name = "yeoh", .keys = keys, .prepare = prepare, .energy = energy, .stress = stress};
