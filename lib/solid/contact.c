#include "solid/contact.h"

#include "base/chunks.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Depths below this part of a contact node's length are none. */
static const double round_off = 1e-6;
enum { CONTACT_NODES_FOR_THREAD = 1000 }; /* see chunks_of */

/* How deep a contact node may be when it is first seen behind the surface without having gone through: half
 * its length, m. */
static double most_depth(const struct contact *contact, int64_t a)
{
    double area = contact->averages->area[a];
    return 0.5 * (contact->dim == 2 ? area : sqrt(area));
}

/* sum_j Phi_aj v_j for node values v */
static void take_mean(const struct contact *contact, int64_t a, const double *v, double x[3])
{
    struct average average = average_of_boundary(contact->averages, a);
    average_take(&average, contact->dim, v, x);
}

/* Cosine between the body's outward normal at contact node a and the direction in which the surface's side
 * lies: at a place where they can touch, it is about -1. */
static double facing(const struct contact *contact, int64_t a, const struct rigid_contact *closest)
{
    double cosine = 0.0;
    for (int c = 0; c < contact->dim; c++) {
        cosine += contact->averages->normal[a * contact->dim + c] * closest->normal[c];
    }
    return cosine;
}

/* No contact node may start far behind the surface, or behind it with its back to it: shallow, as around a
 * body that fills a shell, but on the other side. */
static enum status check_side(const struct contact *contact, struct error *error)
{
    for (int64_t a = 0; a < contact->count; a++) {
        struct rigid_contact closest =
            rigid_closest(&contact->surface, contact->rest + a * contact->dim, INFINITY);
        double depth = closest.found ? -closest.gap : 0.0, length = most_depth(contact, a);
        if (depth > length || (depth > round_off * length && facing(contact, a, &closest) > 0.5)) {
            return fail(error, STATUS_INPUT,
                        "contact: node %d starts %.3g m behind the rigid surface: state its other side, or "
                        "leave the node's facets out",
                        contact->averages->node[a], depth);
        }
    }
    return STATUS_OK;
}

/* Facets are chords of a curved boundary, and their mean lies h^2/6r beneath its nodes, which are on it: the
 * gap is that of the boundary, so the mean is raised to the node along the contact node's normal. Zero on
 * flats. */
static void raise_to_node(const struct contact *contact, int64_t a, const double *X, double x[3])
{
    int dim = contact->dim;
    const double *node = X + (int64_t)contact->averages->node[a] * dim;
    const double *normal = contact->averages->normal + a * dim;
    double height = 0.0;
    for (int c = 0; c < dim; c++) {
        height += (node[c] - x[c]) * normal[c];
    }
    for (int c = 0; c < dim; c++) {
        x[c] += height * normal[c];
    }
}

/* An empty contact that takes over the surface. */
static enum status begin(const struct boundary_averages *averages, int dim, struct rigid_surface *surface,
                         double stiffness, struct contact *contact, struct error *error)
{
    enum status status;
    int64_t count = averages->count;
    *contact = (struct contact){
        .dim = dim, .count = count, .averages = averages, .surface = *surface, .stiffness = stiffness};
    *surface = (struct rigid_surface){0};
    TRY(NEW_ARRAY(&contact->rest, count * dim, error));
    TRY(NEW_ARRAY(&contact->multiplier, count, error));
    TRY(NEW_ARRAY(&contact->gap, count, error));
    TRY(NEW_ARRAY(&contact->pressure, count, error));
    TRY(NEW_ARRAY(&contact->normal, count * dim, error));
    TRY(NEW_ARRAY(&contact->behind, count, error));
    TRY(NEW_ARRAY(&contact->checked_x, count * dim, error));
    TRY(NEW_ARRAY(&contact->checked_distance, count, error));
    for (int64_t a = 0; a < count; a++) {
        contact->gap[a] = INFINITY;
    }
    for (int64_t i = 0; i < count * dim; i++) {
        contact->checked_x[i] = INFINITY; /* never looked at: it may be in contact from the start */
    }
done:
    return status;
}

enum status contact_build(const struct boundary_averages *averages, const double *X, int dim,
                          struct rigid_surface *surface, double stiffness, struct contact *contact,
                          struct error *error)
{
    enum status status;
    TRY(begin(averages, dim, surface, stiffness, contact, error));
    for (int64_t a = 0; a < averages->count; a++) {
        take_mean(contact, a, X, contact->rest + a * dim);
        raise_to_node(contact, a, X, contact->rest + a * dim);
    }
    TRY(check_side(contact, error));
done:
    if (status != STATUS_OK) {
        contact_free(contact);
    }
    return status;
}

