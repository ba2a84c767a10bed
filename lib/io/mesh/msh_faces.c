#include "io/mesh/msh_build.h"

#include "base/memory.h"

#include <stdlib.h>

enum status msh_faces_make(struct msh_faces *faces, int dim, int64_t cell_count, const int32_t cells[],
                           struct error *error)
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
