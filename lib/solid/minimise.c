/* PROTOTYPE: minimisers beside dynamic relaxation, to be measured. Environment: METHOD=newton|lbfgs|ncg, INC=
 * increments of the load, ETA= of inner solves, MEM= pairs of L-BFGS, TOL= on the error, REF= file of the
 * solution: then trace. */
#include "solid/relaxation_private.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double number(const char *name, double otherwise)
{
    const char *text = getenv(name);
    return text != NULL ? strtod(text, NULL) : otherwise;
}

static double *reference;
static double traced[3] = {1e-3, 1e-4, 1e-5};
static int next_traced;
static clock_t started;
static double last_mean, last_worst;

void minimise_trace(struct relaxation *r, const double *u);
void minimise_save(struct relaxation *r);
enum relaxation_outcome minimise(struct relaxation *r, struct error *error);

/* Tell when the mean error first and for good fell below a level. */
void minimise_trace(struct relaxation *r, const double *u)
{
    const char *name = getenv("REF");
    if (name == NULL) {
        return;
    }
    int dim = r->system->dim;
    if (reference == NULL) {
        FILE *f = fopen(name, "rb");
        reference = malloc((size_t)r->size * sizeof *reference);
        if (f == NULL || fread(reference, sizeof *reference, (size_t)r->size, f) != (size_t)r->size) {
            exit(99);
        }
        fclose(f);
    }
    double mean = 0.0, worst = 0.0, largest = 0.0;
    for (int64_t n = 0; n < r->system->node_count; n++) {
        double a = 0.0, b = 0.0;
        for (int i = 0; i < dim; i++) {
            double d = u[n * dim + i] - reference[n * dim + i];
            a += d * d;
            b += reference[n * dim + i] * reference[n * dim + i];
        }
        mean += sqrt(a);
        worst = fmax(worst, sqrt(a));
        largest = fmax(largest, sqrt(b));
    }
    mean /= (double)r->system->node_count * largest;
    worst /= largest;
    last_mean = mean;
    last_worst = worst;
    while (next_traced < 3 && worst < traced[next_traced]) {
        fprintf(stderr, "trace %g: evals %lld cpu %.4f estimate %.2e\n", traced[next_traced],
                (long long)r->report->force_evaluations, (double)(clock() - started) / CLOCKS_PER_SEC,
                r->report->error);
        next_traced++;
    }
    if (getenv("TRACE") != NULL) {
        fprintf(stderr, "at %lld mean %.2e worst %.2e load %.3f estimate %.2e\n",
                (long long)r->report->force_evaluations, mean, worst, r->load / (double)r->report->ramp_steps,
                r->report->error);
    }
}

void minimise_save(struct relaxation *r)
{
    const char *name = getenv("SAVE");
    if (getenv("REF") != NULL) {
        minimise_trace(r, r->u);
        fprintf(stderr, "trace end: cpu %.4f mean %.1e worst %.1e\n",
                (double)(clock() - started) / CLOCKS_PER_SEC, last_mean, last_worst);
    }
    if (name != NULL) {
        FILE *f = fopen(name, "wb");
        fwrite(r->u, sizeof *r->u, (size_t)r->size, f);
        fclose(f);
    }
}

void minimise_clock(void);
void minimise_clock(void)
{
    started = clock();
}

void relaxation_augment_now(struct relaxation *r);

struct minimiser {
    struct relaxation *r;
    double *u, *g, *trial, *trial_g, *step, *rhs, *p, *z, *kp, *lift, *zero;
    double load, low2, high2, energy2, share, load_energy;
    bool spectrum;
    int inner;
};

static double dot(const struct relaxation *r, const double *a, const double *b)
{
    double sum = 0.0;
    for (int64_t i = 0; i < r->size; i++) {
        sum += a[i] * b[i];
    }
    return sum;
}

static bool evaluate(struct minimiser *m, const double *u, double *g)
{
    struct relaxation *r = m->r;
    struct deformation d = system_residual(r->system, u, g);
    r->report->force_evaluations++;
    r->report->least_jacobian = d.least_jacobian;
    r->report->inverted_point = d.point;
    return d.least_jacobian > 0.0;
}

