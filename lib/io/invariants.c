#include "io/invariants_private.h"

#include "io/sections.h"
#include "base/vector.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const double unity_tolerance = 1e-9;

/* Compressed lists: PTR holds the beginnings of the lists in IDX, one list for each row of ROWS_OF; PHI sums
 * to 1 over each; AROUND holds rows of IDX, ascending. */
static const struct list_rule {
    const char *ptr, *idx;
    const char
        *rows_of; /* a section, or "names": the list in the attributes of PTR; NULL: invariants_check_faces */
    const char *phi, *around;
} list_rules[] = {
    {"sets.ptr", "sets.idx", "names", NULL, NULL},
    {"nbr.ptr", "nbr.idx", "points.x", "shape.phi", "nbr.around"},
    {"facepoint.ptr", "facepoint.idx", "facepoints.x", NULL, "facepoint.around"},
    {"face.ptr", "face.idx", NULL, "face.phi", NULL},
    {"boundary.ptr", "boundary.idx", NULL, "boundary.phi", NULL},
    {"node.ptr", "node.idx", "nodes.x", "node.phi", "node.around"},
};

void invariants_violation(struct check *check, const struct section *section, const char *format, ...)
{
    char text[512];
    int length = snprintf(text, sizeof text, "%s: ", section->name);
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text + length, sizeof text - (size_t)length, format, arguments);
    va_end(arguments);
    check->report(check->context, text);
    check->count++;
}

/* Length of the list names=A,B,... ; -1 when there is none. */
static int64_t count_names(const struct section *section)
{
    const char *at = section->attributes;
    if (strncmp(at, "names=", 6) != 0) {
        at = strstr(at, " names=");
        if (at == NULL) {
            return -1;
        }
        at++;
    }
    at += 6;
    int64_t count = *at != '\0' && *at != ' ';
    for (; *at != '\0' && *at != ' '; at++) {
        count += *at == ',';
    }
    return count;
}

/* Rows of the section `other`, or names of `section` itself; -1 when it is absent. */
static int64_t rows_of(const struct check *check, const struct section *section, const char *other)
{
    if (strcmp(other, "names") == 0) {
        return count_names(section);
    }
    const struct section *found = stream_find(check->stream, other);
    return found != NULL ? found->rows : -1;
}

static bool shape_is_right(struct check *check, const struct section *section,
                           const struct section_kind *rule)
{
    int cols = rule->cols == COLS_DIM          ? check->dim
               : rule->cols == COLS_DIM_PLUS_1 ? check->dim + 1
                                               : rule->cols;
    if (section->type != rule->type) {
        invariants_violation(check, section, "type %s instead of %s", element_type_name(section->type),
                             element_type_name(rule->type));
        return false;
    }
    if (section->cols != cols) {
        invariants_violation(check, section, "%" PRId64 " columns instead of %d", section->cols, cols);
        return false;
    }
    int64_t rows = rule->rows_of != NULL ? rows_of(check, section, rule->rows_of) : -1;
    if (rows >= 0 && section->rows != rows) {
        invariants_violation(check, section, "%" PRId64 " rows, but %s has %" PRId64, section->rows,
                             rule->rows_of, rows);
        return false;
    }
    return true;
}

static bool value_is_right(double value, enum content content)
{
    switch (content) {
    case POSITIVE:
        return isfinite(value) && value > 0;
    case AT_LEAST_ONE:
        return isfinite(value) && value >= 1;
    default:
        return isfinite(value);
    }
}

static void check_values(struct check *check, const struct section *section, const struct section_kind *rule)
{
    static const char *const required[] = {
        [FINITE] = "finite", [POSITIVE] = "finite and positive", [AT_LEAST_ONE] = "finite and at least 1"};
    const double *values = section->data;
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (!value_is_right(values[i], rule->content)) {
            invariants_violation(check, section, "row %" PRId64 ": %.17g is not %s", i / section->cols,
                                 values[i], required[rule->content]);
            return;
        }
    }
}

