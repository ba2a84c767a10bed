#include "group_select.h"

#include "approx/parts.h"
#include "base/box.h"
#include "base/memory.h"
#include "base/options.h"
#include "io/surface.h"
#include "io/table.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points on the boundary of a shape belong to it, whatever the round-off: this part of the body's diagonal.
 */
#define SLACK 1e-9
/* How far corners of facets may lie from their plane by default. */
#define FLATNESS 1e-6

/* What a term is evaluated with. */
struct term {
    const struct group_body *body;
    enum group_kind kind;
    const char *text;      /* the whole term */
    const char *arguments; /* behind its colon */
    double unit;           /* m */
    bool *chosen;
    struct error *error;
};

/* ---- arguments ---- */

/* Between `least` and `most` numbers. */
static enum status take_numbers(const struct term *term, int least, int most, const char *form,
                                double values[], int *count)
{
    enum status status =
        parse_double_list(term->arguments, term->text, -DBL_MAX, DBL_MAX, most, values, count, term->error);
    if (status != STATUS_OK || *count < least) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes the numbers %s", term->text, form);
    }
    return STATUS_OK;
}

static void scale(int count, double values[], double unit)
{
    for (int i = 0; i < count; i++) {
        values[i] *= unit;
    }
}

/* A direction has a length. */
static enum status check_direction(const struct term *term, const double *direction)
{
    double square = 0;
    for (int k = 0; k < term->body->cells.dim; k++) {
        square += direction[k] * direction[k];
    }
    if (!(square > 0) || !isfinite(square)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the direction has no length", term->text);
    }
    return STATUS_OK;
}

static enum status check_degrees(const struct term *term, double degrees)
{
    return degrees >= 0 && degrees <= 180
               ? STATUS_OK
               : fail(term->error, STATUS_INPUT, "%.100s: the angle is not within 0 and 180 degrees",
                      term->text);
}

/* Terms of the boundary go with facets, and with nodes: those of such facets. */
static enum status choose_by_facets(const struct term *term, const bool *facets)
{
    const struct faces *boundary = &term->body->boundary;
    if (term->kind == GROUP_REGION) {
        return fail(term->error, STATUS_INPUT, "%.100s: chooses facets: not for regions", term->text);
    }
    memset(term->chosen, 0, (size_t)term->body->items[term->kind].count * sizeof *term->chosen);
    for (int64_t f = 0; f < boundary->count; f++) {
        if (term->kind == GROUP_FACETS) {
            term->chosen[f] = facets[f];
        }
        for (int k = 0; k < boundary->dim && facets[f] && term->kind == GROUP_NODES; k++) {
            term->chosen[boundary->node[f * boundary->dim + k]] = true;
        }
    }
    return STATUS_OK;
}

/* Terms of cells go with all kinds: facets and nodes of such cells. */
static void choose_by_cells(const struct term *term, const bool *cells)
{
    const struct group_body *body = term->body;
    int corners = body->cells.dim + 1;
    memset(term->chosen, 0, (size_t)body->items[term->kind].count * sizeof *term->chosen);
    for (int64_t c = 0; c < body->cells.count && term->kind != GROUP_FACETS; c++) {
        if (term->kind == GROUP_REGION) {
            term->chosen[c] = cells[c];
        }
        for (int k = 0; k < corners && cells[c] && term->kind == GROUP_NODES; k++) {
            term->chosen[body->cells.node[c * corners + k]] = true;
        }
    }
    for (int64_t f = 0; f < body->boundary.count && term->kind == GROUP_FACETS; f++) {
        term->chosen[f] = cells[body->boundary.cell[2 * f]];
    }
}

/* ---- by place ---- */

static enum status choose_all(const struct term *term)
{
    for (int64_t i = 0; i < term->body->items[term->kind].count; i++) {
        term->chosen[i] = true;
    }
    return STATUS_OK;
}

/* The whole boundary: of nodes those on it. */
static enum status choose_boundary(const struct term *term)
{
    enum status status;
    bool *facets = NULL;
    TRY(NEW_ARRAY(&facets, term->body->boundary.count, term->error));
    memset(facets, true, (size_t)term->body->boundary.count * sizeof *facets);
    TRY(choose_by_facets(term, facets));
done:
    free(facets);
    return status;
}

