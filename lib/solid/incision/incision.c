#include "base/round_off.h"
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
    return cut_open(&cut, front, back, opened, error);
}
