/* The stiffness of the coarse space: that of the body by differences, that of the active contacts in closed
 * form. */
#include "solid/preconditioner_private.h"

#include "base/dense.h"
#include "base/memory.h"
#include "base/vector.h"
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

/* The next part, from *i on, of what is opposite contact node a that has a weight; false: no more. */
static bool next_opposite(const struct contact *contact, int64_t a, int64_t *i, int64_t *corner,
                          double *weight)
{
    while (contact_between_part(contact, a, (*i)++, corner, weight)) {
        if (*weight != 0.0) {
            return true;
        }
    }
    return false;
}

/* field[coarse.count]: the coarse fields' means at contact node a, less what is opposite: opposite[corners *
 * coarse.count]. */
static void take_fields(const struct preconditioner *p, const struct contact *contact, int64_t a,
                        const double *opposite, double *field)
{
    struct average average = average_of_boundary(contact_nodes(contact), a);
    int64_t count = p->coarse.count, corner;
    double weight;
    memset(field, 0, (size_t)count * sizeof *field);
    preconditioner_add_fields(p, &average, field);
    for (int64_t i = 0; next_opposite(contact, a, &i, &corner, &weight);) {
        for (int64_t k = 0; k < count; k++) {
            field[k] -= weight * opposite[corner * count + k];
        }
    }
}

/* matrix += the stiffness along the coarse fields of the contact nodes that count as active. */
static void add_contacts(const struct preconditioner *p, const struct solid_system *system, double *matrix)
{
    double *row = p->amount, *field = p->amount + p->size;
    const double *opposite = p->opposite;
    int64_t dim = p->dim, at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            if (!p->active[at]) {
                continue;
            }
            double stiffness = contact_node(contact, a).stiffness * averages->area[a];
            bool creased = p->creased[at];
            take_fields(p, contact, a, opposite, field);
            for (int64_t d = 0; d < (creased ? dim : 1); d++) {
                const double axis[3] = {d == 0, d == 1, d == 2};
                const double *direction = creased ? axis : p->normal + at * dim;
                for (int64_t i = 0; i < p->size; i++) {
                    row[i] = field[i / dim] * direction[i % dim];
                }
                add_square(p->size, stiffness, row, matrix);
            }
        }
        opposite += contact_between_corners(contact) * p->coarse.count;
    }
}

/* mean[dim] -= the field opposite contact node a. */
static void take_opposite(const struct contact *contact, int64_t a, const double *field, double *mean)
{
    int64_t corner;
    double weight, there[3];
    for (int64_t i = 0; next_opposite(contact, a, &i, &corner, &weight);) {
        struct average average = contact_between_corner(contact, corner);
        average_take(&average, contact->dim, field, there);
        for (int c = 0; c < contact->dim; c++) {
            mean[c] -= weight * there[c];
        }
    }
}

/* The transpose. */
static void spread_opposite(const struct contact *contact, int64_t a, const double *amount, double *field)
{
    int64_t corner;
    double weight, there[3];
    for (int64_t i = 0; next_opposite(contact, a, &i, &corner, &weight);) {
        struct average average = contact_between_corner(contact, corner);
        for (int c = 0; c < contact->dim; c++) {
            there[c] = -weight * amount[c];
        }
        average_spread(&average, contact->dim, there, field);
    }
}

void preconditioner_resist_open(const struct preconditioner *p, const struct solid_system *system,
                                const double *move, double *force)
{
    int64_t dim = p->dim, at = 0;
    if (p->active == NULL) {
        return;
    }
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            if (!p->active[at]) {
                continue;
            }
            struct contact_node node = contact_node(contact, a);
            struct average average = average_of_boundary(averages, a);
            const double *normal = p->normal + at * dim;
            double mean[3], on_node[3], stiffness = node.stiffness * averages->area[a];
            average_take(&average, (int)dim, move, mean);
            take_opposite(contact, a, move, mean);
            double along = vector_dot((int)dim, mean, normal);
            for (int64_t i = 0; i < dim; i++) {
                double aside = p->creased[at] && !node.turned ? mean[i] - along * normal[i] : 0.0;
                on_node[i] = stiffness * ((1.0 - node.pressed) * along * normal[i] + aside);
            }
            average_spread(&average, (int)dim, on_node, force);
            spread_opposite(contact, a, on_node, force);
        }
    }
}

/* Part of the coarse fields' mass that the conditions leave free. */
static double free_part(const struct preconditioner *p)
{
    double all = 0.0, part = 0.0;
    for (int64_t k = 0; k < p->size * p->size; k += p->size + 1) {
        all += p->weight[k];
        part += p->free_weight[k];
    }
    return part / all;
}

