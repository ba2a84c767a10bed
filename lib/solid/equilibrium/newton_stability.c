/* Whether an equilibrium is stable. */
#include "base/vector.h"
#include "solid/equilibrium/newton_private.h"
#include "solid/preconditioner/frequency.h"

#include <math.h>
#include <string.h>

/* By the largest Rayleigh quotient: one above minus that is within the round-off of the differences of
 * forces. */
static const double least_told = 1e-6;
/* Of the residual's square that is left, by the share of one mode of a pseudo-random one. */
static const double share_left = 0.1;

/* product = K move with all that resists at u; returns move . K move. */
static double multiply(struct newton *n, const double *move, double sign, double *product)
{
    double epsilon = sign * newton_difference(n, move), sum = 0.0;
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + epsilon * move[i];
    }
    (void)newton_evaluate(n, n->trial, &n->at_trial);
    for (int64_t i = 0; i < n->size; i++) {
        product[i] =
            (n->at_u.smooth[i] + n->at_u.contact[i] - n->at_trial.smooth[i] - n->at_trial.contact[i]) /
            epsilon;
        sum += move[i] * product[i];
    }
    return sum;
}

/* Whether the quotient of the search direction, along which a curvature was found, is negative both ways: a
 * contact that opens or closes makes it so along one of them at most. */
static bool is_negative(struct newton *n, double curvature, double norm2, double largest)
{
    const double most = -least_told * largest * norm2;
    return curvature < most &&
           (n->system->contact_count == 0 || multiply(n, n->search, -1.0, n->product) < most);
}

void newton_judge_stability(struct newton *n)
{
    struct stability *stability = &n->system->stability;
    struct relaxation_report *report = n->report;
    double *rest = n->model.smooth, square = 0.0, first = 0.0, norm2 = 0.0, largest = 0.0, way = 0.0;
    double diagonal[NEWTON_MOST_ITERATIONS], off_diagonal[NEWTON_MOST_ITERATIONS]; /* of Lanczos's matrix */
    int count = 0;
    stability->least = 0.0;
    frequency_start(rest, n->size);
    memset(n->search, 0, (size_t)n->size * sizeof *n->search);
    for (int k = 0; k < NEWTON_MOST_ITERATIONS; k++) {
        preconditioner_apply(&n->preconditioner, rest, n->scaled);
        double now = vector_product(n->size, rest, n->scaled), part = k > 0 ? now / square : 0.0;
        first = k == 0 ? now : first;
        if (!(now > share_left * first / (double)n->size)) {
            break;
        }
        for (int64_t i = 0; i < n->size; i++) {
            n->search[i] = n->scaled[i] + part * n->search[i];
        }
        norm2 = now + part * part * norm2; /* search . M search */
        square = now;
        double curvature = multiply(n, n->search, 1.0, n->product), quotient = curvature / norm2;
        largest = fmax(largest, quotient);
        if (!(quotient > least_told * largest)) {
            if (is_negative(n, curvature, norm2, largest) && quotient < -report->error * largest) {
                (void)newton_longest(n, n->search, &stability->node);
                stability->least = quotient / largest;
            }
            break;
        }
        diagonal[k] = curvature / now + (k > 0 ? part / way : 0.0);
        off_diagonal[k > 0 ? k - 1 : 0] = k > 0 ? sqrt(part) / way : 0.0;
        way = now / curvature;
        count = k + 1;
        for (int64_t i = 0; i < n->size; i++) {
            rest[i] -= way * n->product[i];
        }
    }
    n->lowest = count > 0 ? tridiagonal_least(count, diagonal, off_diagonal) : 1.0;
    report->largest_frequency = sqrt(largest);
    report->lowest_frequency = sqrt(fmax(n->lowest, 0.0));
    (void)newton_evaluate(n, n->u, &n->at_u); /* the last evaluation again */
}
