#include "solid/contact/contact_between.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/vector.h"
#include "solid/contact/contact_rest.h"
#include "solid/contact/friction.h"

#include <math.h>
#include <string.h>

/* Depths below this share of a point's width count as zero, and differences of unit normals. */
static const double round_off = 1e-6;
/* The penalty of a point times its width, at least: by the largest multiplier, and by p^2 / mu with the
 * multiplier p there. */
static const double by_largest = 15.0, by_square = 3.0;
/* By the shear modulus: beyond, no surface bears the multiplier; it grows where no pressure closes a gap. */
static const double most_pressure = 1000.0;
/* Facets whose normals are this close to being across that at a point, by the cosine. */
static const double across = 0.25;
enum { POINTS_FOR_THREAD = 1000 }; /* see chunks_of */

/* A quadrature point has an equal share of the area of its facet. */
double contact_width(const struct contact *contact, int64_t p)
{
    int points = contact->averages == NULL ? 1 : contact->dim;
    double area = contact->points->area[p] * points;
    return contact->dim == 2 ? area : sqrt(area);
}

double contact_most_depth(const struct contact *contact, int64_t p)
{
    return CONTACT_MOST_DEPTH * contact_width(contact, p);
}

double contact_round_off(const struct contact *contact, int64_t p)
{
    return round_off * contact_width(contact, p);
}

/* No point may start far behind the surface. No point may start on or behind it where the body faces away
 * from it, as a body on the wrong side of a shell does. */
static enum status check_side(const struct contact *contact, struct error *error)
{
    int64_t worst = -1;
    double deepest = -INFINITY;
    for (int64_t p = 0; p < contact->count; p++) {
        struct rigid_contact closest =
            rigid_closest(&contact->surface, contact->rest + p * contact->dim, INFINITY);
        double depth = closest.found ? -closest.gap : -INFINITY, length = contact_most_depth(contact, p);
        double cosine = vector_dot(contact->dim, contact->points->normal + p * contact->dim, closest.normal);
        bool back = closest.found && cosine > SAME_DIRECTION; /* about -1 where they can touch */
        if (depth > deepest && (depth > length || (depth > -round_off * length && back))) {
            deepest = depth;
            worst = p;
        }
    }
    if (worst < 0) {
        return STATUS_OK;
    }
    const double *place = contact->rest + worst * contact->dim;
    int32_t node = contact->points->node[worst];
    char at[96] = "";
    for (int a = 0; a < contact->dim; a++) {
        text_append(at, sizeof at, "%s%.4g", a > 0 ? ", " : "", place[a]);
    }
    bool apart = deepest > round_off * contact_most_depth(contact, worst);
    if (apart && !rigid_is_behind(&contact->surface, place)) {
        return fail(error, STATUS_INPUT,
                    "contact: node %d at (%s) m lies on its side of the rigid surface, but %.3g m behind the "
                    "closest facet: the surface passes through or touches itself there: mend it",
                    node, at, deepest);
    }
    if (apart) {
        return fail(error, STATUS_INPUT,
                    "contact: node %d at (%s) m starts %.3g m behind the rigid surface: state its other "
                    "side, or leave the node's facets out",
                    node, at, deepest);
    }
    return fail(error, STATUS_INPUT,
                "contact: node %d at (%s) m faces away from the surface that it starts on, as a body "
                "behind the rigid surface: state its other side, or leave the node's facets out",
                node, at);
}

enum status contact_allocate(struct contact *contact, double stiffness, struct error *error)
{
    int64_t count = contact->count, dim = contact->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&contact->stiffness, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->rest, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->multiplier, contact_nodes(contact)->count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->behind, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->checked_x, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->checked_distance, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->checked_normal, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->before, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->held, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->gap, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->pressure, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->normal, count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&contact->view, count, error));
    for (int64_t p = 0; p < count; p++) {
        contact->gap[p] = INFINITY;
        contact->stiffness[p] = stiffness;
    }
    for (int64_t i = 0; i < count * dim; i++) {
        contact->checked_x[i] = contact->before[i] = INFINITY; /* forces a search in the first evaluation */
    }
    return STATUS_OK;
}

