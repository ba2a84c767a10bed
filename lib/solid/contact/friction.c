#include "solid/contact/friction.h"

#include "base/vector.h"
#include "solid/contact/contact_between.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The yield in a prediction, by that of the last accepted step. */
static const double predicted = 2.0;

/* Whether there is a place opposite to point p for its anchor. */
static bool has_place(const struct contact *contact, int64_t p)
{
    return contact->between == NULL || contact->friction->place_facet[p] > 0;
}

bool friction_acts(const struct contact *contact, int64_t p)
{
    return contact->friction != NULL && contact->friction->yield[p] > 0.0;
}

/* The share of the way to the anchor that the spring holds: beyond it, the point slips. */
static double held_share(const struct contact_friction *friction, int dim, int64_t p)
{
    double pull = friction->stiffness[p] * vector_length(dim, friction->slip + p * dim);
    return pull > friction->yield[p] ? friction->yield[p] / pull : 1.0;
}

bool friction_sticks(const struct contact *contact, int64_t p)
{
    return friction_acts(contact, p) && held_share(contact->friction, contact->dim, p) == 1.0;
}

void friction_traction(const struct contact *contact, int64_t p, double traction[3])
{
    const struct contact_friction *friction = contact->friction;
    int dim = contact->dim;
    memset(traction, 0, 3 * sizeof *traction);
    if (friction_acts(contact, p)) {
        double factor = -friction->stiffness[p] * held_share(friction, dim, p);
        add_scaled(dim, factor, friction->slip + p * dim, traction);
        rigid_place_turn(&contact->place, dim, traction);
    }
}

/* place[dim] = sum of weights times corners of an opposite facet, where they are. */
static void place_on_facet(const struct contact *contact, int64_t facet, const double *weight, double *place)
{
    const struct rigid_surface *surface = &contact->between->opposite.surface;
    int dim = contact->dim;
    memset(place, 0, (size_t)dim * sizeof *place);
    for (int k = 0; k < dim; k++) {
        add_scaled(dim, weight[k], surface->vertex + (int64_t)surface->facet[facet * dim + k] * dim, place);
    }
}

/* The normal across which point p slips. */
static const double *slip_normal(const struct contact *contact, int64_t p)
{
    return contact->friction->follows ? contact->view[p].normal : contact->checked_normal + p * contact->dim;
}

/* slip[dim] = from the anchor to point p, across the normal. */
static void measure_slip(const struct contact *contact, int64_t p, double *slip)
{
    const struct contact_friction *friction = contact->friction;
    int dim = contact->dim;
    const double *x = contact->view[p].x;
    const double *normal = slip_normal(contact, p);
    if (contact->between == NULL) {
        vector_subtract(dim, x, friction->anchor + p * dim, slip);
    } else {
        double place[3];
        place_on_facet(contact, friction->place_facet[p] - 1, friction->place_weight + p * dim, place);
        add_scaled(dim, 1.0, friction->ahead + p * dim, place);
        vector_subtract(dim, x, place, slip);
    }
    add_scaled(dim, -vector_dot(dim, slip, normal), normal, slip);
    add_scaled(dim, -1.0, friction->passed + p * dim, slip);
}

void friction_measure(struct contact *contact)
{
    struct contact_friction *friction = contact->friction;
    for (int64_t p = 0; friction != NULL && p < contact->count; p++) {
        bool placed = has_place(contact, p);
        if (friction->follows) {
            friction->yield[p] = placed ? friction->coefficient * contact->pressure[p] : 0.0;
        }
        bool acted = vector_length(contact->dim, friction->before + p * contact->dim) > 0.0;
        if (placed && (acted || friction_acts(contact, p))) {
            measure_slip(contact, p, friction->slip + p * contact->dim);
        }
    }
}

/* Take what is opposite to point p now; a point that meets a facet for the first time has its anchor there.
 */
static void take_place(struct contact *contact, int64_t p)
{
    struct contact_friction *friction = contact->friction;
    const struct contact_view *here = &contact->view[p];
    int dim = contact->dim;
    double *weight = friction->place_weight + p * dim, *ahead = friction->ahead + p * dim, place[3];
    friction->place_facet[p] = here->searched ? here->facet + 1 : 0;
    if (friction->place_facet[p] == 0) {
        friction->yield[p] = 0.0;
        return;
    }
    memcpy(weight, here->weight, (size_t)dim * sizeof *weight);
    if (friction->facet[p] == 0) {
        friction->facet[p] = friction->place_facet[p];
        memcpy(friction->anchor + p * dim, weight, (size_t)dim * sizeof *weight);
    }
    place_on_facet(contact, here->facet, weight, place);
    place_on_facet(contact, friction->facet[p] - 1, friction->anchor + p * dim, ahead);
    add_scaled(dim, -1.0, place, ahead);
}

