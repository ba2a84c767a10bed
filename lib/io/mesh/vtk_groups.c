/* Unstructured grids of VTK: an array of the cells tells the regions, arrays of the points the sets of tovtk.
 */
#include "io/mesh/vtk_input.h"

#include "base/lists.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

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

/* The whole number that a real one is, to single precision. */
static int64_t near_whole(struct msh_reader *r, const char *name, double number)
{
    double rounding = 2.0 * (double)FLT_EPSILON * (1.0 + fabs(number));
    if (!(fabs(number - rint(number)) <= rounding && fabs(number) < 9e15)) {
        msh_fail(r, "%s: %.9g is not a whole number", name, number);
        return 0;
    }
    return (int64_t)rint(number);
}

/* The keys of the groups of all values, value[count], by value and dimension: key[4 * count], 0 where no cell
 * is. Groups are named in ascending order of the values. */
static void name_regions(struct vtk_input *v, const struct vtk_array *array, const int64_t of_cell[],
                         int64_t count, const int64_t value[], int64_t key[])
{
    bool zero_is_none = strcmp(array->name, "gmsh:physical") == 0;
    int most = 0;
    for (int64_t c = 0; c < v->cell_count; c++) {
        int dim = msh_type(v->r->msh->elements[c].type).dim;
        most = dim > most ? dim : most;
        key[4 * first_from(value, 0, count, of_cell[c]) + dim] = -1;
    }
    for (int64_t k = 0; k < 4 * count; k++) {
        char name[256];
        if (zero_is_none && value[k / 4] == 0) {
            key[k] = 0;
        } else if (key[k] != 0) {
            name_region(v, array, value[k / 4], (int)(k % 4), most, name, sizeof name);
            key[k] = input_group(v->r, (int)(k % 4), name);
        }
    }
}

static void add_regions(struct vtk_input *v, const struct vtk_array *array)
{
    struct msh_reader *r = v->r;
    SCRATCH int64_t *of_cell = NULL, *value = NULL, *key = NULL;
    if (array->count != v->cell_count) {
        msh_fail(r, "%s: %jd numbers, not one for each of %jd cells", array->name, array->count,
                 v->cell_count);
    }
    MSH_NEW(r, &of_cell, v->cell_count);
    MSH_NEW(r, &value, v->cell_count);
    MSH_NEW(r, &key, 4 * v->cell_count);
    for (int64_t c = 0; r->status == STATUS_OK && c < v->cell_count; c++) {
        value[c] = of_cell[c] = near_whole(r, array->name, array->value[c]);
    }
    if (r->status != STATUS_OK) {
        return;
    }
    int64_t count = sort_distinct(v->cell_count, value);
    name_regions(v, array, of_cell, count, value, key);
    for (int64_t c = 0; c < v->cell_count; c++) {
        int64_t place = first_from(value, 0, count, of_cell[c]);
        v->r->msh->elements[c].key = key[4 * place + msh_type(v->r->msh->elements[c].type).dim];
    }
    input_note(v->r, "the regions are those of the cells' array '%s'", array->name);
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

void vtk_add_groups(struct vtk_input *v)
{
    const struct vtk_array *array = v->r->status == STATUS_OK ? find_regions(v) : NULL;
    if (array != NULL && v->r->status == STATUS_OK) {
        add_regions(v, array);
    }
    add_sets(v);
}
