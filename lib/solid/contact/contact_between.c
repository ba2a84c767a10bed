#include "solid/contact/contact_between.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A facet is opposite to a point within this distance, by its size; told_widths for gaps that are
 * reported. In 2D the mass of a relaxation counts every point that has an opposite facet. */
static const double reach_widths_2d = 1.0, reach_widths_3d = 0.5, told_widths = 10.0;
enum { FACETS_FOR_THREAD = 300 }; /* see chunks_of */

void contact_between_free(struct contact *contact)
{
    struct contact_between *between = contact->between;
    if (between != NULL) {
        opposite_free(&between->opposite);
        FREE_ALL(between->part, between->begin, between->before, between->checked_way, between->checked_free,
                 between->taken_facet, between->taken_weight, between->now);
    }
    free(between);
    contact->between = NULL;
}

enum status contact_between_state(struct contact *contact, const char *prefix, const struct state *state,
                                  struct error *error)
{
    struct contact_between *between = contact->between;
    int64_t count = contact->count;
    if (between == NULL) {
        return STATUS_OK;
    }
    const struct state_value values[] = {
        {"before", STATE_NUMBERS, between->before, between->values},
        {"way", STATE_NUMBERS, &between->way, 1},
        {"checked_way", STATE_NUMBERS, between->checked_way, count},
        {"checked_free", STATE_NUMBERS, between->checked_free, count},
        {"taken_facet", STATE_COUNTS, between->taken_facet, count},
        {"taken_weight", STATE_NUMBERS, between->taken_weight, count * 3},
    };
    return state_visit(state, prefix, values, sizeof values / sizeof *values, error);
}

void contact_between_stiffen(struct contact *contact, double modulus)
{
    for (int64_t v = 0; contact->between != NULL && v < contact->between->opposite.rows.count; v++) {
        double area = contact->between->opposite.rows.area[v];
        contact->between->opposite.stiffness[v] = modulus / (contact->dim == 2 ? area : sqrt(area));
    }
}

/* The outward normal of facet f, by its points. */
static void facet_normal(const struct contact *contact, int64_t f, double normal[3])
{
    static const int32_t corners[] = {0, 1, 2};
    int dim = contact->dim;
    double x[9];
    for (int k = 0; k < dim; k++) {
        memcpy(x + k * dim, contact->view[f * contact->between->per_facet + k].x, (size_t)dim * sizeof *x);
    }
    face_area_vector(dim, x, corners, normal);
    vector_normalise(dim, normal);
}

/* How far y_p is from x_p, m. */
static double held_way(const struct contact *contact, int64_t p)
{
    double held = vector_length(contact->dim, contact->held + p * contact->dim);
    return held > 0.0 ? held / contact->stiffness[p] : 0.0; /* the stiffness is 0 while building */
}

/* The length by which reach and depth of point p are measured, m: small facets do not miss large ones. */
static double size_of(const struct contact *contact, int64_t p)
{
    return fmax(contact_width(contact, p), contact->between->mean_width);
}

/* The opposite place closest to y_p; normal: of the facet of point p. */
static struct rigid_contact find_place(const struct contact *contact, int64_t p, const double *normal,
                                       double reach, double *free_way)
{
    const struct contact_between *between = contact->between;
    struct seeker seeker = {.x = contact->view[p].sought,
                            .rest = contact->points->position + p * contact->dim,
                            .rest_normal = contact->points->normal + p * contact->dim,
                            .normal = normal,
                            .width = contact_width(contact, p),
                            .depth = CONTACT_MOST_DEPTH * size_of(contact, p) + held_way(contact, p),
                            .corner = contact->points->node + p - p % between->per_facet,
                            .average = average_of_boundary(contact->points, p),
                            .last_u = contact->checked_distance[p] < 0.0 ? NULL : between->before,
                            .began = -between->begin[p] + contact_round_off(contact, p),
                            .part = between->part[p]};
    struct rigid_contact closest = opposite_closest(&between->opposite, &seeker, reach, free_way);
    *free_way -= held_way(contact, p);
    return closest;
}

/* How far a search looks, m. */
static double reach_of(const struct contact *contact, int64_t p)
{
    return (contact->dim == 2 ? reach_widths_2d : reach_widths_3d) * size_of(contact, p);
}

