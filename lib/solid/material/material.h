/* Hyperelastic materials: energy per reference volume, first Piola stress, and their volumetric part.
 *
 * Equation (11) of lib/README.md: W(F) = W_iso(F) + U(J), U = kappa/2 y(J)^2 with y = J - 1, or ln J and
 * lambda for kappa. Only U is averaged over nodal volumes. W_iso is isochoric for the models with J^(-2/3)
 * below; for the logarithmic one it is the rest of W, and St. Venant-Kirchhoff has no such split (U = 0). F
 * is 3 x 3 row-major; plane strain has F33 = 1. Units Pa.
 *
 *   neo-Hookean            mu/2 (I1' - 3) + kappa/2 (J - 1)^2
 *   neo-Hookean (log)      mu/2 (I1 - 3) - mu ln J + lambda/2 (ln J)^2
 *   Mooney-Rivlin          C10 (I1' - 3) + C01 (I2' - 3) + kappa/2 (J - 1)^2
 *   Ogden                  2 mu/alpha^2 (l1^alpha + l2^alpha + l3^alpha - 3) + kappa/2 (J - 1)^2
 *   St. Venant-Kirchhoff   lambda/2 (tr E)^2 + mu E:E
 *
 * with I1', I2' and the stretches l isochoric (I1' = J^(-2/3) I1), C10 + C01 = mu/2, E = (F^T F - I)/2. */
#pragma once

enum material_model {
    MATERIAL_NEO_HOOKEAN,
    MATERIAL_NEO_HOOKEAN_LOG,
    MATERIAL_MOONEY_RIVLIN,
    MATERIAL_OGDEN,
    MATERIAL_ST_VENANT_KIRCHHOFF,
    MATERIAL_MODEL_COUNT
};

struct material {
    enum material_model model;
    double shear_modulus; /* mu, Pa */
    double bulk_modulus;  /* kappa, Pa */
    double density;       /* kg/m3 */
    double mooney_ratio;  /* C01 / C10 */
    double ogden_alpha;
};

/* Moduli from Young's modulus (Pa, > 0) and Poisson's ratio (-1 < nu < .5). */
void material_set_moduli(struct material *material, double youngs_modulus, double poisson_ratio);

/* lambda + 2 mu, Pa: the modulus of pressure waves at rest. */
double material_wave_modulus(const struct material *material);

/* U''(1), Pa: 0 for laws without U. */
double material_bulk(const struct material *material);

/* W_iso(F). NaN when det F <= 0. */
double material_isochoric_energy(const struct material *material, const double F[9]);

/* P = dW_iso/dF. */
void material_isochoric_stress(const struct material *material, const double F[9], double P[9]);

/* y(J) and dy/dJ. */
double material_volume_strain(const struct material *material, double J);
double material_volume_slope(const struct material *material, double J);

/* U(J) and dU/dJ. */
double material_volume_energy(const struct material *material, double J);
double material_pressure(const struct material *material, double J);

/* Determinant, and cofactor J F^-T. */
double determinant(const double F[9]);
void cofactor(const double F[9], double C[9]);
