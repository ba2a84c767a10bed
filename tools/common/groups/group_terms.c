/* Terms of the expressions that choose facets, nodes or cells. */
#include "base/round_off.h"
#include "groups/group_body.h"

#include "approx/cells/parts.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/options.h"
#include "base/vector.h"
#include "io/files/surface.h"
#include "io/files/table.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_NUMBERS = 7 };

/* A term, and the input of its evaluation. */
struct term {
    const struct group_body *body;
    enum group_kind kind;
    const char *text;      /* the whole term */
    const char *arguments; /* behind its colon */
    int count;             /* of numbers in the arguments, if these are numbers */
    double value[MOST_NUMBERS];
    double unit; /* m */
    bool *chosen;
    struct error *error;
};

/* Default distance of corners of facets from a plane, as a share of the diagonal. */
#define FLATNESS 1e-6

static enum status check_direction(const struct term *term, const double *direction)
{
    double square = vector_dot(term->body->cells.dim, direction, direction);
    if (!(square > 0) || !isfinite(square)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the direction has no length", term->text);
    }
    return STATUS_OK;
}

/* ---- by place ---- */

/* box:LOW,HIGH, ball:CENTRE,RADIUS, half:POINT,NORMAL and plane:POINT,NORMAL[,DISTANCE] */
static enum status choose_shape(const struct term *term)
{
    int dim = term->body->cells.dim;
    double diagonal = term->body->diagonal;
    enum shape_kind kind = term->text[0] == 'h'   ? SHAPE_HALF
                           : term->text[0] == 'p' ? SHAPE_PLANE
                           : term->text[1] == 'o' ? SHAPE_BOX
                                                  : SHAPE_BALL;
    bool flat = kind == SHAPE_HALF || kind == SHAPE_PLANE,
         sized = kind == SHAPE_BALL || term->count > 2 * dim;
    struct shape shape = {.kind = kind,
                          .size = sized                 ? term->value[term->count - 1] * term->unit
                                  : kind == SHAPE_PLANE ? FLATNESS * diagonal
                                                        : 0,
                          .slack = COARSE_ROUND_OFF * diagonal};
    for (int k = 0; k < dim; k++) {
        shape.a[k] = term->value[k] * term->unit;
        shape.b[k] = term->value[dim + k] * (flat ? 1 : term->unit);
        if (kind == SHAPE_BOX && !(shape.a[k] <= shape.b[k])) {
            return fail(term->error, STATUS_INPUT,
                        "%.100s: the box is inside out along %c: the low corner comes first", term->text,
                        "xyz"[k]);
        }
    }
    RETURN_IF_ERROR(flat ? check_direction(term, shape.b) : STATUS_OK);
    if (!(shape.size >= 0) || (kind == SHAPE_BALL && shape.size == 0)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the %s", term->text,
                    kind == SHAPE_BALL ? "radius is not positive" : "distance is negative");
    }
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

/* low:AXIS,PART% and high:AXIS,PART%: all within a share of the body's box from one of its ends. */
static enum status choose_end(const struct term *term)
{
    static const char *const axes[] = {"x", "y", "z", "long"};
    int dim = term->body->cells.dim;
    bool low = term->text[0] == 'l';
    struct box box = box_of(dim, term->body->cells.node_count, term->body->cells.x);
    struct shape shape = {.kind = SHAPE_HALF, .slack = COARSE_ROUND_OFF * term->body->diagonal};
    struct error why;
    double percent = 0;
    int axis = 4;
    char part[32] = "";
    size_t length = strcspn(term->arguments, ",");
    const char *behind = term->arguments + length + (term->arguments[length] == ',');
    size_t digits = strcspn(behind, "%");
    for (int a = 0; a < 4; a++) {
        bool same = strlen(axes[a]) == length && strncmp(term->arguments, axes[a], length) == 0;
        axis = same && (a < dim || a == 3) ? a : axis;
    }
    memcpy(part, behind, digits < sizeof part ? digits : 0);
    if (axis == 4 || strcmp(behind + digits, "%") != 0 ||
        parse_double(part, "", 0, 100, &percent, &why) != STATUS_OK) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes AXIS,PART%%, such as x,12%%; axes are %slong",
                    term->text, dim == 2 ? "x, y, " : "x, y, z, ");
    }
    if (axis == 3) {
        axis = 0;
        for (int a = 1; a < dim; a++) { /* equal sides differ by round-off: take the first of them */
            bool longer = box.high[a] - box.low[a] > (box.high[axis] - box.low[axis]) * (1 + 1e-6);
            axis = longer ? a : axis;
        }
    }
    double depth = percent / 100 * (box.high[axis] - box.low[axis]);
    shape.a[axis] = low ? box.low[axis] + depth : box.high[axis] - depth;
    shape.b[axis] = low ? -1 : 1;
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

/* ---- by a file ---- */

