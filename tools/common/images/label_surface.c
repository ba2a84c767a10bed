#include "images/label_image.h"

#include "output.h"

#include "base/box.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Where facets meet at an edge, nodes must move farther than the gap, at most by this factor. */
static const double most_stretch = 2;
enum { MOST_HALVINGS = 30 };

void label_surface_parse(const struct tool *tool, const struct label_image *image, const char *text,
                         struct label_surface_options *options)
{
    SCRATCH char *copy = tool_memory(tool, strdup(text));
    char *outer = copy;
    const char *inner = strsep(&outer, "|");
    options->inner = label_image_find(image, inner);
    options->outer = outer == NULL ? -1 : strcmp(outer, "outside") == 0 ? 0 : label_image_find(image, outer);
    if (options->inner < 0 || (outer != NULL && options->outer < 0)) {
        tool_fail(tool, STATUS_INPUT, "--surface: no label '%.60s'", options->inner < 0 ? inner : outer);
    }
}

static bool is_chosen(const struct label_cells *mesh, const struct label_surface_options *options,
                      int64_t facet)
{
    const int32_t *side = mesh->side + 2 * facet;
    return side[0] == options->inner && (options->outer < 0 || side[1] == options->outer);
}

/* Unit outward normal of a facet. */
static void unit_normal(const struct label_cells *mesh, int64_t facet, double normal[3])
{
    int dim = mesh->dim;
    face_area_vector(dim, mesh->x, mesh->facet + facet * dim, normal);
    vector_normalise(dim, normal);
}

/* place[node_count * dim]: nodes of the facets moved outward along the mean normal of the facets there, so
 * far that each of these facets moves by the gap. */
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
            least[n] = fmax(fmin(least[n], cosine), 1 / most_stretch);
        }
    }
    for (int64_t i = 0; i < mesh->node_count * dim; i++) {
        place[i] = mesh->x[i] + options->gap / least[i / dim] * mean[i];
    }
}

/* ---- crossings ---- */

/* A chosen facet: where it begins and ends along x when moved. */
struct span {
    double low, high;
    int64_t facet;
};

static int compare_spans(const void *left, const void *right)
{
    const struct span *a = left, *b = right;
    return a->low != b->low ? (a->low < b->low ? -1 : 1) : (a->facet > b->facet) - (a->facet < b->facet);
}

/* Six times the volume of a tetrahedron (2D: twice the area of the triangle a, b, d). */
static double size_of(int dim, const double *a, const double *b, const double *c, const double *d)
{
    double u[3], v[3], w[3], cross[3];
    vector_subtract(dim, b, a, u);
    vector_subtract(dim, d, a, w);
    if (dim == 2) {
        return u[0] * w[1] - u[1] * w[0];
    }
    vector_subtract(dim, c, a, v);
    vector_cross(u, v, cross);
    return vector_dot(3, cross, w);
}

/* Whether an edge of facet f (2D: the facet) without a node of facet g crosses g. */
static bool goes_through(const struct label_cells *mesh, const double *place, int64_t f, int64_t g)
{
    int dim = mesh->dim;
    const int32_t *edge = mesh->facet + f * dim, *node = mesh->facet + g * dim;
    const double *a = place + node[0] * dim, *b = place + node[1] * dim, *c = place + node[dim - 1] * dim;
    for (int k = 0; k < (dim == 2 ? 1 : 3); k++) {
        const int32_t end[2] = {edge[k], edge[(k + 1) % dim]};
        const double *p = place + end[0] * dim, *q = place + end[1] * dim;
        bool apart = true;
        for (int i = 0; i < 2 * dim; i++) {
            apart = apart && node[i % dim] != end[i / dim];
        }
        if (!apart || !(size_of(dim, a, b, c, p) * size_of(dim, a, b, c, q) < 0)) {
            continue;
        }
        double first = size_of(dim, p, q, a, b), second = size_of(dim, p, q, b, c),
               third = size_of(dim, p, q, c, a);
        if (dim == 2 ? size_of(2, p, q, NULL, a) * size_of(2, p, q, NULL, b) < 0
                     : (first > 0 && second > 0 && third > 0) || (first < 0 && second < 0 && third < 0)) {
            return true;
        }
    }
    return false;
}

/* Whether the boxes around two moved facets overlap. */
static bool boxes_meet(const struct label_cells *mesh, const double *place, int64_t f, int64_t g)
{
    int dim = mesh->dim;
    struct box one = box_of_nodes(dim, place, mesh->facet + f * dim, dim);
    struct box other = box_of_nodes(dim, place, mesh->facet + g * dim, dim);
    bool meet = true;
    for (int d = 0; d < dim; d++) {
        meet = meet && one.low[d] <= other.high[d] && other.low[d] <= one.high[d];
    }
    return meet;
}

/* crosses[node_count]: nodes of moved facets that cross another one, or have turned over. False: none. */
static bool find_crossings(const struct label_cells *mesh, const double *place, int64_t count,
                           struct span *span, bool *crosses)
{
    int dim = mesh->dim;
    bool any = false;
    memset(crosses, 0, (size_t)mesh->node_count * sizeof *crosses);
    for (int64_t s = 0; s < count; s++) {
        const int32_t *node = mesh->facet + span[s].facet * dim;
        struct box box = box_of_nodes(dim, place, node, dim);
        span[s].low = box.low[0];
        span[s].high = box.high[0];
    }
    qsort(span, (size_t)count, sizeof *span, compare_spans);
    for (int64_t s = 0; s < count; s++) {
        int64_t f = span[s].facet;
        double before[3], after[3];
        face_area_vector(dim, mesh->x, mesh->facet + f * dim, before);
        face_area_vector(dim, place, mesh->facet + f * dim, after);
        bool turned = !(vector_dot(dim, before, after) > 0);
        for (int k = 0; k < dim && turned; k++) {
            crosses[mesh->facet[f * dim + k]] = any = true;
        }
        for (int64_t t = s + 1; t < count && span[t].low <= span[s].high; t++) {
            int64_t g = span[t].facet;
            bool through = boxes_meet(mesh, place, f, g) &&
                           (goes_through(mesh, place, f, g) || goes_through(mesh, place, g, f));
            for (int k = 0; k < 2 * dim && through; k++) {
                crosses[mesh->facet[(k < dim ? f : g) * dim + k % dim]] = any = true;
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
    TOOL_SCRATCH(tool, struct span, span, mesh->facet_count);
    TOOL_SCRATCH(tool, bool, crosses, mesh->node_count);
    TOOL_SCRATCH(tool, int, halvings, mesh->node_count);
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        if (is_chosen(mesh, options, f)) {
            span[count++].facet = f;
        }
    }
    for (int round = 0;
         round < MOST_HALVINGS && options->gap > 0 && find_crossings(mesh, place, count, span, crosses);
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
                  "--gap: %lld nodes are moved by less, the first at (%s) mm: the surface would cross itself "
                  "there, as where a furrow is narrower than twice the gap",
                  (long long)nodes, text);
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
    struct target target;
    int64_t count = 0;
    for (int64_t f = 0; f < mesh->facet_count; f++) {
        count += is_chosen(mesh, options, f);
    }
    if (count == 0) {
        tool_fail(tool, STATUS_INPUT, "--surface: these labels do not touch");
    }
    target_open(tool, &target, tool->output);
    print_surface(tool, target.file, mesh, options);
    target_end(tool, &target);
}