enum status contact_build(const struct boundary_averages *points, const struct boundary_averages *averages,
                          const double *X, int dim, struct rigid_surface *surface, double stiffness,
                          struct contact *contact, struct error *error)
{
    *contact = (struct contact){.dim = dim,
                                .count = points->count,
                                .points = points,
                                .averages = averages,
                                .surface = *surface,
                                .sign = 1};
    *surface = (struct rigid_surface){0};
    RETURN_IF_ERROR(contact_allocate(contact, stiffness, error));
    RETURN_IF_ERROR(contact_rest_place(contact, X, error));
    return check_side(contact, error);
}

void contact_set_stiffness(struct contact *contact, double modulus)
{
    contact->modulus = modulus;
    for (int64_t p = 0; p < contact->count; p++) {
        contact->stiffness[p] = modulus / contact_width(contact, p);
    }
    contact_between_stiffen(contact, modulus);
}

bool contact_stiffen(struct contact *contact, double shear)
{
    bool changed = false;
    double largest = 0.0;
    for (int64_t p = 0; p < contact->count; p++) {
        largest = fmax(largest, vector_length(contact->dim, contact->held + p * contact->dim));
    }
    largest = fmin(largest, most_pressure * shear);
    for (int64_t p = 0; p < contact->count && contact->modulus > 0.0; p++) {
        double held = fmin(vector_length(contact->dim, contact->held + p * contact->dim), largest);
        double least = by_largest * largest + by_square * held * held / shear;
        double stiffness = fmax(contact->modulus, least) / contact_width(contact, p);
        changed = changed || stiffness != contact->stiffness[p];
        contact->stiffness[p] = stiffness;
    }
    return changed;
}

void contact_free(struct contact *contact)
{
    rigid_free(&contact->surface);
    contact_between_free(contact);
    friction_free(contact);
    FREE_ALL(contact->stiffness, contact->rest, contact->multiplier, contact->behind, contact->checked_x,
             contact->checked_distance, contact->checked_normal, contact->before, contact->held, contact->gap,
             contact->pressure, contact->normal, contact->view);
    *contact = (struct contact){0};
}

enum status contact_state(struct contact *contact, const char *prefix, const struct state *state,
                          struct error *error)
{
    int64_t count = contact->count, dim = contact->dim;
    const struct state_value values[] = {
        {"multiplier", STATE_NUMBERS, contact->multiplier, contact_nodes(contact)->count * dim},
        {"behind", STATE_FLAGS, contact->behind, count},
        {"deepest", STATE_NUMBERS, &contact->deepest, 1},
        {"stiffness", STATE_NUMBERS, contact->stiffness, count},
        {"checked_x", STATE_NUMBERS, contact->checked_x, count * dim},
        {"checked_distance", STATE_NUMBERS, contact->checked_distance, count},
        {"checked_normal", STATE_NUMBERS, contact->checked_normal, count * dim},
        {"step_x", STATE_NUMBERS, contact->before, count * dim},
    };
    RETURN_IF_ERROR(state_visit(state, prefix, values, sizeof values / sizeof *values, error));
    RETURN_IF_ERROR(contact_between_state(contact, prefix, state, error));
    RETURN_IF_ERROR(friction_state(contact, prefix, state, error));
    contact_spread_multipliers(contact); /* `held` follows from the state that was read */
    return STATUS_OK;
}

/* Whether point p was, at its last search, in front of the tangent plane of the surface at the point closest
 * to x, its present position. */
static bool was_in_front(const struct contact *contact, int64_t p, const double *x,
                         const struct rigid_contact *closest)
{
    double height = closest->gap;
    for (int c = 0; c < contact->dim; c++) {
        height += (contact->checked_x[p * contact->dim + c] - x[c]) * closest->normal[c];
    }
    return height >= -contact_round_off(contact, p);
}

/* Whether the point presses on a corner or an edge, or on another facet than at the last step. */
static bool has_turned(const struct contact *contact, int64_t p, const struct rigid_contact *closest)
{
    double turn2 =
        vector_distance2(contact->dim, closest->normal, contact->checked_normal + p * contact->dim);
    return closest->on_edge || (contact->checked_distance[p] < 0.0 && turn2 > round_off * round_off);
}

