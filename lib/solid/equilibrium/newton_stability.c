/* Whether an equilibrium is stable. */
#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "solid/equilibrium/newton_private.h"
#include "solid/preconditioner/frequency.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

/* Of the residual's square that is left, by the share of one mode of a pseudo-random one. */
static const double share_left = 0.1;
/* Asymmetry of the stiffness that is more than the round-off of differences. */
static const double asymmetric = 0.01;

/* product = K move with all that resists at u. */
static void multiply(struct newton *n, const double *move, double *product)
{
    double epsilon = newton_difference(n, move);
    newton_multiply(n, move, product);
    if (n->system->contact_count == 0) {
        return;
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->trial[i] = n->u[i] + epsilon * move[i];
    }
    newton_touch(n, n->trial, &n->at_trial);
    for (int64_t i = 0; i < n->size; i++) {
        product[i] += (n->at_u.contact[i] - n->at_trial.contact[i]) / epsilon;
    }
}

/* Whether the curvature along a move is negative both ways: a contact that opens or closes makes it so along
 * one of them at most. */
static bool is_negative(struct newton *n, double *move)
{
    double curvature[2];
    for (int way = 0; way < 2; way++) {
        multiply(n, move, n->cg.product);
        curvature[way] = vector_dot(n->size, move, n->cg.product);
        for (int64_t i = 0; i < n->size; i++) {
            move[i] = -move[i];
        }
    }
    return curvature[0] < 0.0 && curvature[1] < 0.0;
}

/* The space that is searched for directions of negative stiffness, by Arnoldi's method, of a symmetric K that
 * of Lanczos (Saad 2003, 6.3): an orthonormal basis v_k, for v . M v. */
struct space {
    int count;                             /* its dimension */
    gsl_matrix *H;                         /* M^-1 K in it, a Hessenberg matrix */
    double factor[NEWTON_MOST_ITERATIONS]; /* H = L U: the entries of L below the diagonal */
    double largest;                        /* quotient p . K p / p . M p of a search direction, */
    double least;                          /* and the least, */
    double *where;                         /* the direction of that one, if it is negative */
    double skew;   /* |v_k-1 . K v_k - v_k . K v_k-1| by the quotients of both: 0 if K is symmetric */
    bool searched; /* the residual of a pseudo-random load in it is small enough */
};

/* Arnoldi's step: product = K v_k and scaled = M^-1 K v_k less what they have of the basis so far: of a
 * symmetric K, of its last two vectors. Returns the length of what is left. */
static double orthogonalise(struct newton *n, int k, gsl_matrix *H)
{
    struct newton_directions *basis = &n->directions;
    for (int before = 0; before < newton_directions_kept(basis); before++) {
        int i = newton_direction(basis, before);
        double part = vector_dot(n->size, basis->move[i], n->cg.product);
        gsl_matrix_set(H, (size_t)(k - before), (size_t)k, part);
        add_scaled((int)n->size, -part, basis->product[i], n->cg.product);
        add_scaled((int)n->size, -part, basis->move[i], n->cg.scaled);
    }
    return sqrt(fmax(0.0, vector_dot(n->size, n->cg.scaled, n->cg.product)));
}

/* The pivot of the k-th column of H = L U. */
static double pivot_of(int k, const struct space *space)
{
    double entry = 0.0; /* of the column of U, from the top */
    for (int row = 0; row <= k; row++) {
        entry = gsl_matrix_get(space->H, (size_t)row, (size_t)k) -
                (row > 0 ? space->factor[row - 1] * entry : 0.0);
    }
    return entry;
}

/* Note the search direction, which has this quotient. */
static void note_direction(struct newton *n, double quotient, struct space *space)
{
    space->largest = fmax(space->largest, quotient);
    if (quotient < fmin(0.0, space->least)) {
        memcpy(space->where, n->cg.search, (size_t)n->size * sizeof *n->cg.search);
    }
    space->least = fmin(space->least, quotient);
}

/* Extend the basis by product and scaled, which have this length. All of it is kept where K may not be
 * symmetric. */
static enum status extend(struct newton *n, double length, const struct space *space, struct error *error)
{
    if (!system_has_potential(n->system) && space->count == n->directions.most) {
        RETURN_IF_ERROR(newton_keep_directions(n, space->count + 1, error));
    }
    for (int64_t i = 0; i < n->size; i++) {
        n->cg.scaled[i] /= length;
        n->cg.product[i] /= length;
    }
    newton_keep_direction(n, n->cg.scaled, NULL, 1.0);
    return STATUS_OK;
}

/* Whether the conditions leave nothing of a load: they hold the whole body. */
static bool is_held(struct newton *n, const double *load)
{
    memcpy(n->cg.search, load, (size_t)n->size * sizeof *load);
    preconditioner_project(&n->preconditioner, n->cg.search);
    return sqrt(vector_dot(n->size, n->cg.search, n->cg.search)) <=
           COARSE_ROUND_OFF * sqrt(vector_dot(n->size, load, load));
}

