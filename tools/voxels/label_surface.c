#include "voxels/label_image.h"

#include "output.h"

#include "approx/cells/crossing.h"
#include "approx/support/support.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

/* The chosen facets. */
struct surface {
    int dim;
    int64_t node_count, count;
    const double *x;      /* node_count * dim, m */
    const int32_t *facet; /* count * dim */
    double gap;           /* by which they are moved outward, m */
};

static void unit_normal(const struct surface *surface, int64_t facet, double normal[3])
{
    int dim = surface->dim;
    face_area_vector(dim, surface->x, surface->facet + facet * dim, normal);
    vector_normalise(dim, normal);
}

/* place[node_count * dim]: nodes of the facets moved outward along the mean normal of the facets there, so
 * far that each of these facets moves by the gap; at most by the gap over SAME_DIRECTION. */
static void move_outward(const struct surface *surface, double *mean, double *least, double *place)
{
    int dim = surface->dim;
    double normal[3];
    for (int64_t i = 0; i < surface->count * dim; i++) {
        unit_normal(surface, i / dim, normal);
        add_scaled(dim, 1.0, normal, mean + (int64_t)surface->facet[i] * dim);
    }
    for (int64_t n = 0; n < surface->node_count; n++) {
        vector_normalise(dim, mean + n * dim);
        least[n] = 1;
    }
    for (int64_t i = 0; i < surface->count * dim; i++) {
        int64_t n = surface->facet[i];
        unit_normal(surface, i / dim, normal);
        least[n] = fmax(fmin(least[n], vector_dot(dim, normal, mean + n * dim)), SAME_DIRECTION);
    }
    for (int64_t i = 0; i < surface->node_count * dim; i++) {
        place[i] = surface->x[i] + surface->gap / least[i / dim] * mean[i];
    }
}

/* ---- crossings ---- */

/* crosses[node_count]: nodes of moved facets that cross another one, or have turned over. False: none. */
static bool find_crossings(const struct surface *surface, const double *place, struct facet_box *boxes,
                           bool *crosses)
{
    int dim = surface->dim;
    int64_t count = surface->count;
    bool any = false;
    memset(crosses, 0, (size_t)surface->node_count * sizeof *crosses);
    facet_boxes_sort(dim, place, surface->facet, count, boxes);
    for (int64_t i = 0; i < count; i++) {
        const int32_t *f = surface->facet + boxes[i].facet.item * dim;
        double before[3], after[3];
        face_area_vector(dim, surface->x, f, before);
        face_area_vector(dim, place, f, after);
        bool turned = !(vector_dot(dim, before, after) > 0);
        for (int k = 0; k < dim && turned; k++) {
            crosses[f[k]] = any = true;
        }
        for (int64_t j = i + 1; j < count && boxes[j].facet.place <= boxes[i].box.high[0]; j++) {
            const int32_t *g = surface->facet + boxes[j].facet.item * dim;
            bool through = box_meets(&boxes[i].box, &boxes[j].box) && facets_cross(dim, place, f, g, 0);
            for (int k = 0; k < dim && through; k++) {
                crosses[f[k]] = crosses[g[k]] = any = true;
            }
        }
    }
    return any;
}

/* Halve the moves of facets that cross each other, until none does; note where. */
static void uncross(const struct tool *tool, const struct surface *surface, double *place)
{
    int dim = surface->dim;
    int64_t nodes = 0, first = -1;
    TOOL_SCRATCH(tool, struct facet_box, boxes, surface->count);
    TOOL_SCRATCH(tool, bool, crosses, surface->node_count);
    TOOL_SCRATCH(tool, int, halvings, surface->node_count);
    for (int64_t f = 0; f < surface->count; f++) {
        boxes[f].facet.item = f;
    }
    for (int round = 0;
         round < MOST_HALVINGS && surface->gap > 0 && find_crossings(surface, place, boxes, crosses);
         round++) {
        for (int64_t n = 0; n < surface->node_count; n++) {
            halvings[n] += crosses[n];
            if (crosses[n]) {
                vector_between(dim, surface->x + n * dim, place + n * dim, 0.5, place + n * dim);
            }
        }
    }
    for (int64_t n = 0; n < surface->node_count; n++) {
        nodes += halvings[n] > 0;
        first = first < 0 && halvings[n] > 0 ? n : first;
    }
    if (nodes > 0) {
        tool_note(tool,
                  "--gap: %jd nodes are moved by less, the first at %s m: the surface would cross itself "
                  "there, as where a furrow is narrower than twice the gap",
                  nodes, POINT_TEXT(dim, surface->x + first * dim));
    }
}

