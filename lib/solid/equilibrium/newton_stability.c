/* Whether an equilibrium is stable. */
#include "base/vector.h"
#include "solid/equilibrium/newton_private.h"
#include "solid/preconditioner/frequency.h"

#include <math.h>
#include <string.h>

/* Of the residual's square that is left, by the share of one mode of a pseudo-random one. */
static const double share_left = 0.1;
/* A body has left a state near equilibrium where it goes as far from it as this, by the error there. */
static const double far_by_error = 2.0;

void newton_lanczos_add(struct newton_lanczos *l, double way, double part)
{
    if (l->count > 0) {
        l->off_diagonal[l->count - 1] = sqrt(part) / l->way;
    }
    l->diagonal[l->count] = 1.0 / way + (l->count > 0 ? part / l->way : 0.0);
    l->way = way;
    l->count++;
}

double newton_lanczos_least(const struct newton_lanczos *l)
{
    return l->count > 0 ? tridiagonal_least(l->count, l->diagonal, l->off_diagonal) : INFINITY;
}

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
    const double most = -NEWTON_LEAST_TOLD * largest * norm2;
    return curvature < most &&
           (n->system->contact_count == 0 || multiply(n, n->search, -1.0, n->product) < most);
}

void newton_judge_stability(struct newton *n)
{
    struct stability *stability = &n->system->stability;
    struct statics_report *report = n->report;
    double *rest = n->model.smooth, square = 0.0, first = 0.0, norm2 = 0.0, largest = 0.0;
    struct newton_lanczos lanczos = {0};
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
        if (!(quotient > NEWTON_LEAST_TOLD * largest)) {
            if (is_negative(n, curvature, norm2, largest) && quotient < -report->error * largest) {
                (void)newton_longest(n, n->search, &stability->node);
                stability->least = quotient / largest;
            }
            break;
        }
        newton_lanczos_add(&lanczos, now / curvature, part);
        for (int64_t i = 0; i < n->size; i++) {
            rest[i] -= lanczos.way * n->product[i];
        }
    }
    n->lowest = lanczos.count > 0 ? newton_lanczos_least(&lanczos) : 1.0;
    (void)newton_evaluate(n, n->u, &n->at_u); /* the last evaluation again */
}

/* Whether u is near equilibrium, but not at rest. */
static bool is_near(const struct newton *n)
{
    double error = n->report->error;
    return error > 0.0 && error < NEWTON_ERROR_BETWEEN && newton_has_pressures(n);
}

void newton_note_leaving(struct newton *n)
{
    struct stability *stability = &n->system->stability;
    if (stability->left || n->system->contact_count > 0) {
        return;
    }
    if (n->falls && isfinite(n->nearest_error)) {
        for (int64_t i = 0; i < n->size; i++) {
            n->scaled[i] = n->u[i] - n->nearest[i];
        }
        double way = newton_longest(n, n->scaled, &stability->left_node);
        stability->left = way > far_by_error * n->nearest_error * newton_longest(n, n->nearest, NULL);
        stability->left_load = stability->left ? statics_load_share(n->system, n->load) : 0.0;
    }
    if (n->corrections == 0 || n->report->error < n->nearest_error) {
        n->nearest_error = is_near(n) ? n->report->error : INFINITY;
        n->falls = false;
        memcpy(n->nearest, n->u, (size_t)n->size * sizeof *n->nearest);
    }
}
