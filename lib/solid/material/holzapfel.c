/* Gasser, Ogden and Holzapfel (2006): c/2 (I1' - 3) + kappa/2 (J - 1)^2 and, of each of two families of
 * fibres, k1 / (2 k2) (exp(k2 E^2) - 1), E = d (I1' - 3) + (1 - 3 d) (I4' - 1) > 0 with the dispersion d; the
 * families lie at the angles gamma and -gamma, in degrees, from the direction of the fibres. */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

enum { C, K1, K2, DISPERSION, GAMMA, COSINE = GAMMA, SINE };

/* The parameters are the numbers of the keys, those in Pa relative to mu, and the cosine and sine of
 * gamma. At rest a family has the modulus 4
 * k1 (1 - 3 d)^2 along its direction. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    (void)fault;
    const double *number = input->number;
    double gamma = number[GAMMA] / 180.0 * acos(-1.0), aligned = 1.0 - 3.0 * number[DISPERSION];
    double mu = number[C] + 2.0 * 4.0 * number[K1] * aligned * aligned / 15.0;
    for (int i = C; i < GAMMA; i++) {
        parameters[i] = number[i] / (i <= K1 ? mu : 1.0);
    }
    parameters[COSINE] = cos(gamma);
    parameters[SINE] = sin(gamma);
    return mu;
}

/* The direction of family 0 or 1. */
static void direction(const struct material *material, int family, double a[3])
{
    double along = material->parameters[COSINE], across = material->parameters[SINE];
    for (int i = 0; i < 3; i++) {
        a[i] = along * material->fibre[i] + (family == 0 ? across : -across) * material->fibre[3 + i];
    }
}

static void rest(const struct material *material, struct material_rest *rest)
{
    const double *p = material->parameters;
    double aligned = 1.0 - 3.0 * p[DISPERSION];
    rest->shear = rest->along = p[C] * material->shear_modulus;
    for (rest->families = 0; rest->families < 2; rest->families++) {
        rest->fibre[rest->families] = 4.0 / 3.0 * p[K1] * aligned * aligned * material->shear_modulus;
        direction(material, rest->families, rest->direction[rest->families]);
    }
}

/* E, where it is positive. */
static double strain(const struct material *material, double scale, const double F[9], const double a[3])
{
    double d = material->parameters[DISPERSION];
    double E = d * (scale * norm2(F) - 3.0) + (1.0 - 3.0 * d) * (fibre_square(scale, F, a) - 1.0);
    return fmax(E, 0.0);
}

static double energy(const struct material *material, const double F[9])
{
    const double *p = material->parameters;
    double a[3], scale = isochoric_scale(F), sum = neo_hookean_energy(p[C], F);
    for (int family = 0; family < 2; family++) {
        direction(material, family, a);
        double E = strain(material, scale, F, a);
        sum += p[K1] / (2.0 * p[K2]) * expm1(p[K2] * E * E);
    }
    return material->shear_modulus * sum;
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    const double *p = material->parameters;
    double a[3], slope[2], mu = material->shear_modulus, d = p[DISPERSION], scale = isochoric_scale(F);
    for (int family = 0; family < 2; family++) {
        direction(material, family, a);
        double E = strain(material, scale, F, a);
        slope[family] = mu * p[K1] * E * exp(p[K2] * E * E);
    }
    neo_hookean_stress(mu * p[C] + 2.0 * d * (slope[0] + slope[1]), F, P);
    for (int family = 0; family < 2; family++) {
        direction(material, family, a);
        add_fibre_stress(scale, F, a, (1.0 - 3.0 * d) * slope[family], P);
    }
}

static const struct law_key keys[] = {
    [C] = {"c", "give it in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
    [K1] = {"k1", "give it in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
    [K2] = {"k2", "give the exponent of the fibres", LAW_WITHOUT_E, LAW_POSITIVE},
    [DISPERSION] = {"dispersion", NULL, LAW_WITHOUT_E, 0.0, 1.0 / 3.0, false, 1},
    [GAMMA] = {"gamma", NULL, LAW_WITHOUT_E, 0.0, 90.0, false, 1},
    {.name = NULL}};

const struct law law_holzapfel = {.name = "holzapfel-gasser-ogden",
                                  .keys = keys,
                                  .has_fibres = true,
                                  .slackens = true,
                                  .plane = "gamma",
                                  .prepare = prepare,
                                  .rest = rest,
                                  .energy = energy,
                                  .stress = stress};
