#include "io/msh_gmsh.h"

#include "base/memory.h"

#include <gmshc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* libgmsh's own last word on a failure of `what`. */
static enum status gmsh_fail(struct error *error, const char *what)
{
    char *said = NULL;
    int ierr = 0;
    gmshLoggerGetLastError(&said, &ierr);
    enum status status = fail(error, STATUS_INPUT, "libgmsh cannot read %s: %s", what,
                              ierr == 0 && said != NULL && said[0] != '\0' ? said : "no reason given");
    gmshFree(said);
    return status;
}

/* Start libgmsh, silent and without the user's configuration, and open the file. */
static enum status gmsh_open(const char *path, struct error *error)
{
    static const struct {
        const char *name;
        double value;
    } options[] = {{"General.Terminal", 0},
                   {"General.SaveSession", 0},
                   {"General.SaveOptions", 0},
                   {"General.NumThreads", 1}};
    int ierr = 0;
    gmshInitialize(0, NULL, 0, &ierr);
    for (size_t i = 0; i < sizeof options / sizeof options[0] && ierr == 0; i++) {
        gmshOptionSetNumber(options[i].name, options[i].value, &ierr);
    }
    if (ierr != 0) {
        return fail(error, STATUS_SYSTEM, "libgmsh does not start");
    }
    gmshLoggerStart(&ierr);
    gmshMerge(path, &ierr);
    return ierr == 0 ? STATUS_OK : gmsh_fail(error, "the mesh");
}

/* libgmsh and the scan do not agree on the file. */
static enum status disagree(struct error *error, const char *what)
{
    return fail(error, STATUS_INPUT, "libgmsh does not read all %s of the file: is it from another program?",
                what);
}

static enum status load_nodes(struct msh *msh, const struct msh_scan *scan, struct error *error)
{
    enum status status = STATUS_OK;
    size_t *tags = NULL;
    double *coordinates = NULL;
    double *parameters = NULL;
    size_t tag_count = 0;
    size_t coordinate_count = 0;
    size_t parameter_count = 0;
    bool *seen = NULL;
    int ierr = 0;
    gmshModelMeshGetNodes(&tags, &tag_count, &coordinates, &coordinate_count, &parameters, &parameter_count,
                          -1, -1, 0, 0, &ierr);
    if (ierr != 0) {
        status = gmsh_fail(error, "the nodes");
        goto done;
    }
    TRY(NEW_ARRAY(&msh->x, 3 * scan->node_count, error));
    TRY(NEW_ARRAY(&msh->node_tag, scan->node_count, error));
    TRY(NEW_ARRAY(&seen, scan->node_count, error));
    for (size_t i = 0; i < tag_count && 3 * i + 2 < coordinate_count; i++) {
        int64_t place = msh_index_find(&scan->nodes, (int64_t)tags[i]);
        if (place >= 0) {
            seen[place] = true;
            memcpy(&msh->x[3 * place], &coordinates[3 * i], 3 * sizeof *coordinates);
        }
    }
    /* libgmsh may forget nodes of no element: they get the place of the first node, and are dropped later */
    memcpy(msh->node_tag, scan->node_tag, (size_t)scan->node_count * sizeof *msh->node_tag);
    msh->node_count = scan->node_count;
    for (int64_t i = 0; i < scan->element_count; i++) {
        for (int64_t k = msh->node_ptr[i]; k < msh->node_ptr[i + 1]; k++) {
            if (!seen[msh->node_idx[k]]) {
                status = disagree(error, "nodes");
                goto done;
            }
        }
    }
done:
    free(seen);
    gmshFree(tags);
    gmshFree(coordinates);
    gmshFree(parameters);
    return status;
}

/* ---- elements ---- */

/* The elements of one type on one entity, as libgmsh gives them. */
struct block {
    int dim, entity, type;
    const size_t *tags;
    size_t tag_count;
    const size_t *nodes;
    size_t node_count;
};

/* Put the elements of a block to their places; entity_of[place] receives the number of the entity. */
static enum status place_block(struct msh *msh, const struct msh_scan *scan, const struct block *block,
                               int32_t entity, int32_t entity_of[], int64_t *found, struct error *error)
{
    size_t nodes = (size_t)msh_type(block->type).node_count;
    if (nodes == 0 || block->node_count != nodes * block->tag_count) {
        return disagree(error, "elements");
    }
    for (size_t i = 0; i < block->tag_count; i++) {
        int64_t place = msh_index_find(&scan->elements, (int64_t)block->tags[i]);
        if (place < 0 || scan->element_type[place] != block->type || entity_of[place] >= 0) {
            return disagree(error, "elements");
        }
        entity_of[place] = entity;
        ++*found;
        for (size_t k = 0; k < nodes; k++) {
            int64_t node = msh_index_find(&scan->nodes, (int64_t)block->nodes[nodes * i + k]);
            if (node < 0) {
                return disagree(error, "nodes");
            }
            msh->node_idx[msh->node_ptr[place] + (int64_t)k] = (int32_t)node;
        }
    }
    return STATUS_OK;
}

