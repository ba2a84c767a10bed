/* mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2 */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

static double energy(const struct material *material, const double F[9])
{
    double mu = material->shear_modulus;
    return 0.5 * mu * (norm2(F) - 3.0) - mu * log(determinant(F));
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    double C[9], mu = material->shear_modulus, J = determinant(F);
    cofactor(F, C);
    for (int i = 0; i < 9; i++) {
        P[i] = mu * (F[i] - C[i] / J);
    }
}

static const struct law_key keys[] = {{"mu", "give the shear modulus in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
                                      {.name = NULL}};

const struct law law_neo_hookean_log = {.name = "neo-hookean-log",
                                        .keys = keys,
                                        .by_e = true,
                                        .volume = LAW_VOLUME_LOG,
                                        .energy = energy,
                                        .stress = stress};
