#include "groups/group_terms.h"

#include "approx/cells/parts.h"
#include "base/memory.h"
#include "base/vector.h"

#include <math.h>
#include <string.h>

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

static enum status choose_all(const struct term *term)
{
    for (int64_t i = 0; i < term->body->items[term->kind].count; i++) {
        term->chosen[i] = true;
    }
    return STATUS_OK;
}

/* Choose the whole boundary, or the nodes on it. */
static enum status choose_boundary(const struct term *term)
{
    SCRATCH bool *facets = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&facets, term->body->boundary.count, term->error));
    memset(facets, true, (size_t)term->body->boundary.count * sizeof *facets);
    return choose_by(term, GROUP_FACETS, facets);
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
    double values[4];
    int count;
    SCRATCH bool *facing = NULL;
    RETURN_IF_ERROR(term_numbers(term, dim + 1, dim + 1, dim == 2 ? "NX,NY,DEGREES" : "NX,NY,NZ,DEGREES",
                                 values, &count));
    RETURN_IF_ERROR(term_check_direction(term, values));
    RETURN_IF_ERROR(check_degrees(term, values[dim]));
    RETURN_IF_ERROR(NEW_ARRAY(&facing, term->body->boundary.count, term->error));
    items_facing(&term->body->items[GROUP_FACETS], values, values[dim], facing);
    return choose_by(term, GROUP_FACETS, facing);
}

/* The item whose centre is nearest to a point. */
static int64_t nearest(const struct items *items, const double *point)
{
    int64_t best = 0;
    double least = INFINITY;
    for (int64_t i = 0; i < items->count; i++) {
        double centre[3];
        item_centre(items, i, centre);
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
    const char *form =
        side ? (dim == 2 ? "K,DEGREES or X,Y,DEGREES" : "K,DEGREES or X,Y,Z,DEGREES") : "K or a point";
    double values[4];
    int count;
    int32_t parts;
    SCRATCH int32_t *part = NULL;
    SCRATCH bool *in = NULL;
    RETURN_IF_ERROR(term_numbers(term, 1 + side, dim + side, form, values, &count));
    if (count != 1 + side && count != dim + side) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes the numbers %s", term->text, form);
    }
    double degrees = side ? values[count - 1] : 0;
    RETURN_IF_ERROR(check_degrees(term, degrees));
    RETURN_IF_ERROR(NEW_ARRAY(&part, items->count, term->error));
    RETURN_IF_ERROR(NEW_ARRAY(&in, items->count, term->error));
    RETURN_IF_ERROR(side ? boundary_sides(body->cells.x, &body->boundary, degrees, part, &parts, term->error)
                         : cells_parts(&body->cells, part, &parts, term->error));
    bool by_point = count == dim + side;
    if (!by_point && !(values[0] >= 1 && values[0] <= parts && values[0] == floor(values[0]))) {
        return fail(term->error, STATUS_INPUT, "%.100s: there are %d, counted from 1", term->text, parts);
    }
    term_scale(by_point ? dim : 0, values, term->unit);
    int32_t wanted = by_point ? part[nearest(items, values)] : (int32_t)values[0] - 1;
    for (int64_t i = 0; i < items->count; i++) {
        in[i] = part[i] == wanted;
    }
    return choose_by(term, side ? GROUP_FACETS : GROUP_REGION, in);
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

/* Choose by the items of a group of kind `from`. */
static enum status choose_named(const struct term *term, enum group_kind from, const char *name)
{
    const struct group_list *list = &term->body->groups[from];
    const struct items *items = &term->body->items[from];
    int64_t place = group_find(list, name);
    SCRATCH bool *in = NULL;
    if (place < 0) {
        return fail_unknown(term, from);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&in, items->count, term->error));
    for (int64_t i = 0; i < list->group[place].count; i++) {
        in[list->group[place].item[i]] = true;
    }
    return choose_by(term, from, in);
}

enum status group_term(const struct group_body *body, enum group_kind kind, const char *text, double unit,
                       bool *chosen, struct error *error)
{
    static const struct {
        const char *name;
        enum status (*choose)(const struct term *term);
    } terms[] = {{"box", term_box},     {"ball", term_ball},  {"half", term_plane},
                 {"plane", term_plane}, {"low", term_end},    {"high", term_end},
                 {"near", term_near},   {"along", term_near}, {"normal", choose_normal},
                 {"side", choose_part}, {"body", choose_part}};
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
