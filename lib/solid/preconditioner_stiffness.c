/* The stiffness of the coarse space: that of the body by differences, that of the active contacts in closed
 * form. */
#include "solid/preconditioner_private.h"

#include "base/dense.h"
#include "base/memory.h"
#include "solid/contact_between.h"

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
/* Contact nodes nearer to a surface than this part of their length count as active. */
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

/* matrix += stiffness row row^T */
static void add_square(int64_t size, double stiffness, const double *row, double *matrix)
{
    for (int64_t i = 0; i < size; i++) {
        double part = stiffness * row[i];
        for (int64_t k = 0; k < size && part != 0.0; k++) {
            matrix[i * size + k] += part * row[k];
        }
    }
}

/* row -= what is opposite contact node a along a direction. */
static void subtract_opposite(const struct preconditioner *preconditioner, const struct contact *contact,
                              int64_t a, const double *direction, double *row)
{
    struct average average;
    double weight;
    for (int64_t i = 0; contact_between_part(contact, a, i, &average, &weight); i++) {
        const double less[3] = {-weight * direction[0], -weight * direction[1],
                                contact->dim == 3 ? -weight * direction[2] : 0.0};
        if (weight != 0.0) {
            preconditioner_add_row(preconditioner, &average, less, row);
        }
    }
}

/* matrix += the stiffness along the coarse fields of the contact nodes that count as active. */
static void add_contacts(const struct preconditioner *preconditioner, const struct solid_system *system,
                         double *matrix)
{
    double *row = preconditioner->amount;
    int64_t size = preconditioner->size, at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            if (!preconditioner->active[at]) {
                continue;
            }
            struct average average = average_of_boundary(averages, a);
            double stiffness = contact_node(contact, a).stiffness * averages->area[a];
            bool creased = preconditioner->creased[at];
            for (int64_t d = 0; d < (creased ? preconditioner->dim : 1); d++) {
                const double axis[3] = {d == 0, d == 1, d == 2};
                const double *direction = creased ? axis : preconditioner->normal + at * preconditioner->dim;
                memset(row, 0, (size_t)size * sizeof *row);
                preconditioner_add_row(preconditioner, &average, direction, row);
                subtract_opposite(preconditioner, contact, a, direction, row);
                add_square(size, stiffness, row, matrix);
            }
        }
    }
}

/* mean[dim] += factor times the field opposite contact node a. */
static void add_opposite(const struct contact *contact, int64_t a, double factor, const double *field,
                         double *mean)
{
    struct average average;
    double weight, there[3];
    for (int64_t i = 0; contact_between_part(contact, a, i, &average, &weight); i++) {
        if (weight != 0.0) {
            average_take(&average, contact->dim, field, there);
        }
        for (int c = 0; c < contact->dim && weight != 0.0; c++) {
            mean[c] += factor * weight * there[c];
        }
    }
}

/* The transpose. */
static void spread_opposite(const struct contact *contact, int64_t a, double factor, const double *amount,
                            double *field)
{
    struct average average;
    double weight;
    for (int64_t i = 0; contact_between_part(contact, a, i, &average, &weight); i++) {
        double there[3] = {0.0, 0.0, 0.0};
        for (int c = 0; c < contact->dim; c++) {
            there[c] = factor * weight * amount[c];
        }
        if (weight != 0.0) {
            average_spread(&average, contact->dim, there, NULL, field);
        }
    }
}

void preconditioner_resist_open(const struct preconditioner *preconditioner,
                                const struct solid_system *system, const double *move, double *force)
{
    int64_t dim = preconditioner->dim, at = 0;
    if (preconditioner->active == NULL) {
        return;
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            if (!preconditioner->active[at]) {
                continue;
            }
            struct contact_node node = contact_node(contact, a);
            struct average average = average_of_boundary(averages, a);
            const double *normal = preconditioner->normal + at * dim;
            double mean[3], on_node[3], along = 0.0, stiffness = node.stiffness * averages->area[a];
            average_take(&average, (int)dim, move, mean);
            add_opposite(contact, a, -1.0, move, mean);
            for (int64_t i = 0; i < dim; i++) {
                along += mean[i] * normal[i];
            }
            for (int64_t i = 0; i < dim; i++) {
                double aside =
                    preconditioner->creased[at] && !node.turned ? mean[i] - along * normal[i] : 0.0;
                on_node[i] = stiffness * ((1.0 - node.pressed) * along * normal[i] + aside);
            }
            average_spread(&average, (int)dim, on_node, NULL, force);
            spread_opposite(contact, a, -1.0, on_node, force);
        }
    }
}

