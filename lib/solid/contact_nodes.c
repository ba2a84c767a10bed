/* The boundary nodes of a contact: their multipliers, and means over their hat functions. */
#include "solid/contact.h"

#include <math.h>
#include <string.h>

void contact_spread_multipliers(struct contact *contact)
{
    const struct boundary_averages *hats = contact->hats;
    memset(contact->held, 0, (size_t)contact->count * sizeof *contact->held);
    if (hats == NULL) {
        memcpy(contact->held, contact->multiplier, (size_t)contact->count * sizeof *contact->held);
        return;
    }
    for (int64_t a = 0; a < hats->count; a++) {
        for (int64_t s = hats->sample_ptr[a]; s < hats->sample_ptr[a + 1] && contact->multiplier[a] > 0.0;
             s++) {
            int64_t p = hats->sample_point[s];
            contact->held[p] +=
                contact->multiplier[a] * hats->sample_share[s] * hats->area[a] / contact->points->area[p];
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

/* The multiplier of node a after an augmentation, Pa; and the compliance of the penalty, m/Pa. */
static double augmented(const struct contact *contact, int64_t a, double *compliance)
{
    const struct boundary_averages *hats = contact->hats;
    double sum = 0.0;
    if (hats == NULL) {
        *compliance = 1.0 / contact->stiffness[a];
        return contact->pressure[a];
    }
    *compliance = 0.0;
    for (int64_t s = hats->sample_ptr[a]; s < hats->sample_ptr[a + 1]; s++) {
        int64_t p = hats->sample_point[s];
        double part = hats->sample_share[s] / contact->stiffness[p];
        *compliance += part;
        sum += part * (contact->pressure[p] - contact->held[p]);
    }
    return fmax(0.0, contact->multiplier[a] + sum / *compliance);
}

void contact_augment(struct contact *contact)
{
    double compliance;
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        contact->multiplier[a] = augmented(contact, a, &compliance);
    }
    contact_spread_multipliers(contact);
}

double contact_miss(const struct contact *contact)
{
    double miss = 0.0, compliance;
    for (int64_t a = 0; a < contact_nodes(contact)->count; a++) {
        double next = augmented(contact, a, &compliance);
        miss = fmax(miss, fabs(next - contact->multiplier[a]) * compliance);
    }
    return miss;
}
