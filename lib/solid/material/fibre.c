#include "solid/material/law.h"
#include "solid/material/tensor.h"

#include <string.h>

/* Make v a unit vector orthogonal to u, a unit vector or 0; false if it has no direction of its own. */
static bool orthonormalise(const double u[3], double v[3])
{
    double most = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    for (int i = 0; i < 3 && most > 0.0; i++) {
        v[i] /= most;
    }
    double before = vector_length(3, v);
    add_scaled(3, -vector_dot(3, u, v), u, v);
    double length = vector_length(3, v);
    for (int i = 0; i < 3 && length > 0.0; i++) {
        v[i] /= length;
    }
    return length > 1e-6 * before;
}

bool fibre_frame(int dim, const double along[3], const double *plane, double frame[6])
{
    static const double none[3] = {0.0};
    double *across = frame + 3;
    memcpy(frame, along, sizeof none);
    memcpy(across, plane != NULL ? plane : none, sizeof none);
    bool good = orthonormalise(none, frame);
    if (dim == 2) {
        across[0] = -frame[1];
        across[1] = frame[0];
        return good;
    }
    return good && (plane == NULL || orthonormalise(frame, across));
}

double isochoric_scale(const double F[9])
{
    double J = determinant(F);
    return 1.0 / cbrt(J * J);
}

double fibre_square(double scale, const double F[9], const double a[3])
{
    double Fa[3];
    transform(F, a, Fa);
    return scale * vector_dot(3, Fa, Fa);
}

/* dI4'/dF = 2 J^(-2/3) (F a) (x) a - 2/3 I4' F^-T */
void add_fibre_stress(double scale, const double F[9], const double a[3], double slope, double P[9])
{
    double Fa[3], C[9];
    transform(F, a, Fa);
    cofactor(F, C);
    double along = 2.0 * slope * scale, third = vector_dot(3, Fa, Fa) / (3.0 * determinant(F));
    for (int i = 0; i < 9; i++) {
        P[i] += along * (Fa[i / 3] * a[i % 3] - third * C[i]);
    }
}