void contact_place_point(struct contact *contact, int64_t p, const double *u)
{
    struct contact_view *view = &contact->view[p];
    struct average average = average_of_boundary(contact->points, p);
    int dim = contact->dim;
    double x[3];
    average_place(&average, dim, contact->rest + p * dim, u, x);
    rigid_place_to_rest(&contact->place, dim, x, view->x);
    for (int c = 0; c < dim; c++) {
        view->sought[c] = view->x[c] - contact->held[p * dim + c] / contact->stiffness[p];
    }
}

void contact_keep_point(struct contact *contact, int64_t p)
{
    struct contact_view *view = &contact->view[p];
    int dim = contact->dim;
    view->searched = view->turned = view->led = false;
    view->facet = -1;
    contact->gap[p] = contact->checked_distance[p];
    contact->pressure[p] = 0.0;
    memcpy(view->normal, contact->checked_normal + p * dim, (size_t)dim * sizeof *view->normal);
}

void contact_press_point(struct contact *contact, int64_t p, double gap, bool presses)
{
    contact->pressure[p] = presses ? fmax(0.0, -contact->stiffness[p] * gap) : 0.0;
    contact->gap[p] = gap;
    for (int c = 0; c < contact->dim; c++) {
        contact->gap[p] +=
            contact->view[p].normal[c] * contact->held[p * contact->dim + c] / contact->stiffness[p];
    }
}

/* The side from which a point came: its place and the normal at the last step, and its place now. */
struct side {
    const struct rigid_surface *surface;
    const double *before, *now;
    double normal[3], round_off;
};

/* That of point p; false: it is not known. A point that was not searched for at the last step is now. */
static bool find_side(const struct contact *contact, int64_t p, const double *now, struct side *side)
{
    int dim = contact->dim;
    size_t bytes = (size_t)dim * sizeof *now;
    *side = (struct side){.surface = &contact->surface,
                          .before = contact->before + p * dim,
                          .now = now,
                          .round_off = contact_round_off(contact, p)};
    if (memcmp(side->before, contact->checked_x + p * dim, bytes) == 0) {
        memcpy(side->normal, contact->checked_normal + p * dim, bytes);
    } else if (isfinite(side->before[0])) {
        struct rigid_contact closest = rigid_closest(&contact->surface, side->before, INFINITY);
        memcpy(side->normal, closest.normal, bytes);
    }
    return vector_dot(dim, side->normal, side->normal) > 0.5;
}

/* How far x is in front of the plane of facet f, m. */
static double height_above(const struct rigid_surface *surface, int64_t f, const double *x)
{
    double away[3];
    int dim = surface->dim;
    vector_subtract(dim, x, surface->vertex + (int64_t)surface->facet[f * dim] * dim, away);
    return vector_dot(dim, away, surface->normal + f * dim);
}

/* Whether the point may press on facet f. A tool that is thinner than the point's way has facets on its far
 * side, which would let the point out: they face away from the side of the last step, and the point was
 * behind them. Facets across it are left out while the point stays behind them. */
static bool may_press(void *context, int64_t f)
{
    const struct side *side = context;
    const struct rigid_surface *surface = side->surface;
    double cosine = vector_dot(surface->dim, surface->normal + f * surface->dim, side->normal);
    return cosine >= across || height_above(surface, f, side->before) >= -side->round_off ||
           (cosine > -across && height_above(surface, f, side->now) >= 0.0);
}

