/* Contact between facets of the body: forces on the opposite ones; for preconditioner and time step:
 * dependence of gaps on the field, bounds of the stiffness. */
#include "solid/contact/contact_between.h"

#include "base/vector.h"
#include "solid/contact/friction.h"

#include <math.h>
#include <string.h>

void contact_between_react(struct contact *contact, double *force)
{
    int dim = contact->dim;
    if (contact->between == NULL) {
        return;
    }
    struct opposite *opposite = &contact->between->opposite;
    memset(opposite->load, 0, (size_t)(opposite->rows.count * dim) * sizeof *opposite->load);
    for (int64_t p = 0; p < contact->count; p++) {
        const struct contact_view *here = &contact->view[p];
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
        const struct contact_view *here = &contact->view[p];
        if (here->searched) {
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
        moves = contact->view[p].searched && between->taken_facet[p] != contact->view[p].facet + 1;
    }
    return moves;
}

bool contact_between_part(const struct contact *contact, int64_t a, int64_t i, struct average *average,
                          double *weight)
{
    const struct contact_between *between = contact->between;
    int dim = contact->dim;
    int64_t p;
    double share;
    *weight = 0.0;
    if (between == NULL || !contact_sample(contact, a, i / dim, &p, &share)) {
        return false;
    }
    int64_t facet = between->taken_facet[p] - 1;
    if (facet >= 0) {
        *weight = share * between->taken_weight[p * 3 + i % dim];
        *average = average_of_boundary(&between->opposite.rows,
                                       between->opposite.surface.facet[facet * dim + i % dim]);
    }
    return true;
}

/* The largest sum of the magnitudes of a row of the stiffness bounds its eigenvalues. */
static void add_bond(const struct boundary_averages *rows, int64_t r, double stiffness, double *mass)
{
    struct average average = average_of_boundary(rows, r);
    double sum = 0.0;
    for (int64_t i = 0; i < average.length; i++) {
        sum += fabs(average.phi[i]);
    }
    sum *= stiffness;
    for (int64_t i = 0; i < average.length; i++) {
        mass[average.idx[i]] += sum * fabs(average.phi[i]);
    }
}

void contact_add_to_bound(const struct contact *contact, bool all, double *mass)
{
    const struct boundary_averages *points = contact->points;
    const struct opposite *opposite = contact->between != NULL ? &contact->between->opposite : NULL;
    /* A point and its opposite place form one row, whose square is at most twice the sum of those of its
     * parts. */
    double parts = all && opposite != NULL ? 2.0 : 1.0;
    for (int64_t p = 0; p < contact->count; p++) {
        const struct contact_view *here = &contact->view[p];
        double stiffness = contact->stiffness[p] * points->area[p];
        bool near = opposite != NULL && !all;
        if (!near || contact->gap[p] < INFINITY) {
            add_bond(points, p, parts * stiffness, mass);
        }
        for (int k = 0; k < contact->dim && near && contact->gap[p] < INFINITY && here->facet >= 0; k++) {
            add_bond(&opposite->rows, opposite->surface.facet[here->facet * contact->dim + k],
                     stiffness * here->weight[k], mass);
        }
    }
    for (int64_t v = 0; all && opposite != NULL && v < opposite->rows.count; v++) {
        add_bond(&opposite->rows, v, parts * (opposite->stiffness[v] * opposite->rows.area[v]), mass);
    }
}
