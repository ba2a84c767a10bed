#include "base/memory.h"
#include "io/msh_build.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points of a plane mesh may leave the plane by this part of its extent. */
#define FLATNESS 1e-9

/* The region of cells in no group: beside others, and where there is none at all. */
static const char *rest_name(bool alone)
{
    return alone ? "body" : "unnamed";
}

int mesh_element_dim(const struct msh *msh, int64_t element)
{
    return msh_type(msh->element_type[element]).dim;
}

enum status mesh_find_dim(struct mesh_draft *draft)
{
    const struct msh *msh = draft->msh;
    int dim = -1;
    for (int64_t e = 0; e < msh->element_count; e++) {
        dim = mesh_element_dim(msh, e) > dim ? mesh_element_dim(msh, e) : dim;
    }
    if (dim < 2) {
        return fail(draft->error, STATUS_INPUT,
                    "no cells (triangles, tetrahedra, ...): mesh it with gmsh -2 or -3");
    }
    draft->mesh->dim = dim;
    return STATUS_OK;
}

enum status mesh_check_plane(const struct mesh_draft *draft)
{
    const struct msh *msh = draft->msh;
    double least[3] = {INFINITY, INFINITY, INFINITY};
    double most[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int64_t e = 0; e < msh->element_count; e++) {
        for (int64_t k = msh->node_ptr[e]; mesh_element_dim(msh, e) == 2 && k < msh->node_ptr[e + 1]; k++) {
            for (int i = 0; i < 3; i++) {
                least[i] = fmin(least[i], msh->x[3 * msh->node_idx[k] + i]);
                most[i] = fmax(most[i], msh->x[3 * msh->node_idx[k] + i]);
            }
        }
    }
    double extent = fmax(most[0] - least[0], most[1] - least[1]);
    if (!(most[2] - least[2] <= FLATNESS * extent)) {
        return fail(
            draft->error, STATUS_INPUT,
            "a surface in space, without volume cells: mesh the volume (gmsh -3), or a plane z = const");
    }
    return STATUS_OK;
}

/* The names of all regions of the file, "a, b, c", for a message. */
static void list_regions(const struct mesh_draft *draft, const char *unnamed, char list[], size_t size)
{
    size_t used = 0;
    list[0] = '\0';
    for (int32_t g = 0; g < draft->msh->group_count && used + 1 < size; g++) {
        const struct msh_group *group = &draft->msh->groups[g];
        if (group->dim == draft->mesh->dim && group->element_count > 0) {
            used += (size_t)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", group->name);
        }
    }
    if (unnamed != NULL && used + 1 < size) {
        snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", unnamed);
    }
}

/* Is `name` an item of the list? */
static bool is_listed(const char *list, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = list; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0')) {
            return true;
        }
    }
    return false;
}

/* Every item of the list must be a region that is there. */
static enum status check_wanted(const struct mesh_draft *draft, const char *wanted, const char *unnamed)
{
    const struct msh *msh = draft->msh;
    char present[256];
    list_regions(draft, unnamed, present, sizeof present);
    for (const char *at = wanted; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        int length = (int)strcspn(at, ",");
        bool found =
            unnamed != NULL && length == (int)strlen(unnamed) && strncmp(at, unnamed, (size_t)length) == 0;
        for (int32_t g = 0; g < msh->group_count && !found; g++) {
            found = msh->groups[g].dim == draft->mesh->dim && msh->groups[g].element_count > 0 &&
                    strlen(msh->groups[g].name) == (size_t)length &&
                    strncmp(at, msh->groups[g].name, (size_t)length) == 0;
        }
        if (!found) {
            return fail(draft->error, STATUS_INPUT, "no cells in a region '%.*s': there are %s",
                        length < 100 ? length : 100, at, present);
        }
    }
    return STATUS_OK;
}

/* The group of a cell, of several the first; -1 for none. */
static int32_t cell_group(const struct msh *msh, int64_t element)
{
    int64_t first = msh->member_ptr[element];
    return msh->member_ptr[element + 1] > first ? msh->member_idx[first] : -1;
}

/* ---- cells that stand twice: in MSH 2 that is how they are in two groups ---- */

#define MOST_NODES 8

struct keyed_cell {
    int64_t element;
    int32_t node[MOST_NODES]; /* ascending, -1 fills up */
};

static int compare_cells(const void *left, const void *right)
{
    const struct keyed_cell *a = left;
    const struct keyed_cell *b = right;
    for (int k = 0; k < MOST_NODES; k++) {
        if (a->node[k] != b->node[k]) {
            return a->node[k] < b->node[k] ? -1 : 1;
        }
    }
    return (a->element > b->element) - (a->element < b->element);
}

