#include "base/lists.h"
#include "base/memory.h"
#include "io/mesh/msh_build.h"

#include <stdlib.h>
#include <string.h>

/* The state while facets and sets are gathered. */
struct gathering {
    struct mesh_draft *draft;
    struct msh_faces faces;
    int64_t boundary_count; /* of the faces */
    int64_t *group_ptr;     /* group_count + 1: elements by group */
    int64_t *group_idx;
    int32_t *face_stamp;  /* per face: 1 + the last group that contains it */
    int32_t *node_stamp;  /* per node: the same */
    int64_t set_capacity; /* of mesh->set_idx */
};

/* The error of two cells on the same side of a face: the mesh overlaps, or a cell is repeated. */
static enum status fail_overlap(const struct mesh_draft *draft, const struct msh_overlap *overlap)
{
    const struct msh *msh = draft->msh;
    const struct mesh *mesh = draft->mesh;
    int64_t a = draft->origin[overlap->cell[0]];
    int64_t b = draft->origin[overlap->cell[1]];
    if (mesh->cell_region[overlap->cell[0]] != mesh->cell_region[overlap->cell[1]]) {
        return fail(draft->error, STATUS_INPUT,
                    "elements %lld ('%s') and %lld ('%s') overlap: each cell once, in one group",
                    (long long)msh->elements[a].tag, mesh->regions.name[mesh->cell_region[overlap->cell[0]]],
                    (long long)msh->elements[b].tag, mesh->regions.name[mesh->cell_region[overlap->cell[1]]]);
    }
    return fail(draft->error, STATUS_INPUT, "elements %lld and %lld overlap: one is inverted, or there twice",
                (long long)msh->elements[a].tag, (long long)msh->elements[b].tag);
}

/* The elements of each group, in the order of the file. */
static enum status sort_by_group(struct gathering *g)
{
    const struct msh *msh = g->draft->msh;
    SCRATCH int64_t *at = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&g->group_ptr, msh->group_count + 1, g->draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&g->group_idx, msh->member_ptr[msh->element_count], g->draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&at, msh->group_count, g->draft->error));
    for (int32_t i = 0; i < msh->group_count; i++) {
        g->group_ptr[i + 1] = g->group_ptr[i] + msh->groups[i].element_count;
        at[i] = g->group_ptr[i];
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        for (int64_t k = msh->member_ptr[e]; k < msh->member_ptr[e + 1]; k++) {
            g->group_idx[at[msh->member_idx[k]]++] = e;
        }
    }
    return STATUS_OK;
}

/* Add a node to the current set, once; -1: the node was left out. */
static enum status add_set_node(struct gathering *g, int32_t group, int32_t node)
{
    struct mesh *mesh = g->draft->mesh;
    int64_t *count = &mesh->set_ptr[mesh->node_sets.count + 1];
    if (node < 0 || g->node_stamp[node] == group + 1) {
        return STATUS_OK;
    }
    RETURN_IF_ERROR(GROW_ARRAY(&mesh->set_idx, *count + 1, &g->set_capacity, g->draft->error));
    g->node_stamp[node] = group + 1;
    mesh->set_idx[(*count)++] = node;
    return STATUS_OK;
}

/* End the current set, and name it if it has nodes. */
static enum status close_set(struct gathering *g, int32_t group)
{
    struct mesh *mesh = g->draft->mesh;
    int64_t set = mesh->node_sets.count;
    int64_t first = mesh->set_ptr[set];
    int64_t count = mesh->set_ptr[set + 1] - first;
    if (count == 0) {
        return STATUS_OK;
    }
    qsort(&mesh->set_idx[first], (size_t)count, sizeof *mesh->set_idx, compare_int32);
    RETURN_IF_ERROR(names_add(&mesh->node_sets, g->draft->msh->groups[group].name, g->draft->error));
    mesh->set_ptr[mesh->node_sets.count + 1] = mesh->set_ptr[mesh->node_sets.count];
    return STATUS_OK;
}

