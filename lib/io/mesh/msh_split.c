#include "io/mesh/msh_build.h"

#include "io/mesh/mesh_input.h"

#include <string.h>

enum { TRIANGLE = 2, QUADRANGLE = 3, HEXAHEDRON = 5, PRISM = 6, PYRAMID = 7 };

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
    case PRISM:
    case PYRAMID:
        return split_solid(type, node, simplices);
    default:
        memcpy(simplices[0], node, (size_t)msh_type(type).node_count * sizeof node[0]);
        return 1;
    }
}
