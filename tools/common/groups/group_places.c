/* Terms that choose by position, and by distance from the points or surfaces of a file. */
#include "groups/group_terms.h"

#include "base/box.h"
#include "base/memory.h"
#include "base/options.h"
#include "io/files/surface.h"
#include "io/files/table.h"
#include "base/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Points within this share of the body's diagonal of a shape belong to it, for round-off. */
#define SLACK 1e-9
/* Default distance of corners of facets from a plane, as a share of the diagonal. */
#define FLATNESS 1e-6

/* ---- arguments ---- */

enum status term_numbers(const struct term *term, int least, int most, const char *form, double values[],
                         int *count)
{
    enum status status =
        parse_double_list(term->arguments, term->text, -DBL_MAX, DBL_MAX, most, values, count, term->error);
    if (status != STATUS_OK || *count < least) {
        return fail(term->error, STATUS_INPUT, "%.100s: takes the numbers %s", term->text, form);
    }
    return STATUS_OK;
}

void term_scale(int count, double values[], double unit)
{
    for (int i = 0; i < count; i++) {
        values[i] *= unit;
    }
}

enum status term_check_direction(const struct term *term, const double *direction)
{
    double square = vector_dot(term->body->cells.dim, direction, direction);
    if (!(square > 0) || !isfinite(square)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the direction has no length", term->text);
    }
    return STATUS_OK;
}

/* ---- by place ---- */

enum status term_box(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[6];
    int count;
    struct shape shape = {.kind = SHAPE_BOX, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(
        term_numbers(term, 2 * dim, 2 * dim, dim == 2 ? "X0,Y0,X1,Y1" : "X0,Y0,Z0,X1,Y1,Z1", values, &count));
    term_scale(count, values, term->unit);
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

enum status term_ball(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[4];
    int count;
    struct shape shape = {.kind = SHAPE_BALL, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(
        term_numbers(term, dim + 1, dim + 1, dim == 2 ? "X,Y,RADIUS" : "X,Y,Z,RADIUS", values, &count));
    term_scale(count, values, term->unit);
    memcpy(shape.a, values, (size_t)dim * sizeof *values);
    shape.size = values[dim];
    if (!(shape.size > 0)) {
        return fail(term->error, STATUS_INPUT, "%.100s: the radius is not positive", term->text);
    }
    items_in_shape(&term->body->items[term->kind], &shape, term->chosen);
    return STATUS_OK;
}

/* half:POINT,NORMAL and plane:POINT,NORMAL[,DISTANCE] */
enum status term_plane(const struct term *term)
{
    int dim = term->body->cells.dim;
    double values[7];
    int count;
    bool half = term->text[0] == 'h';
    struct shape shape = {.kind = half ? SHAPE_HALF : SHAPE_PLANE, .slack = SLACK * term->body->diagonal};
    RETURN_IF_ERROR(term_numbers(term, 2 * dim, 2 * dim + !half,
                                 half ? (dim == 2 ? "X,Y,NX,NY" : "X,Y,Z,NX,NY,NZ")
                                      : (dim == 2 ? "X,Y,NX,NY[,DISTANCE]" : "X,Y,Z,NX,NY,NZ[,DISTANCE]"),
                                 values, &count));
    for (int k = 0; k < dim; k++) {
        shape.a[k] = values[k] * term->unit;
        shape.b[k] = values[dim + k];
    }
    RETURN_IF_ERROR(term_check_direction(term, shape.b));
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

/* low:AXIS,PART% and high:AXIS,PART%: all within a share of the body's box from one of its ends. */
enum status term_end(const struct term *term)
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
enum status term_near(const struct term *term)
{
    int dim = term->body->cells.dim;
    bool surface = term->text[0] == 'a';
    FREED_BY(table_free) struct table table = {0};
    struct pieces pieces = {.dim = dim, .corners = surface ? dim : 1};
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
            x[i] *= term->unit;
        }
    }
    pieces.x = x;
    return items_near(&term->body->items[term->kind], &pieces, reach * term->unit, term->chosen, term->error);
}
