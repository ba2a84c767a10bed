/* Sums over the points of a contact: energy, force, moment, work. */
#include "solid/contact/contact.h"

#include "base/vector.h"
#include "solid/contact/friction.h"

#include <string.h>

double contact_energy(const struct contact *contact)
{
    double sum = 0.0;
    for (int64_t p = 0; p < contact->count; p++) {
        double difference = contact->pressure[p] * contact->pressure[p];
        for (int c = 0; c < contact->dim; c++) {
            double held = contact->held[p * contact->dim + c];
            difference -= held * held;
        }
        difference = contact->view[p].led ? 0.0 : difference;
        sum += contact->points->area[p] * difference / (2.0 * contact->stiffness[p]);
    }
    return sum + friction_energy(contact);
}

void contact_total(const struct contact *contact, double *total)
{
    memset(total, 0, (size_t)contact->dim * sizeof *total);
    for (int64_t p = 0; p < contact->count; p++) {
        double force[3];
        contact_point_force(contact, p, force);
        add_scaled(contact->dim, contact->sign, force, total);
    }
}

void contact_moment(const struct contact *contact, const double *point, double moment[3])
{
    int dim = contact->dim;
    memset(moment, 0, 3 * sizeof *moment);
    for (int64_t p = 0; p < contact->count; p++) {
        double arm[3] = {0.0, 0.0, 0.0}, force[3] = {0.0, 0.0, 0.0}, of_point[3];
        if (!contact_acts(contact, p)) {
            continue;
        }
        contact_point_force(contact, p, force);
        rigid_place_from_rest(&contact->place, dim, contact->view[p].x, arm);
        for (int c = 0; c < dim; c++) {
            double raised = contact->rest[p * dim + c] - contact->points->position[p * dim + c];
            arm[c] -= raised + point[c];
        }
        vector_cross(arm, force, of_point);
        add_scaled(3, contact->sign, of_point, moment);
    }
}

struct contact_work contact_work(const struct contact *contact, const double *factor_from,
                                 const double *factor_to)
{
    struct contact_work sum = {0.0, 0.0};
    int dim = contact->dim;
    if (!contact->motion.moves) {
        return sum;
    }
    struct rigid_place from = rigid_place_at(&contact->motion, factor_from);
    struct rigid_place to = rigid_place_at(&contact->motion, factor_to);
    for (int64_t p = 0; p < contact->count; p++) {
        double before[3], after[3], force[3];
        if (!contact_acts(contact, p)) {
            continue;
        }
        contact_point_force(contact, p, force);
        rigid_place_from_rest(&from, dim, contact->view[p].x, before);
        rigid_place_from_rest(&to, dim, contact->view[p].x, after);
        for (int c = 0; c < dim; c++) {
            double way = after[c] - before[c];
            sum.work += force[c] * way;
            sum.unresolved += contact->stiffness[p] * contact->points->area[p] * way * way;
        }
    }
    return sum;
}