static void print_triangles(FILE *file, const struct surface *surface, const double *place)
{
    for (int64_t i = 0; i < surface->count * 9; i++) {
        fprintf(file, "%.9g%c", place[3 * (int64_t)surface->facet[i / 3] + i % 3], i % 9 < 8 ? ' ' : '\n');
    }
}

/* Print curves, each from the first edge that has not been visited along next[], which is indexed by the
 * first node of an edge. */
static void print_curves(FILE *file, const struct surface *surface, const double *place, int64_t *next)
{
    bool first = true;
    for (int64_t n = 0; n < surface->node_count; n++) {
        next[n] = -1;
    }
    for (int64_t f = 0; f < surface->count; f++) {
        next[surface->facet[2 * f]] = f;
    }
    /* Open curves, between two junctions of three labels, start at their first node. */
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t f = 0; f < surface->count && pass == 0; f++) {
            if (next[surface->facet[2 * f + 1]] >= 0) {
                next[surface->facet[2 * f + 1]] += surface->count; /* there is an edge before this node */
            }
        }
        for (int64_t n = 0; n < surface->node_count; n++) {
            if (next[n] < 0 || (pass == 0 && next[n] >= surface->count)) {
                continue;
            }
            fprintf(file, "%s%.9g %.9g\n", first ? "" : "\n", place[2 * n], place[2 * n + 1]);
            first = false;
            for (int64_t at = n; next[at] >= 0;) {
                int64_t facet = next[at] % surface->count;
                next[at] = -1;
                at = surface->facet[2 * facet + 1];
                fprintf(file, "%.9g %.9g\n", place[2 * at], place[2 * at + 1]);
            }
        }
    }
}

static void print_surface(const struct tool *tool, FILE *file, const struct surface *surface)
{
    int dim = surface->dim;
    TOOL_SCRATCH(tool, double, mean, surface->node_count *dim);
    TOOL_SCRATCH(tool, double, least, surface->node_count);
    TOOL_SCRATCH(tool, double, place, surface->node_count *dim);
    TOOL_SCRATCH(tool, int64_t, next, surface->node_count);
    move_outward(surface, mean, least, place);
    uncross(tool, surface, place);
    if (dim == 3) {
        print_triangles(file, surface, place);
    } else {
        print_curves(file, surface, place, next);
    }
}

void label_surface_write(const struct tool *tool, const struct label_cells *mesh,
                         const struct label_surface_options *options)
{
    struct output output;
    int dim = mesh->dim;
    TOOL_SCRATCH(tool, int32_t, facet, mesh->facet_count * dim);
    struct surface surface = {dim, mesh->node_count, 0, mesh->x, facet, options->gap};
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        const int32_t *side = mesh->side + 2 * f;
        if (side[0] == options->inner && (options->outer < 0 || side[1] == options->outer)) {
            memcpy(facet + surface.count++ * dim, mesh->facet + f * dim, (size_t)dim * sizeof *facet);
        }
    }
    if (surface.count == 0) {
        tool_fail(tool, STATUS_INPUT, "--surface: these labels do not touch");
    }
    TOOL_TRY(tool, output_open(&output, tool->output, false, &error));
    print_surface(tool, output.file, &surface);
    TOOL_TRY(tool, output_end(&output, STATUS_OK, &error));
}
