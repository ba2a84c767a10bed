/* Values of the displacement field from which smoothed cells are computed: the rows of edges and of
 * boundary faces (approx/cells/face_edges.h), then the values at the vertices.
 *
 * An evaluation computes the values (apply), evaluates the cells, sums the forces of the cells on each value,
 * and adds these to the nodes (transposed apply), equation (12) of lib/README.md. A use is that of a row by a
 * cell. A part is the force on a row of all cells of a block. */
#pragma once

#include "approx/cells/face_edges.h"
#include "solid/body/body_rows.h"

#include <stdbool.h>

/* Stride of displacements and forces in the force loop, in doubles: 2, or 3 padded to 4. */
#define VECTOR_STRIDE(dim) ((dim) == 2 ? 2 : 4)

struct body;

/* The rows of B, those of edges and boundary faces, then one for each node, are the body's (body.h). With
 * several processes those computed by others are empty. */
struct field_averages {
    int64_t row_count;
    double *value; /* of each row at the last evaluation, m, with stride VECTOR_STRIDE(dim) */
    double *force; /* on each row, with that stride, N (2D: N/m) */
    int64_t cell_count;
    int32_t *of_use; /* offsets in value[] of the rows: of the CELL_EDGES(dim) edges of each cell, then of the
                        dim + 1 vertices of each cell, then of boundary faces */
    int64_t *use_ptr;      /* row_count + 1: the uses of each row, */
    int32_t *use;          /* ascending in each row */
    int64_t *part_first;   /* of each block of the body, and of the end: its first part, */
    uint16_t *part_of_use; /* and which of its parts each use is in */
    double *part_force;    /* dim of each part, and one more, unused: N (2D: N/m) */
    int64_t *part_ptr;     /* row_count + 1: the parts of each row, */
    int32_t *part;         /* ascending in each row */
    int64_t face_count;    /* boundary faces, by their cells: */
    int64_t *face_cell;    /* the cell of each, ascending, */
    int32_t *face_vertex;  /* which of its vertices is opposite, */
    double *face_gradient; /* and the gradient of that vertex's linear shape function, 3 of each, 1/m (2D: the
                              last 0) */
    struct row_table given[2]; /* with several processes: the caller's tables, edges and nodes, */
    int64_t *edge_order;       /* and the order of the former's rows */
};

/* The first use of the vertices. */
static inline int64_t field_averages_vertices(const struct field_averages *averages, int dim)
{
    return averages->cell_count * CELL_EDGES(dim);
}

/* The first use of the boundary faces. */
static inline int64_t field_averages_faces(const struct field_averages *averages, int dim)
{
    return averages->cell_count * (CELL_EDGES(dim) + dim + 1);
}

/* The cell of a use. */
static inline int64_t field_averages_cell(const struct field_averages *averages, int dim, int64_t use)
{
    int64_t vertices = field_averages_vertices(averages, dim), faces = field_averages_faces(averages, dim);
    return use < vertices ? use / CELL_EDGES(dim)
           : use < faces  ? (use - vertices) / (dim + 1)
                          : averages->face_cell[use - faces];
}

/* The uses of cells first to last - 1: begin to end - 1 of each kind. */
enum { USE_EDGES, USE_VERTICES, USE_FACES, USE_KINDS };
void field_averages_uses(const struct field_averages *averages, int dim, int64_t first, int64_t last,
                         int64_t begin[USE_KINDS], int64_t end[USE_KINDS]);

/* The first boundary face of cell q, or of a cell after it. */
int64_t field_averages_face(const struct field_averages *averages, int64_t q);

/* From of_use and the blocks of the body: the uses of each row, and the parts of each block and row. */
MUST_CHECK enum status field_averages_list(struct body *body, struct error *error);

void field_averages_free(struct field_averages *averages);
