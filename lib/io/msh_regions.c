#include "base/memory.h"
#include "io/msh_build.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Points of a plane mesh may leave the plane by this part of its extent. */
#define FLATNESS 1e-9

static const char unnamed[] = "unnamed";

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
static void list_regions(const struct mesh_draft *draft, bool some_unnamed, char list[], size_t size)
{
    size_t used = 0;
    list[0] = '\0';
    for (int32_t g = 0; g < draft->msh->group_count && used + 1 < size; g++) {
        const struct msh_group *group = &draft->msh->groups[g];
        if (group->dim == draft->mesh->dim && group->element_count > 0) {
            used += (size_t)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", group->name);
        }
    }
    if (some_unnamed && used + 1 < size) {
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
static enum status check_wanted(const struct mesh_draft *draft, const char *wanted, bool some_unnamed)
{
    const struct msh *msh = draft->msh;
    char present[256];
    list_regions(draft, some_unnamed, present, sizeof present);
    for (const char *at = wanted; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        int length = (int)strcspn(at, ",");
        bool found =
            some_unnamed && length == (int)strlen(unnamed) && strncmp(at, unnamed, (size_t)length) == 0;
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

/* The one group of a cell, or -1 for none. */
static enum status cell_group(const struct mesh_draft *draft, int64_t element, int32_t *group)
{
    const struct msh *msh = draft->msh;
    int64_t first = msh->member_ptr[element];
    int64_t count = msh->member_ptr[element + 1] - first;
    if (count > 1) {
        return fail(draft->error, STATUS_INPUT,
                    "element %lld is in two physical groups, '%s' and '%s': keep it in one",
                    (long long)msh->element_tag[element], msh->groups[msh->member_idx[first]].name,
                    msh->groups[msh->member_idx[first + 1]].name);
    }
    *group = count == 1 ? msh->member_idx[first] : -1;
    return STATUS_OK;
}

enum status mesh_pick_regions(struct mesh_draft *draft, const char *wanted, int32_t region_of[])
{
    enum status status = STATUS_OK;
    const struct msh *msh = draft->msh;
    struct mesh_names *regions = &draft->mesh->regions;
    int32_t *region_of_group = NULL; /* the last is for cells without a group */
    int64_t without = 0;
    TRY(NEW_ARRAY(&region_of_group, msh->group_count + 1, draft->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        without +=
            mesh_element_dim(msh, e) == draft->mesh->dim && msh->member_ptr[e + 1] == msh->member_ptr[e];
    }
    TRY(wanted == NULL ? STATUS_OK : check_wanted(draft, wanted, without > 0));
    for (int32_t g = 0; g < msh->group_count; g++) {
        const struct msh_group *group = &msh->groups[g];
        region_of_group[g] = -1;
        if (group->dim == draft->mesh->dim && group->element_count > 0 &&
            (wanted == NULL || is_listed(wanted, group->name))) {
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
        int32_t group = -1;
        region_of[e] = -1;
        if (mesh_element_dim(msh, e) == draft->mesh->dim) {
            TRY(cell_group(draft, e, &group));
            region_of[e] = region_of_group[group >= 0 ? group : msh->group_count];
        }
    }
done:
    free(region_of_group);
    return status;
}