/* Part of the coarse fields' mass that the conditions leave free. */
static double free_part(const struct preconditioner *preconditioner)
{
    double all = 0.0, part = 0.0;
    for (int64_t k = 0; k < preconditioner->size * preconditioner->size; k += preconditioner->size + 1) {
        all += preconditioner->weight[k];
        part += preconditioner->free_weight[k];
    }
    return part / all;
}

void preconditioner_invert(struct preconditioner *preconditioner, const struct solid_system *system)
{
    int64_t cells = preconditioner->size * preconditioner->size;
    double *stiffness = preconditioner->capacitance_inverse;
    bool good = false;
    memcpy(stiffness, preconditioner->body, (size_t)cells * sizeof *stiffness);
    add_contacts(preconditioner, system, stiffness);
    bool useful = free_part(preconditioner) > least_free;
    for (double keep = kept; useful && !good && keep < 1e8;
         keep *= 10.0) { /* of an unstable body the stiffness is indefinite */
        for (int64_t i = 0; i < cells; i++) {
            preconditioner->inverse[i] = stiffness[i] / share + keep * preconditioner->weight[i];
        }
        good = invert(preconditioner->size, preconditioner->inverse);
        for (int64_t i = 0; good && i < cells; i++) {
            stiffness[i] =
                stiffness[i] / share + keep * preconditioner->weight[i] + preconditioner->free_weight[i];
        }
    }
    if (!good ||
        !invert(preconditioner->size, preconditioner->capacitance_inverse)) { /* then no coarse space */
        memset(preconditioner->inverse, 0, (size_t)cells * sizeof *preconditioner->inverse);
        memset(preconditioner->capacitance_inverse, 0,
               (size_t)cells * sizeof *preconditioner->capacitance_inverse);
    }
}

/* field = P Z e_k */
static void set_field(struct preconditioner *preconditioner, int64_t k, double *field)
{
    memset(preconditioner->amount, 0, (size_t)preconditioner->size * sizeof *preconditioner->amount);
    memset(field, 0, (size_t)(preconditioner->node_count * preconditioner->dim) * sizeof *field);
    preconditioner->amount[k] = 1.0;
    coarse_space_prolongate(&preconditioner->coarse, preconditioner->amount, field);
    constraint_project(&preconditioner->constraint, NULL, field);
}

static void make_symmetric(int64_t n, double *matrix)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            matrix[i * n + k] = matrix[k * n + i] = 0.5 * (matrix[i * n + k] + matrix[k * n + i]);
        }
    }
}

enum status preconditioner_measure(struct preconditioner *preconditioner, struct solid_system *system,
                                   const double *u, struct error *error)
{
    enum status status = STATUS_OK;
    int64_t values = preconditioner->node_count * preconditioner->dim;
    double *at_u = NULL, *moved = NULL, *force = NULL;
    double epsilon = strain * system_node_spacing(system);
    if (preconditioner->size == 0) {
        return STATUS_OK;
    }
    TRY(NEW_ARRAY(&at_u, values, error));
    TRY(NEW_ARRAY(&moved, values, error));
    TRY(NEW_ARRAY(&force, values, error));
    system_resist(system, u, at_u);
    for (int64_t k = 0; k < preconditioner->size; k++) {
        set_field(preconditioner, k, moved);
        for (int64_t i = 0; i < values; i++) {
            moved[i] = u[i] + epsilon * moved[i];
        }
        system_resist(system, moved, force);
        for (int64_t i = 0; i < values; i++) {
            force[i] = (force[i] - at_u[i]) / epsilon;
        }
        preconditioner_restrict_force(preconditioner, force, moved,
                                      preconditioner->body + k * preconditioner->size);
    }
    make_symmetric(preconditioner->size, preconditioner->body);
    preconditioner->measured_mass = preconditioner_sum_of_mass(preconditioner);
    preconditioner_invert(preconditioner, system);
done:
    free(at_u);
    free(moved);
    free(force);
    return status;
}

