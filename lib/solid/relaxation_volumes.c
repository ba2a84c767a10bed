/* What the rows of nodal volumes in the inertia ask of a relaxation: to be set anew as the body deforms, and
 * that bulk moduli rise to their values only when the load is on. */
#include "solid/relaxation_private.h"

#include <math.h>
#include <string.h>

/* Rise of the largest frequency at which the rows are set anew. */
static const double most_stale = 1.1;
/* Of the power iteration afterwards, and where a mode was unstable. */
static const int fresh_iterations = 10, calm_iterations = 5, rise_iterations = 30;
/* While the load grows no bulk modulus is more than so many shear moduli: rows that are a little stale leave
 * stiffness in proportion to it. */
static const double first_bulk = 50.0;
/* The limit rises from when the error is below this, by this factor a step; the rows are ahead of it by up to
 * that factor. */
static const double rise_error = 1e-2, bulk_rise = 1.1;
/* It waits while nodes move so far from check to check, as a strain, that rows which old leave stiffness of
 * more than so many shear moduli: bulk modulus times strain squared. */
static const double most_left = 5.0;

/* A limit that limits nothing is none. */
static double effective(const struct relaxation *r, double limit)
{
    return limit < body_largest_bulk(&r->system->body) ? limit : INFINITY;
}

void relaxation_limit_bulk(struct relaxation *r)
{
    r->bulk_limit = r->inertia.volumes.count > 0 ? effective(r, first_bulk) : INFINITY;
    r->rows_limit = r->bulk_limit;
    r->bulk_rises = false;
    r->fresh_frequency = 0.0;
    body_limit_bulk(&r->system->body, r->bulk_limit);
}

void relaxation_raise_bulk(struct relaxation *r)
{
    if (r->bulk_rises && !r->bulk_waits && r->at_full_load > 0 && isfinite(r->bulk_limit)) {
        r->bulk_limit = effective(r, bulk_rise * r->bulk_limit);
        body_limit_bulk(&r->system->body, r->bulk_limit);
    }
}

/* Mass and rows of volumes at the state r->residual_at. False on failure. */
static bool set_rows(struct relaxation *r, struct error *error)
{
    (void)system_residual(r->system, r->residual_at, r->residual);
    r->report->force_evaluations++;
    system_relaxation_mass(r->system, true, r->scratch);
    body_limit_bulk(&r->system->body, r->rows_limit);
    r->failure = inertia_set_mass(&r->inertia, r->system, r->scratch, error);
    body_limit_bulk(&r->system->body, r->bulk_limit);
    relaxation_note_new_mass(r);
    r->frequency = 0.0;
    relaxation_update_time_step(r, r->residual_at, fresh_iterations);
    r->fresh_frequency = r->frequency;
    return r->failure == STATUS_OK;
}

/* From here on the limit rises. While the rows are set anew at each check the increments tell nothing of the
 * lowest mode, by which the run is damped: it is found now. False on failure. */
static bool begin_rise(struct relaxation *r, struct error *error)
{
    struct spectrum spectrum;
    r->bulk_rises = true;
    if (!relaxation_find_spectrum(r, r->residual_at, rise_iterations, &spectrum, error)) {
        return false;
    }
    if (spectrum.lowest > 0.0) {
        r->low2 = spectrum.lowest;
        relaxation_damp_at_most(r, r->low2);
    }
    return true;
}

bool relaxation_update_volumes(struct relaxation *r, struct error *error)
{
    if (r->inertia.volumes.count == 0) {
        return true;
    }
    bool limited = isfinite(r->bulk_limit);
    if (limited && !r->bulk_rises && r->at_full_load > 0 && r->report->error < rise_error &&
        !begin_rise(r, error)) {
        return false;
    }
    bool rises = limited && r->bulk_rises;
    double strain = r->moved / r->spacing;
    r->bulk_waits = !(r->bulk_limit * strain * strain < most_left);
    if (rises) {
        r->rows_limit = effective(r, pow(bulk_rise, 2 * CHECK_INTERVAL) * r->bulk_limit);
    }
    return rises || r->frequency >= most_stale * r->fresh_frequency ? set_rows(r, error) : true;
}

/* Whether the mode that the acceleration shows is beyond the critical step. */
static bool is_unstable(struct relaxation *r, const double *acceleration)
{
    memcpy(r->mode, acceleration, (size_t)r->size * sizeof *r->mode);
    (void)system_residual(r->system, r->u, r->residual);
    double frequency = system_largest_frequency(r->system, &r->inertia, r->u, r->residual, calm_iterations,
                                                r->mode, r->scratch);
    r->report->force_evaluations += calm_iterations + 1;
    return !(frequency * r->time_step < 2.0);
}

bool relaxation_calm(struct relaxation *r, const double *acceleration, struct error *error)
{
    r->calmed_step = r->report->steps;
    r->usual_residual2 = 0.0;
    if (!is_unstable(r, acceleration)) {
        return true;
    }
    relaxation_go_back(r, &r->check_before);
    relaxation_keep_check(r);
    r->residual_at = r->u;
    if (r->inertia.volumes.count > 0) {
        return set_rows(r, error);
    }
    (void)system_residual(r->system, r->residual_at, r->residual);
    r->report->force_evaluations++;
    relaxation_update_time_step(r, r->residual_at, calm_iterations);
    return true;
}
