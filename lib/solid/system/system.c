#include "solid/system/system.h"

#include "approx/cells/cells.h"
#include "approx/support/support.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/contact/contact_between.h"
#include "solid/system/condition.h"

#include <omp.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void system_free(struct solid_system *system)
{
    for (int64_t i = 0; i < system->acting.load_count; i++) {
        free(system->acting.loads[i].force);
    }
    for (int64_t i = 0; i < system->acting.pressure_count; i++) {
        free(system->acting.pressures[i].corner);
        boundary_averages_free(&system->acting.pressures[i].corners);
        boundary_averages_free(&system->acting.pressures[i].points);
    }
    for (int64_t i = 0; i < system->acting.membrane_count; i++) {
        membrane_free(&system->acting.membranes[i]);
    }
    system_free_contacts(system);
    for (int64_t i = 0; i < system->curve_count; i++) {
        curve_free(&system->curves[i]);
    }
    FREE_ALL(system->acting.loads, system->acting.pressures, system->acting.membranes, system->curves,
             system->lumped_mass, system->dashpot, system->factor);
    constraint_rows_free(&system->rows);
    sliding_free(&system->sliding);
    sparse_free(&system->turns);
    constraint_rows_free(&system->springs.rows);
    constraint_nodes_free(&system->springs.nodes);
    FREE_ALL(system->springs.stiffness, system->springs.force);
    body_free(&system->body);
    *system = (struct solid_system){0};
}

enum status system_state(struct solid_system *system, const struct state *state, struct error *error)
{
    const struct state_value factor = {"factor", STATE_NUMBERS, system->factor, system->curve_count};
    const struct state_value stability[] = {{"least", STATE_NUMBERS, &system->stability.least, 1},
                                            {"node", STATE_COUNTS, &system->stability.node, 1},
                                            {"left", STATE_FLAGS, &system->stability.left, 1},
                                            {"left_load", STATE_NUMBERS, &system->stability.left_load, 1},
                                            {"left_node", STATE_COUNTS, &system->stability.left_node, 1}};
    RETURN_IF_ERROR(state_visit(state, "loads", &factor, 1, error));
    RETURN_IF_ERROR(
        state_visit(state, "equilibrium", stability, sizeof stability / sizeof *stability, error));
    RETURN_IF_ERROR(prony_state(&system->body, state, error));
    RETURN_IF_ERROR(stiffening_state(&system->body, state, error));
    for (int64_t c = 0; c < system->contact_count; c++) {
        char prefix[32];
        snprintf(prefix, sizeof prefix, "contact.%lld", (long long)c);
        RETURN_IF_ERROR(contact_state(&system->contacts[c], prefix, state, error));
    }
    return STATUS_OK;
}

/* Constraints found linearly dependent are dropped. The solution is accepted only if each of them holds to
 * this share of the largest prescribed displacement. */
static const double most_missed = 1e-4;

/* The nearest row of another section that acts in a similar direction as row r, or -1. */
static int64_t nearest_of_others(const struct solid_system *system, int64_t r)
{
    const struct constraint_rows *rows = &system->rows;
    int64_t nearest = -1;
    int dim = system->dim;
    double least = INFINITY;
    for (int64_t s = 0; s < rows->count; s++) {
        double cosine = vector_dot(dim, rows->direction + s * dim, rows->direction + r * dim);
        double distance2 = vector_distance2(dim, system->X + (int64_t)rows->node[s] * dim,
                                            system->X + (int64_t)rows->node[r] * dim);
        if (rows->section[s] != rows->section[r] && fabs(cosine) > SAME_DIRECTION && distance2 < least) {
            least = distance2;
            nearest = s;
        }
    }
    return nearest;
}

/* The message that row r conflicts with others. */
static enum status fail_at_row(const struct solid_system *system, int64_t r, double missed,
                               struct error *error)
{
    const struct constraint_rows *rows = &system->rows;
    const struct condition *conditions = system->conditions;
    int64_t other = nearest_of_others(system, r);
    char place[96], with[160] = "others";
    point_text(system->dim, system->X + (int64_t)rows->node[r] * system->dim, place);
    if (conditions != NULL && other >= 0) {
        snprintf(with, sizeof with, "those of [displacement %.100s] and others",
                 conditions[rows->section[other]].name);
    }
    return fail(
        error, STATUS_VERDICT,
        "[displacement %.100s]: the conditions at node %d at %s disagree with %s by %.2g m: prescribe its "
        "displacement once, as by components = free in one section, or refine the cloud there",
        conditions != NULL ? conditions[rows->section[r]].name : "?", rows->node[r], place, with, missed);
}

