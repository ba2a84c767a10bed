#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"
#include "io/mesh/msh_build.h"

#include <math.h>
#include <string.h>

enum status mesh_build_nodes(struct mesh_draft *draft)
{
    enum { LOST = -1, IN_CELL = -2, KEPT = -3 };
    const struct msh *msh = draft->msh;
    struct mesh *mesh = draft->mesh;
    int64_t lost = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&draft->node_of, msh->node_count, draft->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        draft->node_of[n] = LOST;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        int used = mesh_element_dim(draft, e) == mesh->dim ? mesh_corners(draft, e) : 0;
        for (int k = 0; k < used; k++) {
            int32_t *node = &draft->node_of[msh->node_idx[msh->elements[e].first + k]];
            *node = draft->region_of[e] >= 0 || *node == KEPT ? KEPT : IN_CELL;
        }
    }
    for (int64_t n = 0; n < msh->node_count; n++) {
        lost += draft->node_of[n] == LOST;
        draft->node_of[n] = draft->node_of[n] == KEPT ? (int32_t)mesh->node_count++ : -1;
    }
    if (lost > 0) {
        RETURN_IF_ERROR(
            mesh_add_note(draft, "midside nodes, and nodes of no cell, left out: %lld", (long long)lost));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->x, mesh->node_count * mesh->dim, draft->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        for (int i = 0; i < mesh->dim && draft->node_of[n] >= 0; i++) {
            mesh->x[draft->node_of[n] * mesh->dim + i] = draft->options->unit * msh->nodes[n].x[i];
        }
    }
    return STATUS_OK;
}

/* Twice the area or six times the volume of a simplex, signed, over the square or cube of its longest edge.
 */
static double relative_volume(const struct mesh *mesh, const int32_t cell[])
{
    int dim = mesh->dim;
    double edge[3][3] = {{0}};
    double longest = 0;
    for (int i = 0; i <= dim; i++) {
        for (int j = i + 1; j <= dim; j++) {
            const double *from = mesh->x + (int64_t)cell[i] * dim, *to = mesh->x + (int64_t)cell[j] * dim;
            longest = fmax(longest, vector_distance(dim, to, from));
            if (i == 0) {
                vector_subtract(dim, to, from, edge[j - 1]);
            }
        }
    }
    if (!(longest > 0)) {
        return 0;
    }
    for (int i = 0; i < 9; i++) {
        edge[i / 3][i % 3] /= longest;
    }
    return dim == 2 ? determinant2(edge[0], edge[1]) : determinant3(edge[0], edge[1], edge[2]);
}

int mesh_simplices(const struct mesh_draft *draft, int64_t element, int32_t simplices[MSH_MOST_SIMPLICES][4])
{
    const struct msh_element *whole = &draft->msh->elements[element];
    int type = msh_type(whole->type).linear;
    int32_t node[8];
    for (int k = 0; k < mesh_corners(draft, element); k++) {
        node[k] = draft->node_of[draft->msh->node_idx[whole->first + k]];
    }
    int count = msh_split(type, node, false, simplices);
    if (draft->mesh->dim == 2 && count == 2 &&
        relative_volume(draft->mesh, simplices[0]) * relative_volume(draft->mesh, simplices[1]) <= 0) {
        count = msh_split(type, node, true, simplices); /* not convex: use the other diagonal */
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
    if (!(fabs(volume) > ROUND_OFF)) {
        return fail(draft->error, STATUS_INPUT, "element %lld has no %s (its relative size is %.3g)",
                    (long long)draft->msh->elements[element].tag, mesh->dim == 2 ? "area" : "volume",
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

enum status mesh_build_cells(struct mesh_draft *draft)
{
    const struct msh *msh = draft->msh;
    struct mesh *mesh = draft->mesh;
    int32_t simplices[MSH_MOST_SIMPLICES][4];
    int64_t count = 0;
    for (int64_t e = 0; e < msh->element_count; e++) {
        count += draft->region_of[e] >= 0 ? mesh_simplices(draft, e, simplices) : 0;
    }
    if (count > INT32_MAX) {
        return fail(draft->error, STATUS_INPUT, "%lld cells are more than %d", (long long)count, INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->cells, count * (mesh->dim + 1), draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->cell_region, count, draft->error));
    RETURN_IF_ERROR(NEW_ARRAY(&draft->origin, count, draft->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        int pieces = draft->region_of[e] >= 0 ? mesh_simplices(draft, e, simplices) : 0;
        for (int i = 0; i < pieces; i++) {
            RETURN_IF_ERROR(add_cell(draft, e, draft->region_of[e], simplices[i]));
        }
    }
    return STATUS_OK;
}
