#include "stages/incise_private.h"

#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>

static void cut_body_free(struct cut_body *whole)
{
    groups_free(&whole->regions);
    groups_free(&whole->facets);
    groups_free(&whole->sets);
    division_free(&whole->body);
}

/* ---- groups ---- */

/* *group: the number of the group NAME|ENDING, which may be new. */
static enum status find_group(struct cut_body *whole, const char *ending, int32_t *group, struct error *error)
{
    struct names *names = &whole->facets.names;
    RETURN_IF_ERROR(names_print(names, error, "%s%s", whole->options->name, ending));
    *group = (int32_t)names_find(names, names->name[names->count - 1]);
    return *group < names->count - 1 ? names_remove(names, names->count - 1, error) : STATUS_OK;
}

static enum status read_body(const struct stream *stream, struct cut_body *whole, struct error *error)
{
    const struct incise_options *options = whole->options;
    struct cells *cells = &whole->cells;
    RETURN_IF_ERROR(stream_cells(stream, true, cells, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_FACETS, false, &whole->facets, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_REGION, false, &whole->regions, error));
    RETURN_IF_ERROR(stream_groups(stream, GROUP_NODES, false, &whole->sets, error));
    RETURN_IF_ERROR(division_begin(cells, options->at, whole->regions.group, whole->facets.count,
                                   whole->facets.node, whole->facets.group, &whole->body, error));
    for (int64_t i = 0; i < whole->sets.count; i++) {
        whole->body.sets[whole->sets.node[i]] |= (uint64_t)1 << whole->sets.group[i] % 64;
    }
    whole->old_groups = whole->facets.names.count;
    whole->front = whole->back = whole->wall = -1;
    if (options->blade != NULL) {
        RETURN_IF_ERROR(find_group(whole, "|front", &whole->front, error));
        RETURN_IF_ERROR(find_group(whole, "|back", &whole->back, error));
    }
    return options->region != NULL ? find_group(whole, "|wall", &whole->wall, error) : STATUS_OK;
}

/* ---- the cut ---- */

static enum status fail_outside(const struct cut_body *whole, struct error *error)
{
    const struct blade *blade = whole->options->blade;
    int dim = whole->cells.dim;
    struct box of_blade = box_of(dim, 0, NULL), own = box_of(dim, whole->cells.node_count, whole->body.at);
    char text[2][128];
    for (int64_t s = 0; s < blade->count; s++) {
        box_add(&of_blade, blade->sheet[s].surface.vertex_count, blade->sheet[s].surface.vertex);
    }
    return fail(error, STATUS_INPUT, "%s: its box is %s, that of the body %s: is the unit right?",
                box_meets(&of_blade, &own)
                    ? "opens nothing: it lies within a cell, along the surface, or outside of the body"
                    : "is outside of the body",
                box_text(&of_blade, text[0]), box_text(&own, text[1]));
}

static enum status cut_along_blade(struct cut_body *whole, struct error *error)
{
    const struct blade *blade = whole->options->blade;
    struct incise_report *report = whole->report;
    struct division *body = &whole->body;
    if (blade != NULL && whole->options->excise && !blade_is_closed(blade)) {
        return fail(error, STATUS_INPUT, "is open: what lies behind it has no end");
    }
    for (int64_t s = 0; blade != NULL && s < blade->count; s++) {
        int64_t opened = 0;
        RETURN_IF_ERROR(incision_cut(body, &blade->sheet[s], whole->front, whole->back, &opened, error));
        report->opened += opened;
        report->unopened += opened == 0;
    }
    for (int64_t n = 0; n < body->node_count; n++) {
        bool old = n < whole->cells.node_count, copy = !old && body->parent[2 * n] == body->parent[2 * n + 1];
        report->moved +=
            old && vector_distance2(body->dim, body->x + n * body->dim, whole->cells.x + n * body->dim) > 0.0;
        report->doubled += copy;
        report->split += !old && !copy;
    }
    return blade != NULL && report->doubled == 0 ? fail_outside(whole, error) : STATUS_OK;
}

/* ---- pieces ---- */

