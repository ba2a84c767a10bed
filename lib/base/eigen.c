#include "base/eigen.h"

#include <math.h>
#include <string.h>

void eigen_symmetric(const double A[9], double values[3], double V[9])
{
    double S[9];
    static const int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    memcpy(S, A, sizeof S);
    for (int i = 0; i < 9; i++) {
        V[i] = i % 4 == 0 ? 1.0 : 0.0;
    }
    for (int sweep = 0; sweep < 30; sweep++) {
        double off = S[1] * S[1] + S[2] * S[2] + S[5] * S[5];
        if (!(off > 1e-34 * (S[0] * S[0] + S[4] * S[4] + S[8] * S[8]))) {
            break;
        }
        for (int r = 0; r < 3; r++) {
            int p = pairs[r][0], q = pairs[r][1];
            if (S[3 * p + q] == 0.0) {
                continue;
            }
            double tau = (S[4 * q] - S[4 * p]) / (2.0 * S[3 * p + q]);
            double t = copysign(1.0, tau) / (fabs(tau) + sqrt(1.0 + tau * tau));
            double c = 1.0 / sqrt(1.0 + t * t), s = t * c;
            for (int k = 0; k < 3; k++) {
                double a = S[3 * k + p], b = S[3 * k + q];
                S[3 * k + p] = c * a - s * b;
                S[3 * k + q] = s * a + c * b;
            }
            for (int k = 0; k < 3; k++) {
                double a = S[3 * p + k], b = S[3 * q + k];
                S[3 * p + k] = c * a - s * b;
                S[3 * q + k] = s * a + c * b;
                a = V[3 * k + p];
                b = V[3 * k + q];
                V[3 * k + p] = c * a - s * b;
                V[3 * k + q] = s * a + c * b;
            }
        }
    }
    values[0] = S[0];
    values[1] = S[4];
    values[2] = S[8];
}
