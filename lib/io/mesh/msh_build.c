/* The mesh of a file: its nodes, its cells as simplices, and all of it in a stream. */
#include "io/mesh/msh_build.h"

#include "base/memory.h"
#include "base/round_off.h"
#include "base/vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- splitting elements ---- */

enum { QUADRANGLE = 3 };

const int8_t msh_face_corners[8][6][4] = {
    [2] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 0, -1, -1}},
    [3] = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {3, 0, -1, -1}},
    [4] = {{0, 1, 2, -1}, {0, 3, 1, -1}, {1, 3, 2, -1}, {2, 3, 0, -1}},
    [5] = {{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}},
    [6] = {{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}},
    [7] = {{0, 1, 2, 3}, {0, 4, 1, -1}, {1, 4, 2, -1}, {2, 4, 3, -1}, {3, 4, 0, -1}},
};

static int lowest(const int32_t node[], int count)
{
    int low = 0;
    for (int i = 1; i < count; i++) {
        low = node[i] < node[low] ? i : low;
    }
    return low;
}

static int split_quadrangle(const int32_t ring[4], bool other, int32_t triangles[][4])
{
    int low = lowest(ring, 4) + other;
    int32_t a = ring[low % 4];
    int32_t c = ring[(low + 2) % 4];
    memcpy(triangles[0], (int32_t[4]){a, ring[(low + 1) % 4], c, -1}, sizeof triangles[0]);
    memcpy(triangles[1], (int32_t[4]){a, c, ring[(low + 3) % 4], -1}, sizeof triangles[1]);
    return 2;
}

/* Join the lowest node to the triangles of the faces without it. The faces with it are thus split along the
 * diagonals through it. */
static int split_solid(int type, const int32_t node[], int32_t tetrahedra[][4])
{
    const int8_t(*faces)[4] = msh_face_corners[type];
    int32_t apex = node[lowest(node, msh_type(type).node_count)];
    int count = 0;
    for (int f = 0; f < 6 && faces[f][0] != faces[f][1]; f++) {
        int32_t ring[4];
        bool touches = false;
        int corners = faces[f][3] < 0 ? 3 : 4;
        for (int k = 0; k < corners; k++) {
            ring[k] = node[faces[f][k]];
            touches = touches || ring[k] == apex;
        }
        if (touches) {
            continue;
        }
        int added = 1;
        if (corners == 4) {
            added = split_quadrangle(ring, false, tetrahedra + count);
        } else {
            memcpy(tetrahedra[count], ring, 3 * sizeof *ring);
        }
        for (int end = count + added; count < end; count++) {
            tetrahedra[count][3] = apex;
        }
    }
    return count;
}

/* Split an element of first order, with these nodes in gmsh's order, into simplices of its dimension,
 * simplices[i][0 .. dim], of any orientation. Returns their number. A quadrangle, and each quadrangular face,
 * is split along the diagonal through its lowest node; with `other`, a quadrangle is split along the other
 * diagonal (for meshes in the plane, whose cells share no quadrangles). */
static int split(int type, const int32_t node[], bool other, int32_t simplices[MSH_MOST_SIMPLICES][4])
{
    if (type == QUADRANGLE) {
        return split_quadrangle(node, other, simplices);
    }
    if (msh_type(type).node_count > 4) {
        return split_solid(type, node, simplices);
    }
    memcpy(simplices[0], node, (size_t)msh_type(type).node_count * sizeof node[0]);
    return 1;
}

/* ---- nodes and cells ---- */

