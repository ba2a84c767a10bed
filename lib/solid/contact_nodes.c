/* Contact nodes: their multipliers, and nodal averages of gap, pressure and normal. */
#include "solid/contact_between.h"

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
            for (int c = 0; c < contact->dim; c++) {
                contact->held[p * contact->dim + c] += weight * multiplier[c];
            }
        }
    }
}

const struct boundary_averages *contact_nodes(const struct contact *contact)
{
    return contact->averages != NULL ? contact->averages : contact->points;
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
    for (int c = 0; c < contact->dim; c++) {
        node->normal[c] += share * contact->normal[p * contact->dim + c];
    }
    return within ? share : 0.0;
}

struct contact_node contact_node(const struct contact *contact, int64_t a)
{
    const struct boundary_averages *averages = contact->averages;
    struct contact_node node = {0};
    double length2 = 0.0, within = averages == NULL ? add_point(contact, a, 1.0, &node) : 0.0;
    for (int64_t s = averages != NULL ? averages->sample_ptr[a] : 0;
         averages != NULL && s < averages->sample_ptr[a + 1]; s++) {
        within += add_point(contact, averages->sample_point[s], averages->sample_share[s], &node);
    }
    node.gap = within > 0.0 ? node.gap / within : INFINITY;
    for (int c = 0; c < contact->dim; c++) {
        length2 += node.normal[c] * node.normal[c];
    }
    for (int c = 0; c < contact->dim && length2 > 0.0; c++) {
        node.normal[c] /= sqrt(length2);
    }
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

/* next[dim]: the multiplier of node a after an augmentation, Pa. Returns the change divided by the penalty
 * stiffness, m. */
static double augmented(const struct contact *contact, int64_t a, double next[3])
{
    const struct boundary_averages *averages = contact->averages;
    const double *multiplier = contact->multiplier + a * contact->dim;
    double sum[3] = {0.0, 0.0, 0.0}, direction[3] = {0.0, 0.0, 0.0}, compliance = 0.0, along = 0.0;
    memcpy(next, multiplier, (size_t)contact->dim * sizeof *next);
    if (averages == NULL) {
        compliance = 1.0 / contact->stiffness[a];
        add_difference(contact, a, compliance, sum, direction);
    }
    for (int64_t s = averages != NULL ? averages->sample_ptr[a] : 0;
         averages != NULL && s < averages->sample_ptr[a + 1]; s++) {
        int64_t p = averages->sample_point[s];
        double part =
            contact_between_led(contact, p) ? 0.0 : averages->sample_share[s] / contact->stiffness[p];
        compliance += part;
        add_difference(contact, p, part, sum, direction);
    }
    if (!(compliance > 0.0)) { /* all of it is pressed on by others */
        return 0.0;
    }
    for (int c = 0; c < contact->dim; c++) {
        next[c] += sum[c] / compliance;
        along += next[c] * direction[c];
    }
    double change2 = 0.0;
    for (int c = 0; c < contact->dim; c++) {
        next[c] = along > 0.0 ? next[c] : 0.0;
        change2 += (next[c] - multiplier[c]) * (next[c] - multiplier[c]);
    }
    return sqrt(change2) * compliance;
}

void contact_augment(struct contact *contact, double share)
{
    double next[3];
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        (void)augmented(contact, a, next);
        double *multiplier = contact->multiplier + a * contact->dim;
        for (int c = 0; c < contact->dim; c++) {
            multiplier[c] = share == 1.0 ? next[c] : multiplier[c] + share * (next[c] - multiplier[c]);
        }
    }
    contact_spread_multipliers(contact);
}

double contact_miss(const struct contact *contact)
{
    double miss = 0.0, next[3];
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        miss = fmax(miss, augmented(contact, a, next));
    }
    return miss;
}
