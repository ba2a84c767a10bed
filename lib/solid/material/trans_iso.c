/* Weiss, Maker and Govindjee (1996), with the fibres of FEBio: c1 (I1' - 3) + c2 (I2' - 3) + f(l) + kappa/2
 * (J - 1)^2, l' isochoric stretch of the fibres; l' f'(l') is 0 for l' < 1, c3 (exp(c4 (l' - 1)) - 1), and
 * from lambda_max on linear with the slope c5. */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

enum { C1, C2, C3, C4, C5, LAMBDA_MAX };

/* The parameters are the numbers of the keys, those in Pa relative to mu. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    const double *number = input->number;
    double matrix = 2.0 * (number[C1] + number[C2]), mu = matrix + number[C3] * number[C4] / 15.0;
    if (!(matrix > 0.0)) {
        return law_refuse(fault, "c1", "c1 + c2 is not positive: the law is not elliptic at rest");
    }
    if (input->given[C5] > 0 && input->given[LAMBDA_MAX] == 0) {
        return law_refuse(fault, "c5", "not allowed: it goes with lambda_max");
    }
    for (int i = C1; i <= LAMBDA_MAX; i++) {
        parameters[i] = number[i] / (i == C4 || i == LAMBDA_MAX ? 1.0 : mu);
    }
    return mu;
}

static void rest(const struct material *material, struct material_rest *rest)
{
    const double *p = material->parameters;
    rest->shear = rest->along = 2.0 * (p[C1] + p[C2]) * material->shear_modulus;
    rest->fibre[0] = p[C3] * p[C4] / 3.0 * material->shear_modulus;
}

/* From where on the fibres are straight. */
static double longest(const double *p)
{
    return p[LAMBDA_MAX] > 0.0 ? p[LAMBDA_MAX] : INFINITY;
}

/* c6 of the line c5 l + c6 that continues l f'(l). */
static double offset(const double *p)
{
    return p[C3] * expm1(p[C4] * (p[LAMBDA_MAX] - 1.0)) - p[C5] * p[LAMBDA_MAX];
}

/* The integral of (exp(c (t - 1)) - 1) / t from 1 to l, by the series of exp(c t). */
static double exponential_integral(double c, double l)
{
    double weight = exp(-c), log_l = log(l), sum = weight * log_l, term = sum;
    for (int k = 1; k < c * l || term > 1e-17 * sum; k++) {
        weight *= c / k;
        term = weight * expm1(k * log_l) / k;
        sum += term;
    }
    return sum - log_l;
}

static double energy(const struct material *material, const double F[9])
{
    const double *p = material->parameters;
    double l = sqrt(fibre_square(isochoric_scale(F), F, material->fibre)), most = longest(p);
    double sum = mooney_energy(p[C1], p[C2], F);
    if (l > 1.0) {
        sum += p[C3] * exponential_integral(p[C4], fmin(l, most));
    }
    if (l > most) {
        sum += p[C5] * (l - most) + offset(p) * log(l / most);
    }
    return material->shear_modulus * sum;
}

static void stress(const struct material *material, const double F[9], double P[9])
{
    const double *p = material->parameters;
    double mu = material->shear_modulus, scale = isochoric_scale(F);
    double square = fibre_square(scale, F, material->fibre), l = sqrt(square);
    mooney_stress(mu * p[C1], mu * p[C2], F, P);
    if (l > 1.0) {
        double along = l < longest(p) ? p[C3] * expm1(p[C4] * (l - 1.0)) : p[C5] * l + offset(p);
        add_fibre_stress(scale, F, material->fibre, mu * along / (2.0 * square), P);
    }
}

static const struct law_key keys[] = {
    [C1] = {"c1", "give it in Pa", LAW_WITHOUT_E, LAW_ANY},
    [C2] = {"c2", NULL, LAW_WITHOUT_E, LAW_ANY},
    [C3] = {"c3", "give it in Pa", LAW_WITHOUT_E, LAW_NOT_NEGATIVE},
    [C4] = {"c4", "give the exponent of the fibres", LAW_WITHOUT_E, 0.0, 500.0, true, 1},
    [C5] = {"c5", NULL, LAW_WITHOUT_E, LAW_NOT_NEGATIVE},
    [LAMBDA_MAX] = {"lambda_max", NULL, LAW_WITHOUT_E, 1.0, 100.0, true, 1},
    {.name = NULL}};

const struct law law_trans_iso = {.name = "trans-iso",
                                  .keys = keys,
                                  .has_fibres = true,
                                  .slackens = true,
                                  .prepare = prepare,
                                  .rest = rest,
                                  .energy = energy,
                                  .stress = stress};