/* Note how far the yields of the model are from those by its pressures, and Aitken's share of that way: two
 * such steps show by which factor the fixed-point iteration of the yields changes it. */
static void note_lag(struct contact *contact)
{
    struct contact_friction *friction = contact->friction;
    double product = 0.0, square = 0.0;
    for (int64_t p = 0; p < contact->count; p++) {
        double yield = friction->yield[p], before = friction->lag[p];
        friction->lag[p] = isfinite(yield) ? friction->coefficient * contact->pressure[p] - yield : 0.0;
        product += before * (friction->lag[p] - before);
        square += (friction->lag[p] - before) * (friction->lag[p] - before);
    }
    double share = friction->lags && square > 0.0 ? -friction->share * product / square : 1.0;
    friction->share = share > 0.0 ? fmin(share, 1.0) : 1.0;
    friction->lags = true;
}

void friction_relax(struct contact *contact)
{
    struct contact_friction *friction = contact->friction;
    for (int64_t p = 0; friction != NULL && friction->lags && p < contact->count; p++) {
        if (has_place(contact, p)) {
            friction->yield[p] -= (1.0 - friction->share) * friction->lag[p];
        }
    }
}

void friction_accept(struct contact *contact)
{
    struct contact_friction *friction = contact->friction;
    for (int64_t i = 0; friction != NULL && !friction->sticks && i < contact->count * contact->dim; i++) {
        friction->passed[i] = 0.0;
    }
    if (friction != NULL && !friction->follows && !friction->sticks) {
        note_lag(contact);
    }
    for (int64_t p = 0; friction != NULL && p < contact->count; p++) {
        if (friction->sticks) {
            friction->yield[p] = contact->pressure[p] > 0.0 ? INFINITY : friction->yield[p];
        } else if (!friction->follows) {
            friction->yield[p] = friction->coefficient * contact->pressure[p];
        }
        if (contact->between != NULL) {
            take_place(contact, p);
        }
    }
}

double friction_energy(const struct contact *contact)
{
    const struct contact_friction *friction = contact->friction;
    double sum = 0.0;
    for (int64_t p = 0; friction != NULL && p < contact->count; p++) {
        if (friction_acts(contact, p)) {
            double way = vector_length(contact->dim, friction->slip + p * contact->dim);
            double share = held_share(friction, contact->dim, p);
            sum +=
                contact->points->area[p] * friction->stiffness[p] * way * way * share * (1.0 - 0.5 * share);
        }
    }
    return sum;
}

void friction_load(const struct contact *contact, double *load)
{
    int dim = contact->dim;
    for (int64_t p = 0; contact->friction != NULL && p < contact->count; p++) {
        if (friction_acts(contact, p)) {
            const int32_t *corner =
                contact->between->opposite.surface.facet + (contact->friction->place_facet[p] - 1) * dim;
            double traction[3];
            friction_traction(contact, p, traction);
            for (int k = 0; k < dim; k++) {
                double weight = contact->friction->place_weight[p * dim + k];
                add_scaled(dim, -weight * contact->points->area[p], traction,
                           load + (int64_t)corner[k] * dim);
            }
        }
    }
}

/* weight[dim] = those of a place that is `way` before the one opposite to point p, in the plane of its facet.
 */
static void weigh_behind(const struct contact *contact, int64_t p, const double *way, double *weight)
{
    const struct rigid_surface *surface = &contact->between->opposite.surface;
    const struct contact_view *here = &contact->view[p];
    int dim = contact->dim;
    double edge[2][3], square[2], both = 0.0, along[2] = {0.0}, part[2] = {0.0};
    const int32_t *corner = surface->facet + here->facet * dim;
    for (int k = 1; k < dim; k++) {
        vector_subtract(dim, surface->vertex + (int64_t)corner[k] * dim,
                        surface->vertex + (int64_t)corner[0] * dim, edge[k - 1]);
        square[k - 1] = vector_dot(dim, edge[k - 1], edge[k - 1]);
        along[k - 1] = vector_dot(dim, edge[k - 1], way);
    }
    if (dim == 2) {
        part[0] = along[0] / square[0];
    } else {
        both = vector_dot(3, edge[0], edge[1]);
        double determinant = square[0] * square[1] - both * both;
        part[0] = (along[0] * square[1] - along[1] * both) / determinant;
        part[1] = (along[1] * square[0] - along[0] * both) / determinant;
    }
    memcpy(weight, here->weight, (size_t)dim * sizeof *weight);
    for (int k = 1; k < dim; k++) {
        weight[k] -= part[k - 1];
        weight[0] += part[k - 1];
    }
}

