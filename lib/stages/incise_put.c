/* The sections of a body that has been cut. */
#include "stages/incise_private.h"

#include "approx/cells/quality.h"
#include "base/memory.h"
#include "base/vector.h"
#include "stages/stages.h"

#include <math.h>
#include <string.h>

/* ---- node sets ---- */

/* in[nodes]: a node on an edge is in a set if both ends are, a copy if its original is. */
static void mark_members(const struct cut_body *whole, int64_t set, bool *in)
{
    const struct division *body = &whole->body;
    const struct groups *sets = &whole->sets;
    memset(in, false, (size_t)body->node_count * sizeof *in);
    for (int64_t i = 0; i < sets->count; i++) {
        in[sets->node[i]] |= sets->group[i] == set;
    }
    for (int64_t n = whole->cells.node_count; n < body->node_count; n++) {
        in[n] = in[body->parent[2 * n]] && in[body->parent[2 * n + 1]];
    }
}

static int64_t find_edge(const struct cut_body *whole)
{
    const char *name = whole->options->name;
    size_t length = strlen(name);
    int64_t own = -1;
    for (int64_t s = 0; s < whole->sets.names.count && whole->options->blade != NULL; s++) {
        const char *set = whole->sets.names.name[s];
        own = strncmp(set, name, length) == 0 && strcmp(set + length, "|edge") == 0 ? s : own;
    }
    return own;
}

/* of_lip[nodes], bits: 1 for a node of the front face, 2 of the back. */
static void mark_lips(int dim, int64_t count, const int32_t *facet, const int32_t *group, int32_t front,
                      int32_t back, int32_t *of_lip)
{
    for (int64_t i = 0; i < count * dim; i++) {
        of_lip[facet[i]] |= group[i / dim] == front ? 1 : group[i / dim] == back ? 2 : 0;
    }
}

/* edge[nodes]: nodes of both faces, where the cells go round: which have no copy, as they have in the corner
 * of a piece between faces of two sheets. Old nodes that were on a face before are judged as they were then.
 */
static enum status mark_edge(const struct cut_body *whole, bool *edge, struct error *error)
{
    const struct division *body = &whole->body;
    int64_t old = whole->cells.node_count, own = find_edge(whole);
    NEW_SCRATCH(int32_t, of_lip, body->node_count, error);
    NEW_SCRATCH(int32_t, before, body->node_count, error);
    NEW_SCRATCH(bool, copied, body->node_count, error);
    if (own >= 0) {
        mark_members(whole, own, edge);
    }
    mark_lips(body->dim, body->facet_count, body->facet, body->group, whole->front, whole->back, of_lip);
    mark_lips(body->dim, whole->facets.count, whole->facets.node, whole->facets.group, whole->front,
              whole->back, before);
    for (int64_t n = old; n < body->node_count; n++) {
        const int32_t *parent = &body->parent[2 * n];
        copied[n] = parent[0] == parent[1];
        copied[parent[0]] = copied[parent[0]] || copied[n];
    }
    for (int64_t n = 0; n < body->node_count; n++) {
        edge[n] = of_lip[n] == 3 && !copied[n] && (edge[n] || n >= old || before[n] == 0);
    }
    return STATUS_OK;
}

/* Node sets in the numbers kept_as[]; `edge` last, or in place of the set that has its name. */
static enum status put_sets(struct cut_body *whole, const bool *edge, const int32_t *kept_as,
                            int64_t node_count, struct stream *stream, struct error *error)
{
    struct names *names = &whole->sets.names;
    int64_t own = find_edge(whole), node_room = 0, group_room = 0, count = 0;
    int32_t sets = 0;
    SCRATCH int32_t *node = NULL, *group = NULL;
    bool any = whole->report->edge > 0;
    NEW_SCRATCH(bool, in, node_count, error);
    for (int64_t s = 0; s < names->count + any; s++) {
        if (s == own) {
            continue;
        }
        if (s < names->count) {
            mark_members(whole, s, in);
        }
        for (int64_t n = 0; n < node_count; n++) {
            if (kept_as[n] >= 0 && (s < names->count ? in[n] : edge[n])) {
                RETURN_IF_ERROR(GROW_ARRAY(&node, count + 1, &node_room, error));
                RETURN_IF_ERROR(GROW_ARRAY(&group, count + 1, &group_room, error));
                node[count] = kept_as[n];
                group[count++] = sets;
            }
        }
        sets++;
    }
    if (own >= 0) {
        RETURN_IF_ERROR(names_remove(names, own, error));
    }
    if (any) {
        RETURN_IF_ERROR(names_print(names, error, "%s|edge", whole->options->name));
    }
    return stream_put_groups(stream, GROUP_NODES, names, count, &node, &group, error);
}

/* ---- cells and facets ---- */

static enum status put_regions(struct cut_body *whole, struct stream *stream, struct error *error)
{
    const struct division *body = &whole->body;
    struct names *names = &whole->regions.names;
    const char *without = whole->options->region;
    int64_t region = without != NULL ? names_find(names, without) : -1;
    if (whole->regions.group == NULL) {
        return STATUS_OK;
    }
    NEW_SCRATCH(int32_t, of_cell, body->cell_count, error);
    for (int64_t c = 0; c < body->cell_count; c++) {
        int32_t own = whole->regions.group[body->of_cell[c]];
        of_cell[c] = own - (region >= 0 && own > region);
    }
    if (region >= 0) {
        RETURN_IF_ERROR(names_remove(names, region, error));
    }
    return stream_put_groups(stream, GROUP_REGION, names, body->cell_count, NULL, &of_cell, error);
}