/* near:DISTANCE,FILE (points) and along:DISTANCE,FILE (a surface) */
static enum status choose_near(const struct term *term)
{
    int dim = term->body->cells.dim;
    bool surface = term->text[0] == 'a';
    FREED_BY(table_free) struct table table = {0};
    struct items pieces = {.dim = dim, .corners = surface ? dim : 1};
    SCRATCH double *x = NULL;
    double reach = 0;
    char number[64] = "";
    struct error why;
    size_t length = strcspn(term->arguments, ",");
    memcpy(number, term->arguments, length < sizeof number ? length : 0);
    if (term->arguments[length] != ',' || term->arguments[length + 1] == '\0' ||
        parse_double(number, "", DBL_MIN, 1e12, &reach, &why) != STATUS_OK) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes DISTANCE,FILE with a positive distance",
                    term->text);
    }
    const char *path = term->arguments + length + 1;
    if (surface) {
        RETURN_IF_ERROR(surface_facets(path, dim, term->unit, &x, &pieces.count, term->error));
    } else {
        RETURN_IF_ERROR(table_read(path, dim, dim, &table, term->error));
        x = array_take(&table.values);
        pieces.count = table.rows;
        for (int64_t i = 0; i < table.rows * dim; i++) {
            x[i] *= table_unit(path, term->unit);
        }
    }
    pieces.x = x;
    return items_near(&term->body->items[term->kind], &pieces, reach * term->unit, term->chosen, term->error);
}

/* ---- items of one kind by those of another ---- */

/* Choose by the items `in` of kind `from`: these items, the nodes of these facets or cells, the facets of
 * these cells, or the facets or cells all of whose nodes are in. Facets choose no cells. */
static enum status choose_by(const struct term *term, enum group_kind from, const bool *in)
{
    const struct group_body *body = term->body;
    const struct items *given = &body->items[from], *wanted = &body->items[term->kind];
    bool *chosen = term->chosen;
    if (from == GROUP_FACETS && term->kind == GROUP_REGION) {
        return fail(term->error, STATUS_INPUT, "%.100s: chooses facets: not for regions", term->text);
    }
    for (int64_t i = 0; i < wanted->count; i++) {
        chosen[i] = from == term->kind ? in[i] : from == GROUP_NODES;
        if (from == GROUP_REGION && term->kind == GROUP_FACETS) {
            chosen[i] = in[body->boundary.cell[2 * i]];
        }
        for (int k = 0; k < wanted->corners && from == GROUP_NODES && from != term->kind; k++) {
            chosen[i] = chosen[i] && in[wanted->item[i * wanted->corners + k]];
        }
    }
    for (int64_t i = 0; i < given->count * given->corners && term->kind == GROUP_NODES; i++) {
        chosen[given->item[i]] |= in[i / given->corners];
    }
    return STATUS_OK;
}

/* ---- by shape of the boundary, and by connection ---- */

static enum status check_degrees(const struct term *term, double degrees)
{
    return degrees >= 0 && degrees <= 180
               ? STATUS_OK
               : fail(term->error, STATUS_INPUT, "%.100s: the angle is not within 0 and 180 degrees",
                      term->text);
}

static enum status choose_normal(const struct term *term)
{
    int dim = term->body->cells.dim;
    RETURN_IF_ERROR(check_direction(term, term->value));
    RETURN_IF_ERROR(check_degrees(term, term->value[dim]));
    NEW_SCRATCH(bool, facing, term->body->boundary.count, term->error);
    items_facing(&term->body->items[GROUP_FACETS], term->value, term->value[dim], facing);
    return choose_by(term, GROUP_FACETS, facing);
}

/* The item whose centre is nearest to a point. */
static int64_t nearest(const struct items *items, const double *point)
{
    int64_t best = 0;
    double least = INFINITY;
    for (int64_t i = 0; i < items->count; i++) {
        double centre[3];
        vector_middle(items->dim, items->x, items->corners, items->item + i * items->corners, centre);
        double square = vector_distance2(items->dim, centre, point);
        if (square < least) {
            least = square;
            best = i;
        }
    }
    return best;
}

/* side:K,DEGREES, side:POINT,DEGREES, body:K, body:POINT */
static enum status choose_part(const struct term *term)
{
    const struct group_body *body = term->body;
    int dim = body->cells.dim;
    bool side = term->text[0] == 's';
    const struct items *items = &body->items[side ? GROUP_FACETS : GROUP_REGION];
    bool by_point = term->count == dim + side;
    double point[3];
    int32_t parts;
    double degrees = side ? term->value[term->count - 1] : 0, number = term->value[0];
    RETURN_IF_ERROR(check_degrees(term, degrees));
    NEW_SCRATCH(int32_t, part, items->count, term->error);
    NEW_SCRATCH(bool, in, items->count, term->error);
    RETURN_IF_ERROR(side ? boundary_sides(body->cells.x, &body->boundary, degrees, part, &parts, term->error)
                         : cells_parts(&body->cells, part, &parts, term->error));
    if (!by_point && !(number >= 1 && number <= parts && number == floor(number))) {
        return fail(term->error, STATUS_INPUT, "%.100s: there are %d, counted from 1", term->text, parts);
    }
    for (int k = 0; k < dim; k++) {
        point[k] = term->value[k] * term->unit;
    }
    int32_t wanted = by_point ? part[nearest(items, point)] : (int32_t)number - 1;
    for (int64_t i = 0; i < items->count; i++) {
        in[i] = part[i] == wanted;
    }
    return choose_by(term, side ? GROUP_FACETS : GROUP_REGION, in);
}

