#include "io/mesh/msh_build.h"

#include "io/mesh/msh.h"

#include <string.h>

enum { TRIANGLE = 2, QUADRANGLE = 3, HEXAHEDRON = 5, PRISM = 6, PYRAMID = 7 };

/* The faces of an element, 3 or 4 nodes each in a ring; -1 fills up. */
struct faces {
    int count;
    int8_t node[6][4];
};

static const struct faces hexahedron_faces = {
    6, {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
static const struct faces prism_faces = {
    5, {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}};
static const struct faces pyramid_faces = {
    5, {{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};

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
static int split_solid(const struct faces *faces, const int32_t node[], int node_count,
                       int32_t tetrahedra[][4])
{
    int32_t apex = node[lowest(node, node_count)];
    int count = 0;
    for (int f = 0; f < faces->count; f++) {
        int32_t ring[4];
        bool touches = false;
        int corners = faces->node[f][3] < 0 ? 3 : 4;
        for (int k = 0; k < corners; k++) {
            ring[k] = node[faces->node[f][k]];
            touches = touches || ring[k] == apex;
        }
        if (touches) {
            continue;
        }
        int added = msh_split(corners == 3 ? TRIANGLE : QUADRANGLE, ring, false, tetrahedra + count);
        for (int end = count + added; count < end; count++) {
            tetrahedra[count][3] = apex;
        }
    }
    return count;
}

int msh_split(int type, const int32_t node[], bool other, int32_t simplices[MSH_MOST_SIMPLICES][4])
{
    switch (type) {
    case QUADRANGLE:
        return split_quadrangle(node, other, simplices);
    case HEXAHEDRON:
        return split_solid(&hexahedron_faces, node, 8, simplices);
    case PRISM:
        return split_solid(&prism_faces, node, 6, simplices);
    case PYRAMID:
        return split_solid(&pyramid_faces, node, 5, simplices);
    default:
        memcpy(simplices[0], node, (size_t)msh_type(type).node_count * sizeof node[0]);
        return 1;
    }
}
