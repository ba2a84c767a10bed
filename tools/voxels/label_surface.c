#include "voxels/label_image.h"

#include "output.h"

#include "approx/cells/crossing.h"
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

static bool is_chosen(const struct label_cells *mesh, const struct label_surface_options *options,
                      int64_t facet)
{
    const int32_t *side = mesh->side + 2 * facet;
    return side[0] == options->inner && (options->outer < 0 || side[1] == options->outer);
}

static void unit_normal(const struct label_cells *mesh, int64_t facet, double normal[3])
{
    int dim = mesh->dim;
    face_area_vector(dim, mesh->x, mesh->facet + facet * dim, normal);
    vector_normalise(dim, normal);
}

/* place[node_count * dim]: nodes of the facets moved outward along the mean normal of the facets there, so
 * far that each of these facets moves by the gap; at most by the gap over SAME_DIRECTION. */
static void move_outward(const struct label_cells *mesh, const struct label_surface_options *options,
                         double *mean, double *least, double *place)
{
    int dim = mesh->dim;
    double normal[3];
    for (int64_t i = 0; i < mesh->facet_count * dim; i++) {
        if (is_chosen(mesh, options, i / dim)) {
            unit_normal(mesh, i / dim, normal);
            add_scaled(dim, 1.0, normal, mean + (int64_t)mesh->facet[i] * dim);
        }
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        vector_normalise(dim, mean + n * dim);
        least[n] = 1;
    }
    for (int64_t i = 0; i < mesh->facet_count * dim; i++) {
        int64_t n = mesh->facet[i];
        if (is_chosen(mesh, options, i / dim)) {
            unit_normal(mesh, i / dim, normal);
            double cosine = vector_dot(dim, normal, mean + n * dim);
            least[n] = fmax(fmin(least[n], cosine), SAME_DIRECTION);
        }
    }
    for (int64_t i = 0; i < mesh->node_count * dim; i++) {
        place[i] = mesh->x[i] + options->gap / least[i / dim] * mean[i];
    }
}

/* ---- crossings ---- */

/* crosses[node_count]: nodes of moved facets that cross another one, or have turned over. False: none. */
static bool find_crossings(const struct label_cells *mesh, const double *place, int64_t count,
                           struct facet_box *boxes, bool *crosses)
{
    int dim = mesh->dim;
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
static void uncross(const struct tool *tool, const struct label_cells *mesh,
                    const struct label_surface_options *options, double *place)
{
    int dim = mesh->dim;
    int64_t count = 0, nodes = 0, first = -1;
    TOOL_SCRATCH(tool, struct facet_box, boxes, mesh->facet_count);
    TOOL_SCRATCH(tool, bool, crosses, mesh->node_count);
    TOOL_SCRATCH(tool, int, halvings, mesh->node_count);
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        if (is_chosen(mesh, options, f)) {
            boxes[count++].facet.item = f;
        }
    }
    for (int round = 0;
         round < MOST_HALVINGS && options->gap > 0 && find_crossings(mesh, place, count, boxes, crosses);
         round++) {
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
        char text[96] = "";
        for (int d = 0; d < dim; d++) {
            text_append(text, sizeof text, "%s%.4g", d > 0 ? ", " : "", 1e3 * mesh->x[first * dim + d]);
        }
        tool_note(tool,
                  "--gap: %jd nodes are moved by less, the first at (%s) mm: the surface would cross itself "
                  "there, as where a furrow is narrower than twice the gap",
                  nodes, text);
    }
}

static void print_triangles(FILE *file, const struct label_cells *mesh,
                            const struct label_surface_options *options, const double *place)
{
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        for (int k = 0; k < 9 && is_chosen(mesh, options, f); k++) {
            fprintf(file, "%.9g%c", place[3 * (int64_t)mesh->facet[3 * f + k / 3] + k % 3],
                    k < 8 ? ' ' : '\n');
        }
    }
}

/* Print curves, each from the first edge that has not been visited along next[], which is indexed by the
 * first node of an edge. */
static void print_curves(FILE *file, const struct label_cells *mesh,
                         const struct label_surface_options *options, const double *place, int64_t *next)
{
    bool first = true;
    for (int64_t n = 0; n < mesh->node_count; n++) {
        next[n] = -1;
    }
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        if (is_chosen(mesh, options, f)) {
            next[mesh->facet[2 * f]] = f;
        }
    }
    /* Open curves, between two junctions of three labels, start at their first node. */
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t f = 0; f < mesh->facet_count && pass == 0; f++) {
            if (is_chosen(mesh, options, f) && next[mesh->facet[2 * f + 1]] >= 0) {
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

static void print_surface(const struct tool *tool, FILE *file, const struct label_cells *mesh,
                          const struct label_surface_options *options)
{
    int dim = mesh->dim;
    TOOL_SCRATCH(tool, double, mean, mesh->node_count *dim);
    TOOL_SCRATCH(tool, double, least, mesh->node_count);
    TOOL_SCRATCH(tool, double, place, mesh->node_count *dim);
    TOOL_SCRATCH(tool, int64_t, next, mesh->node_count);
    move_outward(mesh, options, mean, least, place);
    uncross(tool, mesh, options, place);
    if (dim == 3) {
        print_triangles(file, mesh, options, place);
    } else {
        print_curves(file, mesh, options, place, next);
    }
}

void label_surface_write(const struct tool *tool, const struct label_cells *mesh,
                         const struct label_surface_options *options)
{
    struct output output;
    int64_t count = 0;
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        count += is_chosen(mesh, options, f);
    }
    if (count == 0) {
        tool_fail(tool, STATUS_INPUT, "--surface: these labels do not touch");
    }
    tool_print_to(tool, &output, tool->output);
    print_surface(tool, output.file, mesh, options);
    tool_printed(tool, &output);
}