/* Number of faces of a group by their position. */
struct tally {
    int64_t boundary, interior, elsewhere;
};

/* Add one face of a group: a facet if it is on the boundary, nodes of a set if it is between two cells. */
static enum status add_face(struct gathering *g, int32_t group, const int32_t node[], struct tally *tally)
{
    struct mesh *mesh = g->draft->mesh;
    int dim = mesh->dim;
    int sharing = 0;
    int64_t face = -1;
    bool known = node[0] >= 0 && node[1] >= 0 && (dim == 2 || node[2] >= 0);
    if (known) {
        face = msh_faces_find(&g->faces, node, &sharing);
    }
    if (sharing == 0) {
        tally->elsewhere++;
        return STATUS_OK;
    }
    if (sharing > 1) {
        tally->interior++;
        enum status status = STATUS_OK;
        for (int k = 0; k < dim && status == STATUS_OK; k++) {
            status = add_set_node(g, group, node[k]);
        }
        return status;
    }
    if (g->face_stamp[face] != group + 1) { /* the file may repeat it */
        g->face_stamp[face] = group + 1;
        tally->boundary++;
        msh_face_nodes(&g->faces, face, &mesh->facets[mesh->facet_count * dim]);
        mesh->facet_set[mesh->facet_count++] = (int32_t)mesh->facet_sets.count;
    }
    return STATUS_OK;
}

static enum status note_tally(struct gathering *g, const struct msh_group *group, const struct tally *tally)
{
    if (tally->elsewhere > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft, "group '%s': facets of no cell, left out: %lld", group->name,
                                      (long long)tally->elsewhere));
    }
    if (tally->interior > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft,
                                      "group '%s': facets between two cells, made a set of nodes: %lld",
                                      group->name, (long long)tally->interior));
    }
    return STATUS_OK;
}

/* Gather a group of dimension dim - 1. */
static enum status gather_facets(struct gathering *g, int32_t group)
{
    const struct msh *msh = g->draft->msh;
    struct mesh *mesh = g->draft->mesh;
    struct tally tally = {0, 0, 0};
    for (int64_t i = g->group_ptr[group]; i < g->group_ptr[group + 1]; i++) {
        int32_t pieces[MSH_MOST_SIMPLICES][4];
        int count = mesh_simplices(g->draft, g->group_idx[i], pieces);
        for (int p = 0; p < count; p++) {
            RETURN_IF_ERROR(add_face(g, group, pieces[p], &tally));
        }
    }
    if (msh->by_entity[mesh->dim - 1] && tally.boundary == g->boundary_count) {
        mesh->facet_count -= tally.boundary; /* one entity all over the boundary tells nothing */
    } else if (tally.boundary > 0) {
        RETURN_IF_ERROR(names_add(&mesh->facet_sets, msh->groups[group].name, g->draft->error));
    }
    RETURN_IF_ERROR(close_set(g, group));
    return note_tally(g, &msh->groups[group], &tally);
}

/* Gather a group of lower dimension. */
static enum status gather_nodes(struct gathering *g, int32_t group)
{
    const struct msh *msh = g->draft->msh;
    int64_t lost = 0, midside = 0;
    for (int64_t i = g->group_ptr[group]; i < g->group_ptr[group + 1]; i++) {
        int64_t e = g->group_idx[i];
        int used = mesh_corners(g->draft, e);
        for (int k = 0; k < used; k++) {
            int32_t of_file = msh->node_idx[msh->elements[e].first + k];
            int32_t node = g->draft->node_of[of_file];
            bool is_midside = g->draft->role[of_file] == MESH_MIDSIDE;
            lost += node < 0 && !is_midside;
            midside += node < 0 && is_midside;
            RETURN_IF_ERROR(add_set_node(g, group, node));
        }
    }
    RETURN_IF_ERROR(close_set(g, group));
    if (lost > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft, "group '%s': some of its nodes belong to no cell: left out",
                                      msh->groups[group].name));
    }
    if (midside > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft, "group '%s': midside nodes, left out: %lld",
                                      msh->groups[group].name, (long long)midside));
    }
    return STATUS_OK;
}

