#include "base/round_off.h"
#include "base/sets.h"
#include "solid/incision/incision_private.h"

/* A node on a face of an earlier cut along which the blade goes, to this cosine, is on the blade within this
 * share of its longest edge: a cut goes on from its edge, although a deformed body, or a blade that has
 * moved, is off it a little. */
static const double along_face = 0.87, near_face = 0.4;

/* ---- values at nodes ---- */

static void cut_free(struct cut *cut)
{
    FREE_ALL(cut->value[0], cut->value[1], cut->shortest, cut->longest, cut->face_normal, cut->face);
}

/* The faces of a cut that is continued. */
static enum status find_lips(struct cut *cut, int32_t front, int32_t back, struct error *error)
{
    const struct division *body = cut->body;
    int dim = body->dim;
    RETURN_IF_ERROR(NEW_ARRAY(&cut->face_normal, body->node_count * dim, error));
    for (int64_t f = 0; f < body->facet_count; f++) {
        double normal[3], way = body->group[f] == front ? 1.0 : body->group[f] == back ? -1.0 : 0.0;
        face_area_vector(dim, body->at, body->facet + f * dim, normal);
        for (int k = 0; k < dim; k++) {
            add_scaled(dim, way, normal, cut->face_normal + (int64_t)body->facet[f * dim + k] * dim);
        }
    }
    cut->old = body->node_count;
    for (int64_t n = 0; n < cut->old; n++) {
        vector_normalise(dim, cut->face_normal + n * dim);
    }
    return STATUS_OK;
}

static void measure_edges(struct cut *cut)
{
    const struct division *body = cut->body;
    int dim = body->dim, corners = dim + 1;
    for (int64_t n = 0; n < body->node_count; n++) {
        cut->shortest[n] = INFINITY;
        cut->longest[n] = 0.0;
    }
    for (int64_t i = 0; i < body->cell_count * corners; i++) {
        const int32_t *node = body->node + i / corners * corners;
        int32_t a = body->node[i];
        for (int k = 0; k < corners; k++) {
            double length =
                vector_distance(dim, body->at + (int64_t)a * dim, body->at + (int64_t)node[k] * dim);
            if (node[k] != a) {
                cut->shortest[a] = fmin(cut->shortest[a], length);
                cut->longest[a] = fmax(cut->longest[a], length);
            }
        }
    }
}

void cut_lay(struct cut *cut, int64_t n)
{
    struct sheet_place place;
    bool near = sheet_at(cut->sheet, cut->body->at + n * cut->body->dim, INFINITY, &place);
    double extent = near ? sheet_extent(cut->sheet, &place) : NAN;
    cut->value[LEVEL_HEIGHT][n] = 0.0;
    cut->value[LEVEL_EXTENT][n] = fabs(extent) <= COARSE_ROUND_OFF * cut->longest[n] ? 0.0 : extent;
}

/* Evaluate a node by its place. */
static void evaluate_node(struct cut *cut, int64_t n)
{
    struct sheet_place place;
    double reach = 1.5 * cut->longest[n];
    bool near = sheet_at(cut->sheet, cut->body->at + n * cut->body->dim, reach, &place);
    double least = COARSE_ROUND_OFF * cut->longest[n];
    int dim = cut->body->dim;
    if (near && n < cut->old &&
        fabs(vector_dot(dim, cut->face_normal + n * dim, place.normal)) > along_face) {
        least = near_face * cut->longest[n];
    }
    cut->value[LEVEL_HEIGHT][n] = near ? place.height : NAN;
    cut->value[LEVEL_EXTENT][n] = NAN;
    if (near && fabs(place.height) <= least) {
        cut_lay(cut, n);
    }
}

/* Measure edges and evaluate the nodes that have no values yet. */
static enum status cut_evaluate(struct cut *cut, struct error *error)
{
    int64_t needed = cut->body->node_count;
    RETURN_IF_ERROR(RESIZE_ARRAY(&cut->value[0], needed, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&cut->value[1], needed, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&cut->shortest, needed, error));
    RETURN_IF_ERROR(RESIZE_ARRAY(&cut->longest, needed, error));
    measure_edges(cut);
    for (; cut->known < needed; cut->known++) {
        evaluate_node(cut, cut->known);
    }
    return STATUS_OK;
}

/* ---- cells and faces ---- */

static bool cut_is_near(const struct cut *cut, int64_t cell)
{
    int corners = cut->body->dim + 1;
    for (int k = 0; k < corners; k++) {
        if (!isnan(cut->value[LEVEL_HEIGHT][cut->body->node[cell * corners + k]])) {
            return true;
        }
    }
    return false;
}

