#include "solid/incision/blade.h"

#include "approx/cells/crossing.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "base/sets.h"
#include "base/vector.h"
#include "solid/rigid/rigid_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- building ---- */

static enum status check_crossings(int dim, int64_t count, const double *corners, struct error *error)
{
    struct box all = box_of(dim, count * dim, corners);
    int axis = 0; /* the longest, along which they are sorted */
    NEW_SCRATCH(int32_t, facet, count * dim, error);
    NEW_SCRATCH(struct facet_box, boxes, count, error);
    NEW_SCRATCH(double, x, count * dim * dim, error);
    for (int a = 1; a < dim; a++) {
        axis = all.high[a] - all.low[a] > all.high[axis] - all.low[axis] ? a : axis;
    }
    for (int64_t i = 0; i < count * dim; i++) {
        facet[i] = (int32_t)i;
        boxes[i / dim].facet.item = i / dim;
        for (int a = 0; a < dim; a++) {
            x[i * dim + a] = corners[i * dim + (a + axis) % dim];
        }
    }
    facet_boxes_sort(dim, x, facet, count, boxes);
    for (int64_t i = 0; i < count; i++) {
        for (int64_t k = i + 1; k < count && boxes[k].facet.place <= boxes[i].box.high[0]; k++) {
            int64_t f = boxes[i].facet.item, g = boxes[k].facet.item;
            if (box_meets(&boxes[i].box, &boxes[k].box) &&
                facets_cross(dim, x, facet + f * dim, facet + g * dim,
                             COARSE_ROUND_OFF * box_diagonal(&all))) {
                return fail(error, STATUS_INPUT,
                            "its facets %lld and %lld cross each other: cut along two blades in turn",
                            (long long)(f < g ? f : g) + 1, (long long)(f < g ? g : f) + 1);
            }
        }
    }
    return STATUS_OK;
}

/* first[count]: facets of one sheet have the same first member. They are joined where one ends and one
 * begins, and no other does either: where more meet, a sheet with a corner would be cut off within a cell,
 * and the others end beside it. */
static enum status find_sheets(int dim, int64_t count, const double *corners, int32_t *first,
                               struct error *error)
{
    FREED_BY(rigid_free) struct rigid_surface whole = {0};
    SCRATCH struct ridge *ridges = NULL;
    for (int64_t f = 0; f < count; f++) {
        first[f] = (int32_t)f;
    }
    RETURN_IF_ERROR(dim == 2 ? rigid_weld(dim, count, corners, &whole, error)
                             : rigid_build(dim, count, corners, false, &whole, error));
    RETURN_IF_ERROR(rigid_list_ridges(&whole, &ridges, error));
    for (int64_t i = 0, end; i < count * dim; i = end) {
        end = ridges_end(count * dim, ridges, i);
        if (end - i == 2 && ridges[i].upward != ridges[i + 1].upward) {
            set_join(first, ridges[i].facet, ridges[i + 1].facet);
        }
    }
    return STATUS_OK;
}

static enum status list_border(struct sheet *sheet, struct error *error)
{
    const struct rigid_surface *surface = &sheet->surface;
    int dim = surface->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&sheet->border, surface->facet_count * dim * (dim - 1) * dim, error));
    for (int64_t v = 0; v < surface->vertex_count && dim == 2; v++) {
        if (surface->is_rim[v]) {
            memcpy(sheet->border + 2 * sheet->border_count++, surface->vertex + 2 * v, 2 * sizeof(double));
        }
    }
    for (int64_t e = 0; e < surface->facet_count * 3 && dim == 3; e++) {
        if (surface->edge_is_rim[e]) {
            double *edge = sheet->border + 6 * sheet->border_count++;
            memcpy(edge, surface->vertex + 3 * (int64_t)surface->facet[e], 3 * sizeof *edge);
            memcpy(edge + 3, surface->vertex + 3 * (int64_t)surface->facet[e / 3 * 3 + (e + 1) % 3],
                   3 * sizeof *edge);
        }
    }
    return STATUS_OK;
}