/* Search for what is opposite point p. */
static void search(struct contact *contact, int64_t p, const double *normal, bool all)
{
    struct contact_between *between = contact->between;
    struct contact_view *view = &contact->view[p];
    double reach = all ? told_widths * contact_width(contact, p) : reach_of(contact, p);
    struct rigid_contact closest = find_place(contact, p, normal, reach, &view->free_way);
    memset(view->normal, 0, sizeof view->normal);
    view->distance = contact->gap[p] = INFINITY;
    if (!closest.found) {
        return;
    }
    view->facet = closest.facet;
    view->led = !opposite_leads(&between->opposite, contact->points->normal + p * contact->dim,
                                p / between->per_facet, closest.facet);
    memcpy(view->weight, closest.weight, sizeof view->weight);
    memcpy(view->normal, closest.normal, sizeof view->normal);
    double gap = closest.gap - between->begin[p];
    view->distance = gap - held_way(contact, p);
    contact_press_point(contact, p, gap, !view->led);
    view->turned = contact->pressure[p] > 0.0 && closest.on_edge;
}

/* The relative motion of point p and opposite facets from the last evaluation until one may be near enough
 * for a pressure, or may have turned towards it, m. */
static double free_way(const struct contact *contact, int64_t p)
{
    const struct contact_between *between = contact->between;
    if (contact->view[p].searched) {
        return fmin(contact->view[p].distance, contact->view[p].free_way);
    }
    return fmin(contact->checked_distance[p], between->checked_free[p]) -
           (between->way + between->moved - between->checked_way[p]) - held_way(contact, p);
}

/* Search for the facets opposite the points of facet f that are marked `searched`; the gaps of the others are
 * those of the last search. */
static void measure_facet(struct contact *contact, int64_t f, const double *u, bool all)
{
    int dim = contact->dim, points = contact->between->per_facet;
    bool any = false;
    double normal[3];
    for (int64_t p = f * points; p < (f + 1) * points; p++) {
        any = any || contact->view[p].searched;
    }
    for (int64_t p = f * points; p < (f + 1) * points && any; p++) {
        contact_place_point(contact, p, u);
    }
    if (any) {
        facet_normal(contact, f, normal);
    }
    for (int64_t p = f * points; p < (f + 1) * points; p++) {
        struct contact_view *view = &contact->view[p];
        if (view->searched) {
            search(contact, p, normal, all);
        }
        memcpy(contact->normal + p * dim, view->normal, (size_t)dim * sizeof *view->normal);
    }
}

/* A bound of the relative motion of a point and an opposite place since the last step, m. */
static double relative_way(const struct contact *contact, const double *u)
{
    const struct contact_between *between = contact->between;
    double most2 = 0.0;
    for (int64_t n = 0; n < between->values; n += contact->dim) {
        most2 = fmax(most2, vector_distance2(contact->dim, u + n, between->before + n));
    }
    return between->leverage * sqrt(most2);
}