/* kp = K p at m->u, whose residual is m->g */
static void tangent(struct minimiser *m, const double *p, double *kp)
{
    struct relaxation *r = m->r;
    double largest = 0.0;
    for (int64_t i = 0; i < r->size; i++) {
        largest = fmax(largest, fabs(p[i]));
    }
    double epsilon = 1e-6 * r->spacing / largest;
    for (int64_t i = 0; i < r->size; i++) {
        m->trial[i] = m->u[i] + epsilon * p[i];
    }
    (void)system_residual(r->system, m->trial, kp);
    r->report->force_evaluations++;
    for (int64_t i = 0; i < r->size; i++) {
        kp[i] = (m->g[i] - kp[i]) / epsilon;
    }
}

/* step += w, K w = rhs, to eta of the residual. Ritz values into low2, high2. */
static void solve(struct minimiser *m, double eta, double absolute)
{
    struct relaxation *r = m->r;
    struct preconditioner *M = &r->preconditioner;
    enum { MOST = 400 };
    static double diagonal[MOST], off[MOST];
    double *res = m->rhs, first = 0.0, rz = 0.0, alpha = 1.0, beta = 0.0;
    int k = 0;
    for (; k < MOST; k++) {
        preconditioner_apply(M, res, m->z);
        double now = dot(r, res, m->z);
        first = k == 0 ? now : first;
        if (now <= eta * eta * first || now <= absolute * absolute || !(now > 0.0)) {
            break;
        }
        double before = alpha;
        beta = k > 0 ? now / rz : 0.0;
        for (int64_t i = 0; i < r->size; i++) {
            m->p[i] = m->z[i] + (k > 0 ? beta * m->p[i] : 0.0);
        }
        rz = now;
        tangent(m, m->p, m->kp);
        double curvature = dot(r, m->p, m->kp);
        if (!(curvature > 0.0)) {
            if (k == 0) {
                for (int64_t i = 0; i < r->size; i++) {
                    m->step[i] += m->z[i];
                }
            }
            fprintf(stderr, "negative curvature at %d\n", k);
            break;
        }
        alpha = rz / curvature;
        m->energy2 += alpha * rz;
        diagonal[k] = 1.0 / alpha + (k > 0 ? beta / before : 0.0);
        if (k > 0) {
            off[k - 1] = sqrt(beta) / before;
        }
        for (int64_t i = 0; i < r->size; i++) {
            m->step[i] += alpha * m->p[i];
            res[i] -= alpha * m->kp[i];
        }
    }
    if (k > 4) {
        double low = tridiagonal_least(k, diagonal, off);
        m->low2 = k > 15 ? low : fmin(m->low2, low);
    }
    m->inner += k;
}

static double norm_of(struct minimiser *m, const double *g)
{
    preconditioner_apply(&m->r->preconditioner, g, m->z);
    return sqrt(fmax(dot(m->r, g, m->z), 0.0));
}

static void set_load(struct minimiser *m, double load)
{
    struct relaxation *r = m->r;
    for (int64_t i = 0; i < r->system->curve_count; i++) {
        r->factor_change[i] = -r->system->factor[i];
    }
    system_load_factors(r->system, load);
    for (int64_t i = 0; i < r->system->curve_count; i++) {
        r->factor_change[i] += r->system->factor[i];
    }
    r->load = load * (double)r->report->ramp_steps;
}

static void estimate(struct minimiser *m)
{
    struct relaxation *r = m->r;
    preconditioner_apply(&r->preconditioner, m->g, m->z);
    int dim = r->system->dim;
    double most = 0.0, move = 0.0;
    for (int64_t n = 0; n < r->system->node_count; n++) {
        double a = 0.0, b = 0.0;
        for (int i = 0; i < dim; i++) {
            a += m->z[n * dim + i] * m->z[n * dim + i];
            b += m->u[n * dim + i] * m->u[n * dim + i];
        }
        most = fmax(most, a);
        move = fmax(move, b);
    }
    r->largest_displacement =
        fmax(r->largest_displacement, sqrt(preconditioner_product_diagonal(&r->preconditioner, m->u, m->u)));
    r->largest_move = fmax(r->largest_move, sqrt(move));
    move = r->largest_move * r->largest_move;
    double whole =
        sqrt(preconditioner_product_diagonal(&r->preconditioner, m->z, m->z)) / r->largest_displacement;
    r->report->error = 2.0 * fmax(whole, sqrt(most / move)) / (0.8 * m->low2);
    r->report->lowest_frequency = sqrt(m->low2);
}

