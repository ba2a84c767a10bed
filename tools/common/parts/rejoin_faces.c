#include "parts/rejoin.h"

#include "stages/stages.h"

#include "approx/cells/face_edges.h"
#include "base/lists.h"

#include <stdlib.h>

/* The face of the whole that equals a part's face whose first cell the part owns: it has the same nodes in
 * the same order. begin, face: the faces of each cell. */
static int64_t find_face(const struct rejoin *rejoin, const struct rejoin_part *part, const int64_t *begin,
                         const int32_t *face, int64_t local)
{
    int dim = rejoin->dim;
    int32_t cell = part->cell[part->faces.cell[2 * local]];
    for (int64_t i = begin[cell]; i < begin[cell + 1]; i++) {
        int same = 0;
        for (int a = 0; a < dim; a++) {
            same += rejoin->faces.node[(int64_t)face[i] * dim + a] ==
                    part->node[part->faces.node[local * dim + a]];
        }
        if (same == dim) {
            return face[i];
        }
    }
    tool_fail(rejoin->tool, STATUS_INPUT, "%s: faces: row %lld: not a face of the body: run ipoints again",
              part->file, (long long)local);
}

/* An edge, with its points, belongs to the part that owns the first of its faces. to[]: rows of edges, and
 * of boundary faces. */
static void map_edges(const struct rejoin *rejoin, const struct rejoin_part *part, const int32_t *first_face,
                      int32_t *to)
{
    const struct faces *faces = &part->faces;
    int edges = FACE_EDGES(rejoin->dim);
    const int32_t *face = part->to[ROWS_FACES];
    for (int64_t r = 0; r < face_row_count(faces); r++) {
        to[r] = -1;
    }
    for (int64_t i = 0; i < faces->count * edges && faces->edge_count > 0; i++) {
        int64_t whole = face[i / edges];
        int64_t edge = whole < 0 ? -1 : face_edge(&rejoin->faces, whole, (int)(i % edges));
        if (edge >= 0 && first_face[edge] == whole) {
            to[face_edge(faces, i / edges, (int)(i % edges))] = (int32_t)edge;
        }
    }
    for (int64_t r = faces->edge_count; r < face_row_count(faces); r++) {
        int32_t whole = face[r - faces->edge_count];
        to[r] = whole < 0 ? -1 : (int32_t)(rejoin->faces.edge_count + whole);
    }
}

/* The rows of edges, and the points of faces, of a part. */
static void map_rows(struct rejoin *rejoin, struct rejoin_part *part, const int32_t *first_face)
{
    const struct faces *faces = &part->faces;
    int per_face = FACE_POINTS(rejoin->dim);
    const int32_t *face = part->to[ROWS_FACES];
    int32_t *to = rejoin_new_rows(rejoin, part, ROWS_OF_EDGES, face_row_count(faces));
    int32_t *points = rejoin_new_rows(rejoin, part, ROWS_FACEPOINTS, face_point_count(faces));
    int32_t *boundary = rejoin_new_rows(rejoin, part, ROWS_BOUNDARY, face_boundary_points(faces));
    map_edges(rejoin, part, first_face, to);
    for (int64_t i = 0; i < face_boundary_points(faces); i++) {
        boundary[i] = face[i / per_face] < 0 ? -1 : (int32_t)(face[i / per_face] * per_face + i % per_face);
        points[i] = boundary[i];
    }
    for (int64_t e = 0; e < faces->edge_count; e++) {
        int count;
        int64_t first = face_row_points(faces, e, &count);
        int64_t whole = to[e] < 0 ? -1 : face_row_points(&rejoin->faces, to[e], &count);
        for (int g = 0; g < count; g++) {
            points[first + g] = whole < 0 ? -1 : (int32_t)(whole + g);
        }
    }
}

void rejoin_map_faces(struct rejoin *rejoin)
{
    const struct tool *tool = rejoin->tool;
    const struct section *points = stream_find(&rejoin->part[0].stream, "points.x");
    bool boundary_only = points != NULL && !points_are_smoothed(points);
    int64_t *begin;
    int32_t *face, *first_face;
    const struct cells whole = {.dim = rejoin->dim,
                                .node_count = rejoin->rows[ROWS_NODES],
                                .x = rejoin->x,
                                .count = rejoin->rows[ROWS_CELLS],
                                .node = rejoin->cell};
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        TOOL_TRY(tool, fail_in(&error, stream_faces(&part->stream, &part->cells, &part->faces, &error), "%s",
                               part->file));
    }
    TOOL_TRY(tool, faces_build(&whole, boundary_only, &rejoin->faces, &error));
    const struct faces *faces = &rejoin->faces;
    TOOL_TRY(tool, lists_by_row(faces->count, 2, faces->cell, whole.count, &begin, &face, &error));
    TOOL_TRY(tool, NEW_ARRAY(&first_face, faces->edge_count, &error));
    int edges = FACE_EDGES(rejoin->dim);
    for (int64_t i = faces->count * edges - 1; i >= 0 && faces->edge_count > 0; i--) {
        first_face[face_edge(faces, i / edges, (int)(i % edges))] = (int32_t)(i / edges);
    }
    for (int64_t k = 0; k < rejoin->part_count; k++) {
        struct rejoin_part *part = &rejoin->part[k];
        int32_t *to = rejoin_new_rows(rejoin, part, ROWS_FACES, part->faces.count);
        for (int64_t f = 0; f < part->faces.count; f++) {
            bool own = part->to[ROWS_CELLS][part->faces.cell[2 * f]] >= 0;
            to[f] = own ? (int32_t)find_face(rejoin, part, begin, face, f) : -1;
        }
        map_rows(rejoin, part, first_face);
    }
    FREE_ALL(begin, face, first_face);
    rejoin->rows[ROWS_FACES] = faces->count;
    rejoin->rows[ROWS_OF_EDGES] = face_row_count(faces);
    rejoin->rows[ROWS_FACEPOINTS] = face_point_count(faces);
    rejoin->rows[ROWS_BOUNDARY] = face_boundary_points(faces);
    rejoin_check_rows(rejoin, ROWS_FACES, "faces");
    rejoin_check_rows(rejoin, ROWS_OF_EDGES, "faces.edge");
}