void preconditioner_invert(struct preconditioner *p, const struct solid_system *system)
{
    int64_t cells = p->size * p->size;
    double *stiffness = p->capacitance_inverse;
    bool good = false;
    memcpy(stiffness, p->body, (size_t)cells * sizeof *stiffness);
    add_contacts(p, system, stiffness);
    bool useful = free_part(p) > least_free;
    for (double keep = kept; useful && !good && keep < 1e8;
         keep *= 10.0) { /* of an unstable body the stiffness is indefinite */
        for (int64_t i = 0; i < cells; i++) {
            p->inverse[i] = stiffness[i] / share + keep * p->weight[i];
        }
        good = invert(p->size, p->inverse);
        for (int64_t i = 0; good && i < cells; i++) {
            stiffness[i] = stiffness[i] / share + keep * p->weight[i] + p->free_weight[i];
        }
    }
    if (!good || !invert(p->size, p->capacitance_inverse)) { /* then no coarse space */
        memset(p->inverse, 0, (size_t)cells * sizeof *p->inverse);
        memset(p->capacitance_inverse, 0, (size_t)cells * sizeof *p->capacitance_inverse);
    }
}

/* field = P Z e_k */
static void set_field(struct preconditioner *p, int64_t k, double *field)
{
    memset(p->amount, 0, (size_t)p->size * sizeof *p->amount);
    memset(field, 0, (size_t)(p->node_count * p->dim) * sizeof *field);
    p->amount[k] = 1.0;
    coarse_space_prolongate(&p->coarse, p->amount, field);
    constraint_project(&p->constraint, NULL, field);
}

static void make_symmetric(int64_t n, double *matrix)
{
    for (int64_t i = 0; i < n; i++) {
        for (int64_t k = 0; k < i; k++) {
            matrix[i * n + k] = matrix[k * n + i] = 0.5 * (matrix[i * n + k] + matrix[k * n + i]);
        }
    }
}

enum status preconditioner_measure(struct preconditioner *p, struct solid_system *system, const double *u,
                                   struct error *error)
{
    int64_t values = p->node_count * p->dim;
    SCRATCH double *at_u = NULL, *moved = NULL, *force = NULL;
    double epsilon = strain * system_node_spacing(system);
    if (p->size == 0) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(NEW_ARRAY(&at_u, values, error));
    RETURN_IF_ERROR(NEW_ARRAY(&moved, values, error));
    RETURN_IF_ERROR(NEW_ARRAY(&force, values, error));
    system_resist(system, u, at_u);
    for (int64_t k = 0; k < p->size; k++) {
        set_field(p, k, moved);
        for (int64_t i = 0; i < values; i++) {
            moved[i] = u[i] + epsilon * moved[i];
        }
        system_resist(system, moved, force);
        for (int64_t i = 0; i < values; i++) {
            force[i] = (force[i] - at_u[i]) / epsilon;
        }
        preconditioner_restrict_force(p, force, moved, p->body + k * p->size);
    }
    make_symmetric(p->size, p->body);
    p->measured_mass = preconditioner_sum_of_mass(p);
    preconditioner_invert(p, system);
    return STATUS_OK;
}

/* Whether the normal has turned since the contact node was counted in. */
static bool has_turned(const struct contact_node *node, int dim, const double *counted_normal)
{
    return vector_dot(dim, node->normal, counted_normal) < least_cosine;
}

/* At a check, `i` as in idle: whether a contact node that no longer needs to be counted in is left out. Each
 * time it has been, it stays for twice as many checks: a node that is left out too soon comes back, and as M
 * changes each time, that could go on for ever. */
static bool leaves(struct preconditioner *p, int64_t i)
{
    int64_t *idle = &p->idle[i], *patience = &p->patience[i];
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
static bool follow_crease(struct preconditioner *p, const struct contact_node *node, int64_t at, bool leave)
{
    bool *turned = &p->turned[at], *creased = &p->creased[at], was = *creased;
    int64_t i = p->contact_node_count + at;
    bool again = *turned && node->turned;
    *turned = *turned || node->turned;
    p->idle[i] = *turned ? 0 : p->idle[i];
    *creased = again || (*creased && (!leave || *turned || !leaves(p, i)));
    *turned = *turned && !leave;
    return *creased != was;
}

/* Count contact node a in or out; returns whether A changes. In a body with free rigid-body modes nodes far
 * from the surface stay counted in, as it may come to rest on them. */
static bool follow_node(struct preconditioner *p, const struct contact *contact, int64_t a, int64_t at,
                        bool leave)
{
    double *normal = p->normal + at * contact->dim;
    struct contact_node node = contact_node(contact, a);
    bool *counts = &p->active[at], pressed = node.pressure > 0.0;
    bool creased = follow_crease(p, &node, at, leave);
    if (!pressed && !p->has_rigid_mode) {
        bool left = *counts && leave && leaves(p, at);
        *counts = *counts && !left;
        return left || creased;
    }
    p->idle[at] = 0;
    if (*counts ? !pressed || !has_turned(&node, contact->dim, normal) : !pressed && !leave) {
        return creased;
    }
    *counts = true;
    memcpy(normal, node.normal, (size_t)contact->dim * sizeof *normal);
    return true;
}

bool preconditioner_follow(struct preconditioner *p, const struct solid_system *system, bool leave)
{
    bool changed = false;
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        for (int64_t a = 0; a < contact_nodes(&system->contacts[c])->count; a++) {
            changed = follow_node(p, &system->contacts[c], a, at++, leave) || changed;
        }
    }
    for (int64_t c = 0; c < system->contact_count && changed; c++) {
        contact_between_take(&system->contacts[c]);
    }
    if (!changed || p->size == 0) {
        return false;
    }
    preconditioner_invert(p, system);
    return true;
}
