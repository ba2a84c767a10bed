#include "solid/material/material.h"

#include "base/vector.h"
#include "solid/material/law.h"

#include <string.h>

void material_set_moduli(struct material *material, double youngs_modulus, double poisson_ratio)
{
    material->shear_modulus = youngs_modulus / 2.0 / (1.0 + poisson_ratio);
    material->bulk_modulus = youngs_modulus / 3.0 / (1.0 - 2.0 * poisson_ratio);
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

void material_isochoric_stress(const struct material *material, const double F[9], double P[9])
{
    material_laws[material->model]->stress(material, F, P);
}

double material_isochoric_energy(const struct material *material, const double F[9])
{
    return determinant(F) > 0.0 ? material_laws[material->model]->energy(material, F) : (double)NAN;
}

struct material_rest material_at_rest(const struct material *material)
{
    double mu = material->shear_modulus;
    struct material_rest rest = {.shear = mu, .along = mu};
    if (material->fibre != NULL && material_laws[material->model]->rest != NULL) {
        rest.families = 1;
        memcpy(rest.direction[0], material->fibre, sizeof rest.direction[0]);
        material_laws[material->model]->rest(material, &rest);
    }
    return rest;
}

double material_rest_energy(const struct material *material, const double e[9])
{
    struct material_rest rest = material_at_rest(material);
    double energy = rest.shear * vector_dot(9, e, e), ea[3];
    for (int k = 0; k < rest.families; k++) {
        for (int i = 0; i < 3; i++) {
            ea[i] = vector_dot(3, e + 3 * i, rest.direction[k]);
        }
        double along = vector_dot(3, ea, rest.direction[k]), square = along * along;
        energy +=
            2.0 * (rest.along - rest.shear) * (vector_dot(3, ea, ea) - square) + 1.5 * rest.fibre[k] * square;
    }
    return energy;
}

bool material_is_isochoric(const struct material *material)
{
    return material_laws[material->model]->volume == LAW_VOLUME_LINEAR;
}

bool material_is_logarithmic(const struct material *material)
{
    return material_laws[material->model]->volume == LAW_VOLUME_LOG;
}

double material_volume_strain(const struct material *material, double J)
{
    return material_is_logarithmic(material) ? log(J) : J - 1.0;
}

double material_volume_slope(const struct material *material, double J)
{
    return material_is_logarithmic(material) ? 1.0 / J : 1.0;
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

double material_long_term(const struct material *material)
{
    double left = 1.0;
    for (int k = 0; k < material->prony_terms; k++) {
        left -= material->prony[2 * k];
    }
    return left;
}

double material_bulk(const struct material *material)
{
    switch (material_laws[material->model]->volume) {
    case LAW_VOLUME_LOG:
        return material->bulk_modulus - 2.0 / 3.0 * material->shear_modulus;
    case LAW_VOLUME_NONE:
        return 0.0;
    case LAW_VOLUME_LINEAR:
        break;
    }
    return material->bulk_modulus;
}
