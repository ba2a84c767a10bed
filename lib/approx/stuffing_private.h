/* The steps of stuffing_make, private to lib/approx. */
#ifndef APPROX_STUFFING_PRIVATE_H
#define APPROX_STUFFING_PRIVATE_H

#include "approx/stuffing.h"

/* The lattice whose cells are cut. 3D: corners and centres of cubes, which are leaves of an octree; 2D:
 * equilateral triangles. Cells whose points are all outside are left out. */
struct lattice {
    const struct labels *labels;
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
    double
        *cut; /* edge_count: where it is cut, as a fraction from its first end; 0: it is not, as an end is */
    int64_t *edge_ptr; /* node_count + 1: the edges at each node, */
    int32_t *edge_idx;
    bool *on; /* node_count: moved onto an interface */
};

/* Lay the lattice over the labels and find the label of each point. */
MUST_CHECK enum status lattice_make(const struct labels *labels, const struct stuffing_options *options,
                                    struct lattice *lattice, struct error *error);
void lattice_free(struct lattice *lattice);

/* Find where edges are cut, and move points that lie near a cut onto it. */
MUST_CHECK enum status lattice_cut(struct lattice *lattice, struct error *error);

/* The edge between two nodes, -1 when it is not cut. */
int64_t lattice_edge(const struct lattice *lattice, int32_t p, int32_t q);

/* Cut the lattice's cells into cells of one label each; label 0 is left out. */
MUST_CHECK enum status lattice_cells(const struct lattice *lattice, struct stuffing *stuffing,
                                     struct error *error);

/* Leaves of the octree over count[3] cubes of the finest level. */
enum { OCTREE_MOST_LEVELS = 8 };
struct octree {
    int levels;                           /* level 0 is the coarsest, levels - 1 the finest */
    int64_t count[OCTREE_MOST_LEVELS][3]; /* cubes of each level along each axis */
    bool *split[OCTREE_MOST_LEVELS]; /* of each cube: whether it, or the one that it would be in, is split;
                                        NULL for the finest */
};

/* Split the cubes of an octree so that cubes for which wanted[] holds are of the finest level, with all that
 * touch them, and cubes that touch differ by one level at most. count[] are multiples of 2^(levels - 1);
 * wanted[] is changed. */
MUST_CHECK enum status octree_make(int levels, const int64_t count[3], bool *wanted, struct octree *octree,
                                   struct error *error);
void octree_free(struct octree *octree);

/* Call tell(context, corner) for each tetrahedron between the leaves: four points, each x, y, z in halves of
 * the finest cube's edge. Stops when tell fails. */
typedef enum status octree_tell(void *context, const int32_t corner[4][3]);
MUST_CHECK enum status octree_cells(const struct octree *octree, octree_tell *tell, void *context);

/* Keep the cells of labels that are wanted, without specks, cut apart what hangs together by nodes or edges
 * alone, and find the boundary. (*apart)[node_count], allocated: nodes that have others at the same place.
 * dropped[labels]: the volume of bodies that are left out is added, m3. */
MUST_CHECK enum status stuffing_keep(const struct stuffing_options *options, struct stuffing *stuffing,
                                     bool **apart, double *dropped, struct error *error);

/* Cells at each node and the labels that meet there. */
enum { STUFFING_MOST_LABELS = 4 };
struct stuffing_star {
    int64_t *ptr;  /* node_count + 1 */
    int32_t *cell; /* ptr[node_count] */
    uint16_t (*label)[STUFFING_MOST_LABELS];
    uint8_t *labels; /* node_count: labels that meet; 1: not on an interface */
};
MUST_CHECK enum status star_make(const struct stuffing *stuffing, struct stuffing_star *star,
                                 struct error *error);
void star_free(struct stuffing_star *star);

/* The poorest score of the cells at a node: the score of a cell is 1 where its angles just keep within the
 * bounds, and negative where it is inverted. */
double star_score(const struct stuffing *stuffing, const struct stuffing_star *star, int64_t node);
double stuffing_score(const struct stuffing *stuffing, int64_t cell);

/* Move x onto the interface of the labels, at most four; false where there is none near. */
bool interface_project(const struct labels *labels, int count, const uint16_t label[], double x[]);

/* Move the nodes of cells that score less than `least`, those of interfaces within these or at most `slack`,
 * m, off, until they score more. */
void stuffing_repair(const struct labels *labels, double least, double slack, struct stuffing *stuffing,
                     const struct stuffing_star *star);

/* Move nodes: where labels meet onto their interfaces, those apart[] away from the others at the same place,
 * poor cells into shape, and interfaces for the volumes of labels. */
MUST_CHECK enum status stuffing_improve(const struct labels *labels, const struct stuffing_options *options,
                                        const bool *apart, const double *dropped, struct stuffing *stuffing,
                                        struct error *error);

/* Correct the volumes of labels, those of their voxels less dropped[], by small moves of interfaces, without
 * the nodes apart[]. */
MUST_CHECK enum status stuffing_volumes(const struct labels *labels, const bool *keep, const bool *apart,
                                        const double *dropped, const struct stuffing_star *star,
                                        struct stuffing *stuffing, struct error *error);

/* Move a node towards `target` as far as its cells allow. */
void star_move(struct stuffing *stuffing, const struct stuffing_star *star, int64_t node,
               const double target[]);

#endif
