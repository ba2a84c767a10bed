/* Unstructured grids of VTK: from arrays to nodes and elements. (Format: VTK File Formats, Kitware; the types
 * of cells: vtkCellType.h.) */

#include "io/mesh/vtk_input.h"

#include "base/lists.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- groups: an array of the cells tells the regions, arrays of the points the sets of tovtk ---- */

/* An array that numbers the cells tells no regions: all of more than a few values are different. */
#define FEW_CELLS 10

static bool is_numbering(struct vtk_input *v, const struct vtk_array *array)
{
    _Static_assert(sizeof *array->value == sizeof(int64_t), "bits of values are compared");
    struct msh_reader *r = v->r;
    SCRATCH int64_t *value = NULL;
    MSH_NEW(r, &value, array->count);
    if (r->status != STATUS_OK || array->count <= FEW_CELLS) {
        return false;
    }
    memcpy(value, array->value, (size_t)array->count * sizeof *value);
    return sort_distinct(array->count, value) == array->count;
}

/* The array of the cells of that name, or NULL. */
static const struct vtk_array *named_array(const struct vtk_input *v, const char *name)
{
    for (int64_t i = 0; i < v->count && name != NULL; i++) {
        if (v->arrays[i].kind == VTK_OF_CELLS && strcmp(v->arrays[i].name, name) == 0) {
            return &v->arrays[i];
        }
    }
    return NULL;
}

/* The array that tells the regions, or NULL: the one that is asked for; ours; meshio's of a mesh of gmsh;
 * else the only one. */
static const struct vtk_array *find_regions(struct vtk_input *v)
{
    const char *asked = v->r->region_array;
    const struct vtk_array *found = named_array(v, asked);
    char names[256] = "";
    int64_t count = 0;
    if (asked != NULL && found == NULL) {
        msh_fail(v->r, "the cells have no array '%s' of whole numbers", asked);
    }
    found = found != NULL ? found : named_array(v, "cells.region");
    found = found != NULL ? found : named_array(v, "gmsh:physical");
    if (found != NULL) {
        return found;
    }
    for (int64_t i = 0; i < v->count; i++) {
        const struct vtk_array *array = &v->arrays[i];
        if (array->kind == VTK_OF_CELLS && !is_numbering(v, array)) {
            text_append(names, sizeof names, "%s%s", count++ > 0 ? ", " : "", array->name);
            found = array;
        } else if (array->kind == VTK_OF_CELLS) {
            input_leave_out(v->r, array->name);
        }
    }
    if (count > 1 && named_array(v, found->name) != found) {
        msh_fail(v->r, "the cells have two arrays '%s': take one out", found->name);
    } else if (count > 1) {
        msh_fail(
            v->r,
            "the cells have several arrays of whole numbers: --regions-of names the one with the regions: %s",
            names);
    }
    return found;
}

/* The name of a region: what tovtk tells, else ARRAY_VALUE; other dimensions than that of the cells have
 * theirs between. */
static void name_region(const struct vtk_input *v, const struct vtk_array *array, int64_t value, int dim,
                        int most, char name[], size_t size)
{
    snprintf(name, size, "%s_%s%s%jd", array->name, dim < most ? msh_entity_kind(dim) : "",
             dim < most ? "_" : "", value);
    for (int64_t i = 0; i < v->count && strcmp(array->name, "cells.region") == 0; i++) {
        const struct vtk_array *field = &v->arrays[i];
        if (field->kind == VTK_OF_FIELD && field->count == 1 && vtk_whole(field->value[0]) == value) {
            snprintf(name, size, "%s", field->name + strlen("region."));
        }
    }
}

/* The region of a cell, with its dimension, as a number: ascending by the value, then by the dimension. The
 * value is the whole number that a real one is, to single precision. */
static int64_t region_of(struct vtk_input *v, const struct vtk_array *array, int64_t cell)
{
    double number = array->value[cell];
    double rounding = 2.0 * (double)FLT_EPSILON * (1.0 + fabs(number));
    if (!(fabs(number - rint(number)) <= rounding && fabs(number) < 9e15)) {
        msh_fail(v->r, "%s: %.9g is not a whole number", array->name, number);
        return 0;
    }
    return 4 * (int64_t)rint(number) + msh_type(v->r->msh->elements[cell].type).dim;
}

static void add_regions(struct vtk_input *v, const struct vtk_array *array)
{
    struct msh_reader *r = v->r;
    SCRATCH int64_t *region = NULL, *key = NULL;
    bool zero_is_none = strcmp(array->name, "gmsh:physical") == 0;
    int most = 0;
    if (array->count != v->cell_count) {
        msh_fail(r, "%s: %jd numbers, not one for each of %jd cells", array->name, array->count,
                 v->cell_count);
    }
    MSH_NEW(r, &region, v->cell_count);
    for (int64_t c = 0; r->status == STATUS_OK && c < v->cell_count; c++) {
        region[c] = region_of(v, array, c);
        most = (region[c] & 3) > most ? (int)(region[c] & 3) : most;
    }
    int64_t count = r->status == STATUS_OK ? sort_distinct(v->cell_count, region) : 0;
    MSH_NEW(r, &key, count);
    for (int64_t k = 0; r->status == STATUS_OK && k < count; k++) {
        char name[256];
        int dim = (int)(region[k] & 3);
        name_region(v, array, (region[k] - dim) / 4, dim, most, name, sizeof name);
        key[k] = zero_is_none && region[k] == dim ? 0 : input_group(r, dim, name);
    }
    for (int64_t c = 0; r->status == STATUS_OK && c < v->cell_count; c++) {
        r->msh->elements[c].key = key[first_from(region, 0, count, region_of(v, array, c))];
    }
    input_note(r, "the regions are those of the cells' array '%s'", array->name);
}