/* ---- by name ---- */

/* Choose by the items of a group of kind `from`. */
static enum status choose_named(const struct term *term, enum group_kind from, const char *name)
{
    const struct group_list *list = &term->body->groups[from];
    const struct items *items = &term->body->items[from];
    int64_t place = names_find(&list->names, name);
    if (place < 0) {
        return fail(term->error, STATUS_INPUT,
                    "'%.60s' is no term of -h, and no name of %s; there are: %.256s", term->text,
                    group_kind_names[from], list->names.count > 0 ? list->names.list : "none");
    }
    NEW_SCRATCH(bool, in, items->count, term->error);
    for (int64_t i = 0; i < list->count; i++) {
        in[list->member[i].item] |= list->member[i].group == place;
    }
    return choose_by(term, from, in);
}

/* Terms KIND:ARGUMENTS. Numbers in their arguments: `axes` for each axis and `more`; one more if it is
 * optional; or one in place of those for the axes. */
static const struct {
    const char *name;
    enum status (*choose)(const struct term *term);
    int axes, more;
    const char *forms[2]; /* in 2D and 3D, for messages; NULL: other arguments */
    bool optional, by_number;
} terms[] = {
    {"box", choose_shape, 2, 0, {"X0,Y0,X1,Y1", "X0,Y0,Z0,X1,Y1,Z1"}, false, false},
    {"ball", choose_shape, 1, 1, {"X,Y,RADIUS", "X,Y,Z,RADIUS"}, false, false},
    {"half", choose_shape, 2, 0, {"X,Y,NX,NY", "X,Y,Z,NX,NY,NZ"}, false, false},
    {"plane", choose_shape, 2, 0, {"X,Y,NX,NY[,DISTANCE]", "X,Y,Z,NX,NY,NZ[,DISTANCE]"}, true, false},
    {"normal", choose_normal, 1, 1, {"NX,NY,DEGREES", "NX,NY,NZ,DEGREES"}, false, false},
    {"side", choose_part, 1, 1, {"K,DEGREES or X,Y,DEGREES", "K,DEGREES or X,Y,Z,DEGREES"}, false, true},
    {"body", choose_part, 1, 0, {"K or a point", "K or a point"}, false, true},
    {"low", choose_end, 0, 0, {NULL}, false, false},
    {"high", choose_end, 0, 0, {NULL}, false, false},
    {"near", choose_near, 0, 0, {NULL}, false, false},
    {"along", choose_near, 0, 0, {NULL}, false, false}};
enum { TERMS = sizeof terms / sizeof *terms };

static enum status choose_term(struct term *term, int t)
{
    int dim = term->body->cells.dim, count = terms[t].axes * dim + terms[t].more;
    const char *form = terms[t].forms[dim - 2];
    if (form != NULL) {
        enum status status = parse_double_list(term->arguments, term->text, -DBL_MAX, DBL_MAX, MOST_NUMBERS,
                                               term->value, &term->count, term->error);
        bool fits = term->count == count || (terms[t].optional && term->count == count + 1) ||
                    (terms[t].by_number && term->count == 1 + terms[t].more);
        if (status != STATUS_OK || !fits) {
            return fail(term->error, STATUS_INPUT, "%.100s: takes the numbers %s", term->text, form);
        }
    }
    return terms[t].choose(term);
}

enum status group_term(const struct group_body *body, enum group_kind kind, const char *text, double unit,
                       bool *chosen, struct error *error)
{
    size_t length = strcspn(text, ":");
    struct term term = {
        .body = body, .kind = kind, .text = text, .unit = unit, .chosen = chosen, .error = error};
    term.arguments = text + length + (text[length] == ':');
    if (strcmp(text, "all") == 0) {
        memset(chosen, true, (size_t)body->items[kind].count * sizeof *chosen);
        return STATUS_OK;
    }
    if (strcmp(text, "boundary") == 0) {
        NEW_SCRATCH(bool, facets, body->boundary.count, error);
        memset(facets, true, (size_t)body->boundary.count * sizeof *facets);
        return choose_by(&term, GROUP_FACETS, facets);
    }
    if (text[length] != ':') {
        return choose_named(&term, kind, text);
    }
    for (int t = 0; t < TERMS; t++) {
        if (strlen(terms[t].name) == length && strncmp(text, terms[t].name, length) == 0) {
            return choose_term(&term, t);
        }
    }
    for (int from = 0; from < GROUP_KINDS; from++) {
        if (strlen(group_kind_names[from]) == length && strncmp(text, group_kind_names[from], length) == 0) {
            return choose_named(&term, (enum group_kind)from, term.arguments);
        }
    }
    return fail(error, STATUS_INPUT, "'%.60s' is no term: see -h", text);
}