static void check_indices(struct check *check, const struct section *section, const struct section_kind *rule)
{
    const int32_t *values = section->data;
    int64_t bound = rows_of(check, section, rule->index_of);
    int32_t least = rule->content == INDEX_OR_NONE ? -1 : 0;
    if (bound < 0) {
        if (strcmp(rule->index_of, "names") == 0) {
            invariants_violation(check, section, "no attribute names=");
        }
        bound = INT32_MAX;
    }
    for (int64_t i = 0; i < section->rows * section->cols; i++) {
        if (values[i] < least || values[i] >= bound) {
            invariants_violation(check, section,
                                 "row %" PRId64 ": index %d is not within the %" PRId64 " of %s",
                                 i / section->cols, values[i], bound, rule->index_of);
            return;
        }
    }
}

/* Determinant of the edges of a simplex from its first node: dim! times its volume. */
static double simplex_determinant(const double *x, const int32_t *node, int dim)
{
    double edge[3][3];
    for (int i = 0; i < dim; i++) {
        vector_subtract(dim, x + (int64_t)node[i + 1] * dim, x + (int64_t)node[0] * dim, edge[i]);
    }
    return dim == 2 ? determinant2(edge[0], edge[1]) : determinant3(edge[0], edge[1], edge[2]);
}

/* Cells are positively oriented. Called only when nodes.x and the indices are right. */
static void check_volumes(struct check *check, const struct section *cells)
{
    const struct section *nodes = stream_find(check->stream, "nodes.x");
    const int32_t *node = cells->data;
    if (nodes == NULL || nodes->type != TYPE_F8 || nodes->cols != check->dim) {
        return;
    }
    for (int64_t i = 0; i < cells->rows; i++) {
        if (!(simplex_determinant(nodes->data, node + i * cells->cols, check->dim) > 0)) {
            invariants_violation(check, cells, "row %" PRId64 ": no positive volume", i);
            return;
        }
    }
}

/* Every list ascends strictly. */
static void check_ascending(struct check *check, const struct section *ptr, const struct section *idx)
{
    const int64_t *begin = ptr->data;
    const int32_t *index = idx->data;
    for (int64_t row = 0; row + 1 < ptr->rows; row++) {
        for (int64_t i = begin[row] + 1; i < begin[row + 1]; i++) {
            if (index[i - 1] >= index[i]) {
                invariants_violation(check, idx, "list %" PRId64 ": %d does not ascend to %d", row,
                                     index[i - 1], index[i]);
                return;
            }
        }
    }
}

/* Shape functions sum to 1 over every list. */
static void check_unity(struct check *check, const struct section *ptr, const struct section *phi)
{
    const int64_t *begin = ptr->data;
    const double *value = phi->data;
    for (int64_t row = 0; row + 1 < ptr->rows; row++) {
        double sum = 0;
        for (int64_t i = begin[row]; i < begin[row + 1]; i++) {
            sum += value[i];
        }
        if (!(fabs(sum - 1) <= unity_tolerance)) {
            invariants_violation(check, phi, "list %" PRId64 ": sums to 1 %+.3g", row, sum - 1);
            return;
        }
    }
}

/* ptr rises from 0 to the length of idx. */
static bool beginnings_are_right(struct check *check, const struct section *ptr, int64_t length)
{
    const int64_t *begin = ptr->data;
    if (ptr->rows < 1 || begin[0] != 0) {
        invariants_violation(check, ptr, "row 0: does not begin with 0");
        return false;
    }
    for (int64_t row = 0; row + 1 < ptr->rows; row++) {
        if (begin[row] > begin[row + 1]) {
            invariants_violation(check, ptr, "row %" PRId64 ": falls from %" PRId64 " to %" PRId64, row + 1,
                                 begin[row], begin[row + 1]);
            return false;
        }
    }
    if (begin[ptr->rows - 1] != length) {
        invariants_violation(check, ptr, "row %" PRId64 ": ends with %" PRId64 ", the list has %" PRId64,
                             ptr->rows - 1, begin[ptr->rows - 1], length);
        return false;
    }
    return true;
}

/* Rows of a list, ascending. */
static void check_around(struct check *check, const struct section *around, int64_t length)
{
    const int64_t *row = around->data;
    if (around->type != TYPE_I8 || around->cols != 1) {
        invariants_violation(check, around, "%" PRId64 " columns of %s instead of 1 of i8", around->cols,
                             element_type_name(around->type));
        return;
    }
    for (int64_t i = 0; i < around->rows; i++) {
        if (row[i] < (i > 0 ? row[i - 1] + 1 : 0) || row[i] >= length) {
            invariants_violation(check, around,
                                 "row %" PRId64 ": %" PRId64 " is no row of the list, or not ascending", i,
                                 row[i]);
            return;
        }
    }
}