static enum status load_entity(struct msh *msh, const struct msh_scan *scan, const int dim_tag[2],
                               int32_t entity, int32_t entity_of[], int64_t *found, struct error *error)
{
    enum status status = STATUS_OK;
    int *types = NULL;
    size_t **tags = NULL;
    size_t **nodes = NULL;
    size_t *tag_counts = NULL;
    size_t *node_counts = NULL;
    size_t type_count = 0;
    size_t tags_count = 0;
    size_t nodes_count = 0;
    int ierr = 0;
    gmshModelMeshGetElements(&types, &type_count, &tags, &tag_counts, &tags_count, &nodes, &node_counts,
                             &nodes_count, dim_tag[0], dim_tag[1], &ierr);
    if (ierr != 0) {
        status = gmsh_fail(error, "the elements");
        goto done;
    }
    for (size_t t = 0; t < type_count && t < tags_count && t < nodes_count; t++) {
        struct block block = {dim_tag[0],    dim_tag[1], types[t],      tags[t],
                              tag_counts[t], nodes[t],   node_counts[t]};
        TRY(place_block(msh, scan, &block, entity, entity_of, found, error));
    }
done:
    for (size_t t = 0; t < tags_count; t++) {
        gmshFree(tags[t]);
    }
    for (size_t t = 0; t < nodes_count; t++) {
        gmshFree(nodes[t]);
    }
    gmshFree(types);
    gmshFree(tags);
    gmshFree(nodes);
    gmshFree(tag_counts);
    gmshFree(node_counts);
    return status;
}

static enum status load_elements(struct msh *msh, const struct msh_scan *scan, const int *entities,
                                 size_t entity_count, int32_t entity_of[], struct error *error)
{
    enum status status = STATUS_OK;
    int64_t count = scan->element_count;
    int64_t found = 0;
    TRY(NEW_ARRAY(&msh->element_tag, count, error));
    TRY(NEW_ARRAY(&msh->element_type, count, error));
    TRY(NEW_ARRAY(&msh->node_ptr, count + 1, error));
    for (int64_t i = 0; i < count; i++) {
        msh->element_tag[i] = scan->element_tag[i];
        msh->element_type[i] = scan->element_type[i];
        msh->node_ptr[i + 1] = msh->node_ptr[i] + msh_type(scan->element_type[i]).node_count;
        entity_of[i] = -1;
    }
    TRY(NEW_ARRAY(&msh->node_idx, msh->node_ptr[count], error));
    for (size_t e = 0; e < entity_count; e++) {
        TRY(load_entity(msh, scan, &entities[2 * e], (int32_t)e, entity_of, &found, error));
    }
    if (found != count) {
        status = disagree(error, "elements");
        goto done;
    }
    msh->element_count = count;
done:
    return status;
}

/* ---- groups ---- */

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

/* Names as in the file, "group_TAG" for groups without; two of one name and dimension are an error. */
static enum status name_groups(struct msh *msh, const struct msh_scan *scan, struct error *error)
{
    for (int64_t i = 0; i < scan->name_count; i++) {
        struct msh_group *group = &msh->groups[find_group(msh, scan->names[i].dim, scan->names[i].tag)];
        if (group->name != NULL) {
            return fail(error, STATUS_INPUT, "$PhysicalNames: group %d of dimension %d is named twice",
                        group->tag, group->dim);
        }
        group->name = strdup(scan->names[i].name);
        if (group->name == NULL) {
            return fail_memory(error, "the name of a group");
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

/* All groups: those that the file names, and those that libgmsh found elements for. */
static enum status load_groups(struct msh *msh, const struct msh_scan *scan, struct error *error)
{
    enum status status = STATUS_OK;
    int *found = NULL;
    size_t numbers = 0;
    int ierr = 0;
    int32_t count = 0;
    gmshModelGetPhysicalGroups(&found, &numbers, -1, &ierr);
    if (ierr != 0) {
        status = gmsh_fail(error, "the physical groups");
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
            status = gmsh_fail(error, "the physical groups");
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

/* The groups of each element. In MSH 2 the group stands beside each element (an element of two groups is
 * there twice, and libgmsh would have each entity's elements in all groups of that entity); in MSH 4 it is
 * the entity that has groups. */
static enum status load_members(struct msh *msh, const struct msh_scan *scan, const int *entities,
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
                status = disagree(error, "physical groups");
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

enum status msh_load(struct msh *msh, const struct msh_scan *scan, const char *path, struct error *error)
{
    enum status status = STATUS_OK;
    int *entities = NULL;
    size_t numbers = 0;
    int32_t *entity_of = NULL;
    int ierr = 0;
    TRY(gmsh_open(path, error));
    gmshModelGetEntities(&entities, &numbers, -1, &ierr);
    if (ierr != 0) {
        status = gmsh_fail(error, "the mesh");
        goto done;
    }
    TRY(NEW_ARRAY(&entity_of, scan->element_count, error));
    TRY(load_elements(msh, scan, entities, numbers / 2, entity_of, error));
    TRY(load_nodes(msh, scan, error));
    TRY(load_groups(msh, scan, error));
    TRY(load_members(msh, scan, entities, numbers / 2, entity_of, error));
done:
    free(entity_of);
    gmshFree(entities);
    gmshFinalize(&ierr);
    return status;
}
