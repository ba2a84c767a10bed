#include "base/memory.h"
#include "io/msh_gmsh.h"

#include <gmshc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int compare_groups(const void *left, const void *right)
{
    const struct msh_group *a = left;
    const struct msh_group *b = right;
    int dims = (a->dim > b->dim) - (a->dim < b->dim);
    return dims != 0 ? dims : (a->tag > b->tag) - (a->tag < b->tag);
}

/* Index of a group that exists, or -1. */
static int32_t find_group(const struct msh *msh, int dim, int64_t tag)
{
    struct msh_group key = {.dim = dim, .tag = (int)tag};
    const struct msh_group *group =
        msh->group_count == 0
            ? NULL
            : bsearch(&key, msh->groups, (size_t)msh->group_count, sizeof *msh->groups, compare_groups);
    return group == NULL ? -1 : (int32_t)(group - msh->groups);
}

/* A copy in which blanks, commas and the like, which cannot stand in lists of names, are underscores; or
 * NULL.
 */
static char *plain_name(const char *name)
{
    char *copy = strdup(name);
    for (char *c = copy; c != NULL && *c != '\0'; c++) {
        if ((unsigned char)*c <= ' ' || *c == 127 || strchr(",\"=:", *c) != NULL) {
            *c = '_';
        }
    }
    return copy;
}

/* Names as in the file, "group_TAG" for groups without; two of one name and dimension are an error. */
static enum status name_groups(struct msh *msh, const struct msh_scan *scan, struct error *error)
{
    for (int64_t i = 0; i < scan->name_count; i++) {
        struct msh_group *group = &msh->groups[find_group(msh, scan->names[i].dim, scan->names[i].tag)];
        if (group->name != NULL) {
            return fail(error, STATUS_INPUT, "$PhysicalNames: group %d of dimension %d is named twice",
                        group->tag, group->dim);
        }
        group->name = plain_name(scan->names[i].name);
        if (group->name == NULL) {
            return fail_memory(error, "the name of a group");
        }
        if (strcmp(group->name, scan->names[i].name) != 0) {
            group->written = strdup(scan->names[i].name);
            if (group->written == NULL) {
                return fail_memory(error, "the name of a group");
            }
        }
    }
    for (int32_t i = 0; i < msh->group_count; i++) {
        struct msh_group *group = &msh->groups[i];
        if (group->name == NULL && asprintf(&group->name, "group_%d", group->tag) < 0) {
            group->name = NULL;
            return fail_memory(error, "the name of a group");
        }
        for (int32_t j = i; j-- > 0 && msh->groups[j].dim == group->dim;) {
            if (strcmp(msh->groups[j].name, group->name) == 0) {
                return fail(error, STATUS_INPUT,
                            "physical groups %d and %d of dimension %d are both named '%s'",
                            msh->groups[j].tag, group->tag, group->dim, group->name);
            }
        }
    }
    return STATUS_OK;
}

enum status msh_load_groups(struct msh *msh, const struct msh_scan *scan, struct error *error)
{
    enum status status = STATUS_OK;
    int *found = NULL;
    size_t numbers = 0;
    int ierr = 0;
    int32_t count = 0;
    gmshModelGetPhysicalGroups(&found, &numbers, -1, &ierr);
    if (ierr != 0) {
        status = msh_gmsh_fail(error, "the physical groups");
        goto done;
    }
    TRY(NEW_ARRAY(&msh->groups, scan->name_count + (int64_t)(numbers / 2), error));
    for (size_t i = 0; i + 1 < numbers; i += 2) {
        msh->groups[count++] = (struct msh_group){.dim = found[i], .tag = found[i + 1]};
    }
    for (int64_t i = 0; i < scan->name_count; i++) {
        msh->groups[count++] = (struct msh_group){.dim = scan->names[i].dim, .tag = scan->names[i].tag};
    }
    qsort(msh->groups, (size_t)count, sizeof *msh->groups, compare_groups);
    for (int32_t i = 0; i < count; i++) {
        if (i == 0 || compare_groups(&msh->groups[i], &msh->groups[i - 1]) != 0) {
            msh->groups[msh->group_count++] = msh->groups[i];
        }
    }
    TRY(name_groups(msh, scan, error));
done:
    gmshFree(found);
    return status;
}

/* Groups of each entity (CSR), as libgmsh has them: the memberships of MSH 4. */
static enum status load_entity_groups(const struct msh *msh, const int *entities, size_t entity_count,
                                      int64_t ptr[], int32_t **idx, struct error *error)
{
    enum status status = STATUS_OK;
    int *tags = NULL;
    size_t tag_count = 0;
    for (size_t e = 0; e < entity_count; e++) {
        int ierr = 0;
        gmshModelGetPhysicalGroupsForEntity(entities[2 * e], entities[2 * e + 1], &tags, &tag_count, &ierr);
        if (ierr != 0) {
            status = msh_gmsh_fail(error, "the physical groups");
            goto done;
        }
        int32_t *grown = array_grow(*idx, ptr[e] + (int64_t)tag_count, sizeof **idx);
        if (grown == NULL) {
            status = fail_memory(error, "the physical groups");
            goto done;
        }
        *idx = grown;
        ptr[e + 1] = ptr[e];
        for (int32_t g = 0; g < msh->group_count; g++) { /* ascending, each once */
            bool member = false;
            for (size_t k = 0; k < tag_count; k++) {
                member =
                    member || (msh->groups[g].dim == entities[2 * e] && msh->groups[g].tag == abs(tags[k]));
            }
            if (member && ptr[e + 1] < ptr[e] + (int64_t)tag_count) {
                grown[ptr[e + 1]++] = g;
            }
        }
        gmshFree(tags);
        tags = NULL;
    }
done:
    gmshFree(tags);
    return status;
}

enum status msh_load_members(struct msh *msh, const struct msh_scan *scan, const int *entities,
                             size_t entity_count, const int32_t entity_of[], struct error *error)
{
    enum status status = STATUS_OK;
    int64_t *ptr = NULL;
    int32_t *idx = NULL;
    TRY(NEW_ARRAY(&ptr, (int64_t)entity_count + 1, error));
    TRY(load_entity_groups(msh, entities, entity_count, ptr, &idx, error));
    TRY(NEW_ARRAY(&msh->member_ptr, msh->element_count + 1, error));
    for (int64_t i = 0; i < msh->element_count; i++) {
        bool one = scan->element_group != NULL;
        msh->member_ptr[i + 1] = msh->member_ptr[i] + (one ? scan->element_group[i] != 0
                                                           : ptr[entity_of[i] + 1] - ptr[entity_of[i]]);
    }
    TRY(NEW_ARRAY(&msh->member_idx, msh->member_ptr[msh->element_count], error));
    for (int64_t i = 0; i < msh->element_count; i++) {
        for (int64_t k = msh->member_ptr[i]; k < msh->member_ptr[i + 1]; k++) {
            int32_t group = scan->element_group != NULL
                                ? find_group(msh, msh_type(msh->element_type[i]).dim, scan->element_group[i])
                                : idx[ptr[entity_of[i]] + k - msh->member_ptr[i]];
            if (group < 0) {
                status = msh_disagree(error, "physical groups");
                goto done;
            }
            msh->member_idx[k] = group;
            msh->groups[group].element_count++;
        }
    }
done:
    free(ptr);
    free(idx);
    return status;
}
