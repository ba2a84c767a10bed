#include "solid/material/ellipticity.h"

#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* Directions are those from the origin to the points of a lattice, whose coordinates are at most this. */
enum { LATTICE = 2 };
/* dW/dF of the whole law. */
static void stress(const struct material *material, const double F[9], double P[9])
{
    double C[9];
    material_isochoric_stress(material, F, P);
    cofactor(F, C);
    add_scaled(9, material_pressure(material, determinant(F)), C, P);
}

/* A[9 i + k] = d2W / dF_i dF_k, for entries k of the first dim rows and columns. */
static void tangent(const struct material *material, int dim, const double F[9], double A[81])
{
    for (int k = 0; k < 9; k++) {
        double at[9], after[9], before[9];
        if (k / 3 >= dim || k % 3 >= dim) {
            continue;
        }
        memcpy(at, F, sizeof at);
        at[k] = F[k] + DIFFERENCE_STEP;
        stress(material, at, after);
        at[k] = F[k] - DIFFERENCE_STEP;
        stress(material, at, before);
        for (int i = 0; i < 9; i++) {
            A[9 * i + k] = (after[i] - before[i]) / (2.0 * DIFFERENCE_STEP);
        }
    }
}

/* A += T I (x) a (x) a */
static void add_active(const double a[3], double T, double A[81])
{
    for (int i = 0; i < 27; i++) {
        int k = i / 9, b = i / 3 % 3, c = i % 3;
        A[9 * (3 * k + b) + 3 * k + c] += T * a[b] * a[c];
    }
}

/* Whether the acoustic tensor along n, of any length, is positive definite: its leading minors are positive.
 */
static bool is_positive_along(int dim, const double A[81], const double n[3])
{
    double Q[9] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    for (int i = 0; i < dim; i++) {
        for (int k = 0; k < dim; k++) {
            for (int a = 0; a < dim; a++) {
                for (int b = 0; b < dim; b++) {
                    Q[3 * i + k] += A[9 * (3 * i + a) + 3 * k + b] * n[a] * n[b];
                }
            }
        }
    }
    return Q[0] > 0.0 && Q[0] * Q[4] - Q[1] * Q[3] > 0.0 && determinant(Q) > 0.0;
}

bool material_is_elliptic(const struct material *material, double active, int dim, const double F[9])
{
    double A[81] = {0.0};
    if (material->model == MATERIAL_NEO_HOOKEAN && !(active < 0.0)) {
        return true; /* along m (x) n the second derivative of (11) is at least mu J^(-2/3) / 5 */
    }
    tangent(material, dim, F, A);
    if (fabs(active) > 0.0) {
        add_active(material->fibre, active, A);
    }
    for (int x = 0; x <= LATTICE; x++) {
        for (int y = -LATTICE; y <= LATTICE; y++) {
            for (int z = dim == 3 ? -LATTICE : 0; z <= (dim == 3 ? LATTICE : 0); z++) {
                const double n[3] = {x, y, z};
                if ((x != 0 || y != 0 || z != 0) && !is_positive_along(dim, A, n)) {
                    return false;
                }
            }
        }
    }
    return true;
}
