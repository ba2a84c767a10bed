/* Contact nodes: their multipliers, and nodal averages of gap, pressure and normal. */
#include "solid/contact/contact_between.h"

#include "base/vector.h"
#include "solid/contact/friction.h"

#include <math.h>
#include <string.h>

void contact_spread_multipliers(struct contact *contact)
{
    const struct boundary_averages *averages = contact->averages;
    size_t size = (size_t)(contact->count * contact->dim) * sizeof *contact->held;
    if (averages == NULL) {
        memcpy(contact->held, contact->multiplier, size);
        return;
    }
    memset(contact->held, 0, size);
    for (int64_t a = 0; a < averages->count; a++) {
        const double *multiplier = contact->multiplier + a * contact->dim;
        for (int64_t s = averages->sample_ptr[a]; s < averages->sample_ptr[a + 1]; s++) {
            int64_t p = averages->sample_point[s];
            double weight = averages->sample_share[s] * averages->area[a] / contact->points->area[p];
            add_scaled(contact->dim, weight, multiplier, contact->held + p * contact->dim);
        }
    }
}

const struct boundary_averages *contact_nodes(const struct contact *contact)
{
    return contact->averages != NULL ? contact->averages : contact->points;
}

bool contact_sample(const struct contact *contact, int64_t a, int64_t i, int64_t *p, double *share)
{
    const struct boundary_averages *averages = contact->averages;
    int64_t s = averages != NULL ? averages->sample_ptr[a] + i : i;
    bool any = s < (averages != NULL ? averages->sample_ptr[a + 1] : 1);
    *p = averages != NULL && any ? averages->sample_point[s] : a;
    *share = averages != NULL && any ? averages->sample_share[s] : 1.0;
    return any;
}

/* Add the values at point p to the averages of a node, with the weight `share`. Returns the share where the
 * point has a gap, else 0. */
static double add_point(const struct contact *contact, int64_t p, double share, struct contact_node *node)
{
    bool within = contact->gap[p] < INFINITY;
    node->gap += within ? share * contact->gap[p] : 0.0;
    node->pressure += share * contact->pressure[p];
    node->pressed += contact->pressure[p] > 0.0 ? share : 0.0;
    node->stiffness += share * contact->stiffness[p];
    node->turned = node->turned || contact->view[p].turned;
    add_scaled(contact->dim, share, contact->normal + p * contact->dim, node->normal);
    if (friction_acts(contact, p)) {
        double traction[3];
        friction_traction(contact, p, traction);
        add_scaled(contact->dim, share, traction, node->friction);
        node->sticks += friction_sticks(contact, p) ? share : 0.0;
        node->slips += contact->friction->slips[p] ? share : 0.0;
    }
    return within ? share : 0.0;
}

struct contact_node contact_node(const struct contact *contact, int64_t a)
{
    struct contact_node node = {0};
    double within = 0.0, share;
    int64_t p;
    for (int64_t i = 0; contact_sample(contact, a, i, &p, &share); i++) {
        within += add_point(contact, p, share, &node);
    }
    node.gap = within > 0.0 ? node.gap / within : INFINITY;
    vector_normalise(contact->dim, node.normal);
    return node;
}

/* Add to sum[dim] the traction of point p that its multiplier does not hold yet, and to direction[dim] its
 * normal, both with that weight. */
static void add_difference(const struct contact *contact, int64_t p, double weight, double *sum,
                           double *direction)
{
    for (int c = 0; c < contact->dim; c++) {
        double normal = contact->view[p].normal[c];
        sum[c] += weight * (contact->pressure[p] * normal - contact->held[p * contact->dim + c]);
        direction[c] += weight * normal;
    }
}

/* next[dim]: the multiplier of node a after an augmentation, Pa. Returns the compliance, m/Pa, by which its
 * change is the penetration there; 0: nothing changes. */
static double augmented(const struct contact *contact, int64_t a, double next[3])
{
    double sum[3] = {0.0, 0.0, 0.0}, direction[3] = {0.0, 0.0, 0.0}, compliance = 0.0, along = 0.0, share;
    int64_t p;
    memcpy(next, contact->multiplier + a * contact->dim, (size_t)contact->dim * sizeof *next);
    for (int64_t i = 0; contact_sample(contact, a, i, &p, &share); i++) {
        double part = contact->view[p].led ? 0.0 : share / contact->stiffness[p];
        compliance += part;
        add_difference(contact, p, part, sum, direction);
    }
    if (!(compliance > 0.0)) { /* all points are led */
        return 0.0;
    }
    for (int c = 0; c < contact->dim; c++) {
        next[c] += sum[c] / compliance;
        along += next[c] * direction[c];
    }
    for (int c = 0; c < contact->dim; c++) {
        next[c] = along > 0.0 ? next[c] : 0.0;
    }
    return compliance;
}

void contact_augment(struct contact *contact)
{
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        double next[3];
        (void)augmented(contact, a, next);
        memcpy(contact->multiplier + a * contact->dim, next, (size_t)contact->dim * sizeof *next);
    }
    contact_spread_multipliers(contact);
}

double contact_miss(const struct contact *contact)
{
    double miss = 0.0, next[3];
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        const double *multiplier = contact->multiplier + a * contact->dim;
        double compliance = augmented(contact, a, next);
        miss = fmax(miss, compliance * vector_distance(contact->dim, next, multiplier));
    }
    return miss;
}

double contact_missing_work(const struct contact *contact)
{
    const struct boundary_averages *nodes = contact_nodes(contact);
    double work = 0.0, next[3];
    for (int64_t a = 0; a < nodes->count; a++) {
        const double *multiplier = contact->multiplier + a * contact->dim;
        double compliance = augmented(contact, a, next),
               square =
                   vector_dot(contact->dim, next, next) - vector_dot(contact->dim, multiplier, multiplier);
        work += nodes->area[a] * compliance * square / 2.0;
    }
    return fabs(work);
}

bool contact_is_through(const struct contact *contact)
{
    bool through = false;
    for (int64_t p = 0; p < contact->count && contact->between == NULL && !through; p++) {
        struct rigid_contact closest = rigid_closest(&contact->surface, contact->view[p].x, INFINITY);
        through = closest.found && -closest.gap > contact_most_depth(contact, p);
    }
    return through;
}
