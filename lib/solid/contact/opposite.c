#include "solid/contact/opposite.h"

#include "base/chunks.h"
#include "base/memory.h"
#include "solid/rigid/rigid_private.h"

#include <string.h>

/* Two facets of one body are neighbours through it if they are nearer at rest than this many widths and each
 * is behind the other by more than this share of their distance. A point may be behind another facet by half
 * a width: a body thicker than `near_widths` would have to be flattened to an eighth for that. */
static const double near_widths = 4.0, behind_share = 1e-3;
enum { VERTICES_FOR_THREAD = 500 }; /* see chunks_of */

/* The rims, and the facet beyond each ridge. Ridges of more than two facets, where bodies meet, are no
 * rims. */
static enum status join_facets(struct opposite *opposite, struct error *error)
{
    struct rigid_surface *surface = &opposite->surface;
    int dim = surface->dim;
    int64_t count = surface->facet_count * dim, edges = dim == 3 ? count : 0;
    SCRATCH struct ridge *ridges = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->across, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_normal, edges * 3, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->edge_is_rim, edges, error));
    for (int64_t slot = 0; slot < count; slot++) {
        opposite->across[slot] = slot;
    }
    RETURN_IF_ERROR(rigid_list_ridges(surface, &ridges, error));
    for (int64_t first = 0, end; first < count; first = end) {
        end = ridges_end(count, ridges, first);
        int64_t one = rigid_ridge_slot(dim, &ridges[first]), other = rigid_ridge_slot(dim, &ridges[end - 1]);
        if (end - first == 1) {
            rigid_mark_rim(surface, &ridges[first]);
        }
        if (end - first <= 2) {
            opposite->across[one] = end - first == 1 ? -1 : other;
            opposite->across[other] = end - first == 1 ? -1 : one;
        }
    }
    return STATUS_OK;
}

/* Vertices in the order of the rows, and the facets by them. */
static enum status number_vertices(struct opposite *opposite, const struct face_table *table,
                                   const struct facet_set *set, struct error *error)
{
    struct rigid_surface *surface = &opposite->surface;
    int dim = table->dim;
    surface->vertex_count = opposite->rows.count;
    NEW_SCRATCH(int32_t, number, table->node_count, error);
    RETURN_IF_ERROR(NEW_ARRAY(&surface->vertex, surface->vertex_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->facet, surface->facet_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->rest, surface->vertex_count * dim, error));
    for (int64_t v = 0; v < surface->vertex_count; v++) {
        const double *x = table->x + (int64_t)opposite->rows.node[v] * dim;
        number[opposite->rows.node[v]] = (int32_t)v;
        memcpy(surface->vertex + v * dim, x, (size_t)dim * sizeof *x);
        memcpy(opposite->rest + v * dim, x, (size_t)dim * sizeof *x);
    }
    for (int64_t c = 0; c < surface->facet_count * dim; c++) {
        surface->facet[c] = number[set->facet[c]];
    }
    struct box box = box_of(dim, surface->vertex_count, surface->vertex);
    surface->extent = box_diagonal(&box);
    return STATUS_OK;
}

/* Normals, middles, widths and bodies of the facets at rest. */
static enum status measure_rest(struct opposite *opposite, const struct facet_set *set, const int32_t *part,
                                struct error *error)
{
    const struct rigid_surface *surface = &opposite->surface;
    int dim = surface->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->rest_normal, surface->facet_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->middle, surface->facet_count * dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->width, surface->facet_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->part, surface->facet_count, error));
    for (int64_t f = 0; f < surface->facet_count; f++) {
        const int32_t *facet = surface->facet + f * dim;
        double *normal = opposite->rest_normal + f * dim;
        face_area_vector(dim, opposite->rest, facet, normal);
        double area = vector_length(dim, normal);
        opposite->width[f] = dim == 2 ? area : sqrt(area);
        vector_normalise(dim, normal);
        opposite->part[f] = -1;
        for (int k = 0; k < dim; k++) {
            add_scaled(dim, 1.0 / dim, opposite->rest + (int64_t)facet[k] * dim, opposite->middle + f * dim);
            int32_t known = part[set->facet[f * dim + k]];
            opposite->part[f] = known >= 0 ? known : opposite->part[f];
        }
    }
    return STATUS_OK;
}

/* Fit the boxes of the tree to the moved facets. The branches below a branch come behind it. */
static void fit_boxes(struct rigid_surface *surface)
{
    int dim = surface->dim;
    for (int64_t b = surface->branch_count; b-- > 0;) {
        struct rigid_branch *branch = &surface->branch[b];
        struct box box = box_of(dim, 0, NULL);
        for (int64_t i = branch->first; i < branch->end && branch->second == 0; i++) {
            for (int k = 0; k < dim; k++) {
                box_add(&box, 1,
                        surface->vertex + (int64_t)surface->facet[surface->in_order[i] * dim + k] * dim);
            }
        }
        for (int i = 0; i < 2 && branch->second != 0; i++) {
            const struct rigid_branch *half = i == 0 ? branch + 1 : &surface->branch[branch->second];
            box_add(&box, 1, half->low);
            box_add(&box, 1, half->high);
        }
        memcpy(branch->low, box.low, sizeof branch->low);
        memcpy(branch->high, box.high, sizeof branch->high);
    }
}