/* in_plane[dim]: from the anchor to the place opposite to point p, in the plane of its facet, such that the
 * slip across the normal is `way`. */
static void turn_into_facet(const struct contact *contact, int64_t p, const double *way, double *in_plane)
{
    const struct contact_view *here = &contact->view[p];
    const double *normal = slip_normal(contact, p);
    int dim = contact->dim;
    const double *plane = contact->between->opposite.surface.normal + here->facet * dim;
    double offset[3], place[3];
    place_on_facet(contact, here->facet, here->weight, place);
    vector_subtract(dim, contact->view[p].x, place, offset);
    vector_subtract(dim, way, offset, in_plane);
    add_scaled(dim, vector_dot(dim, offset, normal), normal, in_plane);
    add_scaled(dim, -vector_dot(dim, in_plane, plane) / vector_dot(dim, normal, plane), normal, in_plane);
}

/* Move the anchor of point p to `way` behind it; false where nothing is opposite to it. */
static void move_anchor(struct contact *contact, int64_t p, const double *way)
{
    struct contact_friction *friction = contact->friction;
    int dim = contact->dim;
    double *anchor = friction->anchor + p * dim;
    if (contact->between == NULL) {
        vector_subtract(dim, contact->view[p].x, way, anchor);
        return;
    }
    bool found = contact->view[p].searched && contact->view[p].facet >= 0;
    friction->facet[p] = found ? contact->view[p].facet + 1 : 0;
    if (found) {
        double in_plane[3];
        turn_into_facet(contact, p, way, in_plane);
        weigh_behind(contact, p, in_plane, anchor);
    }
}

/* A point that does not press stays free: its anchor is where it is. */
static void slide_point(struct contact *contact, int64_t p)
{
    struct contact_friction *friction = contact->friction;
    int dim = contact->dim;
    double *slip = friction->slip + p * dim, *before = friction->before + p * dim, mean[3], work = 0.0;
    double share = friction_acts(contact, p) ? held_share(friction, dim, p) : 0.0;
    friction->slips[p] = share > 0.0 && share < 1.0;
    for (int c = 0; c < dim; c++) {
        mean[c] = share * slip[c];
        mean[c] = friction->follows ? 0.5 * (mean[c] + before[c]) : mean[c];
        work += mean[c] * (1.0 - share) * slip[c];
        slip[c] = before[c] = share * slip[c];
    }
    friction->dissipated += contact->points->area[p] * friction->stiffness[p] * work;
    if (share < 1.0) {
        move_anchor(contact, p, slip);
    }
}

void friction_slide(struct contact *contact)
{
    for (int64_t p = 0; contact->friction != NULL && p < contact->count; p++) {
        slide_point(contact, p);
        if (contact->between != NULL) {
            take_place(contact, p);
        }
    }
}

void friction_predict(struct contact *contact, bool sticks)
{
    struct contact_friction *friction = contact->friction;
    if (friction != NULL) {
        friction->lags = false;
    }
    for (int64_t p = 0; friction != NULL && p < contact->count; p++) {
        bool presses = friction->yield[p] > 0.0;
        double passed = presses ? 1.0 - held_share(friction, contact->dim, p) : 0.0;
        add_scaled(contact->dim, passed, friction->slip + p * contact->dim,
                   friction->passed + p * contact->dim);
        friction->yield[p] *= predicted;
        if (presses ? sticks
                    : has_place(contact, p) &&
                          fabs(contact->checked_distance[p]) <= contact_round_off(contact, p)) {
            friction->yield[p] = INFINITY;
        }
    }
}

void friction_hold(struct contact *contact, bool sticks)
{
    if (contact->friction != NULL) {
        contact->friction->sticks = sticks;
        if (sticks) {
            friction_predict(contact, true);
        } else {
            friction_accept(contact);
        }
    }
}
