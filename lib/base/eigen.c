#include "base/eigen.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { SWEEPS = 30 };

/* Rotate rows and columns p and q of the symmetric S so that S_pq vanishes; the columns of V follow. */
static void rotate(int n, int p, int q, double *S, double *V)
{
    double tau = (S[(n + 1) * q] - S[(n + 1) * p]) / (2.0 * S[n * p + q]);
    double t = copysign(1.0, tau) / (fabs(tau) + sqrt(1.0 + tau * tau));
    double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
    for (int k = 0; k < n; k++) {
        double a = S[n * k + p], b = S[n * k + q];
        S[n * k + p] = c * a - s * b;
        S[n * k + q] = s * a + c * b;
    }
    for (int k = 0; k < n; k++) {
        double a = S[n * p + k], b = S[n * q + k];
        S[n * p + k] = c * a - s * b;
        S[n * q + k] = s * a + c * b;
        a = V[n * k + p];
        b = V[n * k + q];
        V[n * k + p] = c * a - s * b;
        V[n * k + q] = s * a + c * b;
    }
}

static bool is_diagonal(int n, const double *S)
{
    double off2 = 0.0, diagonal2 = 0.0;
    for (int p = 0; p < n; p++) {
        diagonal2 += S[(n + 1) * p] * S[(n + 1) * p];
        for (int q = p + 1; q < n; q++) {
            off2 += S[n * p + q] * S[n * p + q];
        }
    }
    return !(off2 > 1e-34 * diagonal2);
}

void eigen_symmetric(int n, const double *A, double *values, double *V)
{
    double S[EIGEN_MOST * EIGEN_MOST];
    memcpy(S, A, (size_t)(n * n) * sizeof *S);
    for (int i = 0; i < n * n; i++) {
        V[i] = i % (n + 1) == 0 ? 1.0 : 0.0;
    }
    for (int sweep = 0; sweep < SWEEPS && !is_diagonal(n, S); sweep++) {
        for (int p = 0; p < n; p++) {
            for (int q = p + 1; q < n; q++) {
                if (S[n * p + q] != 0.0) {
                    rotate(n, p, q, S, V);
                }
            }
        }
    }
    for (int i = 0; i < n; i++) {
        values[i] = S[(n + 1) * i];
    }
}

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
