/* Contact between facets of the body: forces on the opposite ones; for preconditioner and time step:
 * dependence of gaps on the field, bounds of the stiffness. */
#include "solid/contact/contact_between.h"

#include "base/vector.h"
#include "solid/contact/friction.h"

#include <math.h>
#include <string.h>

double contact_between_sign(const struct contact *contact)
{
    return contact->between == NULL ? 1.0 : (double)contact->between->sign;
}

bool contact_between_led(const struct contact *contact, int64_t p)
{
    return contact->between != NULL && contact->between->view[p].led;
}

void contact_between_react(struct contact *contact, double *force)
{
    int dim = contact->dim;
    if (contact->between == NULL) {
        return;
    }
    struct opposite *opposite = &contact->between->opposite;
    memset(opposite->load, 0, (size_t)(opposite->rows.count * dim) * sizeof *opposite->load);
    for (int64_t p = 0; p < contact->count; p++) {
        const struct between_view *here = &contact->between->view[p];
        double strength = contact->pressure[p] * contact->points->area[p], on_point[3];
        for (int c = 0; c < dim; c++) {
            on_point[c] = strength * contact->normal[p * dim + c];
        }
        for (int k = 0; k < dim && contact->pressure[p] > 0.0; k++) {
            int64_t v = opposite->surface.facet[here->facet * dim + k];
            for (int c = 0; c < dim; c++) {
                opposite->load[v * dim + c] -= here->weight[k] * on_point[c];
            }
        }
    }
    friction_load(contact, opposite->load);
    for (int64_t v = 0; v < opposite->rows.count; v++) {
        struct average average = average_of_boundary(&opposite->rows, v);
        const double *load = opposite->load + v * dim;
        if (load[0] != 0.0 || load[1] != 0.0 || load[dim - 1] != 0.0) {
            average_spread(&average, dim, load, force);
        }
    }
}

void contact_between_take(struct contact *contact)
{
    struct contact_between *between = contact->between;
    for (int64_t p = 0; p < contact->count && between != NULL; p++) {
        const struct between_view *here = &between->view[p];
        if (contact->view[p].searched) {
            between->taken_facet[p] = here->facet + 1;
            memcpy(between->taken_weight + p * 3, here->weight, sizeof here->weight);
        }
    }
}

bool contact_between_moves(const struct contact *contact)
{
    const struct contact_between *between = contact->between;
    bool moves = false;
    for (int64_t p = 0; p < contact->count && between != NULL && !moves; p++) {
        moves = contact->view[p].searched && between->taken_facet[p] != between->view[p].facet + 1;
    }
    return moves;
}

bool contact_between_part(const struct contact *contact, int64_t a, int64_t i, int64_t *corner,
                          double *weight)
{
    const struct boundary_averages *averages = contact->averages;
    const struct contact_between *between = contact->between;
    int dim = contact->dim;
    *weight = 0.0;
    if (between == NULL || i >= dim * (averages->sample_ptr[a + 1] - averages->sample_ptr[a])) {
        return false;
    }
    int64_t s = averages->sample_ptr[a] + i / dim, p = averages->sample_point[s];
    int64_t facet = between->taken_facet[p] - 1;
    if (facet >= 0) {
        *weight = averages->sample_share[s] * between->taken_weight[p * 3 + i % dim];
        *corner = between->opposite.surface.facet[facet * dim + i % dim];
    }
    return true;
}

struct average contact_between_corner(const struct contact *contact, int64_t corner)
{
    return average_of_boundary(&contact->between->opposite.rows, corner);
}

int64_t contact_bond_count(const struct contact *contact)
{
    return contact->count + (contact->between != NULL ? contact->between->opposite.rows.count : 0);
}

struct average contact_bond(const struct contact *contact, int64_t b, double *stiffness)
{
    const struct boundary_averages *points = contact->points;
    if (b < contact->count) {
        *stiffness = contact->stiffness[b] * points->area[b];
        return average_of_boundary(points, b);
    }
    const struct opposite *opposite = &contact->between->opposite;
    *stiffness = opposite->stiffness[b - contact->count] * opposite->rows.area[b - contact->count];
    return average_of_boundary(&opposite->rows, b - contact->count);
}

static void add_bond(const struct average *average, double stiffness, double *mass)
{
    double sum = 0.0;
    for (int64_t i = 0; i < average->length; i++) {
        sum += fabs(average->phi[i]);
    }
    for (int64_t i = 0; i < average->length; i++) {
        mass[average->idx[i]] += stiffness * fabs(average->phi[i]) * sum;
    }
}

void contact_add_to_bound(const struct contact *contact, double *mass)
{
    const struct contact_between *between = contact->between;
    int dim = contact->dim;
    for (int64_t p = 0; p < contact->count; p++) {
        double stiffness;
        struct average average = contact_bond(contact, p, &stiffness);
        bool near = between == NULL || contact->gap[p] < INFINITY;
        if (near) {
            add_bond(&average, stiffness, mass);
        }
        for (int k = 0; k < dim && near && between != NULL && between->view[p].facet >= 0; k++) {
            int64_t v = between->opposite.surface.facet[between->view[p].facet * dim + k];
            average = average_of_boundary(&between->opposite.rows, v);
            add_bond(&average, stiffness * between->view[p].weight[k], mass);
        }
    }
}