enum status contact_build_points(const struct boundary_averages *points, int dim,
                                 struct rigid_surface *surface, double stiffness, struct contact *contact,
                                 struct error *error)
{
    enum status status;
    TRY(begin(points, dim, surface, stiffness, contact, error));
    contact->penalty_only = true;
    memcpy(contact->rest, points->position, (size_t)(points->count * dim) * sizeof *contact->rest);
done:
    if (status != STATUS_OK) {
        contact_free(contact);
    }
    return status;
}

void contact_free(struct contact *contact)
{
    rigid_free(&contact->surface);
    free(contact->rest);
    free(contact->multiplier);
    free(contact->gap);
    free(contact->pressure);
    free(contact->normal);
    free(contact->behind);
    free(contact->checked_x);
    free(contact->checked_distance);
    *contact = (struct contact){0};
}

enum status contact_state(struct contact *contact, const char *prefix, const struct state *state,
                          struct error *error)
{
    int64_t count = contact->count, dim = contact->dim;
    const struct state_value values[] = {
        {"multiplier", STATE_NUMBERS, contact->multiplier, count},
        {"gap", STATE_NUMBERS, contact->gap, count},
        {"pressure", STATE_NUMBERS, contact->pressure, count},
        {"normal", STATE_NUMBERS, contact->normal, count * dim},
        {"behind", STATE_FLAGS, contact->behind, count},
        {"checked_x", STATE_NUMBERS, contact->checked_x, count * dim},
        {"checked_distance", STATE_NUMBERS, contact->checked_distance, count},
    };
    return state_visit(state, prefix, values, sizeof values / sizeof *values, error);
}

/* Whether contact node a, when it was last looked at, was in front of the plane that touches the surface
 * closest to x, where it now is. */
static bool was_in_front(const struct contact *contact, int64_t a, const double *x,
                         const struct rigid_contact *closest)
{
    double height = closest->gap;
    for (int c = 0; c < contact->dim; c++) {
        height += (contact->checked_x[a * contact->dim + c] - x[c]) * closest->normal[c];
    }
    return height >= 0.0;
}

/* Find gap and normal of contact node a, now at x in the surface's frame. */
static void look(struct contact *contact, int64_t a, const double *x)
{
    int dim = contact->dim;
    struct rigid_contact closest = rigid_closest(&contact->surface, x, INFINITY);
    bool was_inside = contact->gap[a] < 0.0;
    double gap = closest.found ? closest.gap : INFINITY;
    if (!(gap < 0.0)) {
        contact->behind[a] = false;
    } else if (!was_inside && -gap > most_depth(contact, a) && !was_in_front(contact, a, x, &closest)) {
        contact->behind[a] = true;
    }
    contact->gap[a] = contact->behind[a] ? INFINITY : gap;
    contact->checked_distance[a] = gap < 0.0 ? 0.0 : closest.distance;
    for (int c = 0; c < dim; c++) {
        contact->normal[a * dim + c] = closest.smooth[c];
        contact->checked_x[a * dim + c] = x[c];
    }
    rigid_place_turn(&contact->place, dim, contact->normal + a * dim);
}

/* p_a at x in the surface's frame. Contact nodes that cannot have reached the surface are not looked at. */
static double pressure_at(struct contact *contact, int64_t a, const double *x)
{
    double moved2 = 0.0, multiplier = contact->multiplier[a];
    double free_way = contact->checked_distance[a] - multiplier / contact->stiffness;
    for (int c = 0; c < contact->dim; c++) {
        double step = x[c] - contact->checked_x[a * contact->dim + c];
        moved2 += step * step;
    }
    if (free_way > 0.0 && moved2 < free_way * free_way) {
        return 0.0;
    }
    look(contact, a, x);
    return fmax(0.0, multiplier - contact->stiffness * contact->gap[a]);
}

/* Pressures of the contact nodes from `begin` to before `end`. */
static void press_nodes(struct contact *contact, int64_t begin, int64_t end, const double *u)
{
    int dim = contact->dim;
    for (int64_t a = begin; a < end; a++) {
        double x[3], in_frame[3];
        take_mean(contact, a, u, x);
        for (int c = 0; c < dim; c++) {
            x[c] += contact->rest[a * dim + c];
        }
        rigid_place_to_rest(&contact->place, dim, x, in_frame);
        contact->pressure[a] = pressure_at(contact, a, in_frame);
    }
}

