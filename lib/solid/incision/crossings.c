/* The edges that cross a level; see incision.h. */
#include "base/round_off.h"
#include "solid/incision/incision_private.h"

#include <stdlib.h>

/* New nodes stay so far from the ends of their edges. */
static const double least_share = 0.01;

/* The middle of an edge between nodes on the border is within it by this share of the shortest edge. */
static const double least_within = 0.1;

/* A value that changes its sign by a jump beyond this share of the edge is not 0 there. */
static const double most_jump = 0.05;

void crossings_free(struct crossings *crossings)
{
    free(crossings->item);
    *crossings = (struct crossings){0};
}

static double value_between(const struct cut *cut, enum level level, const int32_t node[2], double share,
                            struct sheet_place *place)
{
    int dim = cut->body->dim;
    double x[3];
    vector_between(dim, cut->body->at + (int64_t)node[0] * dim, cut->body->at + (int64_t)node[1] * dim, share,
                   x);
    double reach = 2.0 * fmax(cut->longest[node[0]], cut->longest[node[1]]);
    return !sheet_at(cut->sheet, x, reach, place) ? NAN
           : level == LEVEL_HEIGHT                ? place->height
                                                  : sheet_extent(cut->sheet, place);
}

/* By the Illinois method (Dowell and Jarratt, BIT 11, 1971). */
bool cut_root(const struct cut *cut, enum level level, const int32_t node[2], double *share,
              struct sheet_place *place)
{
    double low = 0.0, high = 1.0, at_low = cut->value[level][node[0]], at_high = cut->value[level][node[1]];
    double size = fmin(cut->longest[node[0]], cut->longest[node[1]]), here = INFINITY;
    int moved = 0; /* the end that the step before has moved */
    for (int i = 0; i < 60 && high - low > 1e-12 && !(fabs(here) <= 1e-12 * size); i++) {
        *share = isinf(at_low) || isinf(at_high) ? 0.5 * (low + high)
                                                 : (low * at_high - high * at_low) / (at_high - at_low);
        here = value_between(cut, level, node, *share, place);
        if (isnan(here)) {
            return false;
        }
        if ((here < 0) == (at_low < 0)) {
            at_high *= moved < 0 ? 0.5 : 1.0;
            low = *share;
            at_low = here;
            moved = -1;
        } else {
            at_low *= moved > 0 ? 0.5 : 1.0;
            high = *share;
            at_high = here;
            moved = 1;
        }
    }
    return fabs(here) <= most_jump * size;
}

static enum status add_pair(struct crossings *list, const double *value, bool always, int32_t a, int32_t b,
                            struct error *error)
{
    if (always || value[a] * value[b] < 0) {
        RETURN_IF_ERROR(GROW_ARRAY(&list->item, list->count + 1, &list->room, error));
        list->item[list->count++].split = (struct split){.node = {a < b ? a : b, a < b ? b : a}};
    }
    return STATUS_OK;
}

/* The edges of cells whose heights have different signs; and of faces on the sheet, whose extents have. Of a
 * face with all nodes on the border, as in a corner of it, all edges: where one is within, a node is put that
 * can be doubled. */
static enum status list_pairs(const struct cut *cut, enum level level, struct crossings *list,
                              struct error *error)
{
    const struct division *body = cut->body;
    const double *value = cut->value[level];
    int dim = body->dim, corners = dim + 1;
    for (int64_t c = 0; c < body->cell_count && level == LEVEL_HEIGHT; c++) {
        const int32_t *node = body->node + c * corners;
        for (int i = 0; i < corners * corners; i++) {
            if (i / corners < i % corners) {
                RETURN_IF_ERROR(add_pair(list, value, false, node[i / corners], node[i % corners], error));
            }
        }
    }
    for (int64_t f = 0, end; f < cut->face_count && level == LEVEL_EXTENT; f = end) {
        end = keyed_end(cut->face_count, cut->face, f);
        if (end - f == 2 && cut_parts(cut, f)) {
            const int32_t *node = cut->face[f].key;
            bool on_border = dim == 3 && value[node[0]] == 0 && value[node[1]] == 0 && value[node[2]] == 0;
            for (int k = 0; k < dim; k++) {
                RETURN_IF_ERROR(add_pair(list, value, on_border, node[k], node[(k + 1) % dim], error));
            }
        }
    }
    if (list->count > 0) {
        qsort(list->item, (size_t)list->count, sizeof *list->item, split_compare);
    }
    int64_t kept = 0;
    for (int64_t i = 0; i < list->count; i++) {
        if (i == 0 || split_compare(&list->item[i], &list->item[i - 1]) != 0) {
            list->item[kept++] = list->item[i];
        }
    }
    list->count = kept;
    return STATUS_OK;
}