static enum status gather_groups(struct gathering *g)
{
    const struct msh *msh = g->draft->msh;
    int dim = g->draft->mesh->dim;
    for (int32_t group = 0; group < msh->group_count; group++) {
        if (msh->groups[group].element_count == 0) {
            RETURN_IF_ERROR(mesh_add_note(g->draft, "group '%s' of dimension %d is empty: left out",
                                          msh->groups[group].name, msh->groups[group].dim));
        } else if (msh->groups[group].dim == dim - 1) {
            RETURN_IF_ERROR(gather_facets(g, group));
        } else if (msh->groups[group].dim < dim - 1) {
            RETURN_IF_ERROR(gather_nodes(g, group));
        }
    }
    return STATUS_OK;
}

static int compare_names(const void *left, const void *right)
{
    return strcmp(*(char *const *)left, *(char *const *)right);
}

/* Check that node sets have different names: groups differ only within a dimension. */
static enum status check_set_names(const struct mesh_draft *draft)
{
    const struct names *sets = &draft->mesh->node_sets;
    SCRATCH char **order = NULL;
    RETURN_IF_ERROR(NEW_ARRAY(&order, sets->count, draft->error));
    for (int64_t i = 0; i < sets->count; i++) {
        order[i] = sets->name[i];
    }
    qsort(order, (size_t)sets->count, sizeof *order, compare_names);
    for (int64_t i = 1; i < sets->count; i++) {
        if (strcmp(order[i], order[i - 1]) == 0) {
            return fail(draft->error, STATUS_INPUT,
                        "physical groups of two dimensions are named '%s', both sets of nodes: rename one",
                        order[i]);
        }
    }
    return STATUS_OK;
}

/* Most facets that there can be: two of a quadrangle. */
static int64_t most_facets(const struct mesh_draft *draft)
{
    int64_t most = 0;
    for (int32_t i = 0; i < draft->msh->group_count; i++) {
        most += draft->msh->groups[i].dim == draft->mesh->dim - 1 ? draft->msh->groups[i].element_count : 0;
    }
    return most * 2;
}

enum status mesh_build_facets(struct mesh_draft *draft)
{
    enum status status = STATUS_OK;
    struct mesh *mesh = draft->mesh;
    struct gathering g = {.draft = draft};
    struct msh_overlap overlap;
    TRY(msh_faces_make(&g.faces, mesh->dim, mesh->cell_count, mesh->cells, &overlap, draft->error));
    if (overlap.cell[0] >= 0) {
        status = fail_overlap(draft, &overlap);
        goto done;
    }
    for (int64_t f = 0, end; f < g.faces.count; f = end) {
        end = keyed_end(g.faces.count, g.faces.face, f);
        g.boundary_count += end == f + 1;
    }
    TRY(sort_by_group(&g));
    TRY(NEW_ARRAY(&g.face_stamp, mesh->cell_count * (mesh->dim + 1), draft->error));
    TRY(NEW_ARRAY(&g.node_stamp, mesh->node_count, draft->error));
    TRY(NEW_ARRAY(&mesh->facets, most_facets(draft) * mesh->dim, draft->error));
    TRY(NEW_ARRAY(&mesh->facet_set, most_facets(draft), draft->error));
    TRY(NEW_ARRAY(&mesh->set_ptr, draft->msh->group_count + 2, draft->error));
    TRY(gather_groups(&g));
    TRY(check_set_names(draft));
done:
    msh_faces_free(&g.faces);
    FREE_ALL(g.group_ptr, g.group_idx, g.face_stamp, g.node_stamp);
    return status;
}