/* Node sets and facets of tovtk, 1 at their nodes. */
static void add_sets(struct vtk_input *v)
{
    for (int64_t i = 0; v->r->status == STATUS_OK && i < v->count; i++) {
        const struct vtk_array *array = &v->arrays[i];
        if (array->kind != VTK_OF_POINTS) {
            continue;
        }
        const char *name = strchr(array->name, '.') + 1;
        int64_t key = input_add_group(v->r, 0, name, (int64_t)strlen(name));
        if (array->count != v->point_count) {
            msh_fail(v->r, "%s: %jd numbers, not one for each of %jd points", array->name, array->count,
                     v->point_count);
        }
        for (int64_t n = 0; v->r->status == STATUS_OK && n < v->point_count; n++) {
            if (vtk_whole(array->value[n]) != 0) {
                msh_add_element(v->r, MSH_NO_TAG, INPUT_POINT, &n, key);
            }
        }
    }
}

/* ---- arrays ---- */

static bool begins(const char *name, const char *begin)
{
    return strncmp(name, begin, strlen(begin)) == 0;
}

bool vtk_is_wanted(struct vtk_input *v, const struct vtk_array *array)
{
    const struct nifti_type *type = array->type;
    const char *asked = v->r->region_array; /* its numbers may be of a real type */
    bool is_asked = array->kind == VTK_OF_CELLS && asked != NULL && strcmp(array->name, asked) == 0;
    bool is_whole = type != NULL && type->most > type->least;
    bool whole =
        (is_whole || (type != NULL && is_asked)) && array->components == 1 && !begins(array->name, "vtk");
    const char *dot = strchr(array->name, '.'); /* of a name that is not empty */
    bool set = (begins(array->name, "set.") || begins(array->name, "facets.")) && dot[1] != '\0';
    bool of_grid = array->kind >= VTK_POINTS && array->kind <= VTK_TYPES;
    bool wanted =
        of_grid || (whole && (array->kind == VTK_OF_CELLS || (array->kind == VTK_OF_POINTS && set) ||
                              (array->kind == VTK_OF_FIELD && begins(array->name, "region."))));
    if (of_grid && (type == NULL || is_whole == (array->kind == VTK_POINTS))) {
        msh_fail(v->r, "%s: numbers of a type that has no place here", array->name);
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
    added->value = NULL;
    MSH_NEW(r, &added->value, count);
    return r->status == STATUS_OK ? added : NULL;
}

void vtk_fill_text(struct msh_reader *r, struct vtk_array *array, const char **at, const char *end)
{
    bool whole = array->type->most > array->type->least;
    for (int64_t i = 0; r->status == STATUS_OK && i < array->count; i++) {
        int64_t length;
        const char *word = input_word(at, end, ',', &length);
        if (word == NULL) {
            msh_fail(r, "%s: only %jd of %jd numbers", array->name, i, array->count);
            return;
        }
        array->value[i] = input_real(r, array->name, word, length);
        if (whole && !(isfinite(array->value[i]) && array->value[i] == rint(array->value[i]))) {
            msh_fail(r, "%s: '%.*s' is not a whole number", array->name, length < 64 ? (int)length : 64,
                     word);
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
            if (!isfinite(x->value[3 * n + k])) {
                msh_fail(v->r, "point %jd: a coordinate is not finite", n);
            }
        }
        msh_add_node(v->r, n, &x->value[3 * n]);
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

static void add_cell(struct vtk_input *v, int64_t c, int64_t number, int64_t count, const double nodes[])
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
    for (int64_t k = 0; k < count; k++) {
        node[k] = vtk_whole(nodes[k]);
    }
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
        int64_t behind = vtk_whole(end->value[c]);
        if (behind < first || behind > connectivity->count) {
            msh_fail(r, "cell %jd: its offset %jd is not within [%jd, %jd]", c, behind, first,
                     connectivity->count);
            return;
        }
        add_cell(v, c, vtk_whole(type->value[c]), behind - first, &connectivity->value[first]);
        first = behind;
    }
}

void vtk_build(struct vtk_input *v)
{
    struct msh_reader *r = v->r;
    input_at(r, "grid", 0);
    add_nodes(v);
    add_cells(v);
    const struct vtk_array *regions = r->status == STATUS_OK ? find_regions(v) : NULL;
    if (regions != NULL && r->status == STATUS_OK) {
        add_regions(v, regions);
    }
    add_sets(v);
    for (int64_t i = 0; i < v->count; i++) {
        free(v->arrays[i].value);
    }
    free(v->arrays);
}
