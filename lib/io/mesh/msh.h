/* Meshes of gmsh (MSH 2.2 and 4.1, ASCII and binary) and of other programs (decks of Abaqus and CalculiX), in
 * two steps: msh_read reads a file as it is; mesh_build makes cells, facets and node sets of it. */
#pragma once

#include "base/names.h"
#include "base/status.h"
#include "io/stream/stream.h"

#include <stdbool.h>
#include <stdint.h>

/* A physical group. Where there is none of the dimension of the cells, or of their faces, the entities of
 * that dimension are groups in its place; not a single entity of all cells, which tells nothing. */
struct msh_group {
    int dim;    /* 0 points, 1 curves, 2 surfaces, 3 volumes */
    int tag;    /* as in the file */
    char *name; /* without blanks, commas and quotes; "group_TAG" where the file gives none; unique within its
                   dimension */
    int64_t element_count; /* 0 for a group with a name but no elements */
};

struct msh_node {
    int64_t tag;    /* distinct */
    double x[3];    /* in the unit of the file; finite */
    int64_t record; /* its place in the file, for messages */
};

struct msh_element {
    int64_t tag;         /* distinct */
    int64_t first;       /* of its nodes in node_idx */
    int64_t key, entity; /* while it is read: its group and its entity (msh_key); 0: none */
    int32_t group;       /* index into groups, -1: none */
    int8_t type;         /* gmsh's number of the type, one that msh_type knows */
    bool is_shell;       /* while a deck is read: it has sides S1 and S2 */
};

/* A mesh file as it is: elements of all dimensions, in the order of the file. What is in several groups is an
 * element of its own for each. */
struct msh {
    int64_t node_count;
    struct msh_node *nodes; /* node_count */
    int64_t element_count;
    struct msh_element *elements; /* element_count */
    int32_t *node_idx;            /* the nodes of each element, in gmsh's order: indices into nodes */
    int32_t group_count;
    struct msh_group *groups; /* ascending in (dim, tag) */
    bool by_entity[4];        /* of each dimension: the groups are entities */
    struct names notes;       /* what the file says that is not read; remarks on what was left out, one line
                                 each; these may contain blanks */
};

/* A type of element. */
struct msh_type {
    const char *name; /* "triangle", or NULL: not an element of first or second order */
    int dim;
    int node_count;
    int linear; /* number of the first-order type with its corners, which come first; for first order its own
                   number */
};

/* Most nodes of an element. */
#define MSH_MOST_NODES 27

/* The type with this number in gmsh; its name is NULL if it is not an element of first or second order. */
struct msh_type msh_type(int64_t number);

/* Read a mesh from its bytes; `region_array` names the array of the cells of a VTK file that tells the
 * regions, or NULL. STATUS_INPUT if they are not a complete, valid mesh file; the message names section and
 * record, or for a file of another version or program the command that converts it. STATUS_SYSTEM: memory.
 * Time and memory are proportional to the size, whatever counts the file states (what is compressed: to its
 * size when it is not). On failure *msh is empty. */
MUST_CHECK enum status msh_parse(struct msh *msh, const char *bytes, size_t size, const char *region_array,
                                 struct error *error);

/* Read a mesh from an open descriptor (a regular file or a pipe), which stays open. Messages begin with
 * `name`. Errors as msh_parse; STATUS_SYSTEM also for read failures. */
MUST_CHECK enum status msh_read(struct msh *msh, int descriptor, const char *name, const char *region_array,
                                struct error *error);
void msh_free(struct msh *msh);

/* Put the mesh of `msh` into an empty stream: nodes.x, cells and cells.region, facets and facets.set if there
 * are facets, sets.ptr and sets.idx if there are sets; add remarks to msh->notes. `unit`: of the file's
 * lengths, m; `regions`: comma-separated list of regions to keep, or NULL: all. The dimension is 3 if there
 * are tetrahedra, hexahedra, prisms or pyramids, else 2 if there are triangles or quadrangles in a plane z =
 * const. Quadrangles and the cells of more than four nodes are split into simplices so that neighbours
 * conform (every quadrangular face along the diagonal through its lowest node: Dompierre et al., How to
 * subdivide pyramids, prisms and hexahedra into tetrahedra, 1999). Midside nodes are dropped. Nodes keep
 * their order; those without a kept cell are dropped. Facets of one entity all over the boundary get no name.
 * A cell in two groups belongs to the one with the lowest tag; a repeated cell counts once; cells in no group
 * are the region 'body' if there is no other region, else 'unnamed'. STATUS_INPUT for no cells, a surface in
 * space, cells without volume or overlapping cells, an unknown region, and two node sets with one name. */
MUST_CHECK enum status mesh_build(struct msh *msh, double unit, const char *regions, struct stream *stream,
                                  struct error *error);
