#include "stages.h"

#include "mls_options.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status stream_nodes(const struct stream *stream, int *dim, int64_t *node_count, const double **x,
                         struct error *error)
{
    const struct section *nodes;
    enum status status = stream_need(stream, "nodes.x", TYPE_F8, 0, "nodes", &nodes, error);
    if (status != STATUS_OK) {
        return status;
    }
    if ((nodes->cols != 2 && nodes->cols != 3) || nodes->rows < 1 || nodes->rows > INT32_MAX) {
        return fail(error, STATUS_INPUT,
                    "nodes.x: %lld rows of %lld columns: not a cloud in 2 or 3 dimensions",
                    (long long)nodes->rows, (long long)nodes->cols);
    }
    *dim = (int)nodes->cols;
    *node_count = nodes->rows;
    *x = nodes->data;
    for (int64_t i = 0; i < nodes->rows * nodes->cols; i++) {
        if (!isfinite((*x)[i])) {
            return fail(error, STATUS_INPUT, "nodes.x: row %lld: not a finite coordinate",
                        (long long)(i / nodes->cols));
        }
    }
    return STATUS_OK;
}

enum status stream_cells(const struct stream *stream, bool needed, struct cells *cells, struct error *error)
{
    const struct section *section = stream_find(stream, "cells");
    *cells = (struct cells){0};
    enum status status = stream_nodes(stream, &cells->dim, &cells->node_count, &cells->x, error);
    if (status != STATUS_OK || (section == NULL && !needed)) {
        return status;
    }
    status = stream_need(stream, "cells", TYPE_I4, cells->dim + 1, "nodes", &section, error);
    if (status != STATUS_OK) {
        return status;
    }
    cells->count = section->rows;
    cells->node = section->data;
    return cells_check(cells, error);
}

enum status stream_neighbours(const struct stream *stream, const char *prefix, int64_t rows, int64_t columns,
                              struct neighbours *lists, struct error *error)
{
    char name[64];
    const struct section *ptr, *idx, *widen;
    snprintf(name, sizeof name, "%s.ptr", prefix);
    enum status status = stream_need(stream, name, TYPE_I8, 1, "support", &ptr, error);
    if (status != STATUS_OK) {
        return status;
    }
    snprintf(name, sizeof name, "%s.idx", prefix);
    status = stream_need(stream, name, TYPE_I4, 1, "support", &idx, error);
    if (status != STATUS_OK) {
        return status;
    }
    snprintf(name, sizeof name, "%s.widen", prefix);
    widen = stream_find(stream, name);
    *lists = (struct neighbours){.count = rows, .ptr = ptr->data, .idx = idx->data};
    if (widen != NULL && widen->type == TYPE_F8 && widen->rows == rows) {
        lists->widen = widen->data;
    }
    if (ptr->rows != rows + 1 || lists->ptr[0] != 0 || lists->ptr[rows] != idx->rows) {
        return fail(error, STATUS_INPUT, "%s.ptr: does not fit its points and %s.idx: run support again",
                    prefix, prefix);
    }
    for (int64_t p = 0; p < rows; p++) {
        if (lists->ptr[p + 1] < lists->ptr[p]) {
            return fail(error, STATUS_INPUT, "%s.ptr: row %lld: decreases", prefix, (long long)p + 1);
        }
    }
    for (int64_t i = 0; i < idx->rows; i++) {
        if (lists->idx[i] < 0 || lists->idx[i] >= columns) {
            return fail(error, STATUS_INPUT, "%s.idx: row %lld: no node %d", prefix, (long long)i,
                        lists->idx[i]);
        }
    }
    return STATUS_OK;
}

const char *vector_attributes(int dim, const char *unit, char text[64])
{
    snprintf(text, 64, "unit=%s cols=%s", unit, dim == 2 ? "x,y" : "x,y,z");
    return text;
}

/* A stage that has never run leaves none of its sections. */
static void fill_one(const struct tool *tool, struct stream *stream, const char *stage, char *ran,
                     size_t size)
{
    struct error error;
    enum status status;
    int dim;
    int64_t node_count, unresolved;
    const double *x;
    tool_check(tool, stream_nodes(stream, &dim, &node_count, &x, &error), &error);
    if (strcmp(stage, "ipoints") == 0) {
        struct ipoints_options options = ipoints_defaults();
        status = stage_ipoints(stream, &options, &unresolved, &error);
    } else if (strcmp(stage, "support") == 0) {
        struct support_options options = support_defaults(dim);
        struct support_report report;
        status = stage_support(stream, &options, &report, &error);
    } else {
        struct mls mls;
        status = stage_recorded_mls(stream, dim, &mls, &error);
        if (status == STATUS_OK) {
            status = stage_shapefn(stream, &mls, &error);
        }
    }
    tool_check(tool, status, &error);
    char *argv[] = {(char *)(uintptr_t)stage, NULL};
    tool_check(tool, stream_add_provenance(stream, 1, argv, &error), &error);
    size_t length = strlen(ran);
    snprintf(ran + length, size - length, "%s%s", length > 0 ? ", " : "", stage);
}

void stage_fill(const struct tool *tool, struct stream *stream, const char *upto)
{
    static const char *const stages[] = {"ipoints", "support", "shapefn"};
    static const char *const marks[] = {"points.x", "support.radius", "node.phi"};
    char ran[64] = "";
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        if (stream_find(stream, marks[i]) == NULL) {
            fill_one(tool, stream, stages[i], ran, sizeof ran);
        }
        if (strcmp(stages[i], upto) == 0) {
            break;
        }
    }
    if (ran[0] != '\0') {
        tool_note(tool, "no sections of %s in the input: ran with defaults", ran);
    }
}
