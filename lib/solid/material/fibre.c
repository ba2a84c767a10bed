#include "solid/material/law.h"
#include "solid/material/tensor.h"

double fibre_square(const double F[9], const double a[3])
{
    double Fa[3], J = determinant(F);
    transform(F, a, Fa);
    return vector_dot(3, Fa, Fa) / cbrt(J * J);
}

/* dI4'/dF = 2 J^(-2/3) (F a) (x) a - 2/3 I4' F^-T */
void add_fibre_stress(const double F[9], const double a[3], double slope, double P[9])
{
    double Fa[3], C[9], J = determinant(F);
    transform(F, a, Fa);
    cofactor(F, C);
    double scale = 2.0 * slope / cbrt(J * J), third = vector_dot(3, Fa, Fa) / (3.0 * J);
    for (int i = 0; i < 9; i++) {
        P[i] += scale * (Fa[i / 3] * a[i % 3] - third * C[i]);
    }
}