/* A Newton step to another load: u += step, where the step's part `lift` meets the conditions. */
static bool newton_to(struct minimiser *m, double load, double eta, double absolute)
{
    struct relaxation *r = m->r;
    double before = m->load;
    m->energy2 = 0.0;
    if (load != before) {
        set_load(m, load);
        /* m->lift: per load, or zero */
        for (int64_t i = 0; i < r->size; i++) {
            m->step[i] = m->lift[i] * (load - before);
        }
        constraint_project(&r->preconditioner.constraint, r->factor_change, m->step);
        (void)evaluate(m, m->u, m->g); /* with the loads of then */
        tangent(m, m->step, m->kp);
        for (int64_t i = 0; i < r->size; i++) {
            m->rhs[i] = m->g[i] - m->kp[i];
        }
    } else {
        memset(m->step, 0, (size_t)r->size * sizeof *m->step);
        memcpy(m->rhs, m->g, (size_t)r->size * sizeof *m->rhs);
    }
    solve(m, eta, absolute);
    double slope0 = dot(r, m->g, m->step), s = 1.0, bad = 0.0;
    for (int t = 0; t < 8; t++) {
        double at = before + s * (load - before);
        if (load != before) {
            set_load(m, at);
        }
        for (int64_t i = 0; i < r->size; i++) {
            m->trial[i] = m->u[i] + s * m->step[i];
        }
        if (!evaluate(m, m->trial, m->trial_g)) {
            bad = s;
            s *= 0.5;
            continue;
        }
        double slope = dot(r, m->trial_g, m->step);
        if (load == before && slope < -0.5 * slope0) { /* beyond the minimum */
            bad = s;
            s *= fmin(0.7, fmax(0.2, slope0 / (slope0 - slope)));
            continue;
        }
        for (int64_t i = 0; load != before && i < r->size; i++) {
            m->lift[i] = (m->trial[i] - m->u[i]) / (at - before);
        }
        memcpy(m->u, m->trial, (size_t)r->size * sizeof *m->u);
        memcpy(m->g, m->trial_g, (size_t)r->size * sizeof *m->g);
        m->load = at;
        m->share = s;
        return true;
    }
    (void)bad;
    return false;
}

/* mass and preconditioner follow the state */
static void follow(struct minimiser *m, struct error *error)
{
    struct relaxation *r = m->r;
    memcpy(r->before, m->u, (size_t)r->size * sizeof *m->u);
    memcpy(r->residual, m->g, (size_t)r->size * sizeof *m->g);
    r->residual_at = r->before;
    system_relaxation_mass(r->system, r->scratch);
    if (number("MASS", 1.0) > 0.0) {
        (void)!preconditioner_set_mass(&r->preconditioner, r->system, r->scratch, error);
    }
    if (r->system->contact_count > 0) {
        (void)preconditioner_follow(&r->preconditioner, r->system, true);
    }
}

static void remeasure(struct minimiser *m, struct error *error)
{
    struct relaxation *r = m->r;
    r->report->force_evaluations += r->preconditioner.size + 1;
    (void)!preconditioner_measure(&r->preconditioner, r->system, m->u, error);
    (void)system_residual(r->system, m->u, m->g);
}

static void augment_all(struct minimiser *m)
{
    struct relaxation *r = m->r;
    if (body_is_limited(&r->system->body)) {
        body_augment(&r->system->body);
    }
    if (r->system->contact_count > 0) {
        r->residual_at = m->u;
        relaxation_augment_now(r);
        (void)preconditioner_follow(&r->preconditioner, r->system, true);
    }
    if (body_is_limited(&r->system->body) || r->system->contact_count > 0) {
        (void)evaluate(m, m->u, m->g);
    }
}

