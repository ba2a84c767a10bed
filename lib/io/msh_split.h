/* Splitting elements into simplices, so that elements with a common face split it in the same way. */
#ifndef IO_MSH_SPLIT_H
#define IO_MSH_SPLIT_H

#include <stdbool.h>
#include <stdint.h>

/* Elements of first order that an element is made of: places in its list of nodes. */
struct msh_pieces {
    int type;  /* of each piece */
    int count; /* 0: an element of second order that cannot be split at its midside nodes */
    int8_t node[8][8];
};

/* With `midside`, an element of second order is split at its midside nodes; without, it is the one of first
 * order on its corners. */
const struct msh_pieces *msh_pieces(int type, bool midside);

#define MSH_MOST_SIMPLICES 6

/* Split an element of first order with these nodes in gmsh's order, into simplices of its
 * dimension: simplices[i][0 .. dim]. Returns how many. Their orientation is left open. A quadrangle, and each
 * quadrangular face, is split along the diagonal through its lowest node. With `other`, a quadrangle is split
 * along the other one (that is for meshes of the plane, whose cells share no quadrangles). */
int msh_split(int type, const int32_t node[], bool other, int32_t simplices[MSH_MOST_SIMPLICES][4]);

#endif
