#include "io/msh_build.h"

#include "base/memory.h"
#include "io/msh_split.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A cell's volume over the cube (or its area over the square) of its longest edge must be above this. */
#define LEAST_VOLUME 1e-12

/* Points of a plane mesh may leave the plane by this part of its extent. */
#define FLATNESS 1e-9

static const char unnamed[] = "unnamed";

/* ---- names and notes ---- */

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

static int32_t find_name(const struct mesh_names *names, const char *name)
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
    if (find_name(names, group->name) >= 0) {
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

/* ---- dimension and regions ---- */

static int element_dim(const struct msh *msh, int64_t element)
{
    return msh_type(msh->element_type[element]).dim;
}

static enum status find_dim(struct mesh_draft *draft)
{
    const struct msh *msh = draft->msh;
    int dim = -1;
    for (int64_t e = 0; e < msh->element_count; e++) {
        dim = element_dim(msh, e) > dim ? element_dim(msh, e) : dim;
    }
    if (dim < 2) {
        return fail(draft->error, STATUS_INPUT,
                    "no cells (triangles, tetrahedra, ...): mesh it with gmsh -2 or -3");
    }
    draft->mesh->dim = dim;
    return STATUS_OK;
}

/* A mesh of surfaces is a body only in a plane z = const. */
static enum status check_plane(const struct mesh_draft *draft)
{
    const struct msh *msh = draft->msh;
    double least[3] = {INFINITY, INFINITY, INFINITY};
    double most[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int64_t e = 0; e < msh->element_count; e++) {
        for (int64_t k = msh->node_ptr[e]; element_dim(msh, e) == 2 && k < msh->node_ptr[e + 1]; k++) {
            for (int i = 0; i < 3; i++) {
                least[i] = fmin(least[i], msh->x[3 * msh->node_idx[k] + i]);
                most[i] = fmax(most[i], msh->x[3 * msh->node_idx[k] + i]);
            }
        }
    }
    double extent = fmax(most[0] - least[0], most[1] - least[1]);
    if (!(most[2] - least[2] <= FLATNESS * extent)) {
        return fail(
            draft->error, STATUS_INPUT,
            "a surface in space, without volume cells: mesh the volume (gmsh -3), or a plane z = const");
    }
    return STATUS_OK;
}

/* The names of all regions of the file, "a, b, c", for a message. */
static void list_regions(const struct mesh_draft *draft, bool some_unnamed, char list[], size_t size)
{
    size_t used = 0;
    list[0] = '\0';
    for (int32_t g = 0; g < draft->msh->group_count && used + 1 < size; g++) {
        const struct msh_group *group = &draft->msh->groups[g];
        if (group->dim == draft->mesh->dim && group->element_count > 0) {
            used += (size_t)snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", group->name);
        }
    }
    if (some_unnamed && used + 1 < size) {
        snprintf(list + used, size - used, "%s%s", used > 0 ? ", " : "", unnamed);
    }
}

/* Is `name` an item of the list? */
static bool is_listed(const char *list, const char *name)
{
    size_t length = strlen(name);
    for (const char *at = list; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        if (strncmp(at, name, length) == 0 && (at[length] == ',' || at[length] == '\0')) {
            return true;
        }
    }
    return false;
}

/* Every item of the list must be a region that is there. */
static enum status check_wanted(const struct mesh_draft *draft, const char *wanted, bool some_unnamed)
{
    const struct msh *msh = draft->msh;
    char present[256];
    list_regions(draft, some_unnamed, present, sizeof present);
    for (const char *at = wanted; at != NULL; at = strchr(at, ',')) {
        at += *at == ',';
        int length = (int)strcspn(at, ",");
        bool found =
            some_unnamed && length == (int)strlen(unnamed) && strncmp(at, unnamed, (size_t)length) == 0;
        for (int32_t g = 0; g < msh->group_count && !found; g++) {
            found = msh->groups[g].dim == draft->mesh->dim && msh->groups[g].element_count > 0 &&
                    strlen(msh->groups[g].name) == (size_t)length &&
                    strncmp(at, msh->groups[g].name, (size_t)length) == 0;
        }
        if (!found) {
            return fail(draft->error, STATUS_INPUT, "no cells in a region '%.*s': there are %s",
                        length < 100 ? length : 100, at, present);
        }
    }
    return STATUS_OK;
}

/* The one group of a cell; -1: none, or -2 with an error. */
static enum status cell_group(const struct mesh_draft *draft, int64_t element, int32_t *group)
{
    const struct msh *msh = draft->msh;
    int64_t first = msh->member_ptr[element];
    int64_t count = msh->member_ptr[element + 1] - first;
    if (count > 1) {
        return fail(draft->error, STATUS_INPUT,
                    "element %lld is in two physical groups, '%s' and '%s': keep it in one",
                    (long long)msh->element_tag[element], msh->groups[msh->member_idx[first]].name,
                    msh->groups[msh->member_idx[first + 1]].name);
    }
    *group = count == 1 ? msh->member_idx[first] : -1;
    return STATUS_OK;
}

/* Name the regions; region_of[element] receives the region of each cell that is kept, -1 for all else. */
static enum status pick_regions(struct mesh_draft *draft, const char *wanted, int32_t region_of[])
{
    enum status status = STATUS_OK;
    const struct msh *msh = draft->msh;
    struct mesh_names *regions = &draft->mesh->regions;
    int32_t *region_of_group = NULL; /* the last is for cells without a group */
    int64_t without = 0;
    TRY(NEW_ARRAY(&region_of_group, msh->group_count + 1, draft->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        without += element_dim(msh, e) == draft->mesh->dim && msh->member_ptr[e + 1] == msh->member_ptr[e];
    }
    TRY(wanted == NULL ? STATUS_OK : check_wanted(draft, wanted, without > 0));
    for (int32_t g = 0; g < msh->group_count; g++) {
        const struct msh_group *group = &msh->groups[g];
        region_of_group[g] = -1;
        if (group->dim == draft->mesh->dim && group->element_count > 0 &&
            (wanted == NULL || is_listed(wanted, group->name))) {
            region_of_group[g] = regions->count;
            TRY(mesh_add_group(regions, group, draft->error));
        }
    }
    region_of_group[msh->group_count] = -1;
    if (without > 0 && (wanted == NULL || is_listed(wanted, unnamed))) {
        int32_t same = find_name(regions, unnamed);
        region_of_group[msh->group_count] = same >= 0 ? same : regions->count;
        TRY(same >= 0 ? STATUS_OK : mesh_add_name(regions, unnamed, draft->error));
    }
    if (without > 0 && regions->count > 1) {
        TRY(mesh_add_note(draft, "%lld cells are in no physical group: region '%s'", (long long)without,
                          unnamed));
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        int32_t group = -1;
        region_of[e] = -1;
        if (element_dim(msh, e) == draft->mesh->dim) {
            TRY(cell_group(draft, e, &group));
            region_of[e] = region_of_group[group >= 0 ? group : msh->group_count];
        }
    }
done:
    free(region_of_group);
    return status;
}

/* ---- nodes ---- */

/* Number the nodes of the cells that are kept, in the order of the file, and take their coordinates. */
static enum status build_nodes(struct mesh_draft *draft, const int32_t region_of[], double unit)
{
    enum status status = STATUS_OK;
    enum { LOST = -1, IN_CELL = -2, KEPT = -3 };
    const struct msh *msh = draft->msh;
    struct mesh *mesh = draft->mesh;
    int64_t lost = 0;
    TRY(NEW_ARRAY(&draft->node_of, msh->node_count, draft->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        draft->node_of[n] = LOST;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        for (int64_t k = msh->node_ptr[e]; element_dim(msh, e) == mesh->dim && k < msh->node_ptr[e + 1];
             k++) {
            int32_t *node = &draft->node_of[msh->node_idx[k]];
            *node = region_of[e] >= 0 || *node == KEPT ? KEPT : IN_CELL;
        }
    }
    for (int64_t n = 0; n < msh->node_count; n++) {
        lost += draft->node_of[n] == LOST;
        draft->node_of[n] = draft->node_of[n] == KEPT ? (int32_t)mesh->node_count++ : -1;
    }
    if (lost > 0) {
        TRY(mesh_add_note(draft, "%lld nodes belong to no cell: left out", (long long)lost));
    }
    TRY(NEW_ARRAY(&mesh->x, mesh->node_count * mesh->dim, draft->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        for (int i = 0; i < mesh->dim && draft->node_of[n] >= 0; i++) {
            mesh->x[draft->node_of[n] * mesh->dim + i] = unit * msh->x[3 * n + i];
        }
    }
done:
    return status;
}

/* ---- cells ---- */

/* Twice the area or six times the volume of a simplex, signed, over the square or cube of its longest edge.
 */
static double relative_volume(const struct mesh *mesh, const int32_t cell[])
{
    int dim = mesh->dim;
    double edge[3][3] = {{0}};
    double longest = 0;
    for (int i = 0; i <= dim; i++) {
        for (int j = i + 1; j <= dim; j++) {
            double square = 0;
            for (int k = 0; k < dim; k++) {
                double d = mesh->x[cell[j] * dim + k] - mesh->x[cell[i] * dim + k];
                square += d * d;
                if (i == 0) {
                    edge[j - 1][k] = d;
                }
            }
            longest = fmax(longest, sqrt(square));
        }
    }
    if (!(longest > 0)) {
        return 0;
    }
    for (int i = 0; i < dim; i++) {
        for (int k = 0; k < dim; k++) {
            edge[i][k] /= longest;
        }
    }
    if (dim == 2) {
        return edge[0][0] * edge[1][1] - edge[0][1] * edge[1][0];
    }
    return edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) -
           edge[0][1] * (edge[1][0] * edge[2][2] - edge[1][2] * edge[2][0]) +
           edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
}

/* The simplices of an element of the mesh's own dimension. */
static int split_element(const struct mesh_draft *draft, int64_t element,
                         int32_t simplices[MSH_MOST_SIMPLICES][4])
{
    const struct msh *msh = draft->msh;
    int32_t node[8] = {0};
    for (int64_t k = msh->node_ptr[element]; k < msh->node_ptr[element + 1]; k++) {
        node[k - msh->node_ptr[element]] = draft->node_of[msh->node_idx[k]];
    }
    int count = msh_split(msh->element_type[element], node, false, simplices);
    if (draft->mesh->dim == 2 && count == 2 &&
        relative_volume(draft->mesh, simplices[0]) * relative_volume(draft->mesh, simplices[1]) <= 0) {
        count =
            msh_split(msh->element_type[element], node, true, simplices); /* not convex: the other diagonal */
    }
    return count;
}

static enum status add_cell(struct mesh_draft *draft, int64_t element, int32_t region,
                            const int32_t simplex[])
{
    struct mesh *mesh = draft->mesh;
    int64_t at = mesh->cell_count;
    int32_t *cell = &mesh->cells[at * (mesh->dim + 1)];
    memcpy(cell, simplex, (size_t)(mesh->dim + 1) * sizeof *cell);
    double volume = relative_volume(mesh, cell);
    if (!(fabs(volume) > LEAST_VOLUME)) {
        return fail(draft->error, STATUS_INPUT, "element %lld has no %s (its relative size is %.3g)",
                    (long long)draft->msh->element_tag[element], mesh->dim == 2 ? "area" : "volume",
                    fabs(volume));
    }
    if (volume < 0) {
        cell[0] = simplex[1];
        cell[1] = simplex[0];
    }
    mesh->cell_region[at] = region;
    draft->origin[at] = element;
    mesh->cell_count++;
    return STATUS_OK;
}

static enum status build_cells(struct mesh_draft *draft, const int32_t region_of[])
{
    enum status status = STATUS_OK;
    const struct msh *msh = draft->msh;
    struct mesh *mesh = draft->mesh;
    int32_t simplices[MSH_MOST_SIMPLICES][4];
    int64_t count = 0;
    for (int64_t e = 0; e < msh->element_count; e++) {
        count += region_of[e] >= 0 ? split_element(draft, e, simplices) : 0;
    }
    if (count > INT32_MAX) {
        status = fail(draft->error, STATUS_INPUT, "%lld cells are more than %d", (long long)count, INT32_MAX);
        goto done;
    }
    TRY(NEW_ARRAY(&mesh->cells, count * (mesh->dim + 1), draft->error));
    TRY(NEW_ARRAY(&mesh->cell_region, count, draft->error));
    TRY(NEW_ARRAY(&draft->origin, count, draft->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        int pieces = region_of[e] >= 0 ? split_element(draft, e, simplices) : 0;
        for (int i = 0; i < pieces; i++) {
            TRY(add_cell(draft, e, region_of[e], simplices[i]));
        }
    }
done:
    return status;
}

enum status mesh_build(struct mesh *mesh, const struct msh *msh, double unit, const char *wanted,
                       struct error *error)
{
    enum status status = STATUS_OK;
    struct mesh_draft draft = {.mesh = mesh, .msh = msh, .error = error};
    int32_t *region_of = NULL;
    *mesh = (struct mesh){0};
    TRY(find_dim(&draft));
    TRY(mesh->dim == 2 ? check_plane(&draft) : STATUS_OK);
    TRY(NEW_ARRAY(&region_of, msh->element_count, error));
    TRY(pick_regions(&draft, wanted, region_of));
    TRY(build_nodes(&draft, region_of, unit));
    TRY(mesh_check_coincident(&draft));
    TRY(build_cells(&draft, region_of));
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
