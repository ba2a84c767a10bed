/* Guccione, McCulloch and Waldman (1991): C/2 (exp Q - 1) + kappa/2 (J - 1)^2, Q = bf E11^2 + bt (E22^2 +
 * E33^2 + 2 E23^2) + 2 bfs (E12^2 + E13^2), E = (J^(-2/3) F^T F - I)/2, axis 1 along the fibres. */
#include "solid/material/law.h"
#include "solid/material/tensor.h"

enum { C, BF, BT, BFS };

/* The parameters are the numbers of the keys, C relative to mu. The tangent has the eigenvalues C (2 bf + bt)
 * / 3, and C bfs and C bt twice each. */
static double prepare(const struct law_input *input, double *parameters, struct law_fault *fault)
{
    (void)fault;
    const double *b = input->number;
    double mu = b[C] / 5.0 * ((2.0 * b[BF] + b[BT]) / 6.0 + b[BT] + b[BFS]);
    for (int i = C; i <= BFS; i++) {
        parameters[i] = b[i];
    }
    parameters[C] /= mu;
    return mu;
}

static void rest(const struct material *material, struct material_rest *rest)
{
    const double *b = material->parameters;
    double half = 0.5 * material->shear_modulus * b[C];
    rest->shear = half * b[BT];
    rest->along = half * b[BFS];
    rest->fibre[0] = 2.0 / 3.0 * half * (b[BF] - b[BT]);
}

/* E, E a and Q. */
static double exponent(const struct material *material, const double F[9], double E[9], double Ea[3])
{
    const double *b = material->parameters, *a = material->fibre;
    double J = determinant(F), scale = 1.0 / cbrt(J * J);
    right_cauchy_green(F, E);
    for (int i = 0; i < 9; i++) {
        E[i] = 0.5 * (scale * E[i] - (i % 4 == 0 ? 1.0 : 0.0));
    }
    transform(E, a, Ea);
    double along = vector_dot(3, a, Ea), across = vector_dot(3, Ea, Ea) - along * along; /* E12^2 + E13^2 */
    return b[BF] * along * along + b[BT] * (norm2(E) - along * along - 2.0 * across) + 2.0 * b[BFS] * across;
}

static double energy(const struct material *material, const double F[9])
{
    double E[9], Ea[3];
    return 0.5 * material->shear_modulus * material->parameters[C] * expm1(exponent(material, F, E, Ea));
}

/* P = J^(-2/3) (F S - S:(F^T F)/3 F^-T), S = C/2 exp(Q) dQ/dE */
static void stress(const struct material *material, const double F[9], double P[9])
{
    const double *b = material->parameters, *a = material->fibre;
    double E[9], Ea[3], S[9], FS[9], cof[9], J = determinant(F), turned = b[BFS] - b[BT];
    double size = material->shear_modulus * b[C] * exp(exponent(material, F, E, Ea)) / cbrt(J * J);
    double along = vector_dot(3, a, Ea);
    for (int i = 0; i < 9; i++) {
        int r = i / 3, c = i % 3;
        S[i] = size * (b[BT] * E[i] + turned * (Ea[r] * a[c] + a[r] * Ea[c]) +
                       (b[BF] + b[BT] - 2.0 * b[BFS]) * along * a[r] * a[c]);
    }
    multiply(F, S, FS);
    cofactor(F, cof);
    double third = vector_dot(9, F, FS) / (3.0 * J);
    for (int i = 0; i < 9; i++) {
        P[i] = FS[i] - third * cof[i];
    }
}

static const struct law_key keys[] = {
    [C] = {"C", "give it in Pa", LAW_WITHOUT_E, LAW_POSITIVE},
    [BF] = {"bf", "give the exponent along the fibres", LAW_WITHOUT_E, LAW_POSITIVE},
    [BT] = {"bt", "give the exponent across the fibres", LAW_WITHOUT_E, LAW_POSITIVE},
    [BFS] = {"bfs", "give the exponent of shear along the fibres", LAW_WITHOUT_E, LAW_POSITIVE},
    {.name = NULL}};

const struct law law_guccione = {.name = "guccione",
                                 .keys = keys,
                                 .has_fibres = true,
                                 .prepare = prepare,
                                 .rest = rest,
                                 .energy = energy,
                                 .stress = stress};
