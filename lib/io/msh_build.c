#include "io/msh_build.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status mesh_add_name(struct mesh_names *names, const char *name, struct error *error)
{
    char **grown = array_grow(names->name, names->count + 1, sizeof *grown);
    if (grown == NULL) {
        return fail_memory(error, "names");
    }
    names->name = grown;
    grown[names->count] = strdup(name);
    if (grown[names->count] == NULL) {
        return fail_memory(error, "names");
    }
    names->count++;
    return STATUS_OK;
}

enum status mesh_add_note(struct mesh_draft *draft, const char *format, ...)
{
    char note[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(note, sizeof note, format, arguments);
    va_end(arguments);
    return mesh_add_name(&draft->mesh->notes, note, draft->error);
}

int32_t mesh_find_name(const struct mesh_names *names, const char *name)
{
    for (int32_t i = 0; i < names->count; i++) {
        if (strcmp(names->name[i], name) == 0) {
            return i;
        }
    }
    return -1;
}

enum status mesh_add_group(struct mesh_names *names, const struct msh_group *group, struct error *error)
{
    for (const char *c = group->name; *c != '\0'; c++) {
        if ((unsigned char)*c <= ' ' || *c == ',' || *c == '"' || *c == 127) {
            return fail(
                error, STATUS_INPUT,
                "physical group %d of dimension %d: '%s': no blanks, commas and quotes in names: rename it",
                group->tag, group->dim, group->name);
        }
    }
    if (mesh_find_name(names, group->name) >= 0) {
        return fail(error, STATUS_INPUT,
                    "physical group %d of dimension %d: another one is named '%s': rename one", group->tag,
                    group->dim, group->name);
    }
    return mesh_add_name(names, group->name, error);
}

static void names_free(struct mesh_names *names)
{
    for (int32_t i = 0; i < names->count; i++) {
        free(names->name[i]);
    }
    free(names->name);
    *names = (struct mesh_names){0};
}

enum status mesh_build(struct mesh *mesh, const struct msh *msh, double unit, const char *wanted,
                       struct error *error)
{
    enum status status = STATUS_OK;
    struct mesh_draft draft = {.mesh = mesh, .msh = msh, .error = error};
    int32_t *region_of = NULL;
    *mesh = (struct mesh){0};
    TRY(mesh_find_dim(&draft));
    TRY(mesh->dim == 2 ? mesh_check_plane(&draft) : STATUS_OK);
    TRY(NEW_ARRAY(&region_of, msh->element_count, error));
    TRY(mesh_pick_regions(&draft, wanted, region_of));
    TRY(mesh_build_nodes(&draft, region_of, unit));
    TRY(mesh_build_cells(&draft, region_of));
    TRY(mesh_check_coincident(&draft));
    TRY(mesh_build_facets(&draft));
done:
    free(region_of);
    free(draft.node_of);
    free(draft.origin);
    if (status != STATUS_OK) {
        mesh_free(mesh);
    }
    return status;
}

void mesh_free(struct mesh *mesh)
{
    free(mesh->x);
    free(mesh->cells);
    free(mesh->cell_region);
    free(mesh->facets);
    free(mesh->facet_set);
    free(mesh->set_ptr);
    free(mesh->set_idx);
    names_free(&mesh->regions);
    names_free(&mesh->facet_sets);
    names_free(&mesh->node_sets);
    names_free(&mesh->notes);
    *mesh = (struct mesh){0};
}
