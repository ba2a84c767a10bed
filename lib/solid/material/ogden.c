/* sum 2 mu_i/alpha_i^2 (l1^alpha_i + l2^alpha_i + l3^alpha_i - 3) + kappa/2 (J - 1)^2, l isochoric principal
 * stretches; sum mu_i = mu > 0 */
#include "base/eigen.h"
#include "solid/material/law.h"
#include "solid/material/tensor.h"

enum { MU, ALPHA, TERMS = 6 };

/* The parameters are mu_i / mu and, TERMS behind, alpha_i, which is 0 behind the last term. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    const double *mu = input->number, *alpha = mu + TERMS;
    int terms = input->given[ALPHA];
    double sum = 0.0;
    for (int i = 0; i < terms; i++) {
        sum += mu[i];
        if (!(fabs(alpha[i]) > 0.0)) {
            return law_refuse(fault, "alpha", "must not be 0");
        }
    }
    if (input->by_e ? terms != 1 : terms != input->given[MU]) {
        return law_refuse(fault, "alpha",
                          input->by_e ? "E goes with one number; several terms need as many mu"
                                      : "mu and alpha have different numbers of terms");
    }
    if (!input->by_e && !(sum > 0.0)) {
        return law_refuse(fault, "mu", "the sum is not positive: the law is not elliptic at rest");
    }
    for (int i = 0; i < TERMS; i++) {
        parameters[i] = input->by_e ? (i == 0 ? 1.0 : 0.0) : mu[i] / sum;
        parameters[TERMS + i] = alpha[i];
    }
    return sum;
}

static bool has_term(const struct material *material, int i)
{
    return i < TERMS && fabs(material->parameters[TERMS + i]) > 0.0;
}

/* Squares of the principal stretches, also of the isochoric ones, and the directions. */
static void stretches(const double F[9], double lambda2[3], double isochoric2[3], double V[9])
{
    double C[9], J = determinant(F);
    right_cauchy_green(F, C);
    eigen_symmetric(3, C, lambda2, V);
    for (int a = 0; a < 3; a++) {
        isochoric2[a] = lambda2[a] / cbrt(J * J);
    }
}

static void powers(const double isochoric2[3], double alpha, double power[3])
{
    for (int a = 0; a < 3; a++) {
        power[a] = pow(isochoric2[a], 0.5 * alpha);
    }
}

static double energy(const struct material *material, const double F[9])
{
    double lambda2[3], isochoric2[3], V[9], power[3], sum = 0.0;
    stretches(F, lambda2, isochoric2, V);
    for (int i = 0; has_term(material, i); i++) {
        double mu = material->shear_modulus * material->parameters[i];
        double alpha = material->parameters[TERMS + i];
        powers(isochoric2, alpha, power);
        sum += 2.0 * mu / (alpha * alpha) * (power[0] + power[1] + power[2] - 3.0);
    }
    return sum;
}

/* P = F S, S = sum_a s_a N_a N_a, s_a = sum_i 2 mu_i/alpha_i (l_a^alpha_i - mean) / lambda_a^2 */
static void stress(const struct material *material, const double F[9], double P[9])
{
    double lambda2[3], isochoric2[3], V[9], power[3], s[3] = {0.0}, S[9] = {0.0};
    stretches(F, lambda2, isochoric2, V);
    for (int i = 0; has_term(material, i); i++) {
        double mu = material->shear_modulus * material->parameters[i];
        double alpha = material->parameters[TERMS + i];
        powers(isochoric2, alpha, power);
        double mean = (power[0] + power[1] + power[2]) / 3.0;
        for (int a = 0; a < 3; a++) {
            s[a] += 2.0 * mu / alpha * (power[a] - mean) / lambda2[a];
        }
    }
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                S[3 * i + k] += s[a] * V[3 * i + a] * V[3 * k + a];
            }
        }
    }
    multiply(F, S, P);
}

static const struct law_key keys[] = {
    [MU] = {"mu", "give one in Pa for each alpha", LAW_WITHOUT_E, -DBL_MAX, DBL_MAX, false, TERMS},
    [ALPHA] = {"alpha", "give the exponents, up to six", LAW_ALWAYS, -DBL_MAX, DBL_MAX, false, TERMS},
    {.name = NULL}};

const struct law law_ogden = {
    .name = "ogden", .keys = keys, .by_e = true, .prepare = prepare, .energy = energy, .stress = stress};
