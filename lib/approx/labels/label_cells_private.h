/* The steps of label_cells_make, private to lib/approx. */
#pragma once

#include "approx/cells/cells.h"
#include "approx/labels/label_cells.h"
#include "base/vector.h"

/* The lattice whose cells are cut. 3D: corners and centres of cubes, which are leaves of an octree; 2D:
 * equilateral triangles. Cells whose points are all outside are left out. */
struct lattice {
    const struct labels *labels;
    const bool *keep; /* labels->count: labels of the body */
    int dim;
    int64_t node_count;
    double *x;       /* node_count * dim, m; lattice_cut moves some onto interfaces */
    uint16_t *label; /* node_count */
    int32_t *place;  /* node_count * 3: in halves of the finest cube's edge; 2D: zero */
    int64_t cell_count;
    int32_t *cell; /* cell_count * (dim + 1), positively oriented */
    /* Edges between points of different labels: */
    int64_t edge_count;
    int32_t *end; /* edge_count * 2, the lower node first; ascending */
    double *cut;  /* edge_count: place of the cut, as a fraction from the first end; 0: not cut, as an end is
                     on the interface */
    int64_t *edge_ptr; /* node_count + 1: the edges at each node, */
    int32_t *edge_idx;
    bool *on;       /* node_count: moved onto an interface */
    double unsized; /* as of struct label_cells */
};

/* Lay the lattice over the labels and find the label of each point. */
MUST_CHECK enum status lattice_make(const struct labels *labels, const struct label_cells_options *options,
                                    struct lattice *lattice, struct error *error);
void lattice_free(struct lattice *lattice);

/* Locate the cuts of edges, and move points near a cut onto it. */
MUST_CHECK enum status lattice_cut(struct lattice *lattice, struct error *error);

/* Cut the lattice's cells into cells of one label each, including the outside. (*between)[cell_count], to be
 * freed: cells all of whose nodes lie on interfaces. */
MUST_CHECK enum status lattice_cells(const struct lattice *lattice, struct label_cells *mesh, bool **between,
                                     struct error *error);

/* Leaves of the octree over count[3] cubes of the finest level. */
enum { OCTREE_MOST_LEVELS = 8 };
struct octree {
    int levels;                           /* level 0 is the coarsest, levels - 1 the finest */
    int64_t count[OCTREE_MOST_LEVELS][3]; /* cubes of each level along each axis */
    bool *split[OCTREE_MOST_LEVELS]; /* of each cube of a level: whether it is split, if it exists; NULL for
                                        the finest */
};

/* The wanted refinement at a cube of the finest level: the least level, and whether all cubes that touch it
 * must have that level, too. */
#define OCTREE_WISH(level, around) ((uint8_t)(2 * (level) + (around)))

/* Refine an octree so that wish[] of the finest cubes holds, and cubes that touch differ by at most one
 * level. count[] are multiples of 2^(levels - 1); wish[] is changed. */
MUST_CHECK enum status octree_make(int levels, const int64_t count[3], uint8_t *wish, struct octree *octree,
                                   struct error *error);
void octree_free(struct octree *octree);

/* Call visit(context, corner) for each tetrahedron between the leaves: four points, x, y, z in halves of the
 * finest cube's edge. Stops on the first failure. */
typedef enum status octree_visitor(void *context, const int32_t corner[4][3]);
MUST_CHECK enum status octree_cells(const struct octree *octree, octree_visitor *visit, void *context);

/* The cells at each node, and the labels that meet there. */
enum { LABEL_CELLS_MOST_LABELS = 8 };
struct label_cells_star {
    int64_t *ptr;  /* node_count + 1 */
    int32_t *cell; /* ptr[node_count] */
    uint16_t (*label)[LABEL_CELLS_MOST_LABELS];
    uint8_t *labels; /* node_count: labels that meet; 1: not on an interface */
};
void star_free(struct label_cells_star *star);