static enum relaxation_outcome by_newton(struct minimiser *m, struct error *error)
{
    struct relaxation *r = m->r;
    int increments = (int)number("INC", fmax(4.0, ceil((double)r->report->ramp_steps / number("PER", 25)))),
        done = 0;
    double eta = number("ETA", 0.1), tolerance = number("TOL", r->options->tolerance),
           size = 1.0 / increments;
    double theta = number("THETA", 0.3);
    (void)evaluate(m, m->u, m->g);
    while (m->load < 1.0) {
        double next = m->load + size > 1.0 - 1e-9 ? 1.0 : m->load + size, at = m->load;
        if (!newton_to(m, next, eta, 0.0)) {
            fprintf(stderr, "load stuck at %g\n", m->load);
            return RELAXATION_INVERTED;
        }
        double energy = sqrt(m->energy2) + 1e-300, first = norm_of(m, m->g);
        m->load_energy = fmax(m->load_energy, energy);
        int c = 0;
        for (; c < 4 && norm_of(m, m->g) > theta * m->load_energy; c++) {
            augment_all(m);
            if (!newton_to(m, m->load, eta, 0.0)) {
                fprintf(stderr, "corrector stuck\n");
                break;
            }
        }
        if (m->load < next) { /* was cut */
            size = m->load - at;
        } else if (c == 0 && size < 1.0 / increments) {
            size *= 1.5;
        } else if (c > 1) {
            size *= 0.5;
        }
        augment_all(m);
        follow(m, error);
        r->report->steps = ++done;
        minimise_trace(r, m->u);
        if (getenv("TRACE") != NULL) {
            fprintf(stderr, "load %.3f inner %d ritz %g residual %g then %g energy %g correctors %d J %g\n",
                    m->load, m->inner, m->low2, first, norm_of(m, m->g), energy, c,
                    r->report->least_jacobian);
        }
    }
    double etaf = number("ETAF", 0.1);
    for (int it = 0; it < 100; it++) {
        estimate(m);
        minimise_trace(r, m->u);
        if (getenv("TRACE") != NULL) {
            fprintf(stderr, "newton %d inner %d ritz %g residual %g J %g\n", it, m->inner, m->low2,
                    norm_of(m, m->g), r->report->least_jacobian);
        }
        if (r->report->error <= tolerance && it > 1) {
            r->residual_at = m->u;
            if (r->system->contact_count == 0 || relaxation_contacts_hold(r)) {
                return RELAXATION_CONVERGED;
            }
            (void)evaluate(m, m->u, m->g);
        }
        if (it > 0) {
            augment_all(m);
        }
        estimate(m);
        double goal = 0.5 * norm_of(m, m->g) * fmin(1.0, tolerance / r->report->error);
        if (!newton_to(m, 1.0, etaf, goal)) {
            fprintf(stderr, "newton stuck\n");
            return RELAXATION_STALLED;
        }
        r->report->steps = ++done;
    }
    return RELAXATION_TOO_MANY_STEPS;
}

struct memory {
    int most, count, at;
    double **s, **y, *rho;
};

static void remember(struct minimiser *m, struct memory *h, const double *du, const double *dg)
{
    double sy = dot(m->r, du, dg);
    if (!(sy > 0.0) || h->most == 0) {
        return;
    }
    int k = h->at;
    memcpy(h->s[k], du, (size_t)m->r->size * sizeof *du);
    memcpy(h->y[k], dg, (size_t)m->r->size * sizeof *dg);
    h->rho[k] = 1.0 / sy;
    h->at = (k + 1) % h->most;
    h->count += h->count < h->most;
}

/* step = H g, g the residual (downhill) */
static void direction(struct minimiser *m, struct memory *h)
{
    struct relaxation *r = m->r;
    double *q = m->rhs, a[200];
    memcpy(q, m->g, (size_t)r->size * sizeof *q);
    for (int j = 0; j < h->count; j++) {
        int k = (h->at - 1 - j + 2 * h->most) % h->most;
        a[k] = h->rho[k] * dot(r, h->s[k], q);
        for (int64_t i = 0; i < r->size; i++) {
            q[i] -= a[k] * h->y[k][i];
        }
    }
    preconditioner_apply(&r->preconditioner, q, m->step);
    for (int j = h->count; j-- > 0;) {
        int k = (h->at - 1 - j + 2 * h->most) % h->most;
        double b = h->rho[k] * dot(r, h->y[k], m->step);
        for (int64_t i = 0; i < r->size; i++) {
            m->step[i] += (a[k] - b) * h->s[k][i];
        }
    }
}

