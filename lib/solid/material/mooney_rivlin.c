/* c1 (I1' - 3) + c2 (I2' - 3) + kappa/2 (J - 1)^2, c1 + c2 = mu/2 > 0 (also called C10 and C01) */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

double mooney_energy(double c1, double c2, const double F[9])
{
    double C[9], J = determinant(F), I1 = norm2(F);
    right_cauchy_green(F, C);
    return c1 * (I1 / cbrt(J * J) - 3.0) + c2 * (0.5 * (I1 * I1 - norm2(C)) / (cbrt(J) * J) - 3.0);
}

/* The part of I2' is 2 c2 J^(-4/3) (I1 F - F C - 2/3 I2 F^-T) */
void mooney_stress(double c1, double c2, const double F[9], double P[9])
{
    double cof[9], C[9], FC[9], J = determinant(F), I1 = norm2(F);
    neo_hookean_stress(2.0 * c1, F, P);
    if (!(fabs(c2) > 0.0)) {
        return;
    }
    cofactor(F, cof);
    right_cauchy_green(F, C);
    double I2 = 0.5 * (I1 * I1 - norm2(C));
    double scale = 2.0 * c2 / (cbrt(J) * J);
    multiply(F, C, FC);
    for (int i = 0; i < 9; i++) {
        P[i] += scale * (I1 * F[i] - FC[i] - 2.0 / 3.0 * I2 * cof[i] / J);
    }
}

enum { RATIO, C1, C2 };

/* The only parameter is c2 / c1; c1 = 0 is a huge one. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    static const double without_c1 = 1e100;
    const double *number = input->number;
    if (input->by_e) {
        parameters[RATIO] = number[RATIO];
        return 0.0;
    }
    if (!(number[C1] + number[C2] > 0.0)) {
        return law_refuse(fault, "c1", "c1 + c2 is not positive: the law is not elliptic at rest");
    }
    parameters[RATIO] =
        fabs(number[C2]) < without_c1 * fabs(number[C1]) ? number[C2] / number[C1] : without_c1;
    return 2.0 * (number[C1] + number[C2]);
}

static void coefficients(const struct material *material, double *c1, double *c2)
{
    double ratio = material->parameters[RATIO];
    *c1 = 0.5 * material->shear_modulus / (1.0 + ratio);
    *c2 = *c1 * ratio;
}

static double energy(const struct material *material, const double F[9])
{
    double c1, c2;
    coefficients(material, &c1, &c2);
    return mooney_energy(c1, c2, F);
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    double c1, c2;
    coefficients(material, &c1, &c2);
    mooney_stress(c1, c2, F, P);
}

static const struct law_key keys[] = {[RATIO] = {"ratio", "give c2 / c1", LAW_WITH_E, LAW_NOT_NEGATIVE},
                                      [C1] = {"c1", "give c1 and c2 in Pa", LAW_WITHOUT_E, LAW_ANY},
                                      [C2] = {"c2", "give c1 and c2 in Pa", LAW_WITHOUT_E, LAW_ANY},
                                      {.name = NULL}};

const struct law law_mooney_rivlin = {.name = "mooney-rivlin",
                                      .keys = keys,
                                      .by_e = true,
                                      .prepare = prepare,
                                      .energy = energy,
                                      .stress = stress};