int cut_side(const struct cut *cut, int64_t cell)
{
    const struct division *body = cut->body;
    int corners = body->dim + 1, side = 0;
    double middle[3], reach = 0.0;
    struct sheet_place place;
    for (int k = 0; k < corners; k++) {
        int32_t node = body->node[cell * corners + k];
        double height = cut->value[LEVEL_HEIGHT][node];
        int own = height > 0 ? 1 : height < 0 ? -1 : 0;
        if (isnan(height) || own * side < 0) {
            return 0;
        }
        side = own != 0 ? own : side;
        reach = fmax(reach, cut->longest[node]);
    }
    if (side != 0) {
        return side;
    }
    vector_middle(body->dim, body->at, corners, body->node + cell * corners, middle);
    return sheet_at(cut->sheet, middle, 2.0 * reach, &place) && place.height < 0 ? -1 : 1;
}

/* List the faces near the sheet. */
static enum status cut_faces(struct cut *cut, struct error *error)
{
    const struct division *body = cut->body;
    int corners = body->dim + 1;
    int64_t cells = 0;
    cut->face_count = 0;
    for (int64_t c = 0; c < body->cell_count; c++) {
        cells += cut_is_near(cut, c);
    }
    RETURN_IF_ERROR(RESIZE_ARRAY(&cut->face, cells * corners, error));
    for (int64_t c = 0; c < body->cell_count; c++) {
        for (int k = 0; k < corners && cut_is_near(cut, c); k++) {
            int32_t face[3];
            simplex_face(body->dim, body->node + c * corners, k, face);
            face_key(body->dim, face, cut->face[cut->face_count].key);
            cut->face[cut->face_count++].item = c * corners + k;
        }
    }
    keyed_sort(cut->face_count, cut->face);
    return STATUS_OK;
}

bool cut_parts(const struct cut *cut, int64_t i)
{
    int corners = cut->body->dim + 1;
    for (int k = 0; k < cut->body->dim; k++) {
        if (cut->value[LEVEL_HEIGHT][cut->face[i].key[k]] != 0.0) {
            return false;
        }
    }
    return cut_side(cut, cut->face[i].item / corners) * cut_side(cut, cut->face[i + 1].item / corners) < 0;
}

/* ---- opening the faces on the blade: nodes doubled, faces of the cut ---- */

/* Whether face i, with the next one, is opened: it is within the border, not all on it. */
static bool is_opened(const struct cut *cut, int64_t i)
{
    bool within = false;
    for (int k = 0; k < cut->body->dim; k++) {
        double extent = cut->value[LEVEL_EXTENT][cut->face[i].key[k]];
        if (!(extent <= 0.0)) {
            return false;
        }
        within = within || extent < 0.0;
    }
    return within && cut_parts(cut, i);
}

struct opening {
    struct cut *cut;
    int8_t *opened; /* cut->face_count: the side, 1 or -1, of the cell of a face that is opened with the next
                       one */
    bool *touched;  /* node_count: node of an opened face */
    int32_t
        *first; /* of each corner, cell * (dim + 1) + k: the first of its node's that stay connected to it */
};

static void opening_free(struct opening *opening)
{
    FREE_ALL(opening->opened, opening->touched, opening->first);
}

static int32_t corner_at(const struct division *body, int64_t cell, int32_t node)
{
    int corners = body->dim + 1, k = 0;
    while (k < corners - 1 && body->node[cell * corners + k] != node) {
        k++;
    }
    return (int32_t)(cell * corners + k);
}

static enum status mark_opened(struct opening *opening, int64_t *count, struct error *error)
{
    const struct cut *cut = opening->cut;
    const struct division *body = cut->body;
    RETURN_IF_ERROR(NEW_ARRAY(&opening->opened, cut->face_count, error));
    RETURN_IF_ERROR(NEW_ARRAY(&opening->touched, body->node_count, error));
    for (int64_t i = 0, end; i < cut->face_count; i = end) {
        end = keyed_end(cut->face_count, cut->face, i);
        if (end - i != 2 || !is_opened(cut, i)) {
            continue;
        }
        opening->opened[i] = (int8_t)cut_side(cut, cut->face[i].item / (body->dim + 1));
        ++*count;
        for (int k = 0; k < body->dim; k++) {
            opening->touched[cut->face[i].key[k]] = true;
        }
    }
    return STATUS_OK;
}

/* Join the corners of touched nodes across the faces that are not opened. */
static enum status join_corners(struct opening *opening, struct error *error)
{
    const struct cut *cut = opening->cut;
    const struct division *body = cut->body;
    int64_t corners = body->cell_count * (body->dim + 1);
    if (corners > INT32_MAX) {
        return fail(error, STATUS_INPUT, "more than %d corners of cells", INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&opening->first, corners, error));
    for (int64_t i = 0; i < corners; i++) {
        opening->first[i] = (int32_t)i;
    }
    for (int64_t i = 0, end; i < cut->face_count; i = end) {
        end = keyed_end(cut->face_count, cut->face, i);
        for (int k = 0; k < body->dim && end - i == 2 && opening->opened[i] == 0; k++) {
            int32_t node = cut->face[i].key[k];
            if (opening->touched[node]) {
                set_join(opening->first, corner_at(body, cut->face[i].item / (body->dim + 1), node),
                         corner_at(body, cut->face[i + 1].item / (body->dim + 1), node));
            }
        }
    }
    return STATUS_OK;
}

