#include "solid/material/material.h"

#include "base/eigen.h"
#include "base/vector.h"

#include <math.h>

void material_set_moduli(struct material *material, double youngs_modulus, double poisson_ratio)
{
    material->shear_modulus = youngs_modulus / 2.0 / (1.0 + poisson_ratio);
    material->bulk_modulus = youngs_modulus / 3.0 / (1.0 - 2.0 * poisson_ratio);
}

static double lame_lambda(const struct material *material)
{
    return material->bulk_modulus - 2.0 / 3.0 * material->shear_modulus;
}

double material_wave_modulus(const struct material *material)
{
    return material->bulk_modulus + 4.0 / 3.0 * material->shear_modulus;
}

double determinant(const double F[9])
{
    return determinant3(F, F + 3, F + 6);
}

void cofactor(const double F[9], double C[9])
{
    vector_cross(F + 3, F + 6, C);
    vector_cross(F + 6, F, C + 3);
    vector_cross(F, F + 3, C + 6);
}

static double norm2(const double F[9])
{
    return vector_dot(9, F, F);
}

/* C = F^T F, symmetric. */
static void right_cauchy_green(const double F[9], double C[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            C[3 * i + k] = F[i] * F[k] + F[3 + i] * F[3 + k] + F[6 + i] * F[6 + k];
        }
    }
}

/* The product A B. */
static void multiply(const double A[9], const double B[9], double AB[9])
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) {
            AB[3 * i + k] = A[3 * i] * B[k] + A[3 * i + 1] * B[3 + k] + A[3 * i + 2] * B[6 + k];
        }
    }
}

/* mu J^(-2/3) (F - I1/3 F^-T) */
static void neo_hookean_stress(double mu, const double F[9], double P[9])
{
    double C[9], J = determinant(F);
    cofactor(F, C);
    double scale = mu / cbrt(J * J), third = norm2(F) / (3.0 * J);
    for (int i = 0; i < 9; i++) {
        P[i] = scale * (F[i] - third * C[i]);
    }
}

static void neo_hookean_log_stress(double mu, const double F[9], double P[9])
{
    double C[9], J = determinant(F);
    cofactor(F, C);
    for (int i = 0; i < 9; i++) {
        P[i] = mu * (F[i] - C[i] / J);
    }
}

static void mooney_coefficients(const struct material *material, double *c10, double *c01)
{
    *c10 = 0.5 * material->shear_modulus / (1.0 + material->mooney_ratio);
    *c01 = *c10 * material->mooney_ratio;
}

/* I2' part: 2 C01 J^(-4/3) (I1 F - F C - 2/3 I2 F^-T) */
static void mooney_rivlin_stress(const struct material *material, const double F[9], double P[9])
{
    double c10, c01, cof[9], C[9], FC[9], J = determinant(F), I1 = norm2(F);
    mooney_coefficients(material, &c10, &c01);
    neo_hookean_stress(2.0 * c10, F, P);
    cofactor(F, cof);
    right_cauchy_green(F, C);
    double I2 = 0.5 * (I1 * I1 - norm2(C));
    double scale = 2.0 * c01 / (cbrt(J) * J);
    multiply(F, C, FC);
    for (int i = 0; i < 9; i++) {
        P[i] += scale * (I1 * F[i] - FC[i] - 2.0 / 3.0 * I2 * cof[i] / J);
    }
}

/* Isochoric principal stretches to the power alpha, and the directions. */
static void ogden_stretches(const struct material *material, const double F[9], double power[3],
                            double lambda2[3], double V[9])
{
    double C[9], J = determinant(F);
    right_cauchy_green(F, C);
    eigen_symmetric(3, C, lambda2, V);
    for (int a = 0; a < 3; a++) {
        power[a] = pow(lambda2[a] / cbrt(J * J), 0.5 * material->ogden_alpha);
    }
}

/* P = F S, S = sum_a s_a N_a N_a, s_a = 2 mu/alpha (l_a^alpha - mean) / lambda_a^2 */
static void ogden_stress(const struct material *material, const double F[9], double P[9])
{
    double power[3], lambda2[3], V[9], S[9] = {0.0};
    ogden_stretches(material, F, power, lambda2, V);
    double mean = (power[0] + power[1] + power[2]) / 3.0;
    for (int a = 0; a < 3; a++) {
        double s = 2.0 * material->shear_modulus / material->ogden_alpha * (power[a] - mean) / lambda2[a];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) {
                S[3 * i + k] += s * V[3 * i + a] * V[3 * k + a];
            }
        }
    }
    multiply(F, S, P);
}

