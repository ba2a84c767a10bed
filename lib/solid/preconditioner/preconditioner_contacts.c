/* The mass along the coarse fields follows the contacts. */
#include "solid/preconditioner/preconditioner_private.h"

#include "base/dense.h"
#include "base/vector.h"
#include "solid/contact/contact_between.h"

#include <string.h>

static const double least_cosine = 0.98; /* of a surface's normal with what it was when it was counted in */

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

/* The coarse fields' means at contact node a, less what is opposite; the contact's corners are those from
 * `corners` on. */
static void take_fields(const struct preconditioner *p, const struct contact *contact, int64_t a,
                        int64_t corners, struct coarse_mean *mean)
{
    struct average average = average_of_boundary(contact_nodes(contact), a);
    const struct sparse *opposite = &p->opposite;
    int64_t corner;
    double weight;
    coarse_mean_of_average(&p->coarse, &average, p->held, mean);
    for (int64_t i = 0; next_opposite(contact, a, &i, &corner, &weight);) {
        for (int64_t k = opposite->ptr[corners + corner]; k < opposite->ptr[corners + corner + 1]; k++) {
            coarse_mean_add(&p->coarse, opposite->idx[k], -weight * opposite->value[k], mean);
        }
    }
}

/* The lower triangle of matrix += stiffness row^T row, with row = the mean's fields along a direction. */
static void add_square(const struct preconditioner *p, double stiffness, const double *direction,
                       const struct coarse_mean *mean, double *matrix)
{
    int64_t dim = p->dim, fields = dim + 1, numbers = fields * dim;
    double *row = p->amount;
    for (int64_t i = 0; i < mean->count * numbers; i++) {
        row[i] = mean->field[mean->centre[i / numbers] * fields + i % numbers / dim] * direction[i % dim];
    }
    for (int64_t s = 0; s < mean->count; s++) {
        for (int64_t t = 0; t < mean->count; t++) {
            if (mean->centre[t] > mean->centre[s]) {
                continue;
            }
            for (int64_t i = 0; i < numbers; i++) {
                double *to = matrix + (mean->centre[s] * numbers + i) * p->size + mean->centre[t] * numbers;
                double factor = stiffness * row[s * numbers + i];
                for (int64_t k = 0; k < numbers; k++) {
                    to[k] += factor * row[t * numbers + k];
                }
            }
        }
    }
}

void preconditioner_add_contacts(struct preconditioner *p, const struct solid_system *system,
                                 const bool *only, double *matrix)
{
    int64_t dim = p->dim, at = 0, corners = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        const struct contact *contact = &system->contacts[c];
        const struct boundary_averages *averages = contact_nodes(contact);
        for (int64_t a = 0; a < averages->count; a++, at++) {
            if (!p->active[at] || (only != NULL && !only[at])) {
                continue;
            }
            double stiffness = contact_node(contact, a).stiffness * averages->area[a];
            bool creased = p->creased[at];
            take_fields(p, contact, a, corners, &p->mean);
            for (int64_t d = 0; d < (creased ? dim : 1); d++) {
                const double axis[3] = {d == 0, d == 1, d == 2};
                add_square(p, stiffness, creased ? axis : p->normal + at * dim, &p->mean, matrix);
            }
        }
        corners += contact_between_corners(contact);
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
    if (p->active == NULL) { /* the mass of a dynamic run */
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

/* How A changes with the contacts. */
struct change {
    bool any, pushes; /* at all; by nodes that are counted in anew, */
    bool drops;       /* or no longer as they were */
};

/* Count all contact nodes in or out, and set which ones A counts in anew or with another normal. */
static struct change follow_nodes(struct preconditioner *p, const struct solid_system *system, bool leave)
{
    struct change change = {0};
    int64_t at = 0;
    for (int64_t c = 0; c < system->contact_count; c++) {
        for (int64_t a = 0; a < contact_nodes(&system->contacts[c])->count; a++, at++) {
            bool counted = p->active[at];
            bool changes = follow_node(p, &system->contacts[c], a, at, leave);
            p->pushed[at] = changes && p->active[at];
            change.any = change.any || changes;
            change.pushes = change.pushes || p->pushed[at];
            change.drops = change.drops || (changes && counted);
        }
    }
    for (int64_t c = 0; c < system->contact_count && change.any; c++) {
        contact_between_take(&system->contacts[c]);
    }
    return change;
}

/* amount[size] := A'^-1 amount, where that is known. */
static void solve_if(bool known, const struct preconditioner *p, double *amount)
{
    if (known) {
        dense_solve_large(p->size, p->stiffness_factor, amount);
    }
}

/* The momentum A a of the velocity along the coarse fields with the A that counts in both what it did and
 * what it does now: y + P Z (A'^-1 A a - a). Where A' falls to what A becomes, the velocity stays. The
 * factors become those of what A does now, which is A' unless it drops something. */
static void keep_momentum(struct preconditioner *p, const struct solid_system *system, bool drops,
                          double *velocity, double *field)
{
    double *amount = p->amount + 2 * p->size, *change = amount + p->size;
    bool known = false;
    preconditioner_momentum(p, velocity, amount, change);
    if (drops) {
        preconditioner_add_contacts(p, system, p->pushed, p->contacts);
        known = preconditioner_factorise(p, p->stiffness_factor) > 0.0;
        solve_if(known, p, change);
    }
    preconditioner_factorise_both(p, system);
    if (!drops) {
        known = p->uses_coarse;
        solve_if(known, p, change);
    }
    for (int64_t k = 0; k < p->size; k++) {
        change[k] = known ? change[k] - amount[k] : 0.0;
    }
    preconditioner_prolongate(p, change, field);
    for (int64_t i = 0; i < p->node_count * p->dim; i++) {
        velocity[i] += field[i];
    }
}

bool preconditioner_follow(struct preconditioner *p, const struct solid_system *system, bool leave,
                           double *velocity, double *field)
{
    struct change change = follow_nodes(p, system, leave);
    if (!change.any || p->size == 0) {
        return false;
    }
    preconditioner_drop_slow_modes(p);
    if (change.pushes && velocity != NULL && p->uses_coarse) {
        keep_momentum(p, system, change.drops, velocity, field);
    } else {
        preconditioner_factorise_both(p, system);
    }
    return true;
}

void preconditioner_take_penalties(struct preconditioner *p, const struct solid_system *system)
{
    if (p->size > 0) {
        preconditioner_drop_slow_modes(p);
        preconditioner_factorise_both(p, system);
    }
}