/* L-BFGS or NCG at the load, to a share of the residual, or to the error. */
static bool descend(struct minimiser *m, struct memory *h, double share, double tolerance, int most)
{
    struct relaxation *r = m->r;
    bool ncg = h->most == 0;
    double first = norm_of(m, m->g), gz = 0.0, alpha = 1.0;
    double *du = m->p, *dg = m->kp;
    double *old_g = m->zero;
    int since = 0;
    double augmented = first;
    for (int it = 0; it < most; it++) {
        double now = norm_of(m, m->g), slope;
        if (tolerance == 0.0 && now <= share * first) {
            return true;
        }
        if (tolerance > 0.0) {
            estimate(m);
            minimise_trace(r, m->u);
            if (r->report->error <= tolerance) {
                r->residual_at = m->u;
                if (r->system->contact_count == 0 || relaxation_contacts_hold(r)) {
                    return true;
                }
                (void)evaluate(m, m->u, m->g);
            }
        }
        if (r->system->contact_count > 0 && it % 5 == 0 &&
            preconditioner_follow(&r->preconditioner, r->system, false) && ncg) {
            since = 0;
        }
        r->report->steps++;
        if (ncg) {
            preconditioner_apply(&r->preconditioner, m->g, m->z);
            double beta = 0.0, zg = dot(r, m->g, m->z);
            if (since > 0) {
                beta = fmax(0.0, (zg - dot(r, old_g, m->z)) / gz); /* Polak-Ribiere+ */
            }
            gz = zg;
            for (int64_t i = 0; i < r->size; i++) {
                m->step[i] = m->z[i] + (since > 0 ? beta * m->step[i] : 0.0);
            }
        } else {
            direction(m, h);
        }
        since++;
        constraint_project(&r->preconditioner.constraint, NULL, m->step);
        slope = dot(r, m->g, m->step);
        if (!(slope > 0.0)) {
            h->count = 0;
            since = 0;
            continue;
        }
        /* line search on the slope of the energy: by secants, to a part of the first one */
        double s = ncg ? alpha : 1.0, left = 0.0, left_slope = slope,
               accept = ncg ? number("WOLFE", 0.2) : 0.9;
        double right = 0.0;
        bool found = false;
        for (int t = 0; t < 12; t++) {
            for (int64_t i = 0; i < r->size; i++) {
                m->trial[i] = m->u[i] + s * m->step[i];
            }
            if (!evaluate(m, m->trial, m->trial_g)) {
                right = s;
                s = 0.5 * (left + s);
                continue;
            }
            double there = dot(r, m->trial_g, m->step);
            if (fabs(there) <= accept * slope) {
                found = true;
                break;
            }
            double secant = there < left_slope ? s + there * (s - left) / (left_slope - there) : 4.0 * s;
            if (there > 0.0) {
                left = s;
                left_slope = there;
                s = fmin(fmax(secant, 1.1 * s), 4.0 * s);
                if (right > 0.0) {
                    s = fmin(s, 0.5 * (left + right));
                }
            } else {
                right = s;
                s = fmax(fmin(secant, left + 0.9 * (s - left)), left + 0.1 * (s - left));
            }
        }
        if (!found) {
            fprintf(stderr, "line search failed at %d slope %g\n", it, slope);
            if (h->count == 0 && since <= 1) {
                return false;
            }
            h->count = 0;
            since = 0;
            continue;
        }
        alpha = s;
        for (int64_t i = 0; i < r->size; i++) {
            du[i] = m->trial[i] - m->u[i];
            dg[i] = m->g[i] - m->trial_g[i];
        }
        memcpy(old_g, m->g, (size_t)r->size * sizeof *old_g);
        if (!ncg) {
            remember(m, h, du, dg);
        }
        memcpy(m->u, m->trial, (size_t)r->size * sizeof *m->u);
        memcpy(m->g, m->trial_g, (size_t)r->size * sizeof *m->g);
        bool has_contacts = r->system->contact_count > 0;
        if (tolerance > 0.0 && (body_is_limited(&r->system->body) || has_contacts) &&
            norm_of(m, m->g) < number("FALL", 0.1) * augmented) {
            if (body_is_limited(&r->system->body)) {
                body_augment(&r->system->body);
            }
            if (has_contacts) {
                r->residual_at = m->u;
                relaxation_augment_now(r);
            }
            if (getenv("TRACE") != NULL) {
                fprintf(stderr, "augmented at %d from %g\n", it, norm_of(m, m->g));
            }
            (void)evaluate(m, m->u, m->g);
            augmented = norm_of(m, m->g);
            since = ncg ? 0 : since;
        }
    }
    return false;
}

