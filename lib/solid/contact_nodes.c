/* The boundary nodes of a contact: their multipliers, and means over their hat functions. */
#include "solid/contact.h"

#include <math.h>
#include <string.h>

void contact_spread_multipliers(struct contact *contact)
{
    const struct boundary_averages *hats = contact->hats;
    size_t size = (size_t)(contact->count * contact->dim) * sizeof *contact->held;
    if (hats == NULL) {
        memcpy(contact->held, contact->multiplier, size);
        return;
    }
    memset(contact->held, 0, size);
    for (int64_t a = 0; a < hats->count; a++) {
        const double *multiplier = contact->multiplier + a * contact->dim;
        for (int64_t s = hats->sample_ptr[a]; s < hats->sample_ptr[a + 1]; s++) {
            int64_t p = hats->sample_point[s];
            double hat = hats->sample_share[s] * hats->area[a] / contact->points->area[p];
            for (int c = 0; c < contact->dim; c++) {
                contact->held[p * contact->dim + c] += hat * multiplier[c];
            }
        }
    }
}

const struct boundary_averages *contact_nodes(const struct contact *contact)
{
    return contact->hats != NULL ? contact->hats : contact->points;
}

/* Add to the means of a node what point p has, which takes that share of its hat function. Returns the share
 * where there is a gap. */
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
    const struct boundary_averages *hats = contact->hats;
    struct contact_node node = {0};
    double length2 = 0.0, within = hats == NULL ? add_point(contact, a, 1.0, &node) : 0.0;
    for (int64_t s = hats != NULL ? hats->sample_ptr[a] : 0; hats != NULL && s < hats->sample_ptr[a + 1];
         s++) {
        within += add_point(contact, hats->sample_point[s], hats->sample_share[s], &node);
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

/* Add to sum[dim] and to direction[dim] what point p, of that weight, lacks of its traction and has as a
 * normal. */
static void add_lack(const struct contact *contact, int64_t p, double weight, double *sum, double *direction)
{
    for (int c = 0; c < contact->dim; c++) {
        double normal = contact->view[p].normal[c];
        sum[c] += weight * (contact->pressure[p] * normal - contact->held[p * contact->dim + c]);
        direction[c] += weight * normal;
    }
}

/* next[dim]: the multiplier of node a after an augmentation, Pa. Returns by how much the penalty gives way
 * for the change, m. */
static double augmented(const struct contact *contact, int64_t a, double next[3])
{
    const struct boundary_averages *hats = contact->hats;
    const double *multiplier = contact->multiplier + a * contact->dim;
    double sum[3] = {0.0, 0.0, 0.0}, direction[3] = {0.0, 0.0, 0.0}, compliance = 0.0, along = 0.0;
    if (hats == NULL) {
        compliance = 1.0 / contact->stiffness[a];
        add_lack(contact, a, compliance, sum, direction);
    }
    for (int64_t s = hats != NULL ? hats->sample_ptr[a] : 0; hats != NULL && s < hats->sample_ptr[a + 1];
         s++) {
        int64_t p = hats->sample_point[s];
        double part = hats->sample_share[s] / contact->stiffness[p];
        compliance += part;
        add_lack(contact, p, part, sum, direction);
    }
    for (int c = 0; c < contact->dim; c++) {
        next[c] = multiplier[c] + sum[c] / compliance;
        along += next[c] * direction[c];
    }
    double change2 = 0.0;
    for (int c = 0; c < contact->dim; c++) {
        next[c] = along > 0.0 ? next[c] : 0.0;
        change2 += (next[c] - multiplier[c]) * (next[c] - multiplier[c]);
    }
    return sqrt(change2) * compliance;
}

void contact_augment(struct contact *contact)
{
    double next[3];
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        (void)augmented(contact, a, next);
        memcpy(contact->multiplier + a * contact->dim, next, (size_t)contact->dim * sizeof *next);
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
