#include "io/msh_gmsh.h"

#include "base/memory.h"

#include <gmshc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status msh_gmsh_fail(struct error *error, const char *what)
{
    char *said = NULL;
    int ierr = 0;
    gmshLoggerGetLastError(&said, &ierr);
    bool has_reason = ierr == 0 && said != NULL && said[0] != '\0';
    /* It reads a file of ours, which is there. */
    bool lacks_means =
        has_reason && (strstr(said, "Out of memory") != NULL || strstr(said, "Unable to open") != NULL);
    enum status status = fail(error, lacks_means ? STATUS_SYSTEM : STATUS_INPUT, "libgmsh cannot read %s: %s",
                              what, has_reason ? said : "no reason given");
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
    return ierr == 0 ? STATUS_OK : msh_gmsh_fail(error, "the mesh");
}

enum status msh_disagree(struct error *error, const char *what)
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
        status = msh_gmsh_fail(error, "the nodes");
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
                status = msh_disagree(error, "nodes");
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
        return msh_disagree(error, "elements");
    }
    for (size_t i = 0; i < block->tag_count; i++) {
        int64_t place = msh_index_find(&scan->elements, (int64_t)block->tags[i]);
        if (place < 0 || scan->element_type[place] != block->type || entity_of[place] >= 0) {
            return msh_disagree(error, "elements");
        }
        entity_of[place] = entity;
        ++*found;
        for (size_t k = 0; k < nodes; k++) {
            int64_t node = msh_index_find(&scan->nodes, (int64_t)block->nodes[nodes * i + k]);
            if (node < 0) {
                return msh_disagree(error, "nodes");
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
        status = msh_gmsh_fail(error, "the elements");
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
        status = msh_disagree(error, "elements");
        goto done;
    }
    msh->element_count = count;
done:
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
        status = msh_gmsh_fail(error, "the mesh");
        goto done;
    }
    TRY(NEW_ARRAY(&entity_of, scan->element_count, error));
    TRY(load_elements(msh, scan, entities, numbers / 2, entity_of, error));
    TRY(load_nodes(msh, scan, error));
    TRY(msh_load_groups(msh, scan, error));
    TRY(msh_load_members(msh, scan, entities, numbers / 2, entity_of, error));
done:
    free(entity_of);
    gmshFree(entities);
    gmshFinalize(&ierr);
    return status;
}
