/* Parts of a label. They only name facets: their rims are lines on the boundary, and there is no interface
 * between them within the body. */
#include "approx/labels/label_cells_private.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

/* A facet that is the only one of its part at a node turns the rim there. If its angle is larger than this,
 * degrees, once the nodes are on the rim, it is too flat for the cell behind it. */
static const double most_angle = 120.0;

static bool is_part_of(const struct label_cells_options *options, int32_t a, int32_t b)
{
    return a != b && options->whole[a] == options->whole[b];
}

/* The facets at each node. */
struct facets_at {
    int64_t *ptr;   /* node_count + 1 */
    int32_t *facet; /* facet_count * dim */
};

/* The largest angle of a facet, degrees, with its corners moved to the line where the labels meet; 180 if a
 * corner cannot be moved there. */
static double angle_on_line(const struct shaping *shaping, int64_t facet, const uint16_t label[3])
{
    const struct label_cells *mesh = shaping->mesh;
    double x[3][3], most = 0.0;
    for (int k = 0; k < 3; k++) {
        int64_t node = mesh->facet[facet * 3 + k];
        memcpy(x[k], mesh->x + node * 3, sizeof x[k]);
        if (!rim_project(shaping, label, x[k])) {
            return 180.0;
        }
    }
    for (int k = 0; k < 3; k++) {
        double one[3], other[3];
        vector_subtract(3, x[(k + 1) % 3], x[k], one);
        vector_subtract(3, x[(k + 2) % 3], x[k], other);
        double lengths = sqrt(vector_dot(3, one, one) * vector_dot(3, other, other));
        most = fmax(most, acos(fmax(-1.0, vector_dot(3, one, other) / lengths)) * 180.0 / M_PI);
    }
    return most;
}

/* The facet that is the only one of its part at a node where the others belong to one other part of the same
 * label; *beyond receives the label of that part. -1: none. */
static int64_t find_lone(const struct label_cells_options *options, const struct label_cells *mesh,
                         const struct facets_at *at, int64_t node, int32_t *beyond)
{
    int64_t first = at->ptr[node], last = at->ptr[node + 1], lone = -1;
    if (last - first < 3) {
        return -1;
    }
    /* At least two of three facets have the label of all but one. */
    int32_t label[3];
    for (int k = 0; k < 3; k++) {
        label[k] = mesh->side[2 * (int64_t)at->facet[first + k]];
    }
    *beyond = label[0] == label[1] ? label[0] : label[2];
    for (int64_t i = first; i < last; i++) {
        int32_t own = mesh->side[2 * (int64_t)at->facet[i]];
        if (own != *beyond && (lone >= 0 || !is_part_of(options, own, *beyond))) {
            return -1;
        }
        lone = own != *beyond ? at->facet[i] : lone;
    }
    return lone;
}

/* Each change replaces two edges of the rim by one, so the loop terminates. */
static void straighten(const struct label_cells_options *options, const struct shaping *shaping,
                       const struct facets_at *at)
{
    struct label_cells *mesh = shaping->mesh;
    bool changes = true;
    while (changes) {
        changes = false;
        for (int64_t n = 0; n < mesh->node_count; n++) {
            int32_t beyond = 0;
            int64_t facet = find_lone(options, mesh, at, n, &beyond);
            if (facet < 0) {
                continue;
            }
            int32_t *side = mesh->side + 2 * facet;
            const uint16_t label[3] = {(uint16_t)side[0], (uint16_t)beyond, (uint16_t)side[1]};
            if (angle_on_line(shaping, facet, label) > most_angle) {
                side[0] = beyond;
                changes = true;
            }
        }
    }
}

/* rim[3]: the two parts whose facets meet at a node, and the label beyond the boundary. */
static void find_rim(const struct label_cells_options *options, const struct label_cells *mesh,
                     const struct facets_at *at, int64_t node, uint16_t rim[3])
{
    for (int64_t i = at->ptr[node]; i < at->ptr[node + 1]; i++) {
        const int32_t *side = mesh->side + 2 * (int64_t)at->facet[i];
        for (int64_t j = at->ptr[node]; j < i; j++) {
            int32_t other = mesh->side[2 * (int64_t)at->facet[j]];
            if (is_part_of(options, side[0], other)) {
                rim[0] = (uint16_t)side[0];
                rim[1] = (uint16_t)other;
                rim[2] = (uint16_t)side[1];
            }
        }
    }
}

enum status label_cells_rims(const struct label_cells_options *options, const struct shaping *shaping,
                             uint16_t (**rim)[3], struct error *error)
{
    struct label_cells *mesh = shaping->mesh;
    enum status status;
    struct facets_at at = {0};
    TRY(NEW_ARRAY(rim, mesh->node_count, error));
    if (options->whole == NULL) {
        goto done;
    }
    TRY(lists_by_row(mesh->facet_count, mesh->dim, mesh->facet, mesh->node_count, &at.ptr, &at.facet, error));
    if (mesh->dim == 3) {
        straighten(options, shaping, &at);
    }
    for (int64_t n = 0; n < mesh->node_count; n++) {
        find_rim(options, mesh, &at, n, (*rim)[n]);
    }
done:
    FREE_ALL(at.ptr, at.facet);
    return status;
}

enum status labels_without_parts(const struct labels *labels, const int32_t *whole, struct labels *result,
                                 struct error *error)
{
    uint16_t *label = NULL;
    bool has_parts = false;
    int64_t count = labels->size[0] * labels->size[1] * labels->size[2];
    *result = *labels;
    for (int32_t l = 0; l < labels->count && whole != NULL; l++) {
        has_parts = has_parts || whole[l] != l;
    }
    if (has_parts) {
        RETURN_IF_ERROR(NEW_ARRAY(&label, count, error));
        for (int64_t v = 0; v < count; v++) {
            label[v] = (uint16_t)whole[labels->label[v]];
        }
        result->label = label;
    }
    return STATUS_OK;
}