/* The body that is made. The cells around it are part of `mesh`: as long as none of them is inverted, no wall
 * of the body passes through another one. */
struct label_body {
    const struct labels *labels;
    const struct label_cells_options *options;
    struct label_cells *mesh;
    double voxel;    /* of labels, m */
    bool *between;   /* cell_count: all nodes lie on interfaces */
    bool *wanted;    /* cell_count: of the body; the others lie around it */
    bool *apart;     /* node_count: nodes that have others at the same place */
    double *volume;  /* labels->count: that the cells of each label are to have, m3 */
    int32_t *across; /* cells_across */
    int32_t *group;  /* cell_count: -1 between calls, or the connected body of a cell */
    int32_t *stack;  /* cell_count */
    int32_t *from;   /* cell_count */
    struct label_cells_star star;
    double *place; /* node_count * dim: of the nodes on interfaces, */
    double *off;   /* node_count: and how far they are from there, m; infinity: there is none near */
};

/* Set the star: cells at nodes, and the labels there of wanted cells (NULL: of all) and of facets. */
MUST_CHECK enum status star_make(struct label_body *body, struct error *error);

/* Choose the cells of wanted labels, without specks; join or cut apart parts that share only nodes or edges;
 * and find the boundary. */
MUST_CHECK enum status label_cells_keep(struct label_body *body, struct error *error);

/* Drop the cells that are not wanted, and nodes without cells. */
MUST_CHECK enum status label_cells_drop(const bool *wanted, struct label_cells *mesh, struct error *error);

/* Renumber the nodes without those that have no cell. */
MUST_CHECK enum status label_cells_compact(struct label_cells *mesh, struct error *error);

/* Number the wanted cells without a group that are connected with the first; only by faces at `node`, unless
 * that is -1. Returns how many, which stack[] lists. */
int64_t label_cells_flood(struct label_body *body, int64_t first, int32_t number, int64_t node);

/* Resolve places where parts share only a node or an edge (non-manifold boundary): add cells all of whose
 * nodes lie on interfaces so that the parts share faces, or remove such cells. No node leaves its
 * interface. */
void label_cells_join(struct label_body *body);

/* Separate the bodies, numbered in group[], where they share only a node or an edge. */
MUST_CHECK enum status label_cells_cut_apart(struct label_body *body, struct error *error);

/* Voxels by which nodes leave their interface for the sake of volumes, and farther than which they are
 * brought nearer. */
#define LABEL_CELLS_NEAR (0.9 * LABEL_CELLS_MOST_ASTRAY)

/* The score below which cells are improved, and that moves of nodes of interfaces leave. In the end, nodes
 * that are far from their interface are moved towards it as long as the bounds hold: a score of 1. */
#define LABEL_CELLS_GOOD 1.25

/* Sweeps of each kind that move nodes. */
enum { LABEL_CELLS_SWEEPS = 6 };

/* Move a node towards `target` as far as no cell at it scores less than before and than `least`. around: also
 * move the nodes around it, those on interfaces on these, and those with others at the same place not.
 * Returns whether it is at the target. */
bool star_move(const struct label_body *body, int64_t node, const double target[], double least, bool around);

/* Move the nodes of cells that score less than `least` until they score more. Nodes of interfaces stay on
 * these. */
void label_cells_repair(const struct label_body *body, double least);

/* Move x to the place of a node: where all its labels meet, if that is wanted and they do; on the boundary to
 * the surface of the body; elsewhere to the nearest interface of its labels. Where Newton's method finds none
 * near it is searched for within `reach`, m. Returns the distance; infinity if there is none. */
double node_place(const struct label_body *body, int64_t node, bool meeting, double reach, double x[]);

/* Largest distance of a search for an interface, voxels. */
#define LABEL_CELLS_REACH 6.0

/* Gradient of a cell's volume with respect to the position of its corner k. */
void label_cells_gradient(const struct label_cells *mesh, int64_t cell, int k, double gradient[3]);
