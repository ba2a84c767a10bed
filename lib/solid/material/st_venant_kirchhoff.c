/* lambda/2 (tr E)^2 + mu E:E, E = (F^T F - I)/2 */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

static double lambda(const struct material *material)
{
    return material->bulk_modulus - 2.0 / 3.0 * material->shear_modulus;
}

static double energy(const struct material *material, const double F[9])
{
    double E[9];
    green_lagrange(F, E);
    double trace = E[0] + E[4] + E[8];
    return 0.5 * lambda(material) * trace * trace + material->shear_modulus * norm2(E);
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    double E[9], FE[9];
    green_lagrange(F, E);
    multiply(F, E, FE);
    double pressure = lambda(material) * (E[0] + E[4] + E[8]);
    for (int i = 0; i < 9; i++) {
        P[i] = pressure * F[i] + 2.0 * material->shear_modulus * FE[i];
    }
}

static const struct law_key keys[] = {{"mu", "give the shear modulus in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
                                      {.name = NULL}};

const struct law law_st_venant_kirchhoff = {.name = "st-venant-kirchhoff",
                                            .keys = keys,
                                            .by_e = true,
                                            .volume = LAW_VOLUME_NONE,
                                            .energy = energy,
                                            .stress = stress};