/* Normals and boxes of the facets where their vertices are. */
static void refit(struct opposite *opposite)
{
    struct rigid_surface *surface = &opposite->surface;
    int dim = surface->dim;
    for (int64_t f = 0; f < surface->facet_count; f++) {
        face_area_vector(dim, surface->vertex, surface->facet + f * dim, surface->normal + f * dim);
        vector_normalise(dim, surface->normal + f * dim);
    }
    rigid_weigh_normals(surface);
    for (int64_t slot = 0; slot < surface->facet_count * 3 && dim == 3; slot++) {
        double *normal = surface->edge_normal + slot * 3;
        int64_t beyond = opposite->across[slot] >= 0 ? opposite->across[slot] : slot;
        memcpy(normal, surface->normal + slot / 3 * 3, 3 * sizeof *normal);
        add_scaled(3, 1.0, surface->normal + beyond / 3 * 3, normal);
        vector_normalise(3, normal);
    }
    fit_boxes(surface);
}

enum status opposite_build(const struct face_table *table, const struct facet_set *set, const int32_t *part,
                           bool itself, struct opposite *opposite, struct error *error)
{
    *opposite = (struct opposite){.itself = itself};
    struct rigid_surface *surface = &opposite->surface;
    surface->dim = table->dim;
    surface->facet_count = set->count;
    RETURN_IF_ERROR(boundary_corners_build(table, set, &opposite->rows, error));
    RETURN_IF_ERROR(number_vertices(opposite, table, set, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->stiffness, surface->vertex_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opposite->load, surface->vertex_count * table->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->normal, set->count * table->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->vertex_normal, surface->vertex_count * table->dim, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->is_rim, surface->vertex_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&surface->turn, surface->vertex_count, error));
    RETURN_IF_ERROR(join_facets(opposite, error));
    RETURN_IF_ERROR(measure_rest(opposite, set, part, error));
    RETURN_IF_ERROR(rigid_grow_tree(surface, error));
    refit(opposite);
    return STATUS_OK;
}

void opposite_free(struct opposite *opposite)
{
    rigid_free(&opposite->surface);
    boundary_averages_free(&opposite->rows);
    FREE_ALL(opposite->stiffness, opposite->rest, opposite->rest_normal, opposite->middle, opposite->width,
             opposite->part, opposite->across, opposite->load);
    *opposite = (struct opposite){0};
}

void opposite_move(struct opposite *opposite, const double *u)
{
    struct rigid_surface *surface = &opposite->surface;
    int dim = surface->dim;
    struct chunks vertices = chunks_of(surface->vertex_count, VERTICES_FOR_THREAD);
#pragma omp parallel for schedule(static) num_threads(vertices.threads)
    for (int64_t c = 0; c < vertices.count; c++) {
        for (int64_t v = chunks_begin(&vertices, c); v < chunks_begin(&vertices, c + 1); v++) {
            struct average average = average_of_boundary(&opposite->rows, v);
            average_place(&average, dim, opposite->rest + v * dim, u, surface->vertex + v * dim);
        }
    }
    refit(opposite);
}

struct search {
    const struct opposite *opposite;
    const struct seeker *seeker;
    double free_way; /* relative motion until another facet may face the point, m */
};

/* Whether facet f was a neighbour of the point through the body. */
static bool through_body(const struct opposite *opposite, const struct seeker *seeker, int64_t f)
{
    int dim = opposite->surface.dim;
    double offset[3];
    if (opposite->part[f] != seeker->part) {
        return false;
    }
    vector_subtract(dim, opposite->middle + f * dim, seeker->rest, offset);
    double width = seeker->width > opposite->width[f] ? seeker->width : opposite->width[f];
    double away2 = vector_dot(dim, offset, offset), least2 = behind_share * behind_share * away2;
    if (!(away2 < near_widths * near_widths * width * width)) {
        return false;
    }
    double facet_behind = -vector_dot(dim, offset, seeker->rest_normal);
    double point_behind = vector_dot(dim, offset, opposite->rest_normal + f * dim);
    return facet_behind > 0.0 && facet_behind * facet_behind > least2 && point_behind > 0.0 &&
           point_behind * point_behind > least2;
}

/* Cosine of the normals of facet f and of the point's, -1 where they are opposed. */
static double cosine_to(const struct search *search, int64_t f)
{
    int dim = search->opposite->surface.dim;
    return vector_dot(dim, search->opposite->surface.normal + f * dim, search->seeker->normal);
}

/* A facet faces the point below this cosine: of a right angle if it is of another body, so that one which
 * goes round a corner of it begins to press without a jump, or if the point pressed at the last step, so that
 * it does not go in and out at the limit. */