/* Drop the new groups without facets, as the wall of a region that bordered on no other. */
static enum status drop_empty_groups(struct cut_body *whole, struct error *error)
{
    struct division *body = &whole->body;
    for (int64_t g = whole->facets.names.count - 1; g >= whole->old_groups; g--) {
        bool any = false;
        for (int64_t f = 0; f < body->facet_count; f++) {
            any = any || body->group[f] == g;
        }
        for (int64_t f = 0; f < body->facet_count && !any; f++) {
            body->group[f] -= body->group[f] > g;
        }
        RETURN_IF_ERROR(any ? STATUS_OK : names_remove(&whole->facets.names, g, error));
    }
    return STATUS_OK;
}

static void report_result(struct cut_body *whole)
{
    const struct division *body = &whole->body;
    struct cells cells = division_cells(body);
    struct incise_report *report = whole->report;
    report->poorest = INFINITY;
    for (int64_t f = 0; f < body->facet_count; f++) {
        double normal[3];
        face_area_vector(body->dim, body->x, body->facet + f * body->dim, normal);
        report->face_area += body->group[f] == whole->front ? vector_length(body->dim, normal) : 0.0;
    }
    for (int64_t c = 0; c < body->cell_count; c++) {
        report->poorest = fmin(report->poorest, cell_quality(&cells, c, NULL));
    }
}

/* ---- fibres ---- */

/* fibre[cells * cols] = those of the old cells of which the cells are parts, 0 where these have no point;
 * NULL: the stream has none. */
static enum status take_fibres(const struct cut_body *whole, const struct stream *stream, double **fibre,
                               struct error *error)
{
    const struct division *body = &whole->body;
    const struct section *of_point, *cell;
    if (stream_find(stream, "points.fibre") == NULL || stream_find(stream, "points.cell") == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stream_view(stream, "points.fibre", &of_point, error));
    RETURN_IF_ERROR(stream_view(stream, "points.cell", &cell, error));
    const double *value = of_point->data;
    const int32_t *owner = cell->data;
    int64_t cols = of_point->cols;
    NEW_SCRATCH(double, of_old, whole->cells.count * cols, error);
    RETURN_IF_ERROR(NEW_ARRAY(fibre, body->cell_count * cols, error));
    for (int64_t p = cell->rows; p-- > 0;) { /* of several points the first counts */
        if (owner[p] >= 0) {
            memcpy(of_old + owner[p] * cols, value + p * cols, (size_t)cols * sizeof *value);
        }
    }
    for (int64_t c = 0; c < body->cell_count; c++) {
        memcpy(*fibre + c * cols, of_old + body->of_cell[c] * cols, (size_t)cols * sizeof *value);
    }
    return STATUS_OK;
}

/* Put them at the points of smoothed cells. */
static enum status put_fibres(struct stream *stream, int dim, int64_t cell_count, double **fibre,
                              struct error *error)
{
    const struct ipoints_options options = {.smoothed = true};
    char attributes[64];
    int64_t unresolved;
    if (*fibre == NULL) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(stage_ipoints(stream, &options, &unresolved, error));
    return stream_put(stream, "points.fibre", TYPE_F8, cell_count, dim,
                      vector_attributes(dim, "1", attributes), array_take(fibre), true, error);
}

enum status cut_body_put(struct cut_body *whole, const bool *kept, struct stream *stream, struct error *error)
{
    struct division *body = &whole->body;
    int64_t nodes = body->node_count;
    char attributes[64];
    SCRATCH double *fibre = NULL;
    NEW_SCRATCH(bool, edge, nodes, error);
    NEW_SCRATCH(int32_t, kept_as, nodes, error);
    RETURN_IF_ERROR(mark_edge(whole, edge, error));
    RETURN_IF_ERROR(division_take_out(body, kept, whole->wall, kept_as, error));
    report_result(whole);
    RETURN_IF_ERROR(drop_empty_groups(whole, error));
    for (int64_t n = 0; n < nodes; n++) {
        whole->report->edge += edge[n] && kept_as[n] >= 0;
    }
    /* The old cells may be views of what is replaced, so what is made of them comes first. */
    RETURN_IF_ERROR(take_fibres(whole, stream, &fibre, error));
    RETURN_IF_ERROR(put_sets(whole, edge, kept_as, nodes, stream, error));
    RETURN_IF_ERROR(put_regions(whole, stream, error));
    RETURN_IF_ERROR(stream_put_groups(stream, GROUP_FACETS, &whole->facets.names, body->facet_count,
                                      &body->facet, &body->group, error));
    RETURN_IF_ERROR(stream_put(stream, "cells", TYPE_I4, body->cell_count, body->dim + 1, "",
                               array_take(&body->node), true, error));
    RETURN_IF_ERROR(stream_put(stream, "nodes.x", TYPE_F8, body->node_count, body->dim,
                               vector_attributes(body->dim, "m", attributes), array_take(&body->x), true,
                               error));
    sections_remove(stream, MADE_WITH_POINTS, MADE_WITH_RESULTS);
    return put_fibres(stream, body->dim, body->cell_count, &fibre, error);
}