/* Number the nodes of kept cells in the order of the file, and copy their coordinates. */
static enum status build_nodes(struct mesh *mesh)
{
    enum { LOST = -1, IN_CELL = -2, KEPT = -3 };
    const struct msh *msh = mesh->msh;
    int64_t lost = 0;
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->node_of, msh->node_count, mesh->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        mesh->node_of[n] = LOST;
    }
    for (int64_t e = 0; e < msh->element_count; e++) {
        int used = mesh_element_dim(mesh, e) == mesh->dim ? mesh_corners(mesh, e) : 0;
        for (int k = 0; k < used; k++) {
            int32_t *node = &mesh->node_of[msh->node_idx[msh->elements[e].first + k]];
            *node = mesh->region_of[e] >= 0 || *node == KEPT ? KEPT : IN_CELL;
        }
    }
    for (int64_t n = 0; n < msh->node_count; n++) {
        lost += mesh->node_of[n] == LOST;
        mesh->node_of[n] = mesh->node_of[n] == KEPT ? (int32_t)mesh->node_count++ : -1;
    }
    if (lost > 0) {
        RETURN_IF_ERROR(mesh_add_note(mesh, "midside nodes, and nodes of no cell, left out: %jd", lost));
    }
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->x, mesh->node_count * mesh->dim, mesh->error));
    for (int64_t n = 0; n < msh->node_count; n++) {
        for (int i = 0; i < mesh->dim && mesh->node_of[n] >= 0; i++) {
            mesh->x[mesh->node_of[n] * mesh->dim + i] = mesh->unit * msh->nodes[n].x[i];
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

int mesh_simplices(const struct mesh *mesh, int64_t element, int32_t simplices[MSH_MOST_SIMPLICES][4])
{
    const struct msh_element *whole = &mesh->msh->elements[element];
    int type = msh_type(whole->type).linear;
    int32_t node[8];
    for (int k = 0; k < mesh_corners(mesh, element); k++) {
        node[k] = mesh->node_of[mesh->msh->node_idx[whole->first + k]];
    }
    int count = split(type, node, false, simplices);
    if (mesh->dim == 2 && count == 2 &&
        relative_volume(mesh, simplices[0]) * relative_volume(mesh, simplices[1]) <= 0) {
        count = split(type, node, true, simplices); /* not convex: use the other diagonal */
    }
    return count;
}

static enum status add_cell(struct mesh *mesh, int64_t element, int32_t region, const int32_t simplex[])
{
    int64_t at = mesh->cell_count;
    int32_t *cell = &mesh->cells[at * (mesh->dim + 1)];
    memcpy(cell, simplex, (size_t)(mesh->dim + 1) * sizeof *cell);
    double volume = relative_volume(mesh, cell);
    if (!(fabs(volume) > ROUND_OFF)) {
        return fail(mesh->error, STATUS_INPUT, "element %jd has no %s (its relative size is %.3g)",
                    mesh->msh->elements[element].tag, mesh->dim == 2 ? "area" : "volume", fabs(volume));
    }
    if (volume < 0) {
        cell[0] = simplex[1];
        cell[1] = simplex[0];
    }
    mesh->cell_region[at] = region;
    mesh->origin[at] = element;
    mesh->cell_count++;
    return STATUS_OK;
}

static enum status build_cells(struct mesh *mesh)
{
    const struct msh *msh = mesh->msh;
    int32_t simplices[MSH_MOST_SIMPLICES][4];
    int64_t count = 0;
    for (int64_t e = 0; e < msh->element_count; e++) {
        count += mesh->region_of[e] >= 0 ? mesh_simplices(mesh, e, simplices) : 0;
    }
    if (count > INT32_MAX) {
        return fail(mesh->error, STATUS_INPUT, "%jd cells are more than %d", count, INT32_MAX);
    }
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->cells, count * (mesh->dim + 1), mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->cell_region, count, mesh->error));
    RETURN_IF_ERROR(NEW_ARRAY(&mesh->origin, count, mesh->error));
    for (int64_t e = 0; e < msh->element_count; e++) {
        int pieces = mesh->region_of[e] >= 0 ? mesh_simplices(mesh, e, simplices) : 0;
        for (int i = 0; i < pieces; i++) {
            RETURN_IF_ERROR(add_cell(mesh, e, mesh->region_of[e], simplices[i]));
        }
    }
    return STATUS_OK;
}

/* ---- into a stream ---- */

/* Put the arrays, which the stream takes. */
static enum status put(struct mesh *mesh, struct stream *stream)
{
    int64_t dim = mesh->dim, sets = mesh->node_sets.count;
    const struct {
        const char *name;
        enum element_type type;
        int64_t rows, cols;
        const struct names *names;
        void *array;
    } parts[] = {
        {"nodes.x", TYPE_F8, mesh->node_count, dim, NULL, &mesh->x},
        {"cells", TYPE_I4, mesh->cell_count, dim + 1, NULL, &mesh->cells},
        {"cells.region", TYPE_I4, mesh->cell_count, 1, &mesh->regions, &mesh->cell_region},
        {"facets", TYPE_I4, mesh->facet_count, dim, NULL, &mesh->facets},
        {"facets.set", TYPE_I4, mesh->facet_count, 1, &mesh->facet_sets, &mesh->facet_set},
        {"sets.ptr", TYPE_I8, sets > 0 ? sets + 1 : 0, 1, &mesh->node_sets, &mesh->set_ptr},
        {"sets.idx", TYPE_I4, mesh->set_ptr[sets], 1, NULL, &mesh->set_idx},
    };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        const char *attributes = i > 0 ? "" : dim == 2 ? "unit=m cols=x,y" : "unit=m cols=x,y,z";
        void *array = array_take(parts[i].array);
        if (parts[i].rows == 0) {
            free(array);
            continue;
        }
        RETURN_IF_ERROR(parts[i].names != NULL
                            ? stream_put_named(stream, parts[i].name, parts[i].type, parts[i].rows,
                                               parts[i].names, array, true, mesh->error)
                            : stream_put(stream, parts[i].name, parts[i].type, parts[i].rows, parts[i].cols,
                                         attributes, array, true, mesh->error));
    }
    return STATUS_OK;
}

static void mesh_free(struct mesh *mesh)
{
    FREE_ALL(mesh->x, mesh->cells, mesh->cell_region, mesh->facets, mesh->facet_set, mesh->set_ptr,
             mesh->set_idx, mesh->region_of, mesh->node_of, mesh->origin, mesh->face, mesh->group_ptr,
             mesh->group_idx, mesh->face_stamp, mesh->node_stamp);
    names_free(&mesh->regions);
    names_free(&mesh->facet_sets);
    names_free(&mesh->node_sets);
}

enum status mesh_build(struct msh *msh, double unit, const char *regions, struct stream *stream,
                       struct error *error)
{
    FREED_BY(mesh_free) struct mesh mesh = {.msh = msh, .unit = unit, .wanted = regions, .error = error};
    RETURN_IF_ERROR(mesh_find_dim(&mesh));
    RETURN_IF_ERROR(mesh_pick_regions(&mesh));
    RETURN_IF_ERROR(build_nodes(&mesh));
    RETURN_IF_ERROR(build_cells(&mesh));
    RETURN_IF_ERROR(mesh_build_facets(&mesh));
    return put(&mesh, stream);
}
