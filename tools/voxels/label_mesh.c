/* The cells of a label image as a mesh, or as the surface of a label. */
#include "voxels/label_image.h"

#include "approx/cells/crossing.h"
#include "approx/support/support.h"
#include "base/lists.h"
#include "base/vector.h"
#include "output.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An item, a facet or node, of the interface of two labels. */
struct member {
    int32_t inner, outer, item;
};

static int compare_members(const void *left, const void *right)
{
    return compare_numbers(3, left, right);
}

static enum status put_regions(const struct label_image *image, const struct label_cells *result,
                               struct stream *stream, struct error *error)
{
    FREED_BY(names_free) struct names names = {0};
    NEW_SCRATCH(int32_t, region, image->labels.count, error);
    NEW_SCRATCH(int32_t, of_cell, result->cell_count, error);
    for (int64_t c = 0; c < result->cell_count; c++) {
        region[result->label[c]] = 1;
    }
    for (int32_t l = 1; l < image->labels.count; l++) {
        if (region[l] != 0) {
            region[l] = (int32_t)names.count;
            RETURN_IF_ERROR(names_add(&names, image->table.names.name[l], error));
        }
    }
    for (int64_t c = 0; c < result->cell_count; c++) {
        of_cell[c] = region[result->label[c]];
    }
    return stream_put_groups(stream, GROUP_REGION, &names, result->cell_count, NULL, &of_cell, error);
}

/* Put a group A|B for each interface, with its items, once each: with these nodes. */
static enum status put_members(const struct label_image *image, enum group_kind kind, int64_t count,
                               struct member *member, int corners, const int32_t *node_of,
                               struct stream *stream, struct error *error)
{
    FREED_BY(names_free) struct names names = {0};
    int64_t kept = 0;
    NEW_SCRATCH(int32_t, node, count * corners, error);
    NEW_SCRATCH(int32_t, group, count, error);
    if (count > 0) {
        qsort(member, (size_t)count, sizeof *member, compare_members);
    }
    for (int64_t i = 0; i < count; i++) {
        const struct member *own = &member[i], *before = &member[i > 0 ? i - 1 : 0];
        if (i > 0 && compare_members(own, before) == 0) {
            continue;
        }
        if (i == 0 || own->inner != before->inner || own->outer != before->outer) {
            RETURN_IF_ERROR(names_print(&names, error, "%s|%s", image->table.names.name[own->inner],
                                        image->table.names.name[own->outer]));
        }
        memcpy(node + kept * corners, node_of != NULL ? node_of + (int64_t)own->item * corners : &own->item,
               (size_t)corners * sizeof *node);
        group[kept++] = (int32_t)names.count - 1;
    }
    return stream_put_groups(stream, kind, &names, kept, &node, &group, error);
}

/* List the nodes of faces between two regions, once for each face. */
static enum status find_interfaces(const struct cells *cells, const int32_t *label, struct member **member,
                                   int64_t *count, struct error *error)
{
    int corners = cells->dim + 1;
    int64_t room = 0;
    NEW_SCRATCH(int32_t, across, cells->count * corners, error);
    RETURN_IF_ERROR(cells_across(cells, across, error));
    for (int64_t i = 0; i < cells->count * corners; i++) {
        int64_t c = i / corners;
        for (int k = 0; k < corners && across[i] >= 0 && label[across[i]] > label[c]; k++) {
            if (k != i % corners) {
                RETURN_IF_ERROR(GROW_ARRAY(member, *count + 1, &room, error));
                (*member)[(*count)++] =
                    (struct member){label[c], label[across[i]], cells->node[c * corners + k]};
            }
        }
    }
    return STATUS_OK;
}

enum status label_mesh_put(const struct label_image *image, const struct label_cells *result,
                           struct stream *stream, struct error *error)
{
    struct cells cells = label_cells_view(result);
    char attributes[64];
    int64_t count = 0;
    SCRATCH struct member *shared = NULL;
    NEW_SCRATCH(struct member, facet, result->facet_count, error);
    for (int32_t f = 0; f < (int32_t)result->facet_count; f++) {
        facet[f] = (struct member){result->side[2 * f], result->side[2 * f + 1], f};
    }
    RETURN_IF_ERROR(find_interfaces(&cells, result->label, &shared, &count, error));
    RETURN_IF_ERROR(stream_put(stream, "nodes.x", TYPE_F8, result->node_count, result->dim,
                               vector_attributes(result->dim, "m", attributes), result->x, false, error));
    RETURN_IF_ERROR(stream_put(stream, "cells", TYPE_I4, result->cell_count, result->dim + 1, "",
                               result->cell, false, error));
    RETURN_IF_ERROR(put_regions(image, result, stream, error));
    RETURN_IF_ERROR(put_members(image, GROUP_FACETS, result->facet_count, facet, result->dim, result->facet,
                                stream, error));
    return put_members(image, GROUP_NODES, count, shared, 1, NULL, stream, error);
}