void contact_between_measure(struct contact *contact, const double *u, bool all)
{
    struct contact_between *between = contact->between;
    bool any = false;
    between->moved = relative_way(contact, u);
    memcpy(between->now, u, (size_t)between->values * sizeof *u);
    for (int64_t p = 0; p < contact->count; p++) {
        contact_keep_point(contact, p); /* free_way is that of the last search */
        contact->view[p].searched = all || !(free_way(contact, p) > 0.0);
        any = any || contact->view[p].searched;
    }
    if (any) {
        opposite_move(&between->opposite, u);
    }
    struct chunks facets = chunks_of(contact->count / between->per_facet, FACETS_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(facets.threads)
    for (int64_t c = 0; c < facets.count; c++) {
        for (int64_t f = chunks_begin(&facets, c); f < chunks_begin(&facets, c + 1); f++) {
            measure_facet(contact, f, u, all);
        }
    }
}

void contact_between_accept(struct contact *contact)
{
    struct contact_between *between = contact->between;
    if (between == NULL) {
        return;
    }
    between->way += between->moved;
    between->moved = 0.0;
    memcpy(between->before, between->now, (size_t)between->values * sizeof *between->now);
    for (int64_t p = 0; p < contact->count; p++) {
        if (contact->view[p].searched) {
            between->checked_way[p] = between->way;
            between->checked_free[p] = contact->view[p].free_way;
        }
    }
}

/* The longest motion in a step of a corner of the facets, m. */
static double longest_corner(const struct opposite *opposite, int dim, const double *step)
{
    double most = 0.0, moved[3];
    for (int64_t v = 0; v < opposite->rows.count; v++) {
        struct average average = average_of_boundary(&opposite->rows, v);
        average_take(&average, dim, step, moved);
        most = fmax(most, vector_length(dim, moved));
    }
    return most;
}

double contact_passes(const struct contact *contact, const double *step)
{
    const struct contact_between *between = contact->between;
    int dim = contact->dim;
    double most = 0.0, longest = between != NULL ? longest_corner(&between->opposite, dim, step) : 0.0;
    for (int64_t p = 0; p < contact->count && between != NULL; p++) {
        const struct contact_view *here = &contact->view[p];
        struct average average = average_of_boundary(contact->points, p);
        double past[3], corner[3];
        average_take(&average, dim, step, past);
        for (int k = 0; k < dim && here->facet >= 0; k++) {
            average = average_of_boundary(&between->opposite.rows,
                                          between->opposite.surface.facet[here->facet * dim + k]);
            average_take(&average, dim, step, corner);
            add_scaled(dim, -here->weight[k], corner, past);
        }
        double way = vector_length(dim, past) + (here->facet < 0 ? longest : 0.0);
        most = fmax(most, (way - fmax(0.0, free_way(contact, p))) / size_of(contact, p));
    }
    return most;
}

/* 1-norm of the longest row. */
static double longest_row(const struct boundary_averages *rows)
{
    double longest = 0.0;
    for (int64_t a = 0; a < rows->count; a++) {
        double sum = 0.0;
        for (int64_t i = rows->ptr[a]; i < rows->ptr[a + 1]; i++) {
            sum += fabs(rows->phi[i]);
        }
        longest = fmax(longest, sum);
    }
    return longest;
}

/* The height of the boundary at the closest place, by the heights at the points of its facet: quadratic
 * between the corners, where it is 0. At the points the products of two weights add up to 1/6, 3D: 1/4. */
static double height_there(const struct contact *contact, const struct rigid_contact *closest,
                           const double *height)
{
    int points = contact->between->per_facet;
    double mean = 0.0, products = 0.0;
    for (int k = 0; k < points; k++) {
        mean += height[closest->facet * points + k] / points;
    }
    for (int k = 0; k < contact->dim; k++) {
        products += 0.5 * closest->weight[k] * (1.0 - closest->weight[k]);
    }
    return mean * products * (contact->dim == 2 ? 6.0 : 4.0);
}

/* Set begin[]: the heights of both boundaries above their facets (NULL: none), and less where a point starts
 * behind. Returns whether any facet faces any point; with `far`, at any distance. */
static bool begin(struct contact *contact, const double *own, const double *other, bool far)
{
    struct contact_between *between = contact->between;
    int dim = contact->dim;
    bool any = false;
    for (int64_t p = 0; p < contact->count; p++) {
        memcpy(contact->view[p].sought, contact->rest + p * dim, (size_t)dim * sizeof *contact->rest);
    }
    for (int64_t p = 0; p < contact->count; p++) {
        double reach = far && !any ? INFINITY : reach_of(contact, p), height = own != NULL ? own[p] : 0.0;
        struct rigid_contact closest =
            find_place(contact, p, contact->points->normal + p * dim, reach, &contact->view[p].free_way);
        any = any || closest.found;
        if (closest.found && closest.distance < reach_of(contact, p)) {
            height += other != NULL ? height_there(contact, &closest, other) : 0.0;
            height = fmin(height, closest.gap);
        }
        between->begin[p] = height;
    }
    return any;
}

static enum status allocate(struct contact *contact, int64_t values, struct error *error)
{
    struct contact_between *between = contact->between;
    int64_t count = contact->count;
    between->values = values;
    RETURN_IF_ERROR(NEW_ARRAY(&between->part, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->begin, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->before, values, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->checked_way, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->checked_free, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->taken_facet, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&between->taken_weight, count * 3, error));
    return NEW_ARRAY(&between->now, values, error);
}

enum status contact_between_build(const struct boundary_averages *points,
                                  const struct boundary_averages *averages, int dim, int64_t node_count,
                                  int per_facet, struct opposite *opposite, const int32_t *part, int sign,
                                  double stiffness, const double *own, const double *other, bool far,
                                  struct contact *contact, bool *any, struct error *error)
{
    *contact = (struct contact){
        .dim = dim, .count = points->count, .points = points, .averages = averages, .sign = sign};
    RETURN_IF_ERROR(NEW_ARRAY(&contact->between, 1, error));
    struct contact_between *between = contact->between;
    between->per_facet = per_facet;
    between->opposite = *opposite;
    *opposite = (struct opposite){0};
    between->leverage = longest_row(points) + longest_row(&between->opposite.rows);
    RETURN_IF_ERROR(contact_allocate(contact, stiffness, error));
    RETURN_IF_ERROR(allocate(contact, node_count * dim, error));
    for (int64_t p = 0; p < contact->count; p++) {
        between->part[p] = -1;
        for (int64_t k = p - p % per_facet; k < p - p % per_facet + per_facet; k++) {
            between->part[p] = part[points->node[k]] >= 0 ? part[points->node[k]] : between->part[p];
        }
    }
    for (int64_t v = 0; v < between->opposite.rows.count; v++) {
        between->opposite.stiffness[v] = stiffness;
    }
    for (int64_t p = 0; p < contact->count; p++) {
        between->mean_width += contact_width(contact, p) / (double)contact->count;
    }
    memcpy(contact->rest, points->position, (size_t)(contact->count * dim) * sizeof *contact->rest);
    *any = begin(contact, own, other, far);
    return STATUS_OK;
}