/* Whether the normal has turned since the contact node was counted in. */
static bool has_turned(const struct contact_node *node, int dim, const double *counted_normal)
{
    double cosine = 0.0;
    for (int i = 0; i < dim; i++) {
        cosine += node->normal[i] * counted_normal[i];
    }
    return cosine < least_cosine;
}

/* At a check, `i` as in idle: whether a contact node that no longer needs to be counted in is left out. Each
 * time it has been, it stays for twice as many checks: a node that is left out too soon comes back, and as M
 * changes each time, that could go on for ever. */
static bool leaves(struct preconditioner *preconditioner, int64_t i)
{
    int64_t *idle = &preconditioner->idle[i], *patience = &preconditioner->patience[i];
    if (*idle < *patience) {
        ++*idle;
        return false;
    }
    *idle = 0;
    *patience = *patience > 0 ? 2 * *patience : 1;
    return true;
}

/* Set whether contact node `at` is taken to lie in a crease, where it is held in all directions: it has
 * turned twice in a short time. A node that slides from facet to facet turns only once. Returns whether this
 * has changed. */
static bool follow_crease(struct preconditioner *preconditioner, const struct contact_node *node, int64_t at,
                          bool leave)
{
    bool *turned = &preconditioner->turned[at], *creased = &preconditioner->creased[at], was = *creased;
    int64_t i = preconditioner->contact_node_count + at;
    bool again = *turned && node->turned;
    *turned = *turned || node->turned;
    preconditioner->idle[i] = *turned ? 0 : preconditioner->idle[i];
    *creased = again || (*creased && (!leave || *turned || !leaves(preconditioner, i)));
    *turned = *turned && !leave;
    return *creased != was;
}

/* Count contact node a in or out; returns whether A changes. In a body with free rigid-body modes nodes far
 * from the surface stay counted in, as it may come to rest on them. */
static bool follow_node(struct preconditioner *preconditioner, const struct contact *contact, int64_t a,
                        int64_t at, bool leave)
{
    double area = contact_nodes(contact)->area[a], length = contact->dim == 2 ? area : sqrt(area);
    double *normal = preconditioner->normal + at * contact->dim;
    struct contact_node node = contact_node(contact, a);
    bool *counts = &preconditioner->active[at], pressed = node.pressure > 0.0;
    bool creased = follow_crease(preconditioner, &node, at, leave);
    if (!pressed && !preconditioner->has_rigid_mode && !(node.gap < near_share * length)) {
        bool left = *counts && leave && leaves(preconditioner, at);
        *counts = *counts && !left;
        return left || creased;
    }
    preconditioner->idle[at] = 0;
    if (*counts ? !pressed || !has_turned(&node, contact->dim, normal) : !pressed && !leave) {
        return creased;
    }
    *counts = true;
    memcpy(normal, node.normal, (size_t)contact->dim * sizeof *normal);
    return true;
}

bool preconditioner_follow(struct preconditioner *preconditioner, const struct solid_system *system,
                           bool leave)
{
    bool changed = false;
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        for (int64_t a = 0; a < contact_nodes(&system->contacts[c])->count; a++) {
            changed = follow_node(preconditioner, &system->contacts[c], a, at++, leave) || changed;
        }
    }
    for (int64_t c = 0; c < system->contact_count && changed; c++) {
        contact_between_take(&system->contacts[c]);
    }
    if (!changed || preconditioner->size == 0) {
        return false;
    }
    preconditioner_invert(preconditioner, system);
    return true;
}