/* Of a connected piece. */
struct piece {
    double volume;
    bool front, back; /* has facets of that side */
    bool taken_out;
};

static enum status list_pieces(const struct cut_body *whole, int32_t *part, struct piece **piece,
                               int32_t *count, struct error *error)
{
    const struct division *body = &whole->body;
    struct cells cells = division_cells(body);
    FREED_BY(faces_free) struct faces boundary = {0};
    NEW_SCRATCH(int64_t, face, body->facet_count, error);
    RETURN_IF_ERROR(cells_parts(&cells, part, count, error));
    RETURN_IF_ERROR(NEW_ARRAY(piece, *count, error));
    RETURN_IF_ERROR(faces_build(&cells, true, &boundary, error));
    RETURN_IF_ERROR(faces_find(&boundary, body->facet_count, body->facet, face, error));
    for (int64_t c = 0; c < cells.count; c++) {
        (*piece)[part[c]].volume += cell_volume(&cells, c);
    }
    for (int64_t f = 0; f < body->facet_count; f++) {
        if (face[f] >= 0 && body->group[f] == whole->front) {
            (*piece)[part[boundary.cell[2 * face[f]]]].front = true;
        } else if (face[f] >= 0 && body->group[f] == whole->back) {
            (*piece)[part[boundary.cell[2 * face[f]]]].back = true;
        }
    }
    return STATUS_OK;
}

static enum status judge_pieces(const struct cut_body *whole, int32_t count, struct piece *piece,
                                struct error *error)
{
    const struct incise_options *options = whole->options;
    struct incise_report *report = whole->report;
    report->smallest = INFINITY;
    for (int32_t p = 0; p < count; p++) {
        report->volume += piece[p].volume;
    }
    for (int32_t p = 0; p < count; p++) {
        if (!piece[p].front && !piece[p].back) {
            continue;
        }
        bool excised = options->excise && piece[p].back && !piece[p].front;
        piece[p].taken_out = excised || piece[p].volume < options->least * report->volume;
        report->pieces++;
        report->taken_out += piece[p].taken_out;
        report->taken += piece[p].taken_out ? piece[p].volume : 0.0;
        report->smallest = piece[p].taken_out ? report->smallest : fmin(report->smallest, piece[p].volume);
    }
    return options->excise && report->taken_out == 0
               ? fail(error, STATUS_INPUT, "parts nothing behind it from the body")
               : STATUS_OK;
}

/* kept[cells]: all but pieces to be taken out, and the region. */
static enum status choose_cells(struct cut_body *whole, bool *kept, struct error *error)
{
    const struct division *body = &whole->body;
    const char *name = whole->options->region;
    SCRATCH struct piece *piece = NULL;
    int32_t count = 0;
    int64_t left = 0, region = -1;
    NEW_SCRATCH(int32_t, part, body->cell_count, error);
    if (name != NULL) {
        RETURN_IF_ERROR(names_need(&whole->regions.names, "region", name, &region, error));
    }
    RETURN_IF_ERROR(list_pieces(whole, part, &piece, &count, error));
    RETURN_IF_ERROR(judge_pieces(whole, count, piece, error));
    for (int64_t c = 0; c < body->cell_count; c++) {
        bool in_region = region >= 0 && whole->regions.group[body->of_cell[c]] == region;
        kept[c] = !piece[part[c]].taken_out && !in_region;
        whole->report->region_cells += in_region;
        left += kept[c];
    }
    return left > 0 ? STATUS_OK : fail(error, STATUS_INPUT, "nothing is left of the body");
}

enum status stage_incise(struct stream *stream, const struct incise_options *options,
                         struct incise_report *report, struct error *error)
{
    FREED_BY(cut_body_free) struct cut_body whole = {.options = options, .report = report};
    *report = (struct incise_report){0};
    RETURN_IF_ERROR(read_body(stream, &whole, error));
    RETURN_IF_ERROR(cut_along_blade(&whole, error));
    NEW_SCRATCH(bool, kept, whole.body.cell_count, error);
    RETURN_IF_ERROR(choose_cells(&whole, kept, error));
    return cut_body_put(&whole, kept, stream, error);
}