static void check_lists(struct check *check, const struct list_rule *rule)
{
    const struct section *around = rule->around != NULL ? stream_find(check->stream, rule->around) : NULL;
    const struct section *ptr = stream_find(check->stream, rule->ptr);
    const struct section *idx = stream_find(check->stream, rule->idx);
    const struct section *phi = rule->phi != NULL ? stream_find(check->stream, rule->phi) : NULL;
    if (ptr == NULL || idx == NULL) {
        if (ptr != idx) {
            invariants_violation(check, ptr != NULL ? ptr : idx, "stands without %s",
                                 ptr != NULL ? rule->idx : rule->ptr);
        }
        return;
    }
    if (ptr->type != TYPE_I8 || ptr->cols != 1) {
        invariants_violation(check, ptr, "%" PRId64 " columns of %s instead of 1 of i8", ptr->cols,
                             element_type_name(ptr->type));
        return;
    }
    int64_t rows = rule->rows_of != NULL ? rows_of(check, ptr, rule->rows_of) : -1;
    if (rows >= 0 && ptr->rows != rows + 1) {
        invariants_violation(check, ptr, "%" PRId64 " rows, but %s has %" PRId64 ": need one more", ptr->rows,
                             rule->rows_of, rows);
    }
    if (idx->type != TYPE_I4 || idx->cols != 1 || !beginnings_are_right(check, ptr, idx->rows)) {
        return;
    }
    check_ascending(check, ptr, idx);
    if (around != NULL) {
        check_around(check, around, idx->rows);
    }
    if (phi != NULL && phi->type == TYPE_F8 && phi->cols == 1 && phi->rows == idx->rows) {
        check_unity(check, ptr, phi);
    }
}

/* A field at the nodes, of any number of components. */
static void check_field(struct check *check, const struct section *section)
{
    const struct section_kind rule = {"u",    TYPE_F8, (int)section->cols, "nodes.x",
                                      FINITE, NULL,    MADE_WITH_RESULTS};
    if (shape_is_right(check, section, &rule)) {
        check_values(check, section, &rule);
    }
}

/* The dimension that all shapes follow, from the coordinates; 0 when there are none. */
static int find_dimension(struct check *check)
{
    static const char *const coordinates[] = {"nodes.x", "points.x"};
    for (int i = 0; i < 2; i++) {
        const struct section *section = stream_find(check->stream, coordinates[i]);
        if (section != NULL && (section->cols == 2 || section->cols == 3)) {
            return (int)section->cols;
        }
        if (section != NULL) {
            invariants_violation(check, section, "%" PRId64 " columns instead of 2 or 3", section->cols);
        }
    }
    return 0;
}

int64_t stream_check(const struct stream *stream, violation_function *report, void *context)
{
    struct check check = {.stream = stream, .report = report, .context = context};
    check.dim = find_dimension(&check);
    for (int i = 0; i < SECTION_KINDS; i++) {
        const struct section_kind *rule = &section_kinds[i];
        const struct section *section = stream_find(stream, rule->name);
        int64_t before = check.count;
        if (section == NULL || rule->content == ANY || (rule->cols < 0 && check.dim == 0) ||
            !shape_is_right(&check, section, rule)) {
            continue;
        }
        if (rule->type == TYPE_I4) {
            check_indices(&check, section, rule);
            if (strcmp(rule->name, "cells") == 0 && check.count == before) {
                check_volumes(&check, section);
            }
        } else {
            check_values(&check, section, rule);
        }
    }
    for (size_t i = 0; i < sizeof list_rules / sizeof *list_rules; i++) {
        check_lists(&check, &list_rules[i]);
    }
    invariants_check_faces(&check);
    for (int64_t i = 0; i < stream->section_count; i++) {
        const struct section *section = &stream->sections[i];
        if (strcmp(section->name, "u") == 0 || strncmp(section->name, "u.frame.", 8) == 0 ||
            strncmp(section->name, "parameters.frame.", 17) == 0) {
            check_field(&check, section);
        }
    }
    return check.count;
}