/* Check whether the dropped constraints are consistent with the others for all loads. */
static enum status check_dropped(const struct solid_system *system, struct constraint *constraint,
                                 struct error *error)
{
    const struct constraint_rows *rows = &system->rows;
    double largest = 0.0, worst = 0.0;
    int64_t size = system->node_count * system->dim, row = 0, worst_row = -1;
    enum { TIMES = 5 };
    NEW_SCRATCH(double, u, size, error);
    NEW_SCRATCH(double, factor, system->curve_count, error);
    for (int64_t r = 0; r < rows->count; r++) {
        largest = fmax(largest, fabs(rows->target[r]));
    }
    for (int k = 0; k < TIMES; k++) {
        double most = 0.0;
        for (int64_t i = 0; i < system->curve_count; i++) {
            factor[i] = curve_value(&system->curves[i], (double)k / (TIMES - 1));
            most = fmax(most, fabs(factor[i]));
        }
        memset(u, 0, (size_t)size * sizeof *u);
        for (int i = 0; i < 3; i++) { /* repeated: rows may be nearly dependent */
            constraint_project(constraint, factor, u);
        }
        double missed = constraint_violation(constraint, factor, u, &row);
        if (!(missed <= most_missed * largest * fmax(most, 1.0)) && !(missed <= worst)) {
            worst = missed;
            worst_row = row;
        }
    }
    if (worst_row >= 0) {
        return fail_at_row(system, worst_row, worst, error);
    }
    return STATUS_OK;
}

enum status system_constrain(const struct solid_system *system, const double *mass,
                             struct constraint *constraint, struct error *error)
{
    enum status status = constraint_build(&system->rows, system->node_count, mass, constraint, error);
    if (status == STATUS_OK && constraint->factor.dropped > 0) {
        status = check_dropped(system, constraint, error);
    }
    return status;
}

void system_add_contacts(struct solid_system *system, const double *u, double *force)
{
    double started = omp_get_wtime();
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_move(&system->contacts[c], system->factor);
        contact_force(&system->contacts[c], u, force);
    }
    system->cost.contact += omp_get_wtime() - started;
}

struct deformation system_residual(struct solid_system *system, const double *u, double *residual)
{
    struct deformation deformation = system_smooth_residual(system, u, residual);
    system_add_contacts(system, u, residual);
    return deformation;
}

double system_longest_way(const struct solid_system *system)
{
    double longest = 0.0;
    for (int64_t r = 0; r < system->rows.count; r++) {
        longest = fmax(longest, fabs(system->rows.target[r]));
    }
    for (int64_t r = 0; r < system->springs.rows.count; r++) {
        longest = fmax(longest, fabs(system->springs.rows.target[r]));
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        for (int64_t a = 0; a < contact->count; a++) {
            double length = rigid_motion_path(&contact->motion, system->dim, contact->rest + a * system->dim);
            longest = fmax(longest, length);
        }
    }
    return longest;
}

bool system_has_inverse(const struct solid_system *system)
{
    return system->body.smoothed && system->node_lists != NULL;
}

static void add_springs_to_bound(const struct solid_system *system, double *mass)
{
    for (int64_t c = 0; c < system->contact_count; c++) {
        contact_add_to_bound(&system->contacts[c], false, mass);
    }
    for (int64_t r = 0; r < system->springs.rows.count; r++) {
        struct average average = constraint_rows_average(&system->springs.rows, r);
        average_add_squares(&average, system->springs.stiffness[r], mass);
    }
}

void system_relaxation_mass(struct solid_system *system, bool rest, double *mass)
{
    double sum = 0.0;
    body_diagonal(&system->body, rest, mass);
    if (!system_has_inverse(system)) {
        for (int64_t i = 0; i < system->acting.membrane_count; i++) {
            membrane_add_to_bound(&system->acting.membranes[i], mass);
        }
        add_springs_to_bound(system, mass);
    }
    for (int64_t n = 0; n < system->node_count; n++) {
        sum += mass[n];
    }
    /* A node without stiffness needs a mass, though no force acts on it. */
    double least = 1e-6 * sum / (double)system->node_count;
    for (int64_t n = 0; n < system->node_count; n++) {
        mass[n] = fmax(mass[n], least);
    }
}

double system_node_spacing(const struct solid_system *system)
{
    return pow(body_volume(&system->body) / (double)system->node_count, 1.0 / system->dim);
}