static void key_cell(const struct msh *msh, int64_t element, struct keyed_cell *key)
{
    int count = 0;
    key->element = element;
    memset(key->node, 0xff, sizeof key->node);
    for (int64_t k = msh->node_ptr[element]; k < msh->node_ptr[element + 1]; k++, count++) {
        int at = count;
        for (; at > 0 && key->node[at - 1] > msh->node_idx[k]; at--) {
            key->node[at] = key->node[at - 1];
        }
        key->node[at] = msh->node_idx[k];
    }
}

/* is_cell[element]: it is of the mesh's dimension, and the first of those with its nodes. The rest is told,
 * and so are cells in two groups. */
static enum status find_cells(struct mesh_draft *draft, bool is_cell[])
{
    enum status status;
    const struct msh *msh = draft->msh;
    struct keyed_cell *keys = NULL;
    int64_t count = 0;
    int64_t again = 0;
    int64_t twice = 0;
    TRY(NEW_ARRAY(&keys, msh->element_count, draft->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        is_cell[e] = mesh_element_dim(msh, e) == draft->mesh->dim;
        if (is_cell[e]) {
            key_cell(msh, e, &keys[count++]);
            twice += msh->member_ptr[e + 1] - msh->member_ptr[e] > 1;
        }
    }
    qsort(keys, (size_t)count, sizeof *keys, compare_cells);
    for (int64_t i = 1; i < count; i++) {
        if (memcmp(keys[i].node, keys[i - 1].node, sizeof keys[i].node) == 0) {
            again += is_cell[keys[i].element];
            is_cell[keys[i].element] = false;
        }
    }
    if (twice > 0) {
        TRY(mesh_add_note(draft, "cells in two physical groups, taken for the one of the lower tag: %lld",
                          (long long)twice));
    }
    if (again > 0) {
        TRY(mesh_add_note(draft,
                          "cells that stand twice, as for a second physical group, taken once, as the first: "
                          "%lld",
                          (long long)again));
    }
done:
    free(keys);
    return status;
}

/* A note on each name that is not as in the file. */
static enum status note_names(struct mesh_draft *draft)
{
    enum status status = STATUS_OK;
    for (int32_t g = 0; g < draft->msh->group_count; g++) {
        const struct msh_group *group = &draft->msh->groups[g];
        if (group->written != NULL) {
            TRY(mesh_add_note(draft, "group '%s' is named '%s' here", group->written, group->name));
        }
    }
done:
    return status;
}

enum status mesh_pick_regions(struct mesh_draft *draft, const char *wanted, int32_t region_of[])
{
    enum status status = STATUS_OK;
    const struct msh *msh = draft->msh;
    struct mesh_names *regions = &draft->mesh->regions;
    int32_t *region_of_group = NULL; /* the last is for cells without a group */
    int64_t *cells_of = NULL;        /* the same: how many cells */
    bool *is_cell = NULL;
    int64_t cells = 0;
    TRY(NEW_ARRAY(&region_of_group, msh->group_count + 1, draft->error));
    TRY(NEW_ARRAY(&cells_of, msh->group_count + 1, draft->error));
    TRY(NEW_ARRAY(&is_cell, msh->element_count, draft->error));
    TRY(note_names(draft));
    TRY(find_cells(draft, is_cell));
    for (int64_t e = 0; e < msh->element_count; e++) {
        int32_t group = cell_group(msh, e);
        cells += is_cell[e];
        cells_of[group >= 0 ? group : msh->group_count] += is_cell[e];
    }
    int64_t without = cells_of[msh->group_count];
    const char *unnamed = rest_name(without == cells);
    TRY(wanted == NULL ? STATUS_OK : check_wanted(draft, wanted, without > 0 ? unnamed : NULL));
    for (int32_t g = 0; g < msh->group_count; g++) {
        const struct msh_group *group = &msh->groups[g];
        region_of_group[g] = -1;
        if (cells_of[g] > 0 && (wanted == NULL || is_listed(wanted, group->name))) {
            region_of_group[g] = regions->count;
            TRY(mesh_add_group(regions, group, draft->error));
        }
    }
    region_of_group[msh->group_count] = -1;
    if (without > 0 && (wanted == NULL || is_listed(wanted, unnamed))) {
        int32_t same = mesh_find_name(regions, unnamed);
        region_of_group[msh->group_count] = same >= 0 ? same : regions->count;
        TRY(same >= 0 ? STATUS_OK : mesh_add_name(regions, unnamed, draft->error));
    }
    if (without > 0 && regions->count > 1) {
        TRY(mesh_add_note(draft, "cells in no physical group, region '%s': %lld", unnamed,
                          (long long)without));
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        int32_t group = cell_group(msh, e);
        region_of[e] = is_cell[e] ? region_of_group[group >= 0 ? group : msh->group_count] : -1;
    }
done:
    free(region_of_group);
    free(cells_of);
    free(is_cell);
    return status;
}