void contact_move(struct contact *contact, const double *factor)
{
    contact->place = rigid_place_at(&contact->motion, factor);
}

void contact_measure(struct contact *contact, const double *u, bool all)
{
    struct chunks nodes = chunks_of(contact->count, CONTACT_NODES_FOR_THREAD);
    if (all) {
        memset(contact->checked_distance, 0, (size_t)contact->count * sizeof *contact->checked_distance);
    }
#pragma omp parallel for schedule(static) num_threads(nodes.threads)
    for (int64_t c = 0; c < nodes.count; c++) {
        press_nodes(contact, chunks_begin(&nodes, c), chunks_begin(&nodes, c + 1), u);
    }
}

/* Force on contact node a at the last evaluation. */
static void force_on_node(const struct contact *contact, int64_t a, double force[3])
{
    double strength = contact->pressure[a] * contact->averages->area[a];
    for (int c = 0; c < contact->dim; c++) {
        force[c] = strength * contact->normal[a * contact->dim + c];
    }
}

void contact_force(struct contact *contact, const double *u, double *force)
{
    contact_measure(contact, u, false);
    for (int64_t a = 0; a < contact->count; a++) {
        if (contact->pressure[a] > 0.0) {
            struct average average = average_of_boundary(contact->averages, a);
            double on_node[3];
            force_on_node(contact, a, on_node);
            average_spread(&average, contact->dim, on_node, NULL, force);
        }
    }
}

double contact_augment(struct contact *contact, double allowed)
{
    double deepest = 0.0;
    for (int64_t a = 0; a < contact->count; a++) {
        double p = contact->pressure[a], least = contact->stiffness * allowed;
        contact->multiplier[a] = contact->penalty_only || !(p > least) ? 0.0 : p;
        deepest = fmax(deepest, -contact->gap[a]);
    }
    return deepest;
}

double contact_energy(const struct contact *contact)
{
    double sum = 0.0;
    for (int64_t a = 0; a < contact->count; a++) {
        double p = contact->pressure[a], multiplier = contact->multiplier[a];
        sum += contact->averages->area[a] * (p * p - multiplier * multiplier) / (2.0 * contact->stiffness);
    }
    return sum;
}

void contact_total(const struct contact *contact, double *total)
{
    memset(total, 0, (size_t)contact->dim * sizeof *total);
    for (int64_t a = 0; a < contact->count; a++) {
        for (int c = 0; c < contact->dim; c++) {
            total[c] +=
                contact->pressure[a] * contact->averages->area[a] * contact->normal[a * contact->dim + c];
        }
    }
}

void contact_moment(const struct contact *contact, const double *point, double moment[3])
{
    int dim = contact->dim;
    memset(moment, 0, 3 * sizeof *moment);
    for (int64_t a = 0; a < contact->count; a++) {
        double arm[3] = {0.0, 0.0, 0.0}, force[3] = {0.0, 0.0, 0.0};
        if (!(contact->pressure[a] > 0.0)) {
            continue;
        }
        force_on_node(contact, a, force);
        rigid_place_from_rest(&contact->place, dim, contact->checked_x + a * dim, arm);
        for (int c = 0; c < dim; c++) {
            double raised = contact->rest[a * dim + c] - contact->averages->position[a * dim + c];
            arm[c] -= raised + point[c];
        }
        for (int c = 0; c < 3; c++) {
            int i = (c + 1) % 3, j = (c + 2) % 3;
            moment[c] += arm[i] * force[j] - arm[j] * force[i];
        }
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
    for (int64_t a = 0; a < contact->count; a++) {
        double before[3], after[3], force[3];
        if (!(contact->pressure[a] > 0.0)) {
            continue;
        }
        force_on_node(contact, a, force);
        rigid_place_from_rest(&from, dim, contact->checked_x + a * dim, before);
        rigid_place_from_rest(&to, dim, contact->checked_x + a * dim, after);
        for (int c = 0; c < dim; c++) {
            double way = after[c] - before[c];
            sum.work += force[c] * way;
            sum.unresolved += contact->stiffness * contact->averages->area[a] * way * way;
        }
    }
    return sum;
}
