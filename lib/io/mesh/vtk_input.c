/* Unstructured grids of VTK: from arrays to nodes and elements. (Format: VTK File Formats, Kitware; the types
 * of cells: vtkCellType.h.) */
#include "io/mesh/vtk_input.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- arrays ---- */

const struct vtk_type *vtk_find_type(const char *name)
{
    static const struct vtk_type types[] = {
        {"Int8", "char", 1, true, true},      {"UInt8", "unsigned_char", 1, true, false},
        {"Int16", "short", 2, true, true},    {"UInt16", "unsigned_short", 2, true, false},
        {"Int32", "int", 4, true, true},      {"UInt32", "unsigned_int", 4, true, false},
        {"Int64", "long", 8, true, true},     {"UInt64", "unsigned_long", 8, true, false},
        {"Float32", "float", 4, false, true}, {"Float64", "double", 8, false, true},
        {"", "vtktypeint8", 1, true, true},   {"", "vtktypeuint8", 1, true, false},
        {"", "vtktypeint16", 2, true, true},  {"", "vtktypeuint16", 2, true, false},
        {"", "vtktypeint32", 4, true, true},  {"", "vtktypeuint32", 4, true, false},
        {"", "vtktypeint64", 8, true, true},  {"", "vtktypeuint64", 8, true, false},
        {"", "vtkIdType", 4, true, true},     {"String", "string", 0, false, false},
    };
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if ((name[0] != '\0' && strcmp(name, types[i].xml) == 0) || strcasecmp(name, types[i].legacy) == 0) {
            return &types[i];
        }
    }
    return NULL;
}

static bool begins(const char *name, const char *begin)
{
    return strncmp(name, begin, strlen(begin)) == 0;
}

/* The array that is asked for as that of the regions, whose numbers may be of a real type. */
static bool is_asked(const struct msh_reader *r, const struct vtk_array *array)
{
    return array->kind == VTK_OF_CELLS && r->region_array != NULL &&
           strcmp(array->name, r->region_array) == 0;
}

bool vtk_is_wanted(struct vtk_input *v, const struct vtk_array *array, const struct vtk_type *type)
{
    bool any = type->is_whole || (type->size > 0 && is_asked(v->r, array));
    bool whole = any && array->components == 1 && !begins(array->name, "vtk");
    const char *dot = strchr(array->name, '.'); /* of a name that is not empty */
    bool set = (begins(array->name, "set.") || begins(array->name, "facets.")) && dot[1] != '\0';
    bool of_grid = array->kind >= VTK_POINTS && array->kind <= VTK_TYPES;
    bool wanted =
        of_grid || (whole && (array->kind == VTK_OF_CELLS || (array->kind == VTK_OF_POINTS && set) ||
                              (array->kind == VTK_OF_FIELD && begins(array->name, "region."))));
    if (of_grid && (type->size == 0 || type->is_whole == (array->kind == VTK_POINTS))) {
        msh_fail(v->r, "numbers of a type that has no place here");
    } else if (!wanted) {
        input_leave_out(v->r, array->name);
    }
    return wanted;
}

struct vtk_array *vtk_add(struct vtk_input *v, const struct vtk_array *array, int64_t count)
{
    struct msh_reader *r = v->r;
    MSH_GROW(r, &v->arrays, v->count + 1, &v->room);
    if (r->status != STATUS_OK) {
        return NULL;
    }
    struct vtk_array *added = &v->arrays[v->count++];
    *added = *array;
    added->count = count;
    added->real = NULL;
    added->whole = NULL;
    if (array->kind == VTK_POINTS) {
        MSH_NEW(r, &added->real, count);
    } else {
        MSH_NEW(r, &added->whole, count);
    }
    return r->status == STATUS_OK ? added : NULL;
}

/* The whole number in `size` bytes, the least first; those beyond int64_t become -1. */
static int64_t whole_of(const struct vtk_type *type, const unsigned char *byte)
{
    uint64_t bits = 0;
    for (int k = type->size - 1; k >= 0; k--) {
        bits = bits << 8 | byte[k];
    }
    if (type->is_signed && type->size < 8 && bits >> (8 * type->size - 1) != 0) {
        bits |= UINT64_MAX << (8 * type->size);
    }
    return type->is_signed || bits <= INT64_MAX ? (int64_t)bits : -1;
}

/* The whole number that a real one is, to single precision. */
static int64_t near_whole(struct msh_reader *r, const char *name, double number)
{
    double whole = rint(number), rounding = 2.0 * (double)FLT_EPSILON * (1.0 + fabs(number));
    if (!(fabs(number - whole) <= rounding && fabs(whole) < 1e15)) {
        msh_fail(r, "%s: %.9g is not a whole number", name, number);
        return 0;
    }
    return (int64_t)whole;
}

void vtk_fill_binary(struct msh_reader *r, struct vtk_array *array, const struct vtk_type *type, bool swap,
                     const char *bytes)
{
    for (int64_t i = 0; r->status == STATUS_OK && i < array->count; i++) {
        unsigned char byte[8];
        for (int k = 0; k < type->size; k++) {
            byte[k] = (unsigned char)bytes[i * type->size + (swap ? type->size - 1 - k : k)];
        }
        if (type->is_whole) {
            array->whole[i] = whole_of(type, byte);
            continue;
        }
        float single;
        double number;
        if (type->size == 4) {
            memcpy(&single, byte, sizeof single);
            number = (double)single;
        } else {
            memcpy(&number, byte, sizeof number);
        }
        if (array->real != NULL) {
            array->real[i] = number;
        } else {
            array->whole[i] = near_whole(r, array->name, number);
        }
    }
}

