#include "io/mesh/msh_build.h"

#include "base/memory.h"

#include <stdlib.h>

/* Whether the order of a face's nodes is an odd permutation of the ascending one. */
static bool is_odd(int dim, const int32_t node[])
{
    bool odd = node[0] > node[1];
    return dim == 2 ? odd : odd ^ (node[0] > node[2]) ^ (node[1] > node[2]);
}

static bool is_turned(const struct msh_faces *faces, int64_t face)
{
    int32_t node[3];
    msh_face_nodes(faces, face, node);
    return is_odd(faces->dim, node);
}

static void find_overlap(const struct msh_faces *faces, struct msh_overlap *overlap)
{
    int corners = faces->dim + 1;
    *overlap = (struct msh_overlap){{-1, -1}};
    for (int64_t f = 0, end; f < faces->count; f = end) {
        end = keyed_end(faces->count, faces->face, f);
        for (int64_t i = f + 1; i < end; i++) {
            if (i > f + 1 || is_turned(faces, i) == is_turned(faces, i - 1)) {
                *overlap = (struct msh_overlap){
                    {(int32_t)(faces->face[i - 1].item / corners), (int32_t)(faces->face[i].item / corners)}};
                return;
            }
        }
    }
}

enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t cell_count, const int32_t cells[],
                           struct msh_overlap *overlap, struct error *error)
{
    *faces = (struct msh_faces){.dim = dim, .cells = cells, .count = cell_count * (dim + 1)};
    RETURN_IF_ERROR(NEW_ARRAY(&faces->face, faces->count, error));
    for (int64_t f = 0; f < faces->count; f++) {
        int32_t node[3];
        faces->face[f].item = f;
        msh_face_nodes(faces, f, node);
        face_key(dim, node, faces->face[f].key);
    }
    keyed_sort(faces->count, faces->face);
    find_overlap(faces, overlap);
    return STATUS_OK;
}

void msh_faces_free(struct msh_faces *faces)
{
    free(faces->face);
    *faces = (struct msh_faces){0};
}

int64_t msh_faces_find(const struct msh_faces *faces, const int32_t node[], int *count)
{
    int32_t key[3];
    face_key(faces->dim, node, key);
    int64_t first = keyed_find(faces->count, faces->face, key);
    *count = first < 0 ? 0 : (int)(keyed_end(faces->count, faces->face, first) - first);
    return first;
}

void msh_face_nodes(const struct msh_faces *faces, int64_t face, int32_t node[])
{
    int64_t slot = faces->face[face].item, corners = faces->dim + 1;
    simplex_face(faces->dim, faces->cells + slot / corners * corners, (int)(slot % corners), node);
}