/* Give the corners of each touched node that are not connected to its first one copies of it. */
static enum status double_nodes(struct opening *opening, struct error *error)
{
    struct division *body = opening->cut->body;
    int64_t corners = body->cell_count * (body->dim + 1), before = body->node_count;
    NEW_SCRATCH(bool, met, before, error);
    NEW_SCRATCH(int32_t, own, corners, error); /* the node of the first corner of each set */
    for (int64_t i = 0; i < corners; i++) {
        int32_t node = body->node[i], first;
        if (!opening->touched[node]) {
            continue;
        }
        first = set_first(opening->first, (int32_t)i);
        if (first == i) {
            own[i] = node;
            if (met[node]) {
                own[i] = (int32_t)body->node_count;
                RETURN_IF_ERROR(division_add_node(body, node, node, 0.0, error));
            }
            met[node] = true;
        }
    }
    for (int64_t i = 0; i < corners; i++) {
        if (opening->touched[body->node[i]]) {
            body->node[i] = own[set_first(opening->first, (int32_t)i)];
        }
    }
    return STATUS_OK;
}

/* Give the facets with touched nodes the nodes that their cells have got, in the order that they had. */
static void carry_facets(struct opening *opening)
{
    const struct cut *cut = opening->cut;
    struct division *body = cut->body;
    int dim = body->dim;
    for (int64_t f = 0; f < body->facet_count; f++) {
        int32_t key[3], *node = body->facet + f * dim;
        face_key(dim, node, key);
        bool touched = opening->touched[key[0]] || opening->touched[key[1]] || opening->touched[key[dim - 1]];
        int64_t found = touched ? keyed_find(cut->face_count, cut->face, key) : -1;
        const int32_t *cell =
            found >= 0 ? body->node + cut->face[found].item / (dim + 1) * (dim + 1) : body->node;
        for (int i = 0; i < dim * (dim + 1) && found >= 0; i++) {
            int32_t other = cell[i % (dim + 1)];
            const int32_t *parent = &body->parent[2 * (int64_t)other];
            if (parent[0] == node[i / (dim + 1)] && parent[1] == parent[0]) {
                node[i / (dim + 1)] = other;
            }
        }
    }
}

static enum status add_lips(struct opening *opening, int32_t front, int32_t back, struct error *error)
{
    const struct cut *cut = opening->cut;
    struct division *body = cut->body;
    int corners = body->dim + 1;
    for (int64_t i = 0; i < cut->face_count; i++) {
        for (int k = 0; k < 2 && opening->opened[i] != 0; k++) {
            int64_t item = cut->face[i + k].item, cell = item / corners;
            int32_t face[3];
            simplex_face(body->dim, body->node + cell * corners, (int)(item % corners), face);
            bool in_front = (opening->opened[i] > 0) == (k == 0);
            RETURN_IF_ERROR(division_add_facet(body, face, in_front ? front : back, error));
        }
    }
    return STATUS_OK;
}

/* ---- the cut ---- */

/* Split the edges where the level is 0; the nodes there are on it. */
static enum status divide_at(struct cut *cut, enum level level, struct error *error)
{
    FREED_BY(crossings_free) struct crossings crossings = {0};
    struct division *body = cut->body;
    int64_t first = body->node_count;
    RETURN_IF_ERROR(cut_faces(cut, error));
    RETURN_IF_ERROR(cut_crossings(cut, level, &crossings, error));
    RETURN_IF_ERROR(cut_snap(cut, level, &crossings, error));
    RETURN_IF_ERROR(cut_crossings(cut, level, &crossings, error));
    NEW_SCRATCH(struct split, split, crossings.count, error);
    for (int64_t i = 0; i < crossings.count; i++) {
        split[i] = crossings.item[i].split;
    }
    RETURN_IF_ERROR(division_split(body, crossings.count, split, error));
    RETURN_IF_ERROR(cut_evaluate(cut, error));
    for (int64_t n = first; n < body->node_count; n++) {
        cut_lay(cut, n);
        if (level == LEVEL_EXTENT) {
            cut->value[level][n] = crossings.item[n - first].extent;
        }
    }
    return cut_faces(cut, error);
}

enum status incision_cut(struct division *body, const struct sheet *sheet, int32_t front, int32_t back,
                         int64_t *opened, struct error *error)
{
    FREED_BY(cut_free) struct cut cut = {.body = body, .sheet = sheet};
    RETURN_IF_ERROR(find_lips(&cut, front, back, error));
    RETURN_IF_ERROR(cut_evaluate(&cut, error));
    RETURN_IF_ERROR(divide_at(&cut, LEVEL_HEIGHT, error));
    RETURN_IF_ERROR(divide_at(&cut, LEVEL_EXTENT, error));
    FREED_BY(opening_free) struct opening opening = {.cut = &cut};
    *opened = 0;
    RETURN_IF_ERROR(mark_opened(&opening, opened, error));
    RETURN_IF_ERROR(join_corners(&opening, error));
    RETURN_IF_ERROR(double_nodes(&opening, error));
    carry_facets(&opening);
    return add_lips(&opening, front, back, error);
}
