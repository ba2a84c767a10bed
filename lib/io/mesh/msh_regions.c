#include "base/box.h"
#include "base/keyed.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"
#include "io/mesh/msh_build.h"

#include <stdlib.h>
#include <string.h>

int mesh_element_dim(const struct mesh *mesh, int64_t element)
{
    return msh_type(mesh->msh->elements[element].type).dim;
}

int mesh_corners(const struct mesh *mesh, int64_t element)
{
    return msh_type(msh_type(mesh->msh->elements[element].type).linear).node_count;
}

static enum status check_plane(const struct mesh *mesh)
{
    const struct msh *msh = mesh->msh;
    struct box box = box_of(3, 0, NULL);
    for (int64_t e = 0; e < msh->element_count; e++) {
        int count = mesh_element_dim(mesh, e) == 2 ? mesh_corners(mesh, e) : 0;
        for (int k = 0; k < count; k++) {
            box_add(&box, 1, msh->nodes[msh->node_idx[msh->elements[e].first + k]].x);
        }
    }
    double across = box.high[2] - box.low[2];
    box.dim = 2;
    if (!(across <= COARSE_ROUND_OFF * box_side(&box))) {
        return fail(
            mesh->error, STATUS_INPUT,
            "a surface in space, without volume cells: mesh the volume (gmsh -3), or a plane z = const");
    }
    return STATUS_OK;
}

enum status mesh_find_dim(struct mesh *mesh)
{
    int dim = -1;
    for (int64_t e = 0; e < mesh->msh->element_count; e++) {
        dim = mesh_element_dim(mesh, e) > dim ? mesh_element_dim(mesh, e) : dim;
    }
    if (dim < 2) {
        return fail(mesh->error, STATUS_INPUT,
                    "no cells (triangles, tetrahedra, ...): mesh it with gmsh -2 or -3");
    }
    mesh->dim = dim;
    return dim == 2 ? check_plane(mesh) : STATUS_OK;
}

/* The group of a cell; group_count if there is none. */
static int32_t cell_group(const struct msh *msh, int64_t element)
{
    int32_t group = msh->elements[element].group;
    return group >= 0 ? group : msh->group_count;
}

/* ---- repeated cells: a cell in two groups is repeated ---- */

#define MOST_CORNERS 8

struct keyed_cell {
    int64_t element;
    int32_t node[MOST_CORNERS]; /* its corners, ascending; -1 fills up */
};

static int compare_cells(const void *left, const void *right)
{
    const struct keyed_cell *a = left;
    const struct keyed_cell *b = right;
    int nodes = compare_numbers(MOST_CORNERS, a->node, b->node);
    return nodes != 0 ? nodes : (a->element > b->element) - (a->element < b->element);
}

static void key_cell(const struct mesh *mesh, int64_t element, struct keyed_cell *key)
{
    const struct msh *msh = mesh->msh;
    const int32_t *node = &msh->node_idx[msh->elements[element].first];
    key->element = element;
    memset(key->node, 0xff, sizeof key->node);
    sort_nodes(mesh_corners(mesh, element), node, key->node);
}

/* is_cell[element]: it has the mesh's dimension and is the first element with its nodes. */
static enum status find_cells(struct mesh *mesh, bool is_cell[])
{
    const struct msh *msh = mesh->msh;
    int64_t count = 0, again = 0;
    NEW_SCRATCH(struct keyed_cell, keys, msh->element_count, mesh->error);
    for (int64_t e = 0; e < msh->element_count; e++) {
        is_cell[e] = mesh_element_dim(mesh, e) == mesh->dim;
        if (is_cell[e]) {
            key_cell(mesh, e, &keys[count++]);
        }
    }
    qsort(keys, (size_t)count, sizeof *keys, compare_cells);
    for (int64_t i = 1; i < count; i++) {
        if (memcmp(keys[i].node, keys[i - 1].node, sizeof keys[i].node) == 0) {
            again += is_cell[keys[i].element];
            is_cell[keys[i].element] = false;
        }
    }
    return again == 0
               ? STATUS_OK
               : mesh_add_note(mesh, "cells in two physical groups, or there twice, taken once: %jd", again);
}

/* Name the wanted regions. region_of_group[group_count + 1], the last for cells without group, receives the
 * index of each, or -1. cells_of[]: number of cells of each. */
static enum status name_regions(struct mesh *mesh, const int64_t cells_of[], int32_t region_of_group[])
{
    const struct msh *msh = mesh->msh;
    struct names *regions = &mesh->regions;
    FREED_BY(names_free) struct names present = {0}, wanted = {0};
    const char *unnamed = "body"; /* "unnamed" if there are other regions */
    RETURN_IF_ERROR(
        names_split(&wanted, mesh->options->regions != NULL ? mesh->options->regions : "", mesh->error));
    for (int32_t g = 0; g <= msh->group_count; g++) {
        region_of_group[g] = -1;
        if (cells_of[g] == 0) {
            continue;
        }
        bool named = g < msh->group_count;
        unnamed = named ? "unnamed" : unnamed;
        const char *name = named ? msh->groups[g].name : unnamed;
        RETURN_IF_ERROR(names_add(&present, name, mesh->error));
        if (mesh->options->regions != NULL && names_find(&wanted, name) < 0) {
            continue;
        }
        int64_t same = named ? -1 : names_find(regions, name);
        region_of_group[g] = (int32_t)(same >= 0 ? same : regions->count);
        if (same < 0) {
            RETURN_IF_ERROR(names_add(regions, name, mesh->error));
        }
    }
    for (int64_t i = 0, ignored; i < wanted.count; i++) {
        RETURN_IF_ERROR(names_need(&present, "region with cells", wanted.name[i], &ignored, mesh->error));
    }
    if (cells_of[msh->group_count] > 0 && regions->count > 1) {
        RETURN_IF_ERROR(mesh_add_note(mesh, "cells in no physical group, region '%s': %jd", unnamed,
                                      cells_of[msh->group_count]));
    }
    return STATUS_OK;
}

enum status mesh_pick_regions(struct mesh *mesh)
{
    const struct msh *msh = mesh->msh;
    NEW_SCRATCH(int32_t, region_of_group, msh->group_count + 1, mesh->error); /* the last is for cells without a group */
    NEW_SCRATCH(int64_t, cells_of, msh->group_count + 1, mesh->error);
    NEW_SCRATCH(bool, is_cell, msh->element_count, mesh->error);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->region_of, msh->element_count, mesh->error));
    RETURN_IF_ERROR(find_cells(mesh, is_cell));
    for (int64_t e = 0; e < msh->element_count; e++) {
        cells_of[cell_group(msh, e)] += is_cell[e];
    }
    RETURN_IF_ERROR(name_regions(mesh, cells_of, region_of_group));
    for (int64_t e = 0; e < msh->element_count; e++) {
        mesh->region_of[e] = is_cell[e] ? region_of_group[cell_group(msh, e)] : -1;
    }
    return STATUS_OK;
}