static void green_lagrange(const double F[9], double E[9])
{
    right_cauchy_green(F, E);
    for (int i = 0; i < 9; i++) {
        E[i] = 0.5 * (E[i] - (i % 4 == 0 ? 1.0 : 0.0));
    }
}

static void st_venant_kirchhoff_stress(const struct material *material, const double F[9], double P[9])
{
    double E[9], FE[9];
    green_lagrange(F, E);
    multiply(F, E, FE);
    double pressure = lame_lambda(material) * (E[0] + E[4] + E[8]);
    for (int i = 0; i < 9; i++) {
        P[i] = pressure * F[i] + 2.0 * material->shear_modulus * FE[i];
    }
}

void material_isochoric_stress(const struct material *material, const double F[9], double P[9])
{
    switch (material->model) {
    case MATERIAL_NEO_HOOKEAN_LOG:
        neo_hookean_log_stress(material->shear_modulus, F, P);
        return;
    case MATERIAL_MOONEY_RIVLIN:
        mooney_rivlin_stress(material, F, P);
        return;
    case MATERIAL_OGDEN:
        ogden_stress(material, F, P);
        return;
    case MATERIAL_ST_VENANT_KIRCHHOFF:
        st_venant_kirchhoff_stress(material, F, P);
        return;
    case MATERIAL_NEO_HOOKEAN:
    case MATERIAL_MODEL_COUNT:
        break;
    }
    neo_hookean_stress(material->shear_modulus, F, P);
}

double material_isochoric_energy(const struct material *material, const double F[9])
{
    double mu = material->shear_modulus, J = determinant(F), I1 = norm2(F);
    double c10, c01, C[9], power[3], lambda2[3], V[9], trace;
    if (!(J > 0.0)) {
        return (double)NAN;
    }
    switch (material->model) {
    case MATERIAL_NEO_HOOKEAN_LOG:
        return 0.5 * mu * (I1 - 3.0) - mu * log(J);
    case MATERIAL_MOONEY_RIVLIN:
        mooney_coefficients(material, &c10, &c01);
        right_cauchy_green(F, C);
        return c10 * (I1 / cbrt(J * J) - 3.0) + c01 * (0.5 * (I1 * I1 - norm2(C)) / (cbrt(J) * J) - 3.0);
    case MATERIAL_OGDEN:
        ogden_stretches(material, F, power, lambda2, V);
        return 2.0 * mu / (material->ogden_alpha * material->ogden_alpha) *
               (power[0] + power[1] + power[2] - 3.0);
    case MATERIAL_ST_VENANT_KIRCHHOFF:
        green_lagrange(F, C);
        trace = C[0] + C[4] + C[8];
        return 0.5 * lame_lambda(material) * trace * trace + mu * norm2(C);
    case MATERIAL_NEO_HOOKEAN:
    case MATERIAL_MODEL_COUNT:
        break;
    }
    return 0.5 * mu * (I1 / cbrt(J * J) - 3.0);
}

double material_volume_strain(const struct material *material, double J)
{
    return material->model == MATERIAL_NEO_HOOKEAN_LOG ? log(J) : J - 1.0;
}

double material_volume_slope(const struct material *material, double J)
{
    return material->model == MATERIAL_NEO_HOOKEAN_LOG ? 1.0 / J : 1.0;
}

double material_volume_energy(const struct material *material, double J)
{
    double strain = material_volume_strain(material, J);
    return 0.5 * material_bulk(material) * strain * strain;
}

double material_pressure(const struct material *material, double J)
{
    return material_bulk(material) * material_volume_strain(material, J) * material_volume_slope(material, J);
}

double material_bulk(const struct material *material)
{
    switch (material->model) {
    case MATERIAL_NEO_HOOKEAN_LOG:
        return lame_lambda(material);
    case MATERIAL_ST_VENANT_KIRCHHOFF:
        return 0.0;
    case MATERIAL_NEO_HOOKEAN:
    case MATERIAL_MOONEY_RIVLIN:
    case MATERIAL_OGDEN:
    case MATERIAL_MODEL_COUNT:
        break;
    }
    return material->bulk_modulus;
}
