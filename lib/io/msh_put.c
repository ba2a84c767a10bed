#include "io/msh.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* "names=a,b,c" (allocated), or NULL. */
static char *names_attribute(const struct mesh_names *names)
{
    size_t size = sizeof "names=";
    for (int32_t i = 0; i < names->count; i++) {
        size += strlen(names->name[i]) + 1;
    }
    char *text = malloc(size);
    char *at = text != NULL ? stpcpy(text, "names=") : NULL;
    for (int32_t i = 0; i < names->count && text != NULL; i++) {
        at = stpcpy(stpcpy(at, i > 0 ? "," : ""), names->name[i]);
    }
    return text;
}

/* A section whose header lists names. */
static enum status put_named(struct stream *stream, const char *section, enum element_type type, int64_t rows,
                             const struct mesh_names *names, void *data, struct error *error)
{
    char *attributes = names_attribute(names);
    if (attributes == NULL) {
        return fail_memory(error, "names");
    }
    enum status status = stream_put(stream, section, type, rows, 1, attributes, data, false, error);
    free(attributes);
    return status;
}

enum status mesh_put(const struct mesh *mesh, struct stream *stream, struct error *error)
{
    int dim = mesh->dim;
    enum status status =
        stream_put(stream, "nodes.x", TYPE_F8, mesh->node_count, dim,
                   dim == 2 ? "unit=m cols=x,y" : "unit=m cols=x,y,z", mesh->x, false, error);
    if (status == STATUS_OK && mesh->cell_count > 0) {
        status =
            stream_put(stream, "cells", TYPE_I4, mesh->cell_count, dim + 1, "", mesh->cells, false, error);
    }
    if (status == STATUS_OK && mesh->cell_count > 0) {
        status = put_named(stream, "cells.region", TYPE_I4, mesh->cell_count, &mesh->regions,
                           mesh->cell_region, error);
    }
    if (status == STATUS_OK && mesh->facet_count > 0) {
        status =
            stream_put(stream, "facets", TYPE_I4, mesh->facet_count, dim, "", mesh->facets, false, error);
    }
    if (status == STATUS_OK && mesh->facet_count > 0) {
        status = put_named(stream, "facets.set", TYPE_I4, mesh->facet_count, &mesh->facet_sets,
                           mesh->facet_set, error);
    }
    int32_t sets = mesh->node_sets.count;
    if (status == STATUS_OK && sets > 0) {
        status = put_named(stream, "sets.ptr", TYPE_I8, sets + 1, &mesh->node_sets, mesh->set_ptr, error);
    }
    if (status == STATUS_OK && sets > 0) {
        status =
            stream_put(stream, "sets.idx", TYPE_I4, mesh->set_ptr[sets], 1, "", mesh->set_idx, false, error);
    }
    return status;
}