/* Search for the surface at point p. */
static void search(struct contact *contact, int64_t p, struct contact_view *view)
{
    struct side side;
    bool known = find_side(contact, p, view->sought, &side);
    struct rigid_filter filter = {may_press, NULL, &side};
    struct rigid_contact closest =
        rigid_closest_among(&contact->surface, view->sought, INFINITY, known ? &filter : NULL);
    bool was_inside = contact->checked_distance[p] < 0.0 && !contact->behind[p];
    double gap = closest.found ? closest.gap : INFINITY;
    view->searched = true;
    view->behind =
        gap < 0.0 && (contact->behind[p] || (!was_inside && -gap > contact_most_depth(contact, p) &&
                                             !was_in_front(contact, p, view->sought, &closest)));
    view->turned = gap < 0.0 && !view->behind && has_turned(contact, p, &closest);
    view->distance = fmin(gap, closest.distance);
    memcpy(view->normal, closest.normal, sizeof view->normal);
    contact_press_point(contact, p, view->behind ? INFINITY : gap, true);
}

/* Lower bound of the distance of y_p from the surface, from that at the last search, m. */
static double least_distance(const struct contact *contact, int64_t p, const struct contact_view *view)
{
    return contact->checked_distance[p] -
           vector_distance(contact->dim, view->sought, contact->checked_x + p * contact->dim);
}

/* Gaps and pressures of the points from `begin` to before `end`. Where the surface is too far away for a
 * pressure, there is no search, and the gap is that of the last one. */
static void measure_points(struct contact *contact, int64_t begin, int64_t end, const double *u, bool all)
{
    int dim = contact->dim;
    for (int64_t p = begin; p < end; p++) {
        struct contact_view *view = &contact->view[p];
        double *normal = contact->normal + p * dim;
        contact_place_point(contact, p, u);
        contact_keep_point(contact, p);
        if (all || !(least_distance(contact, p, view) > 0.0)) {
            search(contact, p, view);
        }
        memcpy(normal, view->normal, (size_t)dim * sizeof *normal);
        rigid_place_turn(&contact->place, dim, normal);
    }
}

void contact_move(struct contact *contact, const double *factor)
{
    contact->place = rigid_place_at(&contact->motion, factor);
}

static void measure_to_surface(struct contact *contact, const double *u, bool all)
{
    struct chunks points = chunks_of(contact->count, POINTS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(points.threads)
    for (int64_t c = 0; c < points.count; c++) {
        measure_points(contact, chunks_begin(&points, c), chunks_begin(&points, c + 1), u, all);
    }
}

void contact_measure(struct contact *contact, const double *u, bool all)
{
    (contact->between != NULL ? contact_between_measure : measure_to_surface)(contact, u, all);
    friction_measure(contact);
}

void contact_accept(struct contact *contact)
{
    int dim = contact->dim;
    contact_between_accept(contact);
    for (int64_t p = 0; p < contact->count; p++) {
        const struct contact_view *view = &contact->view[p];
        contact->deepest = fmax(contact->deepest, contact->pressure[p] / contact->stiffness[p]);
        memcpy(contact->before + p * dim, view->sought, (size_t)dim * sizeof *view->sought);
        if (view->searched) {
            contact->behind[p] = view->behind;
            contact->checked_distance[p] = view->distance;
            memcpy(contact->checked_x + p * dim, view->sought, (size_t)dim * sizeof *view->sought);
            memcpy(contact->checked_normal + p * dim, view->normal, (size_t)dim * sizeof *view->normal);
        }
    }
    friction_accept(contact);
}

bool contact_acts(const struct contact *contact, int64_t p)
{
    return contact->pressure[p] > 0.0 || friction_acts(contact, p);
}

void contact_point_force(const struct contact *contact, int64_t p, double force[3])
{
    double strength = contact->pressure[p] * contact->points->area[p], traction[3];
    for (int c = 0; c < contact->dim; c++) {
        force[c] = strength * contact->normal[p * contact->dim + c];
    }
    if (friction_acts(contact, p)) {
        friction_traction(contact, p, traction);
        add_scaled(contact->dim, contact->points->area[p], traction, force);
    }
}

void contact_force(struct contact *contact, const double *u, double *force)
{
    contact_measure(contact, u, false);
    for (int64_t p = 0; p < contact->count; p++) {
        if (contact_acts(contact, p)) {
            struct average average = average_of_boundary(contact->points, p);
            double on_point[3];
            contact_point_force(contact, p, on_point);
            average_spread(&average, contact->dim, on_point, force);
        }
    }
    contact_between_react(contact, force);
}
