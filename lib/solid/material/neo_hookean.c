/* mu/2 (I1' - 3) + kappa/2 (J - 1)^2 */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

double neo_hookean_energy(double mu, const double F[9])
{
    double J = determinant(F), I1 = norm2(F);
    return 0.5 * mu * (I1 / cbrt(J * J) - 3.0);
}

/* mu J^(-2/3) (F - I1/3 F^-T) */
void neo_hookean_stress(double mu, const double F[9], double P[9])
{
    double C[9], J = determinant(F);
    cofactor(F, C);
    double scale = mu / cbrt(J * J), third = norm2(F) / (3.0 * J);
    for (int i = 0; i < 9; i++) {
        P[i] = scale * (F[i] - third * C[i]);
    }
}

static double energy(const struct material *material, const double F[9])
{
    return neo_hookean_energy(material->shear_modulus, F);
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    neo_hookean_stress(material->shear_modulus, F, P);
}

static const struct law_key keys[] = {{"mu", "give the shear modulus in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
                                      {.name = NULL}};

const struct law law_neo_hookean = {
    .name = "neo-hookean", .keys = keys, .by_e = true, .energy = energy, .stress = stress};