/* ---- surfaces ---- */

enum { MOST_HALVINGS = 30 };

void label_surface_parse(const struct tool *tool, const struct label_image *image,
                         struct label_surface_options *options)
{
    SCRATCH char *copy = tool_memory(tool, strdup(tool_value(tool, "surface")));
    char *outer = copy;
    const char *inner = strsep(&outer, "|");
    const struct names *names = &image->table.names;
    options->gap = tool_length(tool, "gap", 0);
    options->inner = (int32_t)names_find(names, inner);
    options->outer = outer == NULL ? -1 : (int32_t)names_find(names, outer);
    if (options->inner <= 0 || (outer != NULL && options->outer < 0)) {
        tool_fail(tool, STATUS_INPUT, "--surface: no label '%.60s'", options->inner <= 0 ? inner : outer);
    }
}

static void unit_normal(const struct label_cells *mesh, int64_t facet, double normal[3])
{
    int dim = mesh->dim;
    face_area_vector(dim, mesh->x, mesh->facet + facet * dim, normal);
    vector_normalise(dim, normal);
}

/* place[node_count * dim]: nodes of the facets moved outward along the mean normal of the facets there, so
 * far that each of these facets moves by the gap; at most by the gap over SAME_DIRECTION. */
static void move_outward(const struct label_cells *mesh, double gap, double *mean, double *least,
                         double *place)
{
    int dim = mesh->dim;
    double normal[3];
    for (int64_t i = 0; i < mesh->facet_count * dim; i++) {
        unit_normal(mesh, i / dim, normal);
        add_scaled(dim, 1.0, normal, mean + (int64_t)mesh->facet[i] * dim);
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        vector_normalise(dim, mean + n * dim);
        least[n] = 1;
    }
    for (int64_t i = 0; i < mesh->facet_count * dim; i++) {
        int64_t n = mesh->facet[i];
        unit_normal(mesh, i / dim, normal);
        least[n] = fmax(fmin(least[n], vector_dot(dim, normal, mean + n * dim)), SAME_DIRECTION);
    }
    for (int64_t i = 0; i < mesh->node_count * dim; i++) {
        place[i] = mesh->x[i] + gap / least[i / dim] * mean[i];
    }
}

/* ---- crossings ---- */

/* crosses[node_count]: nodes of moved facets that cross another one, or have turned over. False: none. */
static bool find_crossings(const struct label_cells *mesh, const double *place, struct facet_box *boxes,
                           bool *crosses)
{
    int dim = mesh->dim;
    int64_t count = mesh->facet_count;
    bool any = false;
    memset(crosses, 0, (size_t)mesh->node_count * sizeof *crosses);
    facet_boxes_sort(dim, place, mesh->facet, count, boxes);
    for (int64_t i = 0; i < count; i++) {
        const int32_t *f = mesh->facet + boxes[i].facet.item * dim;
        double before[3], after[3];
        face_area_vector(dim, mesh->x, f, before);
        face_area_vector(dim, place, f, after);
        bool turned = !(vector_dot(dim, before, after) > 0);
        for (int k = 0; k < dim && turned; k++) {
            crosses[f[k]] = any = true;
        }
        for (int64_t j = i + 1; j < count && boxes[j].facet.place <= boxes[i].box.high[0]; j++) {
            const int32_t *g = mesh->facet + boxes[j].facet.item * dim;
            bool through = box_meets(&boxes[i].box, &boxes[j].box) && facets_cross(dim, place, f, g, 0);
            for (int k = 0; k < dim && through; k++) {
                crosses[f[k]] = crosses[g[k]] = any = true;
            }
        }
    }
    return any;
}

