#include "base/axis.h"

#include "base/eigen.h"

#include <math.h>

bool axis_square(int dim, const double *a, double *entries)
{
    double most = 0.0, square = 0.0;
    bool good = true;
    for (int i = 0; i < dim; i++) {
        most = fmax(most, fabs(a[i]));
        good = good && isfinite(a[i]);
    }
    good = good && most > 0.0;
    for (int i = 0; i < dim && good; i++) {
        square += a[i] / most * (a[i] / most);
    }
    for (int i = 0, v = 0; i < dim; i++) {
        for (int j = i; j < dim; j++) {
            entries[v++] = good ? a[i] / most * (a[j] / most) / square : 0.0;
        }
    }
    return good;
}

bool axis_principal(int dim, const double *entries, double *axis)
{
    double A[9] = {0.0}, eigenvalue[3], V[9];
    int first = 0;
    for (int i = 0, v = 0; i < dim; i++) {
        for (int j = i; j < dim; j++, v++) {
            A[dim * i + j] = A[dim * j + i] = entries[v];
        }
    }
    eigen_symmetric(dim, A, eigenvalue, V);
    for (int i = 1; i < dim; i++) {
        first = eigenvalue[i] > eigenvalue[first] ? i : first;
    }
    for (int i = 0; i < dim; i++) {
        axis[i] = V[dim * i + first];
    }
    return eigenvalue[first] > 0.0;
}
