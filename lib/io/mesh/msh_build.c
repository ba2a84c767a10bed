#include "io/mesh/msh_build.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

enum status mesh_build(struct mesh *mesh, const struct msh *msh, const struct mesh_options *options,
                       struct error *error)
{
    enum status status = STATUS_OK;
    struct mesh_draft draft = {.mesh = mesh, .msh = msh, .options = options, .error = error};
    *mesh = (struct mesh){0};
    for (int64_t i = 0; i < msh->notes.count; i++) {
        TRY(mesh_add_note(&draft, "%s", msh->notes.name[i]));
    }
    TRY(mesh_find_dim(&draft));
    TRY(mesh_pick_regions(&draft));
    TRY(mesh_build_nodes(&draft));
    TRY(mesh_build_cells(&draft));
    TRY(mesh_check_coincident(&draft));
    TRY(mesh_build_facets(&draft));
done:
    FREE_ALL(draft.region_of, draft.node_of, draft.origin);
    if (status != STATUS_OK) {
        mesh_free(mesh);
    }
    return status;
}

void mesh_free(struct mesh *mesh)
{
    FREE_ALL(mesh->x, mesh->cells, mesh->cell_region, mesh->facets, mesh->facet_set, mesh->set_ptr,
             mesh->set_idx);
    names_free(&mesh->regions);
    names_free(&mesh->facet_sets);
    names_free(&mesh->node_sets);
    names_free(&mesh->notes);
    *mesh = (struct mesh){0};
}

/* ---- into a stream ---- */

/* A section whose header lists names. */
static enum status put_named(struct stream *stream, const char *section, enum element_type type, int64_t rows,
                             const struct names *names, void *data, struct error *error)
{
    SCRATCH char *attributes = NULL;
    RETURN_IF_ERROR(names_attribute(names, &attributes, error));
    return stream_put(stream, section, type, rows, 1, attributes, data, false, error);
}

enum status mesh_put(const struct mesh *mesh, struct stream *stream, struct error *error)
{
    int dim = mesh->dim;
    int64_t sets = mesh->node_sets.count;
    RETURN_IF_ERROR(stream_put(stream, "nodes.x", TYPE_F8, mesh->node_count, dim,
                               dim == 2 ? "unit=m cols=x,y" : "unit=m cols=x,y,z", mesh->x, false, error));
    if (mesh->cell_count > 0) {
        RETURN_IF_ERROR(
            stream_put(stream, "cells", TYPE_I4, mesh->cell_count, dim + 1, "", mesh->cells, false, error));
        RETURN_IF_ERROR(put_named(stream, "cells.region", TYPE_I4, mesh->cell_count, &mesh->regions,
                                  mesh->cell_region, error));
    }
    if (mesh->facet_count > 0) {
        RETURN_IF_ERROR(
            stream_put(stream, "facets", TYPE_I4, mesh->facet_count, dim, "", mesh->facets, false, error));
        RETURN_IF_ERROR(put_named(stream, "facets.set", TYPE_I4, mesh->facet_count, &mesh->facet_sets,
                                  mesh->facet_set, error));
    }
    if (sets > 0) {
        RETURN_IF_ERROR(
            put_named(stream, "sets.ptr", TYPE_I8, sets + 1, &mesh->node_sets, mesh->set_ptr, error));
        RETURN_IF_ERROR(
            stream_put(stream, "sets.idx", TYPE_I4, mesh->set_ptr[sets], 1, "", mesh->set_idx, false, error));
    }
    return STATUS_OK;
}
