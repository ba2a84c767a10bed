/* Hyperelastic materials: energy per reference volume, first Piola stress, and their volumetric part.
 *
 * Equation (11) of lib/README.md: W(F) = W_iso(F) + U(J), U = kappa/2 y(J)^2 with y = J - 1, or ln J and
 * lambda for kappa. Only U is averaged over nodal volumes. W_iso is isochoric for the laws with J^(-2/3)
 * below; for the logarithmic one it is the rest of W, and St. Venant-Kirchhoff has no such split (U = 0). F
 * is 3 x 3 row-major; plane strain has F33 = 1. Units Pa.
 *
 * A law is one file of this folder, which begins with its energy, and one line of the table in law.c. */
#pragma once

#include <stdbool.h>
#include <stdint.h>

enum { MATERIAL_NEO_HOOKEAN = 0 }; /* the number of the law that has kernels of its own */
enum { PRONY_MOST_TERMS = 6 };

struct material {
    int model;                /* number of the law in material_laws, see law.h */
    double shear_modulus;     /* mu at rest, Pa; of a law with fibres that of the isotropic tangent nearest to
                                 its own, see law.h */
    double bulk_modulus;      /* kappa, Pa */
    double density;           /* kg/m3 */
    const double *parameters; /* of the law, relative to the shear modulus; the caller's */
    const double *fibre;  /* unit vectors at rest: along the fibres and, or zeros, across them in the plane
                             of two families; the caller's; NULL: there are no fibres */
    double active;        /* second Piola-Kirchhoff stress along the fibres, Pa, times a load curve, which
                             the body adds: T/2 (|F a|^2 - 1); 0: none */
    int32_t active_curve; /* of body->load_factors */
    const double *prony;  /* g and tau, s, of each term of a Prony series, sum g < 1; the caller's; the moduli
                             above are then the instantaneous ones. The body relaxes: W and P here do not */
    int prony_terms;      /* 0: elastic */
    double stiffness; /* of a body's material: mu by that at rest, where it only stabilises (stiffening.h) */
};

/* Moduli from Young's modulus (Pa, > 0) and Poisson's ratio (-1 < nu < .5). */
void material_set_moduli(struct material *material, double youngs_modulus, double poisson_ratio);

/* lambda + 2 mu, Pa: the modulus of pressure waves at rest. */
double material_wave_modulus(const struct material *material);

/* U''(1), Pa: 0 for laws without U. */
double material_bulk(const struct material *material);

/* 1 - sum g of a Prony series. */
double material_long_term(const struct material *material);

/* The energy of small isochoric strains e where fibres begin to be stretched, with the unit vectors a_k along
 * their families: shear |e|^2 + sum_k (2 (along - shear) (|e a_k|^2 - (a_k . e a_k)^2) + 3/2 fibre_k (a_k . e
 * a_k)^2). */
struct material_rest {
    double shear, along; /* shear moduli across the fibres and along them, Pa */
    int families;
    double fibre[2], direction[2][3]; /* Pa */
};
struct material_rest material_at_rest(const struct material *material);
double material_rest_energy(const struct material *material, const double e[9]);

/* W_iso(F). NaN when det F <= 0. */
double material_isochoric_energy(const struct material *material, const double F[9]);

/* P = dW_iso/dF. */
void material_isochoric_stress(const struct material *material, const double F[9], double P[9]);

/* Whether W_iso does not depend on the volume. */
bool material_is_isochoric(const struct material *material);

/* Whether y(J) is defined for J > 0 only. */
bool material_is_logarithmic(const struct material *material);

/* y(J) and dy/dJ. */
double material_volume_strain(const struct material *material, double J);
double material_volume_slope(const struct material *material, double J);

/* U(J) and dU/dJ. */
double material_volume_energy(const struct material *material, double J);
double material_pressure(const struct material *material, double J);

/* Determinant, and cofactor J F^-T. */
double determinant(const double F[9]);
void cofactor(const double F[9], double C[9]);
