/* The stiffness of the coarse space: that of the body by differences, that of the active contacts in closed
 * form. */
#include "solid/inertia_private.h"

#include "base/dense.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Eigenvalues of the coarse space by the largest, which is about 1: a margin for stiffening until the
 * stiffness is measured again. */
static const double share = 0.25;
/* Part of D that is added to the stiffness of the coarse space, so that modes without stiffness have a mass.
 */
static const double kept = 1e-4;
/* Share of the mass of the coarse space that the conditions must leave free for it to be used. */
static const double least_free = 0.01;
/* Hats nearer to a surface than this part of their length count as touching. */
static const double near_share = 0.1;
static const double least_cosine = 0.98; /* of a surface's normal with what it was when it was counted in */
static const double strain = 1e-6;       /* of the differences that stiffness is measured with */

/* matrix[n * n] := its inverse; false when it is not positive definite. */
static bool invert(int64_t n, double *matrix)
{
    bool good = dense_factorise(n, matrix);
    if (good) {
        dense_invert(n, matrix);
    }
    return good;
}

/* matrix += the stiffness along the fields of the hats that count as touching. */
static void add_contacts(const struct inertia *inertia, const struct solid_system *system, double *matrix)
{
    double *row = inertia->amount;
    int64_t size = inertia->size, hat = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact->averages;
        for (int64_t a = 0; a < contact->count; a++, hat++) {
            if (!inertia->touching[hat]) {
                continue;
            }
            struct average average = average_of_boundary(averages, a);
            memset(row, 0, (size_t)size * sizeof *row);
            inertia_add_row(inertia, &average, inertia->normal + hat * inertia->dim, row);
            for (int64_t i = 0; i < size; i++) {
                double part = contact->stiffness[a] * averages->area[a] * row[i];
                for (int64_t k = 0; k < size && part != 0.0; k++) {
                    matrix[i * size + k] += part * row[k];
                }
            }
        }
    }
}

/* Part of the fields' mass that the conditions leave free. */
static double free_part(const struct inertia *inertia)
{
    double all = 0.0, part = 0.0;
    for (int64_t k = 0; k < inertia->size * inertia->size; k += inertia->size + 1) {
        all += inertia->weight[k];
        part += inertia->free_weight[k];
    }
    return part / all;
}

void inertia_invert(struct inertia *inertia, const struct solid_system *system)
{
    int64_t cells = inertia->size * inertia->size;
    double *stiffness = inertia->beside;
    bool good = false;
    memcpy(stiffness, inertia->body, (size_t)cells * sizeof *stiffness);
    add_contacts(inertia, system, stiffness);
    bool useful = free_part(inertia) > least_free;
    for (double keep = kept; useful && !good && keep < 1e8;
         keep *= 10.0) { /* unstable bodies have no definite one */
        for (int64_t i = 0; i < cells; i++) {
            inertia->inverse[i] = stiffness[i] / share + keep * inertia->weight[i];
        }
        good = invert(inertia->size, inertia->inverse);
        for (int64_t i = 0; good && i < cells; i++) {
            stiffness[i] = stiffness[i] / share + keep * inertia->weight[i] + inertia->free_weight[i];
        }
    }
    if (!good || !invert(inertia->size, inertia->beside)) { /* no fields, then */
        memset(inertia->inverse, 0, (size_t)cells * sizeof *inertia->inverse);
        memset(inertia->beside, 0, (size_t)cells * sizeof *inertia->beside);
    }
}

/* field = P Z e_k */
static void set_field(struct inertia *inertia, int64_t k, double *field)
{
    memset(inertia->amount, 0, (size_t)inertia->size * sizeof *inertia->amount);
    memset(field, 0, (size_t)(inertia->node_count * inertia->dim) * sizeof *field);
    inertia->amount[k] = 1.0;
    fields_add(&inertia->fields, inertia->amount, field);
    constraint_project(&inertia->constraint, NULL, field);
}

static void make_symmetric(int64_t n, double *matrix)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            matrix[i * n + k] = matrix[k * n + i] = 0.5 * (matrix[i * n + k] + matrix[k * n + i]);
        }
    }
}

enum status inertia_measure(struct inertia *inertia, struct solid_system *system, const double *u,
                            struct error *error)
{
    enum status status = STATUS_OK;
    int64_t values = inertia->node_count * inertia->dim;
    double *at_u = NULL, *moved = NULL, *force = NULL;
    double epsilon = strain * system_node_spacing(system);
    if (inertia->size == 0) {
        return STATUS_OK;
    }
    TRY(NEW_ARRAY(&at_u, values, error));
    TRY(NEW_ARRAY(&moved, values, error));
    TRY(NEW_ARRAY(&force, values, error));
    system_resist(system, u, at_u);
    for (int64_t k = 0; k < inertia->size; k++) {
        set_field(inertia, k, moved);
        for (int64_t i = 0; i < values; i++) {
            moved[i] = u[i] + epsilon * moved[i];
        }
        system_resist(system, moved, force);
        for (int64_t i = 0; i < values; i++) {
            force[i] = (force[i] - at_u[i]) / epsilon;
        }
        inertia_collect_force(inertia, force, moved, inertia->body + k * inertia->size);
    }
    make_symmetric(inertia->size, inertia->body);
    inertia->measured_mass = inertia_sum_of_mass(inertia);
    inertia_invert(inertia, system);
done:
    free(at_u);
    free(moved);
    free(force);
    return status;
}

/* Whether the surface at hat a has turned from what it was when the hat was counted in. */
static bool has_turned(const struct contact *contact, int64_t a, const double *counted_normal)
{
    double cosine = 0.0;
    for (int i = 0; i < contact->dim; i++) {
        cosine += contact->normal[a * contact->dim + i] * counted_normal[i];
    }
    return cosine < least_cosine;
}

/* Count hat a in or out; true when that is a change. A body that can move as a whole may come to rest on hats
 * that are not near yet. */
static bool follow_hat(struct inertia *inertia, const struct contact *contact, int64_t a, int64_t hat,
                       bool leave)
{
    double area = contact->averages->area[a], length = contact->dim == 2 ? area : sqrt(area);
    double *normal = inertia->normal + hat * contact->dim;
    bool *counts = &inertia->touching[hat], pressed = contact->pressure[a] > 0.0;
    if (!pressed && !inertia->floats && !(contact->gap[a] < near_share * length)) {
        bool left = *counts && leave;
        *counts = *counts && !leave;
        return left;
    }
    if (*counts ? !pressed || !has_turned(contact, a, normal) : !pressed && !leave) {
        return false;
    }
    *counts = true;
    memcpy(normal, contact->normal + a * contact->dim, (size_t)contact->dim * sizeof *normal);
    return true;
}

bool inertia_follow(struct inertia *inertia, const struct solid_system *system, bool leave)
{
    bool changed = false;
    int64_t hat = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        for (int64_t a = 0; a < system->contacts[c].count; a++) {
            changed = follow_hat(inertia, &system->contacts[c], a, hat++, leave) || changed;
        }
    }
    if (!changed || inertia->size == 0) {
        return false;
    }
    inertia_invert(inertia, system);
    return true;
}