static enum relaxation_outcome by_gradients(struct minimiser *m, int pairs, struct error *error)
{
    struct relaxation *r = m->r;
    struct memory h = {.most = pairs};
    int increments = (int)number("INC", fmax(4.0, ceil((double)r->report->ramp_steps / number("PER", 25))));
    double size = 1.0 / increments, eta = number("ETA", 0.1);
    h.s = calloc((size_t)pairs + 1, sizeof *h.s);
    h.y = calloc((size_t)pairs + 1, sizeof *h.y);
    h.rho = calloc((size_t)pairs + 1, sizeof *h.rho);
    for (int i = 0; i < pairs; i++) {
        h.s[i] = calloc((size_t)r->size, sizeof(double));
        h.y[i] = calloc((size_t)r->size, sizeof(double));
    }
    (void)evaluate(m, m->u, m->g);
    if (!newton_to(m, size, number("ETA1", 0.1), 0.0)) { /* the linear start */
        return RELAXATION_INVERTED;
    }
    while (m->load < 1.0) {
        double next = m->load + size > 1.0 - 1e-9 ? 1.0 : m->load + size, before = m->load;
        memcpy(r->scratch, m->u, (size_t)r->size * sizeof *m->u);
        set_load(m, next);
        memcpy(m->trial, m->u, (size_t)r->size * sizeof *m->u);
        memset(m->step, 0, (size_t)r->size * sizeof *m->step);
        for (int64_t i = 0; i < r->size; i++) {
            m->step[i] = m->lift[i] * (next - before);
        }
        constraint_project(&r->preconditioner.constraint, r->factor_change, m->step);
        double *start = malloc((size_t)r->size * sizeof *start);
        memcpy(start, m->u, (size_t)r->size * sizeof *start);
        double s = 1.0;
        for (;; s *= 0.5) {
            if (s < 0.01) {
                return RELAXATION_INVERTED;
            }
            set_load(m, before + s * (next - before));
            for (int64_t i = 0; i < r->size; i++) {
                m->u[i] = start[i] + s * m->step[i];
            }
            if (evaluate(m, m->u, m->g)) {
                break;
            }
        }
        size *= s;
        m->load = s == 1.0 ? next : before + s * (next - before);
        if (m->load < 1.0 && !descend(m, &h, eta, 0.0, 100)) {
            fprintf(stderr, "descent ended early at load %g\n", m->load);
        }
        for (int64_t i = 0; i < r->size; i++) {
            m->lift[i] = (m->u[i] - start[i]) / (m->load - before);
        }
        free(start);
        if (body_is_limited(&r->system->body)) {
            body_augment(&r->system->body);
            (void)evaluate(m, m->u, m->g);
        }
        if (r->system->contact_count > 0) {
            r->residual_at = m->u;
            relaxation_augment_now(r);
            (void)evaluate(m, m->u, m->g);
        }
        if (m->load < 1.0 && number("FOLLOW", 1.0) > 0.0) {
            follow(m, error);
        }
        minimise_trace(r, m->u);
    }
    return descend(m, &h, 0.0, number("TOL", r->options->tolerance), 2000) ? RELAXATION_CONVERGED
                                                                           : RELAXATION_STALLED;
}

enum relaxation_outcome minimise(struct relaxation *r, struct error *error)
{
    const char *method = getenv("METHOD");
    struct minimiser m = {.r = r, .u = r->u, .low2 = r->low2 > 0.0 && isfinite(r->low2) ? r->low2 : 1e-3};
    double **vectors[] = {&m.g, &m.trial, &m.trial_g, &m.step, &m.rhs, &m.p, &m.z, &m.kp, &m.lift, &m.zero};
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        *vectors[i] = calloc((size_t)r->size, sizeof(double));
    }
    enum relaxation_outcome outcome = strcmp(method, "newton") == 0 ? by_newton(&m, error)
                                      : strcmp(method, "lbfgs") == 0
                                          ? by_gradients(&m, (int)number("MEM", 10), error)
                                          : by_gradients(&m, 0, error);
    (void)constraint_violation;
    return outcome;
}
