/* A small mesh as the bytes of a file, in every version, as text and binary: a square of 2 mm x 1 mm of two
 * triangles in "body", its lower edge "bottom", its lower left point "corner", and a node of no cell. Tags
 * have gaps. */
#pragma once

#include "unit.h"

#include <stdio.h>

struct fixture {
    bool msh4;
    bool binary;
    size_t size;
    char bytes[8192];
};

enum { FIXTURE_NODES = 5, FIXTURE_ELEMENTS = 4, FIXTURE_FORMS = 4 };

static const int fixture_node_tags[FIXTURE_NODES] = {1, 2, 4, 7, 9};
static const double fixture_points[FIXTURE_NODES][3] = {
    {0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}, {5, 5, 0}};

/* type, dim, group, nodes; the element tags are 11, 12, ... */
static const int fixture_elements[FIXTURE_ELEMENTS][6] = {
    {15, 0, 5, 1, 0, 0}, {1, 1, 3, 1, 2, 0}, {2, 2, 2, 1, 2, 4}, {2, 2, 2, 1, 4, 7}};

static void put_text(struct fixture *f, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    f->size += (size_t)vsnprintf(f->bytes + f->size, sizeof f->bytes - f->size, format, arguments);
    va_end(arguments);
}

static void put_raw(struct fixture *f, const void *value, size_t size)
{
    memcpy(f->bytes + f->size, value, size);
    f->size += size;
}

static void put_int(struct fixture *f, int32_t value)
{
    if (f->binary) {
        put_raw(f, &value, sizeof value);
    } else {
        put_text(f, "%d ", value);
    }
}

static void put_size(struct fixture *f, int64_t value)
{
    if (f->binary) {
        put_raw(f, &value, sizeof value);
    } else {
        put_text(f, "%lld ", (long long)value);
    }
}

static void put_real(struct fixture *f, double value)
{
    if (f->binary) {
        put_raw(f, &value, sizeof value);
    } else {
        put_text(f, "%.17g ", value);
    }
}

static void put_line_end(struct fixture *f)
{
    if (!f->binary) {
        f->bytes[f->size - 1] = '\n';
    }
}

static void put_entities(struct fixture *f)
{
    static const int groups[4] = {5, 3, 2, 0};
    put_text(f, "$Entities\n");
    for (int dim = 0; dim < 4; dim++) {
        put_size(f, dim < 3);
    }
    put_line_end(f);
    for (int dim = 0; dim < 3; dim++) {
        put_int(f, 1);
        for (int k = 0; k < (dim == 0 ? 3 : 6); k++) {
            put_real(f, dim == 0 ? 0 : k < 3 ? 0 : k % 3 == 2 ? 0 : 2);
        }
        put_size(f, 1);
        put_int(f, groups[dim]);
        if (dim == 1) {
            put_size(f, 0);
        } else if (dim == 2) {
            put_size(f, 1);
            put_int(f, 1);
        }
        put_line_end(f);
    }
    put_text(f, "%s$EndEntities\n", f->binary ? "\n" : "");
}

static void put_nodes4(struct fixture *f)
{
    put_size(f, 1);
    put_size(f, FIXTURE_NODES);
    put_size(f, 1);
    put_size(f, 9);
    put_line_end(f);
    put_int(f, 2);
    put_int(f, 1);
    put_int(f, 0);
    put_size(f, FIXTURE_NODES);
    put_line_end(f);
    for (int n = 0; n < FIXTURE_NODES; n++) {
        put_size(f, fixture_node_tags[n]);
        put_line_end(f);
    }
    for (int n = 0; n < FIXTURE_NODES; n++) {
        for (int k = 0; k < 3; k++) {
            put_real(f, fixture_points[n][k]);
        }
        put_line_end(f);
    }
}

static void put_nodes2(struct fixture *f)
{
    put_text(f, "%d\n", FIXTURE_NODES);
    for (int n = 0; n < FIXTURE_NODES; n++) {
        put_int(f, fixture_node_tags[n]);
        for (int k = 0; k < 3; k++) {
            put_real(f, fixture_points[n][k]);
        }
        put_line_end(f);
    }
}

static int fixture_corners(int e)
{
    return fixture_elements[e][1] + 1;
}

static void put_elements4(struct fixture *f)
{
    put_size(f, 3);
    put_size(f, FIXTURE_ELEMENTS);
    put_size(f, 11);
    put_size(f, 14);
    put_line_end(f);
    for (int e = 0; e < FIXTURE_ELEMENTS; e++) {
        const int *element = fixture_elements[e];
        if (e < 3) { /* the last two are one block */
            put_int(f, element[1]);
            put_int(f, 1);
            put_int(f, element[0]);
            put_size(f, e == 2 ? 2 : 1);
            put_line_end(f);
        }
        for (int k = 0; k <= fixture_corners(e); k++) {
            put_size(f, k == 0 ? 11 + e : element[2 + k]);
        }
        put_line_end(f);
    }
}

static void put_elements2(struct fixture *f)
{
    put_text(f, "%d\n", FIXTURE_ELEMENTS);
    for (int e = 0; e < FIXTURE_ELEMENTS; e++) {
        const int *element = fixture_elements[e];
        if (f->binary) {
            put_int(f, element[0]);
            put_int(f, 1);
            put_int(f, 2);
        }
        put_int(f, 11 + e);
        if (!f->binary) {
            put_int(f, element[0]);
            put_int(f, 2);
        }
        put_int(f, element[2]);
        put_int(f, 1);
        for (int k = 0; k < fixture_corners(e); k++) {
            put_int(f, element[3 + k]);
        }
        put_line_end(f);
    }
}

enum { ASCII_22, BINARY_22, ASCII_41, BINARY_41 };

/* The file in one of these FIXTURE_FORMS forms. */
static struct fixture fixture_make(int form)
{
    struct fixture f = {.msh4 = form >= ASCII_41, .binary = form == BINARY_22 || form == BINARY_41};
    const char *raw_end = f.binary ? "\n" : "";
    put_text(&f, "$MeshFormat\n%s %d 8\n", f.msh4 ? "4.1" : "2.2", f.binary);
    if (f.binary) {
        put_int(&f, 1);
        put_text(&f, "\n");
    }
    put_text(&f, "$EndMeshFormat\n$PhysicalNames\n3\n0 5 \"corner\"\n1 3 \"bottom\"\n2 2 "
                 "\"body\"\n$EndPhysicalNames\n");
    if (f.msh4) {
        put_entities(&f);
    }
    put_text(&f, "$Nodes\n");
    (f.msh4 ? put_nodes4 : put_nodes2)(&f);
    put_text(&f, "%s$EndNodes\n$Elements\n", raw_end);
    (f.msh4 ? put_elements4 : put_elements2)(&f);
    put_text(&f, "%s$EndElements\n", raw_end);
    return f;
}

/* The first `from` in the file becomes `to`. True when it was there. */
static inline bool fixture_replace(struct fixture *f, const char *from, const char *to)
{
    char *at = memmem(f->bytes, f->size, from, strlen(from));
    if (at == NULL) {
        return false;
    }
    size_t tail = f->size - (size_t)(at - f->bytes) - strlen(from);
    memmove(at + strlen(to), at + strlen(from), tail);
    memcpy(at, to, strlen(to));
    f->size = f->size - strlen(from) + strlen(to);
    return true;
}