/* Search until the residual is small, or, with a symmetric K, a quotient is negative. */
static enum status search(struct newton *n, struct space *space, struct error *error)
{
    double rest2 = 1.0, pivot = 1.0, norm2 = 0.0;
    bool negative = false;
    newton_forget_directions(n);
    frequency_start(n->cg.product, n->size);
    preconditioner_apply(&n->preconditioner, n->cg.product, n->cg.scaled);
    double length = is_held(n, n->cg.product) ? 0.0 : sqrt(vector_dot(n->size, n->cg.scaled, n->cg.product));
    memset(n->cg.search, 0, (size_t)n->size * sizeof *n->cg.search);
    for (int k = 0; length > 0.0 && !space->searched && !negative && k < NEWTON_MOST_ITERATIONS; k++) {
        RETURN_IF_ERROR(extend(n, length, space, error));
        double above = k > 0 ? length / pivot : 0.0;
        for (int64_t i = 0; i < n->size; i++) { /* conjugate to the last one, if K is symmetric */
            n->cg.search[i] = n->cg.scaled[i] - above * n->cg.search[i];
        }
        norm2 = 1.0 + above * above * norm2;
        multiply(n, n->cg.scaled, n->cg.product);
        preconditioner_apply(&n->preconditioner, n->cg.product, n->cg.scaled);
        double last = length;
        length = orthogonalise(n, k, space->H);
        pivot = pivot_of(k, space);
        space->count++;
        note_direction(n, pivot / norm2, space);
        if (k > 0) {
            double both = gsl_matrix_get(space->H, (size_t)k, (size_t)k) *
                          gsl_matrix_get(space->H, (size_t)k - 1, (size_t)k - 1);
            double other = gsl_matrix_get(space->H, (size_t)k - 1, (size_t)k);
            space->skew = fmax(space->skew, fabs(other - last) / sqrt(fabs(both)));
        }
        if (k + 1 < NEWTON_MOST_ITERATIONS) {
            gsl_matrix_set(space->H, (size_t)k + 1, (size_t)k, length);
        }
        space->factor[k] = length / pivot;
        rest2 *= space->factor[k] * space->factor[k];
        space->searched = rest2 < share_left / (double)n->size;
        negative = !(pivot / norm2 > NEWTON_LEAST_TOLD * space->largest) && space->skew < asymmetric;
    }
    return STATUS_OK;
}

/* The least real part of the eigenvalues in the space. */
static enum status least_real(const struct space *space, double *least, struct error *error)
{
    size_t count = (size_t)space->count;
    *least = 1.0;
    if (count == 0) {
        return STATUS_OK;
    }
    gsl_matrix_view H = gsl_matrix_submatrix(space->H, 0, 0, count, count);
    gsl_vector_complex *values = gsl_vector_complex_alloc(count);
    gsl_eigen_nonsymm_workspace *workspace = gsl_eigen_nonsymm_alloc(count);
    enum status status = STATUS_OK;
    if (values == NULL || workspace == NULL) {
        status = fail_memory(error, "eigenvalues");
    } else {
        (void)gsl_eigen_nonsymm(&H.matrix, values, workspace);
        for (size_t i = 0; i < workspace->n_evals; i++) {
            *least = fmin(*least, GSL_REAL(gsl_vector_complex_get(values, i)));
        }
    }
    gsl_vector_complex_free(values);
    gsl_eigen_nonsymm_free(workspace);
    return status;
}

static void space_free(struct space *space)
{
    gsl_matrix_free(space->H);
}

/* Whether u is unstable, from the least eigenvalue, or with a symmetric K the least quotient. Contacts that
 * open or close, and fibres that slacken, make K look less symmetric than it is. */
static bool is_unstable(struct newton *n, const struct space *space, double least)
{
    bool symmetric = space->skew < asymmetric, negative = space->least < 0.0;
    double most = -fmax(n->report->error, NEWTON_LEAST_TOLD) * space->largest;
    if (!negative || !(least < most) || !(symmetric || space->searched)) {
        return false;
    }
    bool smooth = n->system->contact_count == 0 && !n->slackens;
    return (!symmetric && smooth) || is_negative(n, space->where);
}

enum status newton_judge_stability(struct newton *n, struct error *error)
{
    struct stability *stability = &n->system->stability;
    FREED_BY(space_free)
    struct space space = {.where = n->model.smooth,
                          .H = gsl_matrix_calloc(NEWTON_MOST_ITERATIONS, NEWTON_MOST_ITERATIONS)};
    if (space.H == NULL) {
        return fail_memory(error, "eigenvalues");
    }
    RETURN_IF_ERROR(search(n, &space, error));
    n->directions.most = newton_usual_directions(n);
    RETURN_IF_ERROR(least_real(&space, &n->verdict.lowest, error));
    double least = space.skew < asymmetric ? space.least : n->verdict.lowest;
    stability->least = 0.0;
    if (is_unstable(n, &space, least)) {
        (void)newton_longest(n, space.where, &stability->node);
        stability->least = least / space.largest;
    }
    (void)newton_evaluate(n, n->u, &n->at_u); /* the last evaluation again */
    return STATUS_OK;
}