/* The place on an edge where the extent is 0; or, between two nodes on the border, the middle, if it is
 * within. */
static void find_border(const struct cut *cut, struct crossing *item)
{
    const int32_t *node = item->split.node;
    struct sheet_place place = {0};
    item->extent = 0.0;
    item->used = true;
    if (cut->value[LEVEL_EXTENT][node[0]] == 0 && cut->value[LEVEL_EXTENT][node[1]] == 0) {
        item->split.share = 0.5;
        item->extent = value_between(cut, LEVEL_EXTENT, node, 0.5, &place);
        item->used = item->extent < -least_within * fmin(cut->shortest[node[0]], cut->shortest[node[1]]);
    } else if (!cut_root(cut, LEVEL_EXTENT, node, &item->split.share, &place)) {
        item->split.share = 0.5;
    }
}

static void find_roots(const struct cut *cut, enum level level, struct crossings *list)
{
    for (int64_t i = 0; i < list->count; i++) {
        struct crossing *item = &list->item[i];
        struct sheet_place place = {0};
        if (level == LEVEL_EXTENT) {
            find_border(cut, item);
        } else {
            bool found = cut_root(cut, level, item->split.node, &item->split.share, &place);
            item->extent = found ? sheet_extent(cut->sheet, &place) : INFINITY;
            item->used = false;
        }
        item->split.share = fmin(fmax(item->split.share, least_share), 1.0 - least_share);
    }
}

/* Use the crossings of a cell, if the sheet itself meets it. */
static void use_cell(const struct cut *cut, const struct crossings *list, const int32_t *node)
{
    struct crossing *own[6];
    int count = 0, corners = cut->body->dim + 1;
    bool meets = false;
    for (int i = 0; i < corners * corners; i++) {
        int32_t a = node[i / corners], b = node[i % corners];
        struct split key = {.node = {a, b}};
        if (a < b && cut->value[LEVEL_HEIGHT][a] * cut->value[LEVEL_HEIGHT][b] < 0) {
            own[count] = bsearch(&key, list->item, (size_t)list->count, sizeof *list->item, split_compare);
            count += own[count] != NULL && own[count]->extent < INFINITY;
        }
    }
    for (int i = 0; i < count; i++) {
        meets = meets || own[i]->extent < -COARSE_ROUND_OFF * cut->longest[own[i]->split.node[0]];
    }
    for (int k = 0; k < corners && count > 0; k++) {
        meets = meets || (cut->value[LEVEL_HEIGHT][node[k]] == 0 && cut->value[LEVEL_EXTENT][node[k]] < 0);
    }
    for (int i = 0; i < count && meets; i++) {
        own[i]->used = true;
    }
}

enum status cut_crossings(const struct cut *cut, enum level level, struct crossings *list,
                          struct error *error)
{
    int64_t used = 0;
    int corners = cut->body->dim + 1;
    list->count = 0;
    RETURN_IF_ERROR(list_pairs(cut, level, list, error));
    find_roots(cut, level, list);
    for (int64_t c = 0; c < cut->body->cell_count && level == LEVEL_HEIGHT; c++) {
        use_cell(cut, list, cut->body->node + c * corners);
    }
    for (int64_t i = 0; i < list->count; i++) {
        if (list->item[i].used) {
            list->item[used++] = list->item[i];
        }
    }
    list->count = used;
    return STATUS_OK;
}
