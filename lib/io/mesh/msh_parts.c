/* The parts of a mesh: its regions, and the facets and sets that its groups become. */
#include "io/mesh/msh_build.h"

#include "base/box.h"
#include "base/lists.h"
#include "base/memory.h"
#include "base/round_off.h"

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

/* is_cell[element]: it has the mesh's dimension and is the first element with its nodes. */
static enum status find_cells(struct mesh *mesh, bool is_cell[])
{
    const struct msh *msh = mesh->msh;
    int64_t count = 0, again = 0;
    NEW_SCRATCH(struct keyed_cell, keys, msh->element_count, mesh->error);
    for (int64_t e = 0; e < msh->element_count; e++) {
        is_cell[e] = mesh_element_dim(mesh, e) == mesh->dim;
        if (is_cell[e]) {
            keys[count].element = e;
            memset(keys[count].node, 0xff, sizeof keys->node);
            sort_nodes(mesh_corners(mesh, e), &msh->node_idx[msh->elements[e].first], keys[count++].node);
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
    RETURN_IF_ERROR(names_split(&wanted, mesh->wanted != NULL ? mesh->wanted : "", mesh->error));
    for (int32_t g = 0; g <= msh->group_count; g++) {
        region_of_group[g] = -1;
        if (cells_of[g] == 0) {
            continue;
        }
        bool named = g < msh->group_count;
        unnamed = named ? "unnamed" : unnamed;
        const char *name = named ? msh->groups[g].name : unnamed;
        RETURN_IF_ERROR(names_add(&present, name, mesh->error));
        if (mesh->wanted != NULL && names_find(&wanted, name) < 0) {
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

/* ---- the faces (edges in 2D) of the cells ---- */

/* The nodes of a face, oriented outward from its cell. */
static void face_nodes(const struct mesh *mesh, int64_t face, int32_t node[])
{
    int64_t slot = mesh->face[face].item, corners = mesh->dim + 1;
    simplex_face(mesh->dim, mesh->cells + slot / corners * corners, (int)(slot % corners), node);
}

static enum status make_faces(struct mesh *mesh)
{
    mesh->face_count = mesh->cell_count * (mesh->dim + 1);
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->face, mesh->face_count, mesh->error));
    for (int64_t f = 0; f < mesh->face_count; f++) {
        int32_t node[3];
        mesh->face[f].item = f;
        face_nodes(mesh, f, node);
        face_key(mesh->dim, node, mesh->face[f].key);
    }
    keyed_sort(mesh->face_count, mesh->face);
    return STATUS_OK;
}

/* Whether the order of a face's nodes is an odd permutation of the ascending one. */
static bool is_turned(const struct mesh *mesh, int64_t face)
{
    int32_t node[3];
    face_nodes(mesh, face, node);
    bool odd = node[0] > node[1];
    return mesh->dim == 2 ? odd : odd ^ (node[0] > node[2]) ^ (node[1] > node[2]);
}

/* Count the faces of one cell. Two cells on the same side of a face, or three at one, overlap. */
static enum status count_boundary(struct mesh *mesh)
{
    for (int64_t f = 0, end; f < mesh->face_count; f = end) {
        end = keyed_end(mesh->face_count, mesh->face, f);
        mesh->boundary_count += end == f + 1;
        if (end > f + 2 || (end == f + 2 && is_turned(mesh, f) == is_turned(mesh, f + 1))) {
            int64_t a = mesh->face[end - 2].item / (mesh->dim + 1),
                    b = mesh->face[end - 1].item / (mesh->dim + 1);
            return fail(mesh->error, STATUS_INPUT,
                        "elements %jd and %jd overlap: one is inverted, or there twice (of '%s', of '%s')",
                        mesh->msh->elements[mesh->origin[a]].tag, mesh->msh->elements[mesh->origin[b]].tag,
                        mesh->regions.name[mesh->cell_region[a]], mesh->regions.name[mesh->cell_region[b]]);
        }
    }
    return STATUS_OK;
}

static enum status sort_by_group(struct mesh *mesh)
{
    const struct msh *msh = mesh->msh;
    NEW_SCRATCH(int32_t, group, msh->element_count, mesh->error);
    for (int64_t e = 0; e < msh->element_count; e++) {
        group[e] = msh->elements[e].group;
    }
    return lists_by_row(msh->element_count, 1, group, msh->group_count, &mesh->group_ptr, &mesh->group_idx,
                        mesh->error);
}

/* Add a node to the current set, once; -1: the node was left out. */
static enum status add_set_node(struct mesh *mesh, int32_t group, int32_t node)
{
    int64_t *count = &mesh->set_ptr[mesh->node_sets.count + 1];
    if (node < 0 || mesh->node_stamp[node] == group + 1) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->set_idx, *count + 1, &mesh->set_capacity, mesh->error));
    mesh->node_stamp[node] = group + 1;
    mesh->set_idx[(*count)++] = node;
    return STATUS_OK;
}

/* End the current set, and name it if it has nodes. */
static enum status close_set(struct mesh *mesh, int32_t group)
{
    int64_t set = mesh->node_sets.count;
    int64_t first = mesh->set_ptr[set];
    int64_t count = mesh->set_ptr[set + 1] - first;
    if (count == 0) {
        return STATUS_OK;
    }
    const char *name = mesh->msh->groups[group].name;
    if (names_find(&mesh->node_sets, name) >= 0) { /* groups differ only within a dimension */
        return fail(mesh->error, STATUS_INPUT,
                    "physical groups of two dimensions are named '%s', both sets of nodes: rename one", name);
    }
    qsort(&mesh->set_idx[first], (size_t)count, sizeof *mesh->set_idx, compare_int32);
    RETURN_IF_ERROR(names_add(&mesh->node_sets, name, mesh->error));
    mesh->set_ptr[mesh->node_sets.count + 1] = mesh->set_ptr[mesh->node_sets.count];
    return STATUS_OK;
}

/* Number of faces of a group by their position. */
struct tally {
    int64_t boundary, interior, elsewhere;
};

/* Add one face of a group: a facet if it is on the boundary, nodes of a set if it is between two cells. */
static enum status add_face(struct mesh *mesh, int32_t group, const int32_t node[], struct tally *tally)
{
    int dim = mesh->dim;
    int32_t key[3];
    face_key(dim, node, key);
    int64_t face = key[0] >= 0 ? keyed_find(mesh->face_count, mesh->face, key) : -1;
    if (face < 0) {
        tally->elsewhere++;
        return STATUS_OK;
    }
    if (keyed_end(mesh->face_count, mesh->face, face) > face + 1) {
        tally->interior++;
        enum status status = STATUS_OK;
        for (int k = 0; k < dim && status == STATUS_OK; k++) {
            status = add_set_node(mesh, group, node[k]);
        }
        return status;
    }
    if (mesh->face_stamp[face] != group + 1) { /* the file may repeat it */
        mesh->face_stamp[face] = group + 1;
        tally->boundary++;
        face_nodes(mesh, face, &mesh->facets[mesh->facet_count * dim]);
        mesh->facet_set[mesh->facet_count++] = (int32_t)mesh->facet_sets.count;
    }
    return STATUS_OK;
}

static enum status note_tally(const struct mesh *mesh, const struct msh_group *group,
                              const struct tally *tally)
{
    if (tally->elsewhere > 0) {
        RETURN_IF_ERROR(mesh_add_note(mesh, "group '%s': facets of no cell, left out: %jd", group->name,
                                      tally->elsewhere));
    }
    if (tally->interior > 0) {
        RETURN_IF_ERROR(mesh_add_note(mesh, "group '%s': facets between two cells, made a set of nodes: %jd",
                                      group->name, tally->interior));
    }
    return STATUS_OK;
}

static enum status gather_facets(struct mesh *mesh, int32_t group)
{
    const struct msh *msh = mesh->msh;
    struct tally tally = {0, 0, 0};
    for (int64_t i = mesh->group_ptr[group]; i < mesh->group_ptr[group + 1]; i++) {
        int32_t pieces[MSH_MOST_SIMPLICES][4];
        int count = mesh_simplices(mesh, mesh->group_idx[i], pieces);
        for (int p = 0; p < count; p++) {
            RETURN_IF_ERROR(add_face(mesh, group, pieces[p], &tally));
        }
    }
    if (msh->by_entity[mesh->dim - 1] && tally.boundary == mesh->boundary_count) {
        mesh->facet_count -= tally.boundary; /* one entity all over the boundary tells nothing */
    } else if (tally.boundary > 0) {
        RETURN_IF_ERROR(names_add(&mesh->facet_sets, msh->groups[group].name, mesh->error));
    }
    RETURN_IF_ERROR(close_set(mesh, group));
    return note_tally(mesh, &msh->groups[group], &tally);
}

static enum status gather_nodes(struct mesh *mesh, int32_t group)
{
    const struct msh *msh = mesh->msh;
    int64_t lost = 0;
    for (int64_t i = mesh->group_ptr[group]; i < mesh->group_ptr[group + 1]; i++) {
        int64_t e = mesh->group_idx[i];
        int used = mesh_corners(mesh, e);
        for (int k = 0; k < used; k++) {
            int32_t node = mesh->node_of[msh->node_idx[msh->elements[e].first + k]];
            lost += node < 0;
            RETURN_IF_ERROR(add_set_node(mesh, group, node));
        }
    }
    RETURN_IF_ERROR(close_set(mesh, group));
    return lost == 0 ? STATUS_OK
                     : mesh_add_note(mesh, "group '%s': midside nodes or nodes of no cell, left out: %jd",
                                     msh->groups[group].name, lost);
}

static enum status gather_groups(struct mesh *mesh)
{
    const struct msh *msh = mesh->msh;
    for (int32_t group = 0; group < msh->group_count; group++) {
        if (msh->groups[group].element_count == 0) {
            RETURN_IF_ERROR(mesh_add_note(mesh, "group '%s' of dimension %d is empty: left out",
                                          msh->groups[group].name, msh->groups[group].dim));
        } else if (msh->groups[group].dim == mesh->dim - 1) {
            RETURN_IF_ERROR(gather_facets(mesh, group));
        } else if (msh->groups[group].dim < mesh->dim - 1) {
            RETURN_IF_ERROR(gather_nodes(mesh, group));
        }
    }
    return STATUS_OK;
}

/* Most facets that there can be: two of a quadrangle. */
static int64_t most_facets(const struct mesh *mesh)
{
    int64_t most = 0;
    for (int32_t i = 0; i < mesh->msh->group_count; i++) {
        most += mesh->msh->groups[i].dim == mesh->dim - 1 ? mesh->msh->groups[i].element_count : 0;
    }
    return most * 2;
}

enum status mesh_build_facets(struct mesh *mesh)
{
    RETURN_IF_ERROR(make_faces(mesh));
    RETURN_IF_ERROR(count_boundary(mesh));
    RETURN_IF_ERROR(sort_by_group(mesh));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->face_stamp, mesh->face_count, mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->node_stamp, mesh->node_count, mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facets, most_facets(mesh) * mesh->dim, mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet_set, most_facets(mesh), mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->set_ptr, mesh->msh->group_count + 2, mesh->error));
    return gather_groups(mesh);
}