static enum status choose_box(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[6];
    int count;
    struct shape shape = {.kind = SHAPE_BOX, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(
        take_numbers(term, 2 * dim, 2 * dim, dim == 2 ? "X0,Y0,X1,Y1" : "X0,Y0,Z0,X1,Y1,Z1", values, &count));
    scale(count, values, term->unit);
    for (int k = 0; k < dim; k++) {
        shape.a[k] = values[k];
        shape.b[k] = values[dim + k];
        if (!(shape.a[k] <= shape.b[k])) {
            return fail(term->error, STATUS_INPUT,
                        "%.100s: the box is inside out along %c: the low corner comes first", term->text,
                        "xyz"[k]);
        }
    }
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

static enum status choose_ball(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[4];
    int count;
    struct shape shape = {.kind = SHAPE_BALL, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(
        take_numbers(term, dim + 1, dim + 1, dim == 2 ? "X,Y,RADIUS" : "X,Y,Z,RADIUS", values, &count));
    scale(count, values, term->unit);
    memcpy(shape.a, values, (size_t)dim * sizeof *values);
    shape.size = values[dim];
    if (!(shape.size > 0)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the radius is not positive", term->text);
    }
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

/* half:POINT,NORMAL and plane:POINT,NORMAL[,DISTANCE] */
static enum status choose_plane(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[7];
    int count;
    bool half = term->text[0] == 'h';
    struct shape shape = {.kind = half ? SHAPE_HALF : SHAPE_PLANE, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(take_numbers(term, 2 * dim, 2 * dim + !half,
                                 half ? (dim == 2 ? "X,Y,NX,NY" : "X,Y,Z,NX,NY,NZ")
                                      : (dim == 2 ? "X,Y,NX,NY[,DISTANCE]" : "X,Y,Z,NX,NY,NZ[,DISTANCE]"),
                                 values, &count));
    for (int k = 0; k < dim; k++) {
        shape.a[k] = values[k] * term->unit;
        shape.b[k] = values[dim + k];
    }
    RETURN_IF_ERROR(check_direction(term, shape.b));
    shape.size = half ? 0 : FLATNESS * term->body->diagonal;
    if (count > 2 * dim) {
        shape.size = values[2 * dim] * term->unit;
        if (!(shape.size >= 0)) {
            return fail(term->error, STATUS_INPUT, "%.100s: the distance is negative", term->text);
        }
    }
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

/* low:AXIS,PART% and high:AXIS,PART%: everything within a part of the body's box from one of its ends. */
static enum status choose_end(const struct term *term)
{
    static const char *const axes[] = {"x", "y", "z", "long"};
    int dim = term->body->cells.dim;
    bool low = term->text[0] == 'l';
    struct box box = box_of(dim, term->body->cells.node_count, term->body->cells.x);
    struct shape shape = {.kind = SHAPE_HALF, .slack = SLACK * term->body->diagonal};
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
        for (int a = 1; a < dim; a++) { /* equal sides differ by round-off: the first of them */
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

/* Segments between the rows of each block. */
static enum status table_segments(const struct table *table, struct pieces *pieces, double **x,
                                  struct error *error)
{
    RETURN_IF_ERROR(NEW_ARRAY(x, (table->rows - table->block_count) * 4, error));
    for (int64_t b = 0; b < table->block_count; b++) {
        for (int64_t r = table->block_ptr[b]; r + 1 < table->block_ptr[b + 1]; r++) {
            memcpy(*x + 4 * pieces->count++, table->values + 2 * r, 4 * sizeof **x);
        }
    }
    return STATUS_OK;
}

/* near:DISTANCE,FILE (points) and along:DISTANCE,FILE (a surface) */
static enum status choose_near(const struct term *term)
{
    enum status status;
    int dim = term->body->cells.dim;
    bool surface = term->text[0] == 'a';
    struct table table = {0};
    struct pieces pieces = {.dim = dim, .corners = surface ? dim : 1};
    double *x = NULL;
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
    TRY(surface ? surface_read(path, dim, &table, term->error)
                : table_read(path, dim, dim, &table, term->error));
    for (int64_t i = 0; i < table.rows * table.cols; i++) {
        table.values[i] *= term->unit;
    }
    pieces.count = table.rows;
    pieces.x = table.values;
    if (surface && dim == 2) {
        pieces.count = 0;
        TRY(table_segments(&table, &pieces, &x, term->error));
        pieces.x = x;
    }
    TRY(items_near(&term->body->items[term->kind], &pieces, reach * term->unit, term->chosen, term->error));
done:
    free(x);
    table_free(&table);
    return status;
}

/* ---- by shape of the boundary, and by connection ---- */

static enum status choose_normal(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[4];
    int count;
    bool *facing = NULL;
    enum status status;
    TRY(take_numbers(term, dim + 1, dim + 1, dim == 2 ? "NX,NY,DEGREES" : "NX,NY,NZ,DEGREES", values,
                     &count));
    TRY(check_direction(term, values));
    TRY(check_degrees(term, values[dim]));
    TRY(NEW_ARRAY(&facing, term->body->boundary.count, term->error));
    items_facing(&term->body->items[GROUP_FACETS], values, values[dim], facing);
    TRY(choose_by_facets(term, facing));
done:
    free(facing);
    return status;
}

/* The item whose centre is nearest to a point. */
static int64_t nearest(const struct items *items, const double *point)
{
    int64_t best = 0;
    double least = INFINITY;
    for (int64_t i = 0; i < items->count; i++) {
        double centre[3];
        double square = 0;
        item_centre(items, i, centre);
        for (int k = 0; k < items->dim; k++) {
            square += (centre[k] - point[k]) * (centre[k] - point[k]);
        }
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
    const char *form =
        side ? (dim == 2 ? "K,DEGREES or X,Y,DEGREES" : "K,DEGREES or X,Y,Z,DEGREES") : "K or a point";
    double values[4];
    int count;
    int32_t parts;
    int32_t *part = NULL;
    bool *in = NULL;
    enum status status;
    TRY(take_numbers(term, 1 + side, dim + side, form, values, &count));
    if (count != 1 + side && count != dim + side) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes the numbers %s", term->text, form);
    }
    double degrees = side ? values[count - 1] : 0;
    TRY(check_degrees(term, degrees));
    TRY(NEW_ARRAY(&part, items->count, term->error));
    TRY(NEW_ARRAY(&in, items->count, term->error));
    TRY(side ? boundary_sides(body->cells.x, &body->boundary, degrees, part, &parts, term->error)
             : cells_parts(&body->cells, part, &parts, term->error));
    bool by_point = count == dim + side;
    if (!by_point && !(values[0] >= 1 && values[0] <= parts && values[0] == floor(values[0]))) {
        TRY(fail(term->error, STATUS_INPUT, "%.100s: there are %d, counted from 1", term->text, parts));
    }
    scale(by_point ? dim : 0, values, term->unit);
    int32_t wanted = by_point ? part[nearest(items, values)] : (int32_t)values[0] - 1;
    for (int64_t i = 0; i < items->count; i++) {
        in[i] = part[i] == wanted;
    }
    if (side) {
        TRY(choose_by_facets(term, in));
    } else {
        choose_by_cells(term, in);
    }
done:
    free(part);
    free(in);
    return status;
}

/* ---- by name ---- */

static enum status fail_unknown(const struct term *term, enum group_kind kind)
{
    const struct group_list *list = &term->body->groups[kind];
    char names[256] = "";
    for (int64_t g = 0; g < list->count; g++) {
        text_append(names, sizeof names, "%s%s", g == 0 ? "" : ", ", list->group[g].name);
    }
    return fail(term->error, STATUS_INPUT, "'%.60s' is no term of -h, and no name of %s; there are: %s",
                term->text, group_kind_names[kind], list->count > 0 ? names : "none");
}

/* The items of a group of some kind, as items of the kind that is being chosen. */
static enum status choose_named(const struct term *term, enum group_kind from, const char *name)
{
    enum status status;
    const struct group_list *list = &term->body->groups[from];
    const struct items *items = &term->body->items[from];
    int64_t place = group_find(list, name);
    bool *in = NULL;
    if (place < 0) {
        return fail_unknown(term, from);
    }
    TRY(NEW_ARRAY(&in, items->count, term->error));
    for (int64_t i = 0; i < list->group[place].count; i++) {
        in[list->group[place].item[i]] = true;
    }
    if (from == term->kind) {
        memcpy(term->chosen, in, (size_t)items->count * sizeof *in);
    } else if (from == GROUP_FACETS) {
        TRY(choose_by_facets(term, in));
    } else if (from == GROUP_REGION) {
        choose_by_cells(term, in);
    } else { /* of nodes: facets or cells all of whose nodes are in the set */
        const struct items *to = &term->body->items[term->kind];
        for (int64_t i = 0; i < to->count; i++) {
            term->chosen[i] = true;
            for (int k = 0; k < to->corners; k++) {
                term->chosen[i] = term->chosen[i] && in[to->item[i * to->corners + k]];
            }
        }
    }
done:
    free(in);
    return status;
}

enum status group_term(const struct group_body *body, enum group_kind kind, const char *text, double unit,
                       bool *chosen, struct error *error)
{
    static const struct {
        const char *name;
        enum status (*choose)(const struct term *term);
    } terms[] = {{"box", choose_box},     {"ball", choose_ball},  {"half", choose_plane},
                 {"plane", choose_plane}, {"low", choose_end},    {"high", choose_end},
                 {"near", choose_near},   {"along", choose_near}, {"normal", choose_normal},
                 {"side", choose_part},   {"body", choose_part}};
    size_t length = strcspn(text, ":");
    struct term term = {
        .body = body, .kind = kind, .text = text, .unit = unit, .chosen = chosen, .error = error};
    term.arguments = text + length + (text[length] == ':');
    if (strcmp(text, "all") == 0) {
        return choose_all(&term);
    }
    if (strcmp(text, "boundary") == 0) {
        return choose_boundary(&term);
    }
    if (text[length] != ':') {
        return choose_named(&term, kind, text);
    }
    for (size_t i = 0; i < sizeof terms / sizeof *terms; i++) {
        if (strlen(terms[i].name) == length && strncmp(text, terms[i].name, length) == 0) {
            return terms[i].choose(&term);
        }
    }
    for (int from = 0; from < GROUP_KINDS; from++) {
        if (strlen(group_kind_names[from]) == length && strncmp(text, group_kind_names[from], length) == 0) {
            return choose_named(&term, (enum group_kind)from, term.arguments);
        }
    }
    return fail(error, STATUS_INPUT, "'%.60s' is no term: see -h", text);
}