static double facing_cosine(const struct search *search, int64_t f)
{
    bool early = search->opposite->part[f] != search->seeker->part || search->seeker->last_u == NULL;
    return early ? 0.0 : -SAME_DIRECTION;
}

/* Admit facets that are not turned away from the point. For those that do not face it, bound the motion
 * before they can: to change the cosine of its angle by c, a facet must turn by more than c, which moves one
 * of its corners by more than a third of its width times c. */
static bool considers(void *context, int64_t f)
{
    struct search *search = context;
    double cosine = cosine_to(search, f), beyond = cosine - facing_cosine(search, f);
    if (through_body(search->opposite, search->seeker, f)) {
        return false;
    }
    if (beyond >= 0.0) {
        double width = fmin(search->opposite->width[f], search->seeker->width);
        search->free_way = fmin(search->free_way, width / 3.0 * beyond);
    }
    return cosine < 0.0;
}

/* Whether facet f and the point's have a corner in common. */
static bool shares_corner(const struct opposite *opposite, const struct seeker *seeker, int64_t f)
{
    int dim = opposite->surface.dim;
    for (int i = 0; i < dim * dim; i++) {
        int64_t v = opposite->surface.facet[f * dim + i / dim];
        if (opposite->rows.node[v] == seeker->corner[i % dim]) {
            return true;
        }
    }
    return false;
}

/* Whether the point was behind facet f at the last step. */
static bool was_behind(const struct opposite *opposite, const struct seeker *seeker, int64_t f)
{
    static const int32_t corners[] = {0, 1, 2};
    int dim = opposite->surface.dim;
    double x[9] = {0.0}, last[3] = {0.0}, normal[3], offset[3];
    for (int k = 0; k < dim; k++) {
        int64_t v = opposite->surface.facet[f * dim + k];
        struct average average = average_of_boundary(&opposite->rows, v);
        average_place(&average, dim, opposite->rest + v * dim, seeker->last_u, x + k * dim);
    }
    face_area_vector(dim, x, corners, normal);
    vector_normalise(dim, normal);
    average_place(&seeker->average, dim, seeker->rest, seeker->last_u, last);
    vector_subtract(dim, last, x, offset);
    return vector_dot(dim, offset, normal) < -seeker->began;
}

static bool admits(void *context, int64_t f, const double *away)
{
    const struct search *search = context;
    int dim = search->opposite->surface.dim;
    const struct seeker *seeker = search->seeker;
    double depth = seeker->depth;
    if (vector_dot(dim, away, search->opposite->surface.normal + f * dim) > 0.0) {
        return true;
    }
    return vector_dot(dim, away, away) < depth * depth &&
           (seeker->last_u == NULL || !shares_corner(search->opposite, seeker, f) ||
            !was_behind(search->opposite, seeker, f));
}

/* Whether the closest facet faces the point, and, where the closest place is on a ridge, those beyond it. */
static bool all_face(const struct search *search, const struct rigid_contact *closest)
{
    const struct opposite *opposite = search->opposite;
    int dim = opposite->surface.dim;
    bool all = cosine_to(search, closest->facet) < facing_cosine(search, closest->facet);
    for (int k = 0; k < dim; k++) {
        int64_t beyond = opposite->across[closest->facet * dim + k];
        if (closest->weight[(k + dim - 1) % dim] == 0.0 && beyond >= 0) {
            all = all && cosine_to(search, beyond / dim) < facing_cosine(search, beyond / dim) &&
                  !through_body(opposite, search->seeker, beyond / dim);
        }
    }
    return all;
}

struct rigid_contact opposite_closest(const struct opposite *opposite, const struct seeker *seeker,
                                      double reach, double *free_way)
{
    struct search search = {opposite, seeker, reach};
    struct rigid_filter filter = {considers, admits, &search};
    struct rigid_contact closest = rigid_closest_among(&opposite->surface, seeker->x, reach, &filter);
    closest.found = closest.found && closest.gap > -seeker->depth;
    double least = fmax(0.0, -seeker->began);
    if (closest.found && closest.gap < least && !all_face(&search, &closest)) {
        double sign = closest.gap < 0.0 ? -1.0 : 1.0;
        closest.gap = fmax(least, closest.distance);
        for (int c = 0; c < opposite->surface.dim; c++) {
            closest.normal[c] *= sign;
        }
    }
    *free_way = search.free_way;
    return closest;
}

bool opposite_leads(const struct opposite *opposite, const double *rest_normal, int64_t own_facet, int64_t f)
{
    /* Decided by the component of the normals at rest along a fixed, generic direction, so that all facets of
     * a face of a slit have the same role; by the facets' numbers where these are equal. */
    static const double direction[3] = {0.5377, 0.6180, 0.5734};
    int dim = opposite->surface.dim;
    double own = vector_dot(dim, direction, rest_normal),
           other = vector_dot(dim, direction, opposite->rest_normal + f * dim);
    if (!opposite->itself || fabs(own - other) < 1e-9) {
        return !opposite->itself || own_facet < f;
    }
    return own < other;
}