void vtk_fill_text(struct msh_reader *r, struct vtk_array *array, const char **at, const char *end)
{
    for (int64_t i = 0; r->status == STATUS_OK && i < array->count; i++) {
        int64_t length;
        const char *word = input_word(at, end, ',', &length);
        if (word == NULL) {
            msh_fail(r, "%s: only %jd of %jd numbers", array->name, i, array->count);
        } else if (array->real != NULL) {
            array->real[i] = input_real(r, array->name, word, length);
        } else if (is_asked(r, array)) {
            array->whole[i] = near_whole(r, array->name, input_real(r, array->name, word, length));
        } else {
            array->whole[i] = input_whole(r, array->name, word, length, INT64_MIN + 1, INT64_MAX);
        }
    }
}

/* ---- nodes and elements ---- */

/* The only array of a kind, with so many numbers (-1: any); NULL after a failure. */
static const struct vtk_array *find_array(struct vtk_input *v, enum vtk_kind kind, const char *what,
                                          int64_t count)
{
    const struct vtk_array *found = NULL;
    for (int64_t i = 0; i < v->count; i++) {
        if (v->arrays[i].kind == kind) {
            if (found != NULL) {
                msh_fail(v->r, "%s: twice", what);
            }
            found = &v->arrays[i];
        }
    }
    if (found == NULL) {
        msh_fail(v->r, "no %s: the file is truncated, or has no grid", what);
    } else if (count >= 0 && found->count != count) {
        msh_fail(v->r, "%s: %jd numbers, not %jd", what, found->count, count);
    }
    return v->r->status == STATUS_OK ? found : NULL;
}

static void add_nodes(struct vtk_input *v)
{
    const struct vtk_array *x = find_array(v, VTK_POINTS, "points", 3 * v->point_count);
    for (int64_t n = 0; x != NULL && v->r->status == STATUS_OK && n < v->point_count; n++) {
        for (int k = 0; k < 3; k++) {
            if (!isfinite(x->real[3 * n + k])) {
                msh_fail(v->r, "point %jd: a coordinate is not finite", n);
            }
        }
        msh_add_node(v->r, n, &x->real[3 * n]);
    }
}

/* The type of gmsh of a type of VTK; 0: it is not read. Pixels and voxels become quadrangles and hexahedra,
 * polygons and lines of many points what has so many. */
static int find_type(int64_t number, int64_t count)
{
    static const int8_t types[] = {
        [1] = 15,  [3] = 1,   [5] = 2,   [8] = 3,   [9] = 3,   [10] = 4,  [11] = 5,
        [12] = 5,  [13] = 6,  [14] = 7,  [21] = 8,  [22] = 9,  [23] = 16, [24] = 11,
        [25] = 17, [26] = 18, [27] = 19, [28] = 10, [29] = 12, [32] = 13};
    int type = number >= 0 && number < (int64_t)sizeof types ? types[number] : 0;
    type = number == 4 && count == 2   ? 1
           : number == 7 && count == 3 ? 2
           : number == 7 && count == 4 ? 3
                                       : type;
    return type != 0 && msh_type(type).node_count == count ? type : 0;
}

static void swap_nodes(int64_t *a, int64_t *b)
{
    int64_t kept = *a;
    *a = *b;
    *b = kept;
}

static void add_cell(struct vtk_input *v, int64_t c, int64_t number, int64_t count, const int64_t nodes[])
{
    enum { PIXEL = 8, VOXEL = 11 };
    int64_t node[MSH_MOST_NODES];
    int type = find_type(number, count);
    if (type == 0) {
        msh_fail(v->r,
                 "cell %jd: type %jd of VTK with %jd points is no element of first or second order that is "
                 "read: make simplices of them (ParaView's filter Tetrahedralize)",
                 c, number, count);
        return;
    }
    memcpy(node, nodes, (size_t)count * sizeof *nodes);
    if (number == PIXEL || number == VOXEL) {
        swap_nodes(&node[2], &node[3]);
    }
    if (number == VOXEL) {
        swap_nodes(&node[6], &node[7]);
    }
    msh_add_element(v->r, c, type, node, 0);
}

static void add_cells(struct vtk_input *v)
{
    struct msh_reader *r = v->r;
    const struct vtk_array *connectivity = find_array(v, VTK_CONNECTIVITY, "connectivity", -1);
    const struct vtk_array *end = find_array(v, VTK_OFFSETS, "offsets", v->cell_count);
    const struct vtk_array *type = find_array(v, VTK_TYPES, "types", v->cell_count);
    int64_t first = 0;
    for (int64_t c = 0; r->status == STATUS_OK && c < v->cell_count; c++) {
        if (end->whole[c] < first || end->whole[c] > connectivity->count) {
            msh_fail(r, "cell %jd: its offset %jd is not within [%jd, %jd]", c, end->whole[c], first,
                     connectivity->count);
            return;
        }
        add_cell(v, c, type->whole[c], end->whole[c] - first, &connectivity->whole[first]);
        first = end->whole[c];
    }
}

void vtk_build(struct vtk_input *v)
{
    struct msh_reader *r = v->r;
    input_at(r, "grid", 0);
    add_nodes(v);
    add_cells(v);
    vtk_add_groups(v);
    for (int64_t i = 0; i < v->count; i++) {
        FREE_ALL(v->arrays[i].real, v->arrays[i].whole);
    }
    free(v->arrays);
}
