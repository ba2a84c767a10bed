#include "base/lists.h"
#include "base/memory.h"
#include "io/mesh/msh_build.h"

#include <stdlib.h>

/* The faces (edges in 2D) of the cells, to be found by their nodes. */
struct faces {
    int dim;
    const int32_t *cells;
    int64_t count;
    struct keyed *face; /* count, sorted: cell * (dim + 1) + the node of the cell that is not on it */
};

/* The nodes of a face, oriented outward from its cell. */
static void face_nodes(const struct faces *faces, int64_t face, int32_t node[])
{
    int64_t slot = faces->face[face].item, corners = faces->dim + 1;
    simplex_face(faces->dim, faces->cells + slot / corners * corners, (int)(slot % corners), node);
}

static enum status make_faces(const struct mesh *mesh, struct faces *faces, struct error *error)
{
    *faces = (struct faces){mesh->dim, mesh->cells, mesh->cell_count * (mesh->dim + 1), NULL};
    RETURN_IF_ERROR(NEW_ARRAY(&faces->face, faces->count, error));
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t node[3];
        faces->face[f].item = f;
        face_nodes(faces, f, node);
        face_key(mesh->dim, node, faces->face[f].key);
    }
    keyed_sort(faces->count, faces->face);
    return STATUS_OK;
}

/* The state while facets and sets are gathered. */
struct gathering {
    struct mesh_draft *draft;
    struct faces faces;
    int64_t boundary_count; /* of the faces */
    int64_t *group_ptr;     /* group_count + 1: elements by group, in the order of the file */
    int32_t *group_idx;
    int32_t *face_stamp;  /* per face: 1 + the last group that contains it */
    int32_t *node_stamp;  /* per node: the same */
    int64_t set_capacity; /* of mesh->set_idx */
};

/* Whether the order of a face's nodes is an odd permutation of the ascending one. */
static bool is_turned(const struct faces *faces, int64_t face)
{
    int32_t node[3];
    face_nodes(faces, face, node);
    bool odd = node[0] > node[1];
    return faces->dim == 2 ? odd : odd ^ (node[0] > node[2]) ^ (node[1] > node[2]);
}

/* Count the faces of one cell. Two cells on the same side of a face, or three at one, overlap. */
static enum status count_boundary(struct gathering *g)
{
    const struct mesh_draft *draft = g->draft;
    const struct faces *faces = &g->faces;
    for (int64_t f = 0, end; f < faces->count; f = end) {
        end = keyed_end(faces->count, faces->face, f);
        g->boundary_count += end == f + 1;
        if (end > f + 2 || (end == f + 2 && is_turned(faces, f) == is_turned(faces, f + 1))) {
            int64_t a = faces->face[end - 2].item / (faces->dim + 1),
                    b = faces->face[end - 1].item / (faces->dim + 1);
            return fail(draft->error, STATUS_INPUT,
                        "elements %jd and %jd overlap: one is inverted, or there twice (of '%s', of '%s')",
                        draft->msh->elements[draft->origin[a]].tag,
                        draft->msh->elements[draft->origin[b]].tag,
                        draft->mesh->regions.name[draft->mesh->cell_region[a]],
                        draft->mesh->regions.name[draft->mesh->cell_region[b]]);
        }
    }
    return STATUS_OK;
}

static enum status sort_by_group(struct gathering *g)
{
    const struct msh *msh = g->draft->msh;
    NEW_SCRATCH(int32_t, group, msh->element_count, g->draft->error);
    for (int64_t e = 0; e < msh->element_count; e++) {
        group[e] = msh->elements[e].group;
    }
    return lists_by_row(msh->element_count, 1, group, msh->group_count, &g->group_ptr, &g->group_idx,
                        g->draft->error);
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
    const char *name = g->draft->msh->groups[group].name;
    if (names_find(&mesh->node_sets, name) >= 0) { /* groups differ only within a dimension */
        return fail(g->draft->error, STATUS_INPUT,
                    "physical groups of two dimensions are named '%s', both sets of nodes: rename one", name);
    }
    qsort(&mesh->set_idx[first], (size_t)count, sizeof *mesh->set_idx, compare_int32);
    RETURN_IF_ERROR(names_add(&mesh->node_sets, name, g->draft->error));
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
    int32_t key[3];
    face_key(dim, node, key);
    int64_t face = key[0] >= 0 ? keyed_find(g->faces.count, g->faces.face, key) : -1;
    if (face < 0) {
        tally->elsewhere++;
        return STATUS_OK;
    }
    if (keyed_end(g->faces.count, g->faces.face, face) > face + 1) {
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
        face_nodes(&g->faces, face, &mesh->facets[mesh->facet_count * dim]);
        mesh->facet_set[mesh->facet_count++] = (int32_t)mesh->facet_sets.count;
    }
    return STATUS_OK;
}

static enum status note_tally(struct gathering *g, const struct msh_group *group, const struct tally *tally)
{
    if (tally->elsewhere > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft, "group '%s': facets of no cell, left out: %jd", group->name,
                                      tally->elsewhere));
    }
    if (tally->interior > 0) {
        RETURN_IF_ERROR(mesh_add_note(g->draft,
                                      "group '%s': facets between two cells, made a set of nodes: %jd",
                                      group->name, tally->interior));
    }
    return STATUS_OK;
}

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

static enum status gather_nodes(struct gathering *g, int32_t group)
{
    const struct msh *msh = g->draft->msh;
    int64_t lost = 0;
    for (int64_t i = g->group_ptr[group]; i < g->group_ptr[group + 1]; i++) {
        int64_t e = g->group_idx[i];
        int used = mesh_corners(g->draft, e);
        for (int k = 0; k < used; k++) {
            int32_t node = g->draft->node_of[msh->node_idx[msh->elements[e].first + k]];
            lost += node < 0;
            RETURN_IF_ERROR(add_set_node(g, group, node));
        }
    }
    RETURN_IF_ERROR(close_set(g, group));
    return lost == 0 ? STATUS_OK
                     : mesh_add_note(g->draft, "group '%s': midside nodes or nodes of no cell, left out: %jd",
                                     msh->groups[group].name, lost);
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

/* Most facets that there can be: two of a quadrangle. */
static int64_t most_facets(const struct mesh_draft *draft)
{
    int64_t most = 0;
    for (int32_t i = 0; i < draft->msh->group_count; i++) {
        most += draft->msh->groups[i].dim == draft->mesh->dim - 1 ? draft->msh->groups[i].element_count : 0;
    }
    return most * 2;
}

static void gathering_free(struct gathering *g)
{
    FREE_ALL(g->faces.face, g->group_ptr, g->group_idx, g->face_stamp, g->node_stamp);
}

enum status mesh_build_facets(struct mesh_draft *draft)
{
    struct mesh *mesh = draft->mesh;
    FREED_BY(gathering_free) struct gathering g = {.draft = draft};
    RETURN_IF_ERROR(make_faces(mesh, &g.faces, draft->error));
    RETURN_IF_ERROR(count_boundary(&g));
    RETURN_IF_ERROR(sort_by_group(&g));
    RETURN_IF_ERROR(NEW_ARRAY(&g.face_stamp, mesh->cell_count * (mesh->dim + 1), draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&g.node_stamp, mesh->node_count, draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facets, most_facets(draft) * mesh->dim, draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->facet_set, most_facets(draft), draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->set_ptr, draft->msh->group_count + 2, draft->error));
    return gather_groups(&g);
}