/* The sheet of the facets whose first member is `member`. */
static enum status build_sheet(int dim, int64_t count, const double *corners, int32_t *first, int32_t member,
                               struct sheet *sheet, struct error *error)
{
    int64_t kept = 0;
    NEW_SCRATCH(double, own, count * dim * dim, error);
    for (int64_t f = member; f < count; f++) {
        if (set_first(first, (int32_t)f) == member) {
            memcpy(own + kept++ * dim * dim, corners + f * dim * dim, (size_t)(dim * dim) * sizeof *own);
        }
    }
    RETURN_IF_ERROR(rigid_build(dim, kept, own, false, &sheet->surface, error));
    return list_border(sheet, error);
}

enum status blade_build(int dim, int64_t facet_count, const double *corners, struct blade *blade,
                        struct error *error)
{
    *blade = (struct blade){.dim = dim};
    NEW_SCRATCH(int32_t, first, facet_count, error);
    RETURN_IF_ERROR(find_sheets(dim, facet_count, corners, first, error));
    RETURN_IF_ERROR(check_crossings(dim, facet_count, corners, error));
    for (int64_t f = 0; f < facet_count; f++) {
        if (set_first(first, (int32_t)f) == f) {
            RETURN_IF_ERROR(RESIZE_ARRAY(&blade->sheet, blade->count + 1, error));
            blade->sheet[blade->count++] = (struct sheet){0};
            RETURN_IF_ERROR(build_sheet(dim, facet_count, corners, first, (int32_t)f,
                                        &blade->sheet[blade->count - 1], error));
        }
    }
    return STATUS_OK;
}

void blade_free(struct blade *blade)
{
    for (int64_t s = 0; s < blade->count; s++) {
        rigid_free(&blade->sheet[s].surface);
        free(blade->sheet[s].border);
    }
    free(blade->sheet);
    *blade = (struct blade){0};
}

bool blade_is_closed(const struct blade *blade)
{
    for (int64_t s = 0; s < blade->count; s++) {
        if (blade->sheet[s].border_count > 0) {
            return false;
        }
    }
    return true;
}

/* ---- places ---- */

/* The distance from the border; closed: INFINITY. */
static double distance_to_border(const struct sheet *sheet, const double *x)
{
    int dim = sheet->surface.dim;
    double least2 = INFINITY;
    for (int64_t b = 0; b < sheet->border_count; b++) {
        const double *edge = sheet->border + b * (dim - 1) * dim;
        double along[3] = {0.0}, from[3] = {0.0}, here[3] = {0.0};
        memcpy(here, edge, (size_t)dim * sizeof *here);
        if (dim == 3) {
            vector_subtract(3, edge + 3, edge, along);
            vector_subtract(3, x, edge, from);
            double share = vector_dot(3, from, along) / vector_dot(3, along, along);
            add_scaled(3, fmin(fmax(share, 0.0), 1.0), along, here);
        }
        least2 = fmin(least2, vector_distance2(dim, here, x));
    }
    return sqrt(least2);
}

bool sheet_at(const struct sheet *sheet, const double *x, double reach, struct sheet_place *place)
{
    int dim = sheet->surface.dim;
    struct rigid_contact near = rigid_closest(&sheet->surface, x, reach);
    double away[3] = {0.0};
    if (!near.within) {
        return false;
    }
    vector_subtract(dim, x, near.point, away);
    place->height = vector_dot(dim, away, near.side);
    place->beyond = near.on_rim;
    memcpy(place->near, near.point, sizeof place->near);
    memcpy(place->foot, near.point, sizeof place->foot);
    memcpy(place->normal, near.side, sizeof place->normal);
    if (near.on_rim) {
        add_scaled(dim, -place->height, near.side, away);
        add_scaled(dim, 1.0, away, place->foot);
    } else {
        place->height = copysign(vector_length(dim, away), place->height);
    }
    return true;
}

double sheet_extent(const struct sheet *sheet, const struct sheet_place *place)
{
    return place->beyond ? vector_distance(sheet->surface.dim, place->foot, place->near)
                         : -distance_to_border(sheet, place->near);
}