/* Halve the moves of facets that cross each other, until none does; note where. */
static void uncross(const struct tool *tool, const struct label_cells *mesh, double *place)
{
    int dim = mesh->dim;
    int64_t nodes = 0, first = -1;
    TOOL_SCRATCH(tool, struct facet_box, boxes, mesh->facet_count);
    TOOL_SCRATCH(tool, bool, crosses, mesh->node_count);
    TOOL_SCRATCH(tool, int, halvings, mesh->node_count);
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        boxes[f].facet.item = f;
    }
    for (int round = 0; round < MOST_HALVINGS && find_crossings(mesh, place, boxes, crosses); round++) {
        for (int64_t n = 0; n < mesh->node_count; n++) {
            halvings[n] += crosses[n];
            if (crosses[n]) {
                vector_between(dim, mesh->x + n * dim, place + n * dim, 0.5, place + n * dim);
            }
        }
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        nodes += halvings[n] > 0;
        first = first < 0 && halvings[n] > 0 ? n : first;
    }
    if (nodes > 0) {
        tool_note(tool,
                  "--gap: %jd nodes are moved by less, the first at %s m: the surface would cross itself "
                  "there, as where a furrow is narrower than twice the gap",
                  nodes, POINT_TEXT(dim, mesh->x + first * dim));
    }
}

static void print_triangles(FILE *file, const struct label_cells *mesh, const double *place)
{
    for (int64_t i = 0; i < mesh->facet_count * 9; i++) {
        fprintf(file, "%.9g%c", place[3 * (int64_t)mesh->facet[i / 3] + i % 3], i % 9 < 8 ? ' ' : '\n');
    }
}

/* Print curves, each from the first edge that has not been visited along next[], which is indexed by the
 * first node of an edge. */
static void print_curves(FILE *file, const struct label_cells *mesh, const double *place, int64_t *next)
{
    bool first = true;
    for (int64_t n = 0; n < mesh->node_count; n++) {
        next[n] = -1;
    }
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        next[mesh->facet[2 * f]] = f;
    }
    /* Open curves, between two junctions of three labels, start at their first node. */
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t f = 0; f < mesh->facet_count && pass == 0; f++) {
            if (next[mesh->facet[2 * f + 1]] >= 0) {
                next[mesh->facet[2 * f + 1]] += mesh->facet_count; /* there is an edge before this node */
            }
        }
        for (int64_t n = 0; n < mesh->node_count; n++) {
            if (next[n] < 0 || (pass == 0 && next[n] >= mesh->facet_count)) {
                continue;
            }
            fprintf(file, "%s%.9g %.9g\n", first ? "" : "\n", place[2 * n], place[2 * n + 1]);
            first = false;
            for (int64_t at = n; next[at] >= 0;) {
                int64_t facet = next[at] % mesh->facet_count;
                next[at] = -1;
                at = mesh->facet[2 * facet + 1];
                fprintf(file, "%.9g %.9g\n", place[2 * at], place[2 * at + 1]);
            }
        }
    }
}

void label_surface_write(const struct tool *tool, struct label_cells *mesh,
                         const struct label_surface_options *options)
{
    struct output output;
    int dim = mesh->dim;
    int64_t count = 0;
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        const int32_t *side = mesh->side + 2 * f;
        if (side[0] == options->inner && (options->outer < 0 || side[1] == options->outer)) {
            memmove(mesh->facet + count++ * dim, mesh->facet + f * dim, (size_t)dim * sizeof *mesh->facet);
        }
    }
    mesh->facet_count = count;
    if (count == 0) {
        tool_fail(tool, STATUS_INPUT, "--surface: these labels do not touch");
    }
    TOOL_SCRATCH(tool, double, mean, mesh->node_count *dim);
    TOOL_SCRATCH(tool, double, least, mesh->node_count);
    TOOL_SCRATCH(tool, double, place, mesh->node_count *dim);
    TOOL_SCRATCH(tool, int64_t, next, mesh->node_count);
    move_outward(mesh, options->gap, mean, least, place);
    if (options->gap > 0) {
        uncross(tool, mesh, place);
    }
    TOOL_TRY(tool, output_open(&output, tool->output, false, &error));
    if (dim == 3) {
        print_triangles(output.file, mesh, place);
    } else {
        print_curves(output.file, mesh, place, next);
    }
    TOOL_TRY(tool, output_end(&output, STATUS_OK, &error));
}
